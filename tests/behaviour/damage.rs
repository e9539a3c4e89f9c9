//! Cloth is torn by load and by order, cut by a pointer's right button and by order, and made whole by a reset.

use crate::common::*;
use bevy::picking::pointer::{PointerAction, PointerButton};
use bevy::prelude::*;
use bevy_cloth::*;

fn hung(app: &mut App) -> Entity {
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(16, 16), Pins::top())).id();
    run(app, 4);
    cloth
}

/// A blade through the world along −z, from one place in the plane to another.
fn blade(cloth: Entity, from: [f32; 2], to: [f32; 2]) -> CutCloth {
    let ray = |[x, y]: [f32; 2]| Ray3d::new(Vec3::new(x, y, 2.0), Dir3::NEG_Z);
    CutCloth { entity: cloth, from: ray(from), to: ray(to), reach: 10.0 }
}

fn pieces(app: &App, cloth: Entity) -> usize {
    app.world().get::<ClothPieces>(cloth).map_or(1, |pieces| pieces.pieces.len())
}

fn mass(app: &App, cloth: Entity) -> f64 {
    get::<Particles>(app, cloth).mass.iter().map(|mass| f64::from(*mass)).sum()
}

fn lowest(app: &App, cloth: Entity) -> f32 {
    world_positions(app, cloth).iter().map(|position| position.y).fold(f32::INFINITY, f32::min)
}

#[test]
fn a_cut_by_order_lets_the_lower_part_fall_and_is_told() {
    let mut app = headless();
    let cloth = hung(&mut app);
    note_events::<ClothCut>(&mut app);
    note_events::<PiecesSeparated>(&mut app);
    let before = mass(&app, cloth);
    app.world_mut().trigger(blade(cloth, [-0.7, 0.1], [0.7, 0.12]));
    app.update();
    assert_eq!(pieces(&app, cloth), 2);
    assert_eq!(seen::<ClothCut>(&app).len(), 1);
    let [apart] = seen::<PiecesSeparated>(&app)[..] else { panic!("not told once") };
    assert_eq!((apart.entity, apart.pieces), (cloth, 2));
    assert!((-0.6..0.15).contains(&apart.position.y), "the new piece hangs below: {}", apart.position);
    assert!((mass(&app, cloth) / before - 1.0).abs() < 1e-6);
    run(&mut app, 64);
    assert!(lowest(&app, cloth) < -4.0, "after a second the lower part is at {}", lowest(&app, cloth));
    let upper = world_positions(&app, cloth).iter().filter(|p| p.y > 0.0).count();
    assert!(upper >= 17 * 6, "{upper} particles still hang");
}

#[test]
fn a_reset_makes_a_cut_cloth_whole() {
    let mut app = headless();
    let cloth = hung(&mut app);
    let whole = get::<ClothTopology>(&app, cloth).triangles.clone();
    app.world_mut().trigger(blade(cloth, [-0.7, 0.1], [0.7, 0.12]));
    run(&mut app, 10);
    assert_ne!(get::<ClothTopology>(&app, cloth).triangles, whole);
    app.world_mut().trigger(ResetCloth { entity: cloth });
    run(&mut app, 2);
    assert_eq!(get::<ClothTopology>(&app, cloth).triangles, whole);
    assert!(app.world().get::<ClothPieces>(cloth).is_none());
    run(&mut app, 64);
    assert!((lowest(&app, cloth) + 0.5).abs() < 0.05);
}

#[test]
fn a_tearable_cloth_rips_under_a_load_and_another_does_not() {
    let mut app = headless();
    note_events::<ClothTorn>(&mut app);
    // The strength of cotton times the scale: 120 N/m, and 60 N hang on half a metre.
    let corner = PinSelect::Region { min: Vec3::new(-0.3, -0.26, -0.1), max: Vec3::new(0.3, -0.24, 0.1) };
    let cloth = || (Cloth::rectangle(0.5, 0.5).with_cells(12, 12), Pins::top(), Weights::one(corner.clone(), 12.0));
    let tearable = Tearable { scale: 0.01, ..default() };
    let torn = app.world_mut().spawn((cloth(), tearable)).id();
    let holds = app.world_mut().spawn(cloth()).id();
    run(&mut app, 128);
    assert!(!seen::<ClothTorn>(&app).is_empty());
    assert!(seen::<ClothTorn>(&app).iter().all(|event| event.entity == torn && event.overload > 1.0));
    assert!(lowest(&app, torn) < -1.0, "the weight fell to {}", lowest(&app, torn));
    assert!(lowest(&app, holds) > -0.6, "the other one hangs at {}", lowest(&app, holds));
    assert!(get::<Particles>(&app, torn).is_finite());
}

