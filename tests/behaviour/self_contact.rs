//! A cloth with `SelfContact` keeps off itself, for as long as it has it and as it says.

use std::f32::consts::{FRAC_PI_2, PI};

use crate::common::sleep::*;
use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::cloth_solver::contact::SelfContacts;
use bevy_cloth::cloth_solver::measure;
use bevy_cloth::*;

fn crossings(app: &App, cloth: Entity) -> usize {
    measure::crossings(get::<ClothTopology>(app, cloth), get::<Particles>(app, cloth)).len()
}

fn own(app: &App, cloth: Entity) -> Option<&SelfContacts> {
    app.world().get::<SelfContacts>(cloth)
}

/// A sheet that falls on its edge and folds.
fn on_edge() -> impl Bundle {
    let tilted = Quat::from_rotation_x(0.15) * Quat::from_rotation_z(0.2);
    (
        Cloth::rectangle(0.4, 0.8).with_cells(12, 24),
        ClothStats::default(),
        Transform::from_xyz(0.0, 0.46, 0.0).with_rotation(tilted),
    )
}

/// An app with ground, and a cloth that falls on its edge.
fn falling(components: impl Bundle) -> (App, Entity) {
    let mut app = headless();
    app.world_mut().spawn(ClothCollider::Ground);
    let cloth = app.world_mut().spawn((on_edge(), components)).id();
    (app, cloth)
}

/// The most crossings after any of so many ticks.
fn most_crossings(app: &mut App, cloth: Entity, ticks: usize) -> usize {
    let after = (0..ticks).map(|_| {
        app.update();
        crossings(app, cloth)
    });
    after.max().unwrap_or_default()
}

/// Puts a cloth of 0.5 m into a fold 6 cm high, at rest; bent down so that one corner of the upper half pierces the lower if
/// `is_tangled`.
fn fold(app: &mut App, cloth: Entity, is_tangled: bool) {
    let topology = get::<ClothTopology>(app, cloth).clone();
    let mut particles = app.world_mut().get_mut::<Particles>(cloth).expect("it runs");
    let radius = 0.03;
    for slot in 0..topology.slots() {
        let mut x = Quat::from_rotation_x(-FRAC_PI_2) * topology.rest[slot];
        let (along, arc) = (x.x - 0.012, PI * radius);
        if along > arc {
            x = Vec3::new(0.012 + arc - along, 2.0 * radius, x.z);
        } else if along > 0.0 {
            let (sin, cos) = (along / radius).sin_cos();
            x = Vec3::new(0.012 + radius * sin, radius * (1.0 - cos), x.z);
        }
        if is_tangled && x.y >= 2.0 * radius {
            let hinge = Vec3::new(0.012, 2.0 * radius, x.z);
            x = hinge + Quat::from_rotation_z(0.9 * (-x.z / 0.25).max(0.0)) * (x - hinge);
        }
        particles.position.set(slot, x);
        particles.previous.set(slot, x);
        particles.velocity.set(slot, Vec3::ZERO);
    }
}

/// A cloth that floats where nothing else is, folded and perhaps tangled.
fn floating(components: impl Bundle, is_tangled: bool) -> (App, Entity) {
    let mut app = headless();
    note_events::<ClothTangled>(&mut app);
    note_events::<ClothUntangled>(&mut app);
    let cloth = (Cloth::rectangle(0.5, 0.5).with_cells(20, 20), Gravity(Vec3::ZERO), ClothStats::default());
    let cloth = app.world_mut().spawn((cloth, components)).id();
    app.update();
    fold(&mut app, cloth, is_tangled);
    (app, cloth)
}

