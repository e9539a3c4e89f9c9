//! Every component of a cloth or collider may be inserted, changed and removed at any time.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;

/// A cloth of 8 × 8 cells on two rods that has swung for a while.
fn swinging() -> (App, Entity) {
    let mut app = headless();
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.5, 0.5).with_cells(8, 8), Pins::rods(2))).id();
    run(&mut app, 30);
    (app, cloth)
}

/// The largest distance any particle moves in the tick after `change`.
fn jump(change: impl FnOnce(&mut App, Entity)) -> f32 {
    let (mut app, cloth) = swinging();
    let before = world_positions(&app, cloth);
    change(&mut app, cloth);
    app.update();
    largest_move(&before, &world_positions(&app, cloth))
}

#[test]
fn another_fabric_keeps_shape_and_speed() {
    let (mut app, cloth) = swinging();
    let speed = get::<Particles>(&app, cloth).velocity.clone();
    app.world_mut().resource_mut::<Time<ClothClock>>().pause();
    let before = world_positions(&app, cloth);
    app.world_mut().entity_mut(cloth).insert(Fabric::DENIM_11_OZ);
    app.update();
    assert_eq!(world_positions(&app, cloth), before);
    let particles = get::<Particles>(&app, cloth);
    assert_eq!(particles.velocity, speed);
    let density = particles.mass.iter().sum::<f32>() / 0.25;
    assert!((density - Fabric::DENIM_11_OZ.areal_density).abs() < 1e-3, "it weighs {density} kg/m²");
    assert_eq!(particles.inverse_mass[0], 0.0, "it lost its pins");
}

#[test]
fn a_fabric_that_is_removed_is_plain_cotton() {
    let (mut app, cloth) = swinging();
    app.world_mut().entity_mut(cloth).insert(Fabric::DENIM_11_OZ);
    run(&mut app, 2);
    app.world_mut().entity_mut(cloth).remove::<Fabric>();
    run(&mut app, 2);
    let weight = get::<Particles>(&app, cloth).mass.iter().sum::<f32>();
    assert!((weight / 0.25 - Fabric::COTTON_POPLIN.areal_density).abs() < 1e-3);
}

#[test]
fn touching_a_component_without_changing_it_changes_nothing() {
    let (mut app, cloth) = swinging();
    let (mut untouched, other) = swinging();
    for _ in 0..10 {
        let mut entity = app.world_mut().entity_mut(cloth);
        entity.get_mut::<Cloth>().unwrap().set_changed();
        entity.get_mut::<Fabric>().unwrap().set_changed();
        entity.get_mut::<Pins>().unwrap().set_changed();
        entity.get_mut::<Transform>().unwrap().set_changed();
        app.update();
        untouched.update();
        assert_eq!(bits(&app, cloth), bits(&untouched, other));
    }
}

#[test]
fn more_rods_hold_at_once_and_move_nothing_else() {
    let moved = jump(|app, cloth| {
        app.world_mut().entity_mut(cloth).insert(Pins::rods(9));
    });
    assert!(moved < 0.05, "a particle moved {moved} m");
}

#[test]
fn pins_that_are_removed_let_go() {
    let (mut app, cloth) = swinging();
    app.world_mut().entity_mut(cloth).remove::<Pins>();
    run(&mut app, 64);
    assert!(centre(&app, cloth).y < -2.0);
    assert!(get::<Particles>(&app, cloth).inverse_mass[0] > 0.0);
}

#[test]
fn pins_that_come_later_hold() {
    let mut app = headless();
    let cloth = app.world_mut().spawn(Cloth::rectangle(0.5, 0.5).with_cells(8, 8)).id();
    run(&mut app, 4);
    app.world_mut().entity_mut(cloth).insert(Pins::top());
    run(&mut app, 64);
    assert!(centre(&app, cloth).y > -0.1);
}

#[test]
fn another_size_or_resolution_makes_another_cloth_with_the_same_pins() {
    let (mut app, cloth) = swinging();
    app.world_mut().entity_mut(cloth).insert(Cloth::rectangle(1.0, 0.25).with_cells(4, 2));
    run(&mut app, 64);
    let topology = get::<ClothTopology>(&app, cloth);
    assert_eq!(topology.particle_count(), 15);
    let particles = get::<Particles>(&app, cloth);
    let [left, right] = [(0, 0), (0, 4)].map(|(row, column)| topology.grid.unwrap().slot(row, column) as usize);
    assert_eq!(particles.position.get(left), Vec3::new(-0.5, 0.125, 0.0));
    assert_eq!(particles.position.get(right), Vec3::new(0.5, 0.125, 0.0));
}

#[test]
fn changes_show_while_the_clock_is_paused() {
    let (mut app, cloth) = swinging();
    app.world_mut().resource_mut::<Time<ClothClock>>().pause();
    app.world_mut().entity_mut(cloth).insert(Cloth::rectangle(2.0, 2.0).with_cells(4, 4));
    app.update();
    assert_eq!(get::<ClothTopology>(&app, cloth).particle_count(), 25);
}