#[test]
fn a_curtain_is_reinforced_around_its_hooks_as_far_as_it_is_told() {
    let torn_at = |reinforcement: f32| {
        let mut app = headless();
        note_events::<ClothTorn>(&mut app);
        // 120 N/m, a cell of 0.05 m takes 6 N; each of two hooks carries 15.
        let hem = PinSelect::Region { min: Vec3::new(-0.6, -0.51, -0.1), max: Vec3::new(0.6, -0.49, 0.1) };
        let tearable = Tearable { scale: 0.01, reinforcement, reach: 0.12, ..default() };
        let hooks = Pins::region(Vec3::new(-0.21, 0.49, -0.1), Vec3::new(-0.19, 0.51, 0.1))
            .and(Pins::region(Vec3::new(0.19, 0.49, -0.1), Vec3::new(0.21, 0.51, 0.1)));
        let cloth = (Cloth::rectangle(1.0, 1.0).with_cells(20, 20), hooks, Weights::one(hem, 3.0), tearable);
        let cloth = app.world_mut().spawn(cloth).id();
        run(&mut app, 128);
        let hooks = [-0.2, 0.2].map(|x| Vec3::new(x, 0.5, 0.0));
        let away = |place: Vec3| hooks.map(|hook| hook.distance(place)).into_iter().fold(f32::INFINITY, f32::min);
        let rest = &get::<ClothTopology>(&app, cloth).rest;
        seen::<ClothTorn>(&app).iter().map(|torn| away(rest[torn.particle as usize])).collect::<Vec<f32>>()
    };
    let plain = torn_at(1.0);
    assert!(plain.first().is_some_and(|away| *away < 0.06), "{plain:?}");
    let firm = torn_at(1000.0);
    assert!(firm.first().is_some_and(|away| *away < 0.25) && firm.iter().all(|away| *away > 0.12), "{firm:?}");
}

#[test]
fn a_seam_that_is_painted_weak_tears_along_its_whole_length_and_nothing_else_does() {
    const SEAM: f32 = 0.125;
    let mut app = with_meshes();
    note_events::<ClothTorn>(&mut app);
    let mut sheet = Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(15).build();
    let places = sheet.attribute(Mesh::ATTRIBUTE_POSITION).and_then(|all| all.as_float3()).expect("positions").to_vec();
    let is_seam = |y: f32| (y - SEAM).abs() < 0.01;
    let strength: Vec<f32> = places.iter().map(|at| if is_seam(at[1]) { 0.2 } else { 1.0 }).collect();
    sheet.insert_attribute(ATTRIBUTE_STRENGTH, strength);
    let mesh = Mesh3d(app.world_mut().resource_mut::<Assets<Mesh>>().add(sheet));
    // 120 N/m hold, 24 at the seam; 30 N hang on a metre, and pull twice as hard when they are let go.
    let hem = PinSelect::Region { min: Vec3::new(-0.6, -0.51, -0.1), max: Vec3::new(0.6, -0.49, 0.1) };
    let cloth = (Cloth::mesh(), mesh, Pins::top(), Weights::one(hem, 3.0), Tearable { scale: 0.01, ..default() });
    let cloth = app.world_mut().spawn(cloth).id();
    run(&mut app, 128);
    let torn = seen::<ClothTorn>(&app);
    let rest = &get::<ClothTopology>(&app, cloth).rest;
    assert!(!torn.is_empty());
    for told in torn {
        assert!((rest[told.particle as usize].y - SEAM).abs() < 0.07, "torn at {}", rest[told.particle as usize]);
    }
    assert!(lowest(&app, cloth) < -1.0, "what is below fell to {}", lowest(&app, cloth));
}

#[test]
fn a_tear_by_order_parts_the_nearest_particle_and_a_pin_stays_with_its_side() {
    let mut app = headless();
    let cloth = hung(&mut app);
    let before = get::<ClothTopology>(&app, cloth).particle_count();
    app.world_mut().trigger(TearCloth { entity: cloth, position: Vec3::new(0.01, 0.5, 0.0), pull: Direction::Weft });
    app.update();
    assert_eq!(get::<ClothTopology>(&app, cloth).particle_count(), before + 1);
    assert_eq!(pieces(&app, cloth), 1);
    run(&mut app, 32);
    let pinned = world_positions(&app, cloth).iter().filter(|p| (p.y - 0.5).abs() < 1e-6).count();
    assert_eq!(pinned, 17, "every pin still holds one particle");
}

#[test]
fn debris_is_gone_after_its_time() {
    let mut app = headless();
    let tearable = Tearable { debris: 20, debris_lifetime: 0.5, ..default() };
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(16, 16), Pins::top(), tearable)).id();
    run(&mut app, 4);
    note_events::<DebrisGone>(&mut app);
    // The lower right corner.
    app.world_mut().trigger(blade(cloth, [0.36, -0.6], [0.6, -0.36]));
    app.update();
    assert_eq!(pieces(&app, cloth), 2);
    run(&mut app, 24);
    assert_eq!(pieces(&app, cloth), 2);
    run(&mut app, 16);
    assert_eq!(pieces(&app, cloth), 1);
    let [gone] = seen::<DebrisGone>(&app)[..] else { panic!("not told once") };
    assert!(gone.triangles < 20 && gone.position.y < -0.4, "{gone:?}");
}