#[test]
fn a_cloth_that_folds_keeps_off_itself_with_the_component_and_passes_through_itself_without() {
    let (mut app, cloth) = falling(SelfContact::default());
    let mut most_touching = 0;
    for _ in 0..160 {
        app.update();
        assert_eq!(crossings(&app, cloth), 0);
        let stats = get::<ClothStats>(&app, cloth);
        assert_eq!((stats.tangled, stats.self_contact_bounded), (0, false));
        most_touching = most_touching.max(stats.self_contacts);
    }
    assert!(most_touching > 10, "at most {most_touching} places touched");
    let (mut app, cloth) = falling(());
    let most = most_crossings(&mut app, cloth, 160);
    assert!(most > 10, "at most {most} crossings without");
    assert!(own(&app, cloth).is_none());
    assert_eq!(get::<ClothStats>(&app, cloth).self_contacts, 0);
}

#[test]
fn halves_that_close_on_each_other_stop_where_there_is_no_collider_at_all() {
    for (is_on, passes) in [(true, false), (false, true)] {
        let (mut app, cloth) = floating((), false);
        if is_on {
            app.world_mut().entity_mut(cloth).insert(SelfContact::default());
        }
        let mut particles = app.world_mut().get_mut::<Particles>(cloth).expect("it runs");
        for slot in 0..particles.slots() {
            let is_upper = particles.position.get(slot).y > 0.05;
            particles.velocity.set(slot, if is_upper { Vec3::NEG_Y * 2.0 } else { Vec3::ZERO });
        }
        assert_eq!(most_crossings(&mut app, cloth, 20) > 0, passes);
    }
}

#[test]
fn added_while_it_falls_it_holds_from_then_on_and_removed_no_more() {
    let (mut app, cloth) = falling(());
    run(&mut app, 4);
    app.world_mut().entity_mut(cloth).insert(SelfContact::default());
    app.update();
    assert!(own(&app, cloth).is_some());
    assert_eq!(most_crossings(&mut app, cloth, 30), 0);
    app.world_mut().entity_mut(cloth).remove::<SelfContact>();
    app.update();
    assert!(own(&app, cloth).is_none());
    assert!(most_crossings(&mut app, cloth, 100) > 0);
}

#[test]
fn its_numbers_are_those_of_the_component_and_of_the_fabric_whichever_changes() {
    let mut app = headless();
    let cloth = app.world_mut().spawn((on_edge(), SelfContact::default(), Fabric::TERRY_TOWEL)).id();
    let distance = |app: &mut App| {
        app.update();
        own(app, cloth).expect("it is there").distance()
    };
    assert_eq!(distance(&mut app), Fabric::TERRY_TOWEL.thickness);
    app.world_mut().entity_mut(cloth).insert(Fabric { thickness: 0.004, ..Fabric::TERRY_TOWEL });
    assert_eq!(distance(&mut app), 0.004);
    app.world_mut().entity_mut(cloth).insert(SelfContact { distance: Some(0.007), ..default() });
    assert_eq!(distance(&mut app), 0.007);
    app.world_mut().entity_mut(cloth).insert(Fabric { thickness: 0.005, ..Fabric::TERRY_TOWEL });
    assert_eq!(distance(&mut app), 0.007);
    app.world_mut().entity_mut(cloth).insert(SelfContact::default());
    assert_eq!(distance(&mut app), 0.005);
}

#[test]
fn another_shape_and_no_shape_any_more_are_followed() {
    let (mut app, cloth) = falling(SelfContact::default());
    run(&mut app, 40);
    app.world_mut().entity_mut(cloth).insert(Cloth::rectangle(0.3, 0.7).with_cells(9, 21));
    assert_eq!(most_crossings(&mut app, cloth, 120), 0);
    app.world_mut().trigger(ResetCloth { entity: cloth });
    assert_eq!(most_crossings(&mut app, cloth, 120), 0);
    app.world_mut().entity_mut(cloth).remove::<Cloth>();
    app.update();
    assert!(own(&app, cloth).is_none());
}

#[test]
fn while_its_entity_moves_and_turns_or_jumps_it_keeps_off_itself() {
    let (mut app, cloth) = falling(SelfContact::default());
    for tick in 0..160 {
        let mut place = app.world_mut().get_mut::<Transform>(cloth).expect("it has a place");
        place.translation.x += if tick == 100 { 5.0 } else { 0.01 };
        place.rotate_y(0.02);
        app.update();
        assert_eq!(crossings(&app, cloth), 0, "tick {tick}");
    }
}

