//! The method is a setting: shared or of one cloth, changed at any time, with iterations for those that iterate.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::cloth_solver::cloth::Constraints;
use bevy_cloth::*;

/// Soft enough for every method, also those that step forces, with 100 substeps in a tick.
const SOFT: Fabric = Fabric {
    areal_density: 0.1,
    stretch_warp: 5.0,
    stretch_weft: 5.0,
    shear: 2.0,
    bend_warp: 1e-6,
    bend_weft: 1e-6,
    damping: 10.0,
    ..Fabric::COTTON_POPLIN
};

fn sheet() -> impl Bundle {
    (Cloth::rectangle(0.3, 0.3).with_cells(6, 6), SOFT, Pins::top())
}

/// Substeps in which `method` copes with [`SOFT`].
fn budget(method: Method) -> Substeps {
    let count = if method.steps_forces() { 100 } else { 10 };
    Substeps { count, max: count, iterations: if method.iterates() { 4 } else { 1 } }
}

fn method_of(app: &App, cloth: Entity) -> Method {
    get::<Constraints>(app, cloth).method()
}

#[test]
fn every_method_carries_a_sheet_that_hangs() {
    let mut app = headless();
    note_events::<ClothRecovered>(&mut app);
    let hung: Vec<_> = Method::ALL
        .into_iter()
        .map(|method| (method, app.world_mut().spawn((sheet(), method, budget(method))).id()))
        .collect();
    run(&mut app, 32);
    assert!(seen::<ClothRecovered>(&app).is_empty(), "{:?}", seen::<ClothRecovered>(&app));
    for (method, cloth) in hung {
        let positions = world_positions(&app, cloth);
        let (low, high) = positions.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), position| {
            assert!(position.is_finite(), "{method:?}: {position}");
            (low.min(*position), high.max(*position))
        });
        // At rest it is stretched by half its weight over its width, 3 %.
        assert!((-0.17..-0.149).contains(&low.y) && high.y == 0.15, "{method:?}: from {low} to {high}");
        assert!(low.x > -0.16 && high.x < 0.16 && high.z - low.z < 0.02, "{method:?}: from {low} to {high}");
    }
}

#[test]
fn another_method_goes_on_with_the_shape_and_the_speed_of_the_cloth() {
    let mut app = headless();
    let cloth = app.world_mut().spawn((sheet(), Gravity(Vec3::new(2.0, -9.81, 4.0)))).id();
    for method in Method::ALL {
        run(&mut app, 6);
        let before = world_positions(&app, cloth);
        app.update();
        let usual = largest_move(&before, &world_positions(&app, cloth));

        app.world_mut().resource_mut::<Time<ClothClock>>().pause();
        let (shape, speed) = (world_positions(&app, cloth), get::<Particles>(&app, cloth).velocity.clone());
        app.world_mut().entity_mut(cloth).insert((method, budget(method)));
        run(&mut app, 2);
        assert_eq!(world_positions(&app, cloth), shape, "{method:?}");
        assert_eq!(get::<Particles>(&app, cloth).velocity, speed, "{method:?}");

        app.world_mut().resource_mut::<Time<ClothClock>>().unpause();
        app.update();
        let moved = largest_move(&shape, &world_positions(&app, cloth));
        assert_eq!(method_of(&app, cloth), method);
        // Gravity alone adds 2.6 mm. Position-based dynamics knows no soft fabric and takes all stretch out at once.
        let more = if method == Method::Pbd { 0.1 } else { 0.003 };
        assert!(moved < usual + more, "{method:?}: {moved} m in a tick, {usual} m in the one before");
    }
}

#[test]
fn a_method_of_its_own_overrides_the_shared_one() {
    let mut app = headless();
    let own = app.world_mut().spawn((sheet(), Method::XpbdSweeps)).id();
    let other = app.world_mut().spawn(sheet()).id();
    run(&mut app, 2);
    assert_eq!((method_of(&app, own), method_of(&app, other)), (Method::XpbdSweeps, Method::default()));
    app.world_mut().resource_mut::<Shared<Method>>().0 = Method::Pbd;
    run(&mut app, 2);
    assert_eq!((method_of(&app, own), method_of(&app, other)), (Method::XpbdSweeps, Method::Pbd));
    app.world_mut().entity_mut(own).remove::<Method>();
    run(&mut app, 2);
    assert_eq!((method_of(&app, own), method_of(&app, other)), (Method::Pbd, Method::Pbd));
}

#[test]
fn the_method_outlives_another_fabric_and_a_recovery() {
    let mut app = headless();
    let cloth = app.world_mut().spawn((sheet(), Method::Pbd)).id();
    run(&mut app, 2);
    app.world_mut().entity_mut(cloth).insert(Fabric::COTTON_JERSEY);
    run(&mut app, 2);
    assert_eq!(method_of(&app, cloth), Method::Pbd);
    app.world_mut().get_mut::<Particles>(cloth).expect("running").velocity.set(8, Vec3::NAN);
    run(&mut app, 2);
    assert_eq!(method_of(&app, cloth), Method::Pbd);
}

#[test]
fn iterations_change_what_iterates_and_nothing_else() {
    let mut app = headless();
    for method in Method::ALL {
        let mut spawn = |iterations| {
            let substeps = Substeps { iterations, ..budget(method) };
            app.world_mut().spawn((sheet(), method, substeps, Gravity(Vec3::new(2.0, -9.81, 4.0)))).id()
        };
        let (few, many) = (spawn(1), spawn(3));
        run(&mut app, 5);
        let same = bits(&app, few) == bits(&app, many);
        assert_eq!(same, !method.iterates(), "{method:?}");
        for cloth in [few, many] {
            app.world_mut().despawn(cloth);
        }
    }
}

#[test]
fn no_iterations_are_refused() {
    for iterations in [0, 101] {
        let mut app = headless();
        note_events::<ClothRejected>(&mut app);
        let cloth = app.world_mut().spawn((sheet(), Substeps { iterations, ..default() })).id();
        run(&mut app, 3);
        let told: Vec<_> = seen::<ClothRejected>(&app).iter().map(|event| event.error.to_string()).collect();
        assert_eq!(told.len(), 1, "told once: {told:?}");
        for part in ["Substeps::iterations", &iterations.to_string(), "1..=100"] {
            assert!(told[0].contains(part), "`{}` does not say {part}", told[0]);
        }
        app.world_mut().entity_mut(cloth).insert(Substeps::default());
        run(&mut app, 3);
        assert!(app.world().get::<ClothRejection>(cloth).is_none(), "still refused");
    }
}
