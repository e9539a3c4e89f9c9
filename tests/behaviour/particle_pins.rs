//! Pins on single particles, made and released while the cloth runs.

use crate::common::*;
use bevy::picking::pointer::{PointerAction, PointerButton};
use bevy::prelude::*;
use bevy_cloth::*;

/// A cloth of 1 m × 1 m that hangs by its top edge, and its particle in the middle.
fn hung(pins: Pins) -> (App, Entity, u32) {
    let mut app = headless();
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(16, 16), pins)).id();
    run(&mut app, 8);
    let middle = get::<ClothTopology>(&app, cloth).grid.expect("a rectangle has a grid").slot(8, 8);
    (app, cloth, middle)
}

fn place(app: &App, cloth: Entity, particle: u32) -> Vec3 {
    let local = get::<Particles>(app, cloth).position.get(particle as usize);
    get::<ClothFrame>(app, cloth).to_world(local)
}

fn is_held(app: &App, cloth: Entity, particle: u32) -> bool {
    get::<Particles>(app, cloth).inverse_mass[particle as usize] == 0.0
}

fn pin(app: &mut App, entity: Entity, particle: u32, to: PinTarget) {
    app.world_mut().trigger(PinParticle { entity, particle, to });
    app.update();
}

#[test]
fn a_particle_is_pinned_where_it_is_and_not_where_it_was_at_rest() {
    let (mut app, cloth, middle) = hung(Pins::top());
    let grab = Grab { triangle: 2 * (8 * 16 + 8), target: Vec3::new(0.0, 0.0, 0.4), ..default() };
    app.world_mut().entity_mut(cloth).insert(Grabs(vec![grab]));
    run(&mut app, 64);
    let pulled = place(&app, cloth, middle);
    assert!(pulled.z > 0.05, "pulled to {pulled}");
    pin(&mut app, cloth, middle, PinTarget::World);
    let there = place(&app, cloth, middle);
    app.world_mut().entity_mut(cloth).remove::<Grabs>();
    run(&mut app, 128);
    assert!(place(&app, cloth, middle).distance(there) < 1e-5, "it is at {}", place(&app, cloth, middle));
    app.world_mut().trigger(UnpinParticle { entity: cloth, particle: middle });
    run(&mut app, 256);
    assert!(place(&app, cloth, middle).z < 0.5 * pulled.z, "it hangs at {}", place(&app, cloth, middle));
}

#[test]
fn it_works_while_the_clock_is_paused_and_moves_nothing() {
    let (mut app, cloth, middle) = hung(Pins::top());
    app.world_mut().resource_mut::<Time<ClothClock>>().pause();
    let before = world_positions(&app, cloth);
    pin(&mut app, cloth, middle, PinTarget::World);
    run(&mut app, 4);
    assert!(is_held(&app, cloth, middle));
    assert_eq!(world_positions(&app, cloth), before);
    app.world_mut().trigger(UnpinParticle { entity: cloth, particle: middle });
    run(&mut app, 4);
    assert!(!is_held(&app, cloth, middle));
}

#[test]
fn it_survives_other_pins_another_fabric_and_a_cut() {
    let (mut app, cloth, middle) = hung(Pins::top());
    pin(&mut app, cloth, middle, PinTarget::World);
    let there = place(&app, cloth, middle);
    app.world_mut().entity_mut(cloth).insert((Pins::corners(), Fabric::CANVAS));
    run(&mut app, 16);
    let ray = |x: f32| Ray3d::new(Vec3::new(x, 0.2, 1.0), Dir3::NEG_Z);
    app.world_mut().trigger(CutCloth { entity: cloth, from: ray(-1.0), to: ray(1.0), reach: 5.0 });
    run(&mut app, 64);
    assert_eq!(get::<ClothPieces>(&app, cloth).pieces.len(), 2);
    assert!(place(&app, cloth, middle).distance(there) < 1e-4, "it is at {}", place(&app, cloth, middle));
    assert!(is_held(&app, cloth, middle));
}

#[test]
fn a_pin_on_an_entity_moves_with_it_and_so_does_one_on_the_cloth() {
    let (mut app, cloth, middle) = hung(Pins::top().to_world());
    let hand = app.world_mut().spawn(Transform::from_xyz(0.3, 0.2, 0.1)).id();
    pin(&mut app, cloth, middle, PinTarget::Entity(hand));
    let corner = get::<ClothTopology>(&app, cloth).grid.expect("a grid").slot(16, 0);
    pin(&mut app, cloth, corner, PinTarget::Cloth);
    let (before, corner_before) = (place(&app, cloth, middle), place(&app, cloth, corner));
    app.world_mut().get_mut::<Transform>(hand).unwrap().translation.z += 0.05;
    app.world_mut().get_mut::<Transform>(cloth).unwrap().translation.x += 0.03;
    run(&mut app, 8);
    assert!((place(&app, cloth, middle) - before).distance(0.05 * Vec3::Z) < 1e-4);
    assert!((place(&app, cloth, corner) - corner_before).distance(0.03 * Vec3::X) < 1e-4);
}

#[test]
fn a_released_particle_of_pins_comes_off_and_all_others_stay() {
    let (mut app, cloth, _) = hung(Pins::top());
    app.world_mut().trigger(UnpinParticle { entity: cloth, particle: 0 });
    run(&mut app, 32);
    assert!(!is_held(&app, cloth, 0) && is_held(&app, cloth, 1) && is_held(&app, cloth, 16));
    app.world_mut().entity_mut(cloth).remove::<ParticlePins>();
    run(&mut app, 2);
    assert!(is_held(&app, cloth, 0), "nothing releases it any more");
}