#[test]
fn wrong_values_are_told_with_field_and_range_and_the_cloth_goes_on_where_it_was_once_they_are_mended() {
    let settings = SelfContact::default();
    for (wrong, field) in [
        (SelfContact { distance: Some(0.2), ..settings }, "`SelfContact::distance` is 0.2, allowed is 1e-6..=0.1 m"),
        (SelfContact { distance: Some(f32::NAN), ..settings }, "`SelfContact::distance` is NaN"),
        (SelfContact { friction: Some(-1.0), ..settings }, "`SelfContact::friction` is -1, allowed is 0..=10"),
        (SelfContact { rate: f32::INFINITY, ..settings }, "`SelfContact::rate` is inf"),
        (SelfContact { budget: 0, ..settings }, "`SelfContact::budget` is 0, allowed is 1..=1000"),
    ] {
        let (mut app, cloth) = falling(settings);
        note_events::<ClothRejected>(&mut app);
        run(&mut app, 40);
        let (before, distance) = (bits(&app, cloth), own(&app, cloth).map(SelfContacts::distance));
        app.world_mut().entity_mut(cloth).insert(wrong);
        run(&mut app, 5);
        let [ClothRejected { entity, error }] = seen(&app) else { panic!("{:?}", seen::<ClothRejected>(&app)) };
        assert!(*entity == cloth && error.to_string().starts_with(field), "{error}");
        assert_eq!(bits(&app, cloth), before, "it stands still");
        assert_eq!(own(&app, cloth).map(SelfContacts::distance), distance, "nothing is lost");
        app.world_mut().entity_mut(cloth).insert(settings);
        assert_eq!(most_crossings(&mut app, cloth, 60), 0);
        assert_ne!(bits(&app, cloth), before, "it goes on");
        assert!(!app.world().entity(cloth).contains::<ClothRejection>());
    }
}

#[test]
fn spawned_with_wrong_values_it_begins_once_they_are_mended() {
    let (mut app, cloth) = falling(SelfContact { budget: 0, ..default() });
    run(&mut app, 3);
    assert!(app.world().entity(cloth).contains::<ClothRejection>());
    app.world_mut().entity_mut(cloth).insert(SelfContact::default());
    assert_eq!(most_crossings(&mut app, cloth, 120), 0);
    assert!(own(&app, cloth).is_some());
}

#[test]
fn one_that_is_cut_while_it_folds_stays_finite_and_its_parts_keep_off_each_other() {
    let (mut app, cloth) = falling(SelfContact::default());
    note_events::<ClothRecovered>(&mut app);
    run(&mut app, 20);
    let ray = |x: f32| Ray3d::new(Vec3::new(x, 0.3, 2.0), Dir3::NEG_Z);
    app.world_mut().trigger(CutCloth { entity: cloth, from: ray(-1.0), to: ray(1.0), reach: 10.0 });
    app.update();
    assert_eq!(get::<ClothPieces>(&app, cloth).pieces.len(), 2);
    let slots = get::<ClothTopology>(&app, cloth).slots();
    assert_eq!(get::<Particles>(&app, cloth).slots(), slots);
    let with = (0..200).map(|_| {
        app.update();
        crossings(&app, cloth)
    });
    let with: Vec<usize> = with.collect();
    let last = with[with.len() - 1];
    assert_eq!(last, 0, "crossings of tick by tick: {with:?}");
    assert_eq!(seen::<ClothRecovered>(&app), []);
}