#[test]
fn scale_is_part_of_the_rest_shape() {
    let (mut app, cloth) = swinging();
    app.world_mut().get_mut::<Transform>(cloth).unwrap().scale = Vec3::new(2.0, 3.0, 1.0);
    app.update();
    let rest = &get::<ClothTopology>(&app, cloth).rest;
    assert_eq!(rest[0], Vec3::new(-0.5, 0.75, 0.0));
    let weight = get::<Particles>(&app, cloth).mass.iter().sum::<f32>();
    assert!((weight - 1.5 * Fabric::COTTON_POPLIN.areal_density).abs() < 1e-4, "scaled cloth weighs {weight} kg");
}

#[test]
fn a_cloth_that_is_removed_leaves_nothing_and_may_come_back() {
    let (mut app, cloth) = swinging();
    app.world_mut().entity_mut(cloth).remove::<Cloth>();
    app.update();
    let left: Vec<_> = app.world().inspect_entity(cloth).unwrap().map(|component| component.name()).collect();
    for gone in ["Particles", "Constraints", "Contacts", "ClothTopology", "ClothFrame", "ClothHistory"] {
        assert!(!left.iter().any(|name| name.ends_with(gone)), "{gone} is left behind");
    }
    run(&mut app, 4);
    app.world_mut().entity_mut(cloth).insert(Cloth::rectangle(1.0, 1.0));
    run(&mut app, 4);
    assert!(centre(&app, cloth).y < 0.0);
}

#[test]
fn a_part_of_the_runtime_state_that_someone_removes_is_made_anew() {
    let (mut app, cloth) = swinging();
    app.world_mut().entity_mut(cloth).remove::<Particles>();
    run(&mut app, 8);
    assert!(centre(&app, cloth).y < 0.0);
}

#[test]
fn a_clone_of_a_cloth_is_a_cloth_of_its_own_from_the_same_mesh() {
    let mut app = with_meshes();
    let sheet = Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(3).build();
    let sheet = app.world_mut().resource_mut::<Assets<Mesh>>().add(sheet);
    let cloth = app.world_mut().spawn((Cloth::mesh(), Mesh3d(sheet.clone()), Pins::top())).id();
    run(&mut app, 8);
    let clone = app.world_mut().entity_mut(cloth).clone_and_spawn();
    run(&mut app, 8);
    assert_eq!(get::<ClothTopology>(&app, clone).particle_count(), 25);
    assert_ne!(get::<Mesh3d>(&app, clone).0, get::<Mesh3d>(&app, cloth).0);
    assert_ne!(bits(&app, clone), bits(&app, cloth), "they fell for different times");
    app.world_mut().entity_mut(clone).remove::<Cloth>();
    run(&mut app, 2);
    assert_eq!(get::<Mesh3d>(&app, clone).0, sheet);
}

#[test]
fn gravity_of_its_own_overrides_the_shared_one_until_it_is_removed() {
    let mut app = headless();
    let fall = |app: &mut App, cloth| {
        let before = centre(app, cloth);
        run(app, 32);
        centre(app, cloth) - before
    };
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.2, 0.2).with_cells(4, 4), Gravity(Vec3::X))).id();
    run(&mut app, 2);
    let own = fall(&mut app, cloth);
    assert!(own.x > 0.1 && own.y == 0.0, "{own}");
    app.world_mut().resource_mut::<Shared<Gravity>>().0 = Gravity(Vec3::Z);
    app.world_mut().entity_mut(cloth).remove::<Gravity>();
    let shared = fall(&mut app, cloth);
    assert!(shared.z > 0.1 && shared.y.abs() < 1e-3, "{shared}");
}

#[test]
fn substeps_of_its_own_override_the_shared_ones() {
    let mut app = headless();
    let cloth = Cloth::rectangle(0.2, 0.2).with_cells(4, 4);
    let own =
        app.world_mut().spawn((cloth.clone(), Substeps { count: 3, max: 3, ..default() }, ClothStats::default())).id();
    let shared = app.world_mut().spawn((cloth, ClothStats::default())).id();
    app.world_mut().resource_mut::<Shared<Substeps>>().0 = Substeps { count: 17, max: 17, ..default() };
    run(&mut app, 3);
    assert_eq!(get::<ClothStats>(&app, own).substeps, 3);
    assert_eq!(get::<ClothStats>(&app, shared).substeps, 17);
}

#[test]
fn load_raises_the_substeps_up_to_the_maximum_and_rest_brings_them_back() {
    let mut app = headless();
    let budget = Substeps { count: 2, max: 12, ..default() };
    let cloth =
        (Cloth::rectangle(1.0, 2.0), Pins::rods(2), budget, Gravity(Vec3::NEG_Y * 100.0), ClothStats::default());
    // Stiffer shear asks for more than two substeps at rest, too.
    let fabric = Fabric { shear: 10.0, ..Fabric::COTTON_POPLIN };
    let cloth = app.world_mut().spawn((cloth, fabric, ClothSleep::NEVER)).id();
    run(&mut app, 30);
    assert_eq!(get::<ClothStats>(&app, cloth).substeps, 12);
    app.world_mut().entity_mut(cloth).insert(Gravity(Vec3::ZERO));
    app.world_mut().trigger(ResetCloth { entity: cloth });
    run(&mut app, 64);
    assert_eq!(get::<ClothStats>(&app, cloth).substeps, 2);
}

