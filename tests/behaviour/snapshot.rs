//! A snapshot of a cloth goes on as the cloth does, and the cloth knows nothing of it.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::cloth_solver::Particles;
use bevy_cloth::*;

#[test]
fn a_snapshot_goes_on_as_the_cloth_itself_does() {
    let mut app = headless();
    let curtain = (Cloth::rectangle(0.6, 0.5).with_cells(12, 10), Pins::rods(2), Air::default(), Tearable::default());
    let place = Transform::from_xyz(3.0, 1.0, 0.0).with_rotation(Quat::from_rotation_x(0.4));
    let cloth = app.world_mut().spawn((curtain, place)).id();
    app.world_mut().spawn((ClothCollider::Sphere { radius: 0.15 }, Transform::from_xyz(3.0, 0.9, 0.1)));
    run(&mut app, 20);
    let mut copy = ClothSnapshot::take(app.world(), cloth).expect("it runs");
    assert!(copy.tearing.is_some() && copy.cloth.air.is_some());
    run(&mut app, 20);
    (0..20).for_each(|_| copy.cloth.step(copy.tick, copy.gravity));
    let particles = app.world().get::<Particles>(cloth).unwrap();
    let apart = copy.cloth.topology.particles().map(|slot| {
        let slot = slot as usize;
        particles.position.get(slot).distance(copy.cloth.particles.position.get(slot))
    });
    let farthest = apart.fold(0.0, f32::max);
    assert!(farthest < 1e-4, "{farthest} m apart");
}

#[test]
fn there_is_no_snapshot_of_what_is_no_cloth_or_was_refused() {
    let mut app = headless();
    let nothing = app.world_mut().spawn_empty().id();
    let wrong = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0), Fabric { areal_density: -1.0, ..default() })).id();
    run(&mut app, 2);
    for entity in [nothing, wrong, Entity::PLACEHOLDER] {
        assert!(ClothSnapshot::take(app.world(), entity).is_none());
    }
}