#[test]
fn a_tangled_cloth_says_so_once_is_untangled_and_says_that_once() {
    let (mut app, cloth) = floating(SelfContact::default(), true);
    let began = crossings(&app, cloth);
    app.update();
    let [told] = seen::<ClothTangled>(&app)[..] else { panic!("{:?}", seen::<ClothTangled>(&app)) };
    assert_eq!((told.entity, told.crossings > 0), (cloth, true));
    let stats = get::<ClothStats>(&app, cloth);
    assert!(stats.tangled > 5 && began > 5, "{began} crossings, {} found", stats.tangled);
    assert_eq!(take_messages::<ClothTangled>(&mut app), [told]);
    run(&mut app, 256);
    assert_eq!((crossings(&app, cloth), get::<ClothStats>(&app, cloth).tangled), (0, 0));
    assert_eq!(seen::<ClothTangled>(&app).len(), 1);
    assert_eq!(seen::<ClothUntangled>(&app), [ClothUntangled { entity: cloth }]);
}

#[test]
fn without_the_component_nobody_tells_of_a_tangle_and_who_loses_it_is_tangled_no_more() {
    let (mut app, cloth) = floating((), true);
    run(&mut app, 3);
    assert_eq!(seen::<ClothTangled>(&app), []);
    app.world_mut().entity_mut(cloth).insert(SelfContact::default());
    app.update();
    assert_eq!(seen::<ClothTangled>(&app).len(), 1);
    assert_eq!(seen::<ClothUntangled>(&app), []);
    app.world_mut().entity_mut(cloth).remove::<SelfContact>();
    run(&mut app, 2);
    assert_eq!(seen::<ClothUntangled>(&app), [ClothUntangled { entity: cloth }]);
}

#[test]
fn two_runs_are_the_same_to_the_last_bit_at_any_frame_rate() {
    let run_at = |ticks_per_frame: u32| {
        let (mut app, cloth) = falling(SelfContact::default());
        app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(TICK * ticks_per_frame));
        run(&mut app, 96 / ticks_per_frame as usize);
        bits(&app, cloth)
    };
    let once = run_at(1);
    assert_eq!(once, run_at(1));
    assert_eq!(once, run_at(4));
}

#[test]
fn a_folded_cloth_falls_asleep_and_wakes_when_the_component_comes_changes_or_goes() {
    let (mut app, cloth) = floating((SelfContact::default(), Air::default()), false);
    app.world_mut().spawn((ClothCollider::Ground, Transform::from_xyz(0.0, -0.03, 0.0)));
    app.world_mut().entity_mut(cloth).remove::<Gravity>();
    note_events::<ClothWoke>(&mut app);
    run_to_sleep(&mut app, cloth);
    assert_eq!(crossings(&app, cloth), 0);
    let touching = get::<ClothStats>(&app, cloth).self_contacts;
    assert!(touching > 10, "the layers touch in {touching} places");
    let asleep = bits(&app, cloth);
    run(&mut app, 10);
    assert_eq!(bits(&app, cloth), asleep);
    let other = SelfContact { rate: 20.0, ..default() };
    for change in 0..3 {
        run_to_sleep(&mut app, cloth);
        let before = seen::<ClothWoke>(&app).len();
        match change {
            0 => _ = app.world_mut().entity_mut(cloth).insert(other),
            1 => _ = app.world_mut().entity_mut(cloth).remove::<SelfContact>(),
            _ => _ = app.world_mut().entity_mut(cloth).insert(other),
        }
        app.update();
        assert_eq!(seen::<ClothWoke>(&app)[before..], [ClothWoke { entity: cloth, cause: WakeCause::Change }]);
        assert_eq!(own(&app, cloth).is_some(), change != 1);
    }
}

#[test]
fn one_that_is_written_to_without_a_change_sleeps_on() {
    let (mut app, cloth) = floating((SelfContact::default(), Air::default()), false);
    app.world_mut().spawn((ClothCollider::Ground, Transform::from_xyz(0.0, -0.03, 0.0)));
    app.world_mut().entity_mut(cloth).remove::<Gravity>();
    run_to_sleep(&mut app, cloth);
    app.world_mut().get_mut::<SelfContact>(cloth).expect("it has it").set_changed();
    run(&mut app, 3);
    assert!(is_asleep(&app, cloth));
}