#[test]
fn a_reset_takes_the_pins_out_and_leaves_the_cloth_at_rest() {
    let (mut app, cloth, middle) = hung(Pins::top());
    let at = Vec3::new(0.0, 0.1, 0.3);
    let pins =
        ParticlePins { held: vec![ParticlePin { particle: middle, to: PinTarget::World, at }], released: vec![0] };
    app.world_mut().entity_mut(cloth).insert(pins);
    run(&mut app, 64);
    assert!(place(&app, cloth, middle).distance(at) < 1e-5);
    app.world_mut().trigger(ResetCloth { entity: cloth });
    run(&mut app, 4);
    assert!(app.world().get::<ParticlePins>(cloth).is_none());
    assert!(is_held(&app, cloth, 0) && !is_held(&app, cloth, middle));
    let rest = get::<ClothTopology>(&app, cloth).rest[middle as usize];
    assert!(place(&app, cloth, middle).distance(rest) < 0.02, "it is at {}", place(&app, cloth, middle));
}

#[test]
fn a_reset_puts_the_cloth_to_where_its_entity_was_moved() {
    for paused in [false, true] {
        let (mut app, cloth, middle) = hung(Pins::top());
        if paused {
            app.world_mut().resource_mut::<Time<ClothClock>>().pause();
        }
        app.world_mut().get_mut::<Transform>(cloth).unwrap().translation.x += 0.4;
        app.world_mut().trigger(ResetCloth { entity: cloth });
        run(&mut app, 4);
        let rest = get::<ClothTopology>(&app, cloth).rest[middle as usize] + 0.4 * Vec3::X;
        assert!(place(&app, cloth, middle).distance(rest) < 0.02, "paused: {paused}");
    }
}

#[test]
fn in_a_pause_cloth_follows_what_it_hangs_on_and_no_time_passes() {
    let (mut app, cloth, middle) = hung(Pins::top());
    app.world_mut().resource_mut::<Time<ClothClock>>().pause();
    let (before, time) = (place(&app, cloth, middle), app.world().resource::<Time<ClothClock>>().elapsed());
    for _ in 0..60 {
        app.world_mut().get_mut::<Transform>(cloth).unwrap().translation.x += 0.01;
        app.update();
    }
    let moved = place(&app, cloth, middle) - before;
    assert!(moved.x > 0.3, "moved by {moved}");
    assert_eq!(app.world().resource::<Time<ClothClock>>().elapsed(), time);
    let stood = bits(&app, cloth);
    run(&mut app, 4);
    assert_eq!(bits(&app, cloth), stood, "nothing moves it any more");
}

#[test]
fn wrong_pins_are_refused_by_name_and_the_others_hold() {
    let (mut app, cloth, middle) = hung(Pins::top());
    let pin =
        |particle, at| ParticlePins { held: vec![ParticlePin { particle, to: PinTarget::World, at }], ..default() };
    for (pins, told) in [
        (pin(100_000, Vec3::ZERO), "ParticlePin::particle"),
        (pin(middle, Vec3::splat(f32::NAN)), "ParticlePin::at"),
        (ParticlePins { released: vec![100_000], ..default() }, "ParticlePins::released"),
    ] {
        app.world_mut().entity_mut(cloth).insert(pins);
        run(&mut app, 2);
        let rejection = get::<ClothRejection>(&app, cloth).error().to_string();
        assert!(rejection.contains(told), "{rejection}");
        assert!(is_held(&app, cloth, 0) && !is_held(&app, cloth, middle));
    }
    app.world_mut().entity_mut(cloth).insert(pin(middle, Vec3::ZERO));
    run(&mut app, 2);
    assert!(app.world().get::<ClothRejection>(cloth).is_none() && is_held(&app, cloth, middle));
}

#[test]
fn a_pin_on_an_entity_that_is_not_there_yet_holds_once_it_is() {
    let (mut app, cloth, middle) = hung(Pins::top());
    let hand = app.world_mut().spawn_empty().id();
    let pin = ParticlePin { particle: middle, to: PinTarget::Entity(hand), at: Vec3::ZERO };
    app.world_mut().entity_mut(cloth).insert(ParticlePins { held: vec![pin], ..default() });
    run(&mut app, 2);
    assert!(!is_held(&app, cloth, middle));
    app.world_mut().entity_mut(hand).insert(Transform::from_xyz(0.0, 0.0, 0.1));
    run(&mut app, 4);
    assert!(place(&app, cloth, middle).distance(Vec3::new(0.0, 0.0, 0.1)) < 1e-5);
}

#[test]
fn a_button_that_is_a_pin_pins_what_it_presses_and_unpins_it_again() {
    let mut app = with_pointer();
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(16, 16), Pins::top())).id();
    run(&mut app, 4);
    app.world_mut().resource_mut::<ClothPicking>().primary = Some(ClothTool::Pin);
    let mut held = Vec::new();
    for _ in 0..2 {
        for action in [PointerAction::Press(PointerButton::Primary), PointerAction::Release(PointerButton::Primary)] {
            send(&mut app, [400.0, 300.0], PointerAction::Move { delta: Vec2::ZERO });
            app.update();
            send(&mut app, [400.0, 300.0], action);
            run(&mut app, 2);
        }
        held.push(app.world().get::<ParticlePins>(cloth).map_or(0, |pins| pins.held.len()));
    }
    assert_eq!(held, [1, 0]);
}