#[test]
fn a_collider_may_change_its_shape_and_size_under_a_cloth() {
    let mut app = headless();
    let flat = Transform::from_xyz(0.0, 0.6, 0.0).with_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2));
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.5, 0.5).with_cells(10, 10), flat)).id();
    let collider = app.world_mut().spawn(ClothCollider::Cuboid { size: Vec3::splat(1.0) }).id();
    run(&mut app, 64);
    let on_box = centre(&app, cloth).y;
    assert!((on_box - 0.5).abs() < 0.03, "on the box it lies at {on_box}");
    app.world_mut().entity_mut(collider).insert(ClothCollider::Cuboid { size: Vec3::new(1.0, 0.4, 1.0) });
    run(&mut app, 64);
    let lower = centre(&app, cloth).y;
    assert!((lower - 0.2).abs() < 0.03, "on the lower box it lies at {lower}");
    app.world_mut().entity_mut(collider).remove::<ClothCollider>();
    run(&mut app, 64);
    assert!(centre(&app, cloth).y < -1.0);
}

#[test]
fn friction_of_a_collider_overrides_that_of_the_fabric() {
    let slide = |friction: Option<ColliderFriction>| {
        let mut app = headless();
        let slope = Quat::from_rotation_z(-0.35);
        let flat = Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
        let at = Transform::from_translation(slope * Vec3::new(0.0, 0.02, 0.0)).with_rotation(slope * flat);
        let cloth = app.world_mut().spawn((Cloth::rectangle(0.2, 0.2).with_cells(4, 4), at)).id();
        let ground = app.world_mut().spawn((ClothCollider::Ground, Transform::from_rotation(slope))).id();
        if let Some(friction) = friction {
            app.world_mut().entity_mut(ground).insert(friction);
        }
        run(&mut app, 64);
        centre(&app, cloth).length()
    };
    let [fabric, ice, rubber] = [None, Some(0.0), Some(2.0)].map(|f| slide(f.map(ColliderFriction)));
    assert!(ice > 1.0, "on ice it slid {ice} m");
    assert!(rubber < 0.1, "on rubber it slid {rubber} m");
    assert!(ice > fabric + 0.5, "its own friction does nothing: {fabric} m");
}

#[test]
fn a_reset_puts_the_cloth_back_to_its_rest_pose_even_while_paused() {
    let (mut app, cloth) = swinging();
    note_events::<ClothReset>(&mut app);
    app.world_mut().resource_mut::<Time<ClothClock>>().pause();
    app.world_mut().trigger(ResetCloth { entity: cloth });
    app.update();
    let (particles, topology) = (get::<Particles>(&app, cloth), get::<ClothTopology>(&app, cloth));
    assert_eq!(topology.rest, (0..topology.slots()).map(|slot| particles.position.get(slot)).collect::<Vec<_>>());
    assert!(particles.velocity.x.iter().all(|v| *v == 0.0));
    assert_eq!(seen::<ClothReset>(&app), [ClothReset { entity: cloth }]);
    assert_eq!(take_messages::<ClothReset>(&mut app).len(), 1);
}

#[test]
fn everything_changed_in_every_tick_stays_finite() {
    let (mut app, cloth) = swinging();
    let ball = app.world_mut().spawn((ClothCollider::default(), Transform::from_xyz(0.0, -0.4, 0.1))).id();
    let fabrics = [Fabric::COTTON_POPLIN, Fabric::DENIM_11_OZ, Fabric::SILK_CHARMEUSE];
    for round in 0..120_u32 {
        let mut entity = app.world_mut().entity_mut(cloth);
        entity.insert((fabrics[round as usize % 3], Pins::rods(round % 5), Gravity(Vec3::Y * (round as f32 - 60.0))));
        if round % 7 == 0 {
            entity.insert(Cloth::rectangle(0.5, 0.5).with_cells(3 + round % 6, 4 + round % 3));
        }
        if round % 11 == 0 {
            entity.remove::<(Transform, Pins)>();
        }
        entity.insert(
            Transform::from_xyz((round % 3) as f32 * 0.1, 0.0, 0.0).with_scale(Vec3::splat(1.0 + (round % 2) as f32)),
        );
        let shape = match round % 4 {
            0 => ClothCollider::Sphere { radius: 0.2 },
            1 => ClothCollider::Cuboid { size: Vec3::splat(0.3) },
            2 => ClothCollider::Pyramid { base: Vec2::splat(0.4), height: 0.3 },
            _ => ClothCollider::Capsule { radius: 0.1, length: 0.3 },
        };
        app.world_mut().entity_mut(ball).insert(shape);
        app.update();
        assert!(get::<Particles>(&app, cloth).is_finite(), "round {round}");
    }
    assert_eq!(take_messages::<ClothRecovered>(&mut app), []);
}
