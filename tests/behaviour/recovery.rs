//! A number that is not finite harms one cloth for one tick, and nothing else at all.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;

/// Two hanging clothes over a ball, two metres apart.
fn two_cloths() -> (App, Entity, Entity) {
    let mut app = headless();
    note_events::<ClothRecovered>(&mut app);
    let cloth = (Cloth::rectangle(1.0, 1.0).with_cells(12, 12), Pins::corners(), ClothStats::default());
    let victim = app.world_mut().spawn(cloth.clone()).id();
    let witness = app.world_mut().spawn((cloth, Transform::from_xyz(2.0, 0.0, 0.0))).id();
    app.world_mut().spawn((ClothCollider::Sphere { radius: 0.2 }, Transform::from_xyz(0.0, 0.0, 0.1)));
    run(&mut app, 20);
    (app, victim, witness)
}

/// Does `harm` to one of two clothes for one tick, and checks what must hold whatever it was: the victim is finite
/// after every tick and told of once, and the other is as it would have been.
fn survives(harm: impl FnOnce(&mut App, Entity)) {
    let _ = survived(harm, |_, _| {});
}

/// The same, with something done after the first tick; and what is left of the victim's world.
fn survived(harm: impl FnOnce(&mut App, Entity), mend: impl FnOnce(&mut App, Entity)) -> (App, Entity) {
    let (mut unharmed, _, undisturbed) = two_cloths();
    let (mut app, victim, witness) = two_cloths();
    harm(&mut app, victim);
    let mut mend = Some(mend);
    for _ in 0..32 {
        app.update();
        unharmed.update();
        if let Some(mend) = mend.take() {
            mend(&mut app, victim);
        }
        assert!(get::<Particles>(&app, victim).is_finite());
        assert_eq!(bits(&app, witness), bits(&unharmed, undisturbed));
    }
    assert_eq!(seen::<ClothRecovered>(&app), [ClothRecovered { entity: victim }]);
    assert_eq!(take_messages::<ClothRecovered>(&mut app).len(), 0, "told again, in the last two updates");
    (app, victim)
}

#[test]
fn a_position_that_a_system_spoils_is_undone() {
    let (mut app, victim, _) = two_cloths();
    let before = world_positions(&app, victim);
    let velocity = &get::<Particles>(&app, victim).velocity;
    let fastest = (0..velocity.len()).map(|i| velocity.get(i).length()).fold(0.0, f32::max);
    app.world_mut().get_mut::<Particles>(victim).unwrap().position.x[40] = f32::NAN;
    app.update();
    let moved = largest_move(&before, &world_positions(&app, victim));
    // It is where it was a tick ago: no farther than it came since.
    let came = fastest / 60.0 + 0.01;
    assert!(moved < came, "it lost its shape: a particle moved {moved} m in a tick, not {came} m");
    assert_eq!(take_messages::<ClothRecovered>(&mut app), [ClothRecovered { entity: victim }]);
    survives(|app, victim| app.world_mut().get_mut::<Particles>(victim).unwrap().position.x[40] = f32::NAN);
}

#[test]
fn a_velocity_that_is_infinite_is_undone() {
    survives(|app, victim| app.world_mut().get_mut::<Particles>(victim).unwrap().velocity.z[3] = f32::INFINITY);
}

#[test]
fn a_mass_that_is_spoilt_is_undone() {
    survives(|app, victim| {
        let mut particles = app.world_mut().get_mut::<Particles>(victim).unwrap();
        particles.inverse_mass.fill(f32::NAN);
    });
}

#[test]
fn a_force_that_is_not_a_number_is_undone() {
    survives(|app, victim| {
        let mut particles = app.world_mut().get_mut::<Particles>(victim).unwrap();
        particles.add_force(50, Vec3::new(0.0, f32::NAN, 0.0));
    });
}

#[test]
fn a_recovered_cloth_runs_on_and_keeps_its_pins() {
    let spoil = |app: &mut App, victim| {
        app.world_mut().get_mut::<Particles>(victim).unwrap().position.x.fill(f32::NAN);
    };
    let (app, victim) = survived(spoil, |_, _| {});
    let topology = get::<ClothTopology>(&app, victim);
    let corner = topology.grid.unwrap().slot(0, 0) as usize;
    assert_eq!(get::<Particles>(&app, victim).position.get(corner), topology.rest[corner]);
    assert!(get::<ClothStats>(&app, victim).rms_speed > 0.0);
}

#[test]
fn a_transform_that_is_not_a_number_for_one_frame_is_passed_over() {
    let _ = survived(
        |app, victim| app.world_mut().get_mut::<Transform>(victim).unwrap().translation.x = f32::NAN,
        |app, victim| app.world_mut().get_mut::<Transform>(victim).unwrap().translation.x = 0.0,
    );
}

/// A cloth that lies on a table.
fn laid() -> (App, Entity, Entity) {
    let mut app = headless();
    note_events::<ColliderRejected>(&mut app);
    let flat = Transform::from_xyz(0.0, 0.27, 0.0).with_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2));
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.3, 0.3).with_cells(6, 6), flat)).id();
    let table = app.world_mut().spawn(ClothCollider::Cuboid { size: Vec3::new(1.0, 0.5, 1.0) }).id();
    run(&mut app, 32);
    (app, cloth, table)
}

#[test]
fn a_collider_that_is_nowhere_for_some_frames_stays_where_it_was() {
    let (mut unharmed, undisturbed, _) = laid();
    let (mut app, cloth, table) = laid();
    for place in [f32::NAN, f32::INFINITY, f32::NAN, 0.0, 0.0] {
        app.world_mut().get_mut::<Transform>(table).unwrap().translation.y = place;
        app.update();
        unharmed.update();
        assert_eq!(bits(&app, cloth), bits(&unharmed, undisturbed), "with the table at {place} m");
    }
    let told = seen::<ColliderRejected>(&app);
    assert_eq!(told.len(), 1, "told once: {told:?}");
    assert_eq!(told[0].entity, table);
    assert!(told[0].error.to_string().contains("Transform"), "{}", told[0].error);
}