#[test]
fn a_wrong_tearable_is_refused_by_name() {
    let mut app = headless();
    let tearable = Tearable { scale: -1.0, ..default() };
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(4, 4), tearable)).id();
    run(&mut app, 3);
    let text = get::<ClothRejection>(&app, cloth).error().to_string();
    assert!(text.contains("Tearable::scale") && text.contains("-1"), "{text}");
    app.world_mut().entity_mut(cloth).insert(Tearable::default());
    run(&mut app, 2);
    assert!(app.world().get::<ClothRejection>(cloth).is_none());
}

#[test]
fn a_torn_cloth_runs_the_same_to_the_bit_twice() {
    let once = || {
        let mut app = headless();
        let cloth = hung(&mut app);
        app.world_mut().trigger(blade(cloth, [-0.3, 0.1], [0.7, 0.31]));
        app.world_mut().trigger(TearCloth { entity: cloth, position: Vec3::ZERO, pull: Direction::Warp });
        run(&mut app, 64);
        bits(&app, cloth)
    };
    assert_eq!(once(), once());
}

#[test]
fn a_right_drag_across_cuts_in_two_also_in_one_frame_and_while_time_stands() {
    const MOVE: PointerAction = PointerAction::Move { delta: Vec2::ZERO };
    for (frames, paused) in [(1, false), (30, false), (3, true)] {
        let mut app = with_pointer();
        let cloth = hung(&mut app);
        send(&mut app, [20.0, 300.0], MOVE);
        app.update();
        if paused {
            app.world_mut().resource_mut::<Time<ClothClock>>().pause();
        }
        send(&mut app, [20.0, 300.0], PointerAction::Press(PointerButton::Secondary));
        for frame in 1..=frames {
            send(&mut app, [20.0 + 760.0 * frame as f32 / frames as f32, 310.0], MOVE);
            if frames > 1 {
                app.update();
            }
        }
        send(&mut app, [780.0, 310.0], PointerAction::Release(PointerButton::Secondary));
        app.update();
        assert_eq!(pieces(&app, cloth), 2, "{frames} frames");
        let after = get::<ClothTopology>(&app, cloth).triangles.len();
        send(&mut app, [400.0, 200.0], MOVE);
        app.update();
        assert_eq!(get::<ClothTopology>(&app, cloth).triangles.len(), after, "the button is up: nothing is cut");
    }
}

#[test]
fn a_right_drag_leaves_no_neck_in_a_curtain_that_swings_away() {
    const MOVE: PointerAction = PointerAction::Move { delta: Vec2::ZERO };
    let mut app = with_pointer();
    let cloth = hung(&mut app);
    for (slot, rest) in get::<ClothTopology>(&app, cloth).rest.clone().into_iter().enumerate() {
        let velocity = (0.5 - rest.y) * Vec3::new(2.0, 0.0, -1.5);
        app.world_mut().get_mut::<Particles>(cloth).unwrap().velocity.set(slot, velocity);
    }
    send(&mut app, [20.0, 300.0], MOVE);
    app.update();
    send(&mut app, [20.0, 300.0], PointerAction::Press(PointerButton::Secondary));
    for frame in 1..=25 {
        send(&mut app, [20.0 + 30.4 * frame as f32, 310.0], MOVE);
        app.update();
        // The slit is followed also where something else takes the cloth apart meanwhile.
        let tear = TearCloth { entity: cloth, position: Vec3::new(0.1, 0.4, 0.0), pull: Direction::Weft };
        app.world_mut().trigger(tear);
    }
    send(&mut app, [780.0, 310.0], PointerAction::Release(PointerButton::Secondary));
    run(&mut app, 64);
    let fallen = world_positions(&app, cloth).iter().filter(|p| p.y < -2.0).count();
    assert!(fallen > 100, "{fallen} particles fell: the lower part hangs by a neck");
}

#[test]
fn a_left_drag_rips_a_tearable_cloth() {
    const MOVE: PointerAction = PointerAction::Move { delta: Vec2::ZERO };
    let mut app = with_pointer();
    let tearable = Tearable { scale: 0.004, ..default() };
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(16, 16), Pins::top(), tearable)).id();
    run(&mut app, 4);
    note_events::<ClothTorn>(&mut app);
    send(&mut app, [400.0, 400.0], MOVE);
    app.update();
    send(&mut app, [400.0, 400.0], PointerAction::Press(PointerButton::Primary));
    for step in 1..=40 {
        send(&mut app, [400.0, 400.0 + 5.0 * step as f32], MOVE);
        app.update();
    }
    run(&mut app, 40);
    assert!(!seen::<ClothTorn>(&app).is_empty(), "the pull of the hand tears");
    assert_eq!(get::<Grabs>(&app, cloth).0.len(), 1, "it still holds on");
    assert!(get::<Particles>(&app, cloth).is_finite());
}
