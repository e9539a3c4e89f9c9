//! A cloth that has come to rest falls asleep: it stands still, at no cost, until something could move it.

use crate::common::sleep::*;
use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;
use std::f32::consts::FRAC_PI_2;

#[test]
fn any_cloth_that_hangs_in_still_air_falls_asleep_and_says_so_once() {
    for seed in 0..cases(3, 12) {
        let mut bed = Bed::swinging(seed);
        let cloth = bed.cloth;
        run_to_sleep(&mut bed.app, cloth);
        assert_eq!(seen::<ClothFellAsleep>(&bed.app), [ClothFellAsleep { entity: cloth }], "seed {seed}");
        run(&mut bed.app, 64);
        assert_eq!(seen::<ClothFellAsleep>(&bed.app).len(), 1, "seed {seed}");
        assert_eq!(bed.causes(), [], "seed {seed}");
    }
}

/// Where it is pulled over an edge, contact gives some particles a velocity that takes them nowhere.
#[test]
fn cloth_that_lies_over_edges_falls_asleep() {
    let solids = [
        (ClothCollider::Cuboid { size: Vec3::splat(0.25) }, Quat::from_rotation_y(0.3)),
        (ClothCollider::Pyramid { base: Vec2::splat(0.4), height: 0.3 }, Quat::IDENTITY),
        (ClothCollider::Pyramid { base: Vec2::splat(0.4), height: 0.3 }, Quat::from_rotation_x(-1.03)),
    ];
    for (solid, rotation) in solids.into_iter().skip(cases(1, 0)) {
        let mut app = headless();
        let told = format!("{solid:?}");
        app.world_mut().spawn((solid, Transform::from_rotation(rotation)));
        app.world_mut().spawn((ClothCollider::Ground, Transform::from_xyz(0.0, -0.4, 0.0)));
        let lies = Transform::from_xyz(0.013, 0.3, 0.007).with_rotation(Quat::from_rotation_x(-FRAC_PI_2));
        let cloth = (Cloth::rectangle(0.5, 0.5).with_cells(16, 16), Air::default(), lies);
        let cloth = app.world_mut().spawn(cloth).id();
        let asleep = (0..ticks(25.0)).find(|_| {
            app.update();
            is_asleep(&app, cloth)
        });
        assert!(asleep.is_some(), "on {told}");
    }
}

#[test]
fn the_messages_are_those_of_the_events() {
    let mut bed = Bed::hanging(0);
    run_to_sleep(&mut bed.app, bed.cloth);
    let entity = bed.cloth;
    assert_eq!(take_messages::<ClothFellAsleep>(&mut bed.app), [ClothFellAsleep { entity }]);
    bed.world().trigger(WakeCloth { entity });
    bed.app.update();
    let woke = ClothWoke { entity, cause: WakeCause::Request };
    assert_eq!(take_messages::<ClothWoke>(&mut bed.app), [woke]);
}

#[test]
fn asleep_it_stands_still_to_the_last_bit_without_speed_or_substeps_and_nothing_writes_to_it() {
    #[derive(Resource, Default)]
    struct Written(usize);
    type Runtime = Or<(Changed<Particles>, Changed<cloth_solver::cloth::Constraints>, Changed<ClothHistory>)>;
    for seed in 0..4 {
        let mut bed = Bed::asleep(seed);
        let (app, cloth) = (&mut bed.app, bed.cloth);
        let particles = get::<Particles>(app, cloth);
        assert!(particles.velocity.x.iter().chain(&particles.velocity.y).all(|speed| *speed == 0.0));
        assert_eq!(get::<ClothHistory>(app, cloth).position, particles.position);
        let before = bits(app, cloth);
        app.init_resource::<Written>();
        app.add_systems(Last, |cloths: Query<(), Runtime>, mut written: ResMut<Written>| {
            written.0 += cloths.iter().count();
        });
        app.update();
        app.world_mut().resource_mut::<Written>().0 = 0;
        run(app, 64);
        assert_eq!(bits(app, cloth), before);
        assert_eq!(app.world().resource::<Written>().0, 0);
        let stats = get::<ClothStats>(app, cloth);
        assert!(stats.asleep && stats.substeps == 0 && stats.rms_speed == 0.0);
    }
}

#[test]
fn a_cloth_in_wind_does_not_fall_asleep() {
    for seed in 0..cases(2, 6) {
        let mut bed = Bed::hanging(seed);
        bed.world().resource_mut::<Shared<Wind>>().0 = Wind(Vec3::new(0.3, 0.0, 0.4));
        run(&mut bed.app, ticks(8.0));
        assert_eq!(seen::<ClothFellAsleep>(&bed.app), [], "seed {seed}");
    }
}

#[test]
fn a_wind_that_ends_lets_it_fall_asleep() {
    let mut bed = Bed::hanging(3);
    bed.world().resource_mut::<Shared<Wind>>().0 = Wind(Vec3::Z * 3.0);
    run(&mut bed.app, ticks(2.0));
    bed.world().resource_mut::<Shared<Wind>>().0 = Wind(Vec3::ZERO);
    run_to_sleep(&mut bed.app, bed.cloth);
}

#[test]
fn what_begins_to_fall_does_not_fall_asleep_however_weak_gravity_is() {
    let mut app = headless();
    let cloth = (Cloth::rectangle(0.3, 0.3).with_cells(4, 4), Gravity(Vec3::NEG_Y * 0.01));
    let cloth = app.world_mut().spawn(cloth).id();
    run(&mut app, ticks(2.9));
    assert!(!is_asleep(&app, cloth));
    let speed = -get::<Particles>(&app, cloth).velocity.get(0).y;
    assert!((0.028..0.03).contains(&speed), "{speed} m/s");
}

#[test]
fn what_drifts_without_gravity_goes_on_and_what_stands_there_falls_asleep() {
    let mut app = headless();
    let cloth = (Cloth::rectangle(0.3, 0.3).with_cells(4, 4), Gravity(Vec3::ZERO));
    let [still, drifting] = [(); 2].map(|()| app.world_mut().spawn(cloth.clone()).id());
    app.update();
    app.world_mut().get_mut::<Particles>(drifting).unwrap().velocity.fill(Vec3::X * 0.02);
    run(&mut app, ticks(5.0));
    assert!(is_asleep(&app, still) && !is_asleep(&app, drifting));
    let gone = centre(&app, drifting).x;
    assert!((gone - 0.1).abs() < 1e-3, "it drifted {gone} m");
}

#[test]
fn a_cloth_on_the_ground_falls_asleep() {
    let mut app = headless();
    let flat = Transform::from_xyz(0.0, 0.3, 0.0).with_rotation(Quat::from_rotation_x(-1.5));
    let cloth = (Cloth::rectangle(0.5, 0.5).with_cells(10, 10), flat, Air::default());
    let cloth = app.world_mut().spawn(cloth).id();
    app.world_mut().spawn(ClothCollider::Ground);
    run_to_sleep(&mut app, cloth);
    let lowest = world_positions(&app, cloth).iter().map(|point| point.y).fold(1.0, f32::min);
    assert!((0.0..0.02).contains(&lowest), "it lies at {lowest} m");
}

#[test]
fn switched_off_by_its_component_or_for_all_it_never_falls_asleep() {
    for own in [false, true] {
        let mut bed = Bed::hanging(1);
        match own {
            true => drop(bed.entity().insert(ClothSleep::NEVER)),
            false => bed.world().resource_mut::<Shared<ClothSleep>>().0 = ClothSleep::NEVER,
        }
        run(&mut bed.app, ticks(10.0));
        assert_eq!(seen::<ClothFellAsleep>(&bed.app), []);
    }
}

#[test]
fn switched_off_for_all_but_on_for_one_that_one_falls_asleep() {
    let mut bed = Bed::hanging(1);
    bed.world().resource_mut::<Shared<ClothSleep>>().0 = ClothSleep::NEVER;
    bed.entity().insert(ClothSleep::default());
    run_to_sleep(&mut bed.app, bed.cloth);
}

#[test]
fn it_sleeps_later_by_as_much_as_it_is_told_to_wait_longer() {
    let [soon, late] = [0.5, 2.5].map(|time| {
        let mut app = headless();
        let cloth = (Cloth::rectangle(0.4, 0.4).with_cells(8, 8), Pins::top(), Fabric::CANVAS, Air::default());
        let cloth = app.world_mut().spawn((cloth, ClothSleep { time, ..default() })).id();
        run_to_sleep(&mut app, cloth) as f32 * TICK.as_secs_f32()
    });
    assert!((late - soon - 2.0).abs() < 0.1, "after {soon} and {late} s");
}

#[test]
fn a_threshold_out_of_range_is_refused_by_name() {
    let mut bed = Bed::asleep(2);
    for (sleep, field) in [
        (ClothSleep { speed: f32::NAN, ..default() }, "ClothSleep::speed"),
        (ClothSleep { time: -1.0, ..default() }, "ClothSleep::time"),
        (ClothSleep { wind: 101.0, ..default() }, "ClothSleep::wind"),
    ] {
        bed.entity().insert(sleep);
        bed.app.update();
        let error = get::<ClothRejection>(&bed.app, bed.cloth).error().to_string();
        assert!(error.contains(field), "{error}");
        bed.entity().remove::<ClothSleep>();
        bed.app.update();
        assert!(!bed.entity().contains::<ClothRejection>());
    }
    run_to_sleep(&mut bed.app, bed.cloth);
}

#[test]
fn what_sleeps_and_wakes_does_the_same_to_the_last_bit_at_any_frame_rate() {
    let run_at = |ticks_per_frame: u32| {
        let mut bed = Bed::hanging(7);
        bed.app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(TICK * ticks_per_frame));
        // All that happens happens at ticks that all frame rates share.
        let frames = |seconds: f32| ticks(seconds) / ticks_per_frame as usize;
        let mut states = Vec::new();
        run(&mut bed.app, frames(8.0));
        for x in [1.0, -2.0, 0.5].into_iter().take(cases(1, 3)) {
            bed.entity().insert(Gravity(Vec3::new(x, -9.81, 0.3)));
            run(&mut bed.app, frames(0.5));
            let (cloth, moving) = (bed.cloth, bits(&bed.app, bed.cloth));
            run(&mut bed.app, frames(8.0));
            assert!(is_asleep(&bed.app, cloth));
            states.push((moving, bits(&bed.app, cloth)));
        }
        (states, bed.causes().len())
    };
    let once = run_at(1);
    assert_eq!(once.1, once.0.len(), "it woke each time");
    assert_eq!(once, run_at(1));
    assert_eq!(once, run_at(4));
}

#[test]
fn while_the_clock_is_paused_nothing_falls_asleep_or_is_confused() {
    let mut bed = Bed::swinging(5);
    run(&mut bed.app, 20);
    bed.world().resource_mut::<Time<ClothClock>>().pause();
    let before = bits(&bed.app, bed.cloth);
    run(&mut bed.app, ticks(3.0));
    assert!(!is_asleep(&bed.app, bed.cloth));
    assert_eq!(bits(&bed.app, bed.cloth), before);
    bed.world().resource_mut::<Time<ClothClock>>().unpause();
    run_to_sleep(&mut bed.app, bed.cloth);
}

#[test]
fn ticks_in_which_only_a_hand_moves_put_nothing_to_sleep() {
    let mut bed = Bed::swinging(5);
    let held = bed.world().spawn((Cloth::rectangle(0.3, 0.3).with_cells(4, 4), Pins::top())).id();
    run(&mut bed.app, 20);
    bed.world().resource_mut::<Time<ClothClock>>().pause();
    let grab = Grab { target: Vec3::Z, ..default() };
    bed.world().entity_mut(held).insert(Grabs(vec![grab]));
    run(&mut bed.app, ticks(3.0));
    assert!(!is_asleep(&bed.app, bed.cloth) && !is_asleep(&bed.app, held));
}

#[test]
fn a_cloth_grabbed_in_its_sleep_while_the_clock_is_paused_follows_the_hand() {
    let mut bed = Bed::asleep(4);
    bed.world().resource_mut::<Time<ClothClock>>().pause();
    run(&mut bed.app, 5);
    assert!(is_asleep(&bed.app, bed.cloth));
    let before = world_positions(&bed.app, bed.cloth);
    let target = centre(&bed.app, bed.cloth) + Vec3::Z;
    let triangle = get::<ClothTopology>(&bed.app, bed.cloth).triangles.len() as u32 / 2;
    bed.entity().insert(Grabs(vec![Grab { triangle, target, ..default() }]));
    run(&mut bed.app, 20);
    assert_eq!(bed.causes(), [WakeCause::Hand]);
    assert!(largest_move(&before, &world_positions(&bed.app, bed.cloth)) > 0.02);
}

#[test]
fn what_is_removed_or_despawned_in_its_sleep_leaves_nothing() {
    let mut bed = Bed::asleep(6);
    bed.entity().remove::<Cloth>();
    bed.app.update();
    let left: Vec<_> =
        bed.app.world().inspect_entity(bed.cloth).unwrap().map(|component| component.name().to_string()).collect();
    assert!(!left.iter().any(|name| name.contains("Asleep") || name.contains("Rest")), "{left:?}");
    bed.entity().insert(Cloth::rectangle(0.4, 0.4).with_cells(4, 4));
    run_to_sleep(&mut bed.app, bed.cloth);
    bed.entity().despawn();
    run(&mut bed.app, 3);
    assert!(!bed.causes().contains(&WakeCause::Change));
}

#[test]
fn a_clone_of_what_sleeps_is_awake() {
    let mut bed = Bed::asleep(6);
    let clone = bed.entity().clone_and_spawn();
    bed.app.update();
    assert!(!is_asleep(&bed.app, clone) && is_asleep(&bed.app, bed.cloth));
}

#[test]
fn debris_that_is_still_to_be_cleared_keeps_its_cloth_awake() {
    let mut app = headless();
    app.world_mut().spawn(ClothCollider::Ground);
    let flat = Transform::from_xyz(0.0, 0.02, 0.0).with_rotation(Quat::from_rotation_x(-1.57));
    let tearable = Tearable { debris_lifetime: 4.0, ..default() };
    let cloth = Cloth::rectangle(0.4, 0.4).with_cells(8, 8);
    let cloth = app.world_mut().spawn((cloth, flat, tearable, Air::default())).id();
    run(&mut app, 8);
    // A corner of one cell is cut off.
    let ray = |x: f32, z: f32| Ray3d::new(Vec3::new(x, 1.0, z), Dir3::NEG_Y);
    let (from, to) = (ray(0.1, 0.25), ray(0.25, 0.1));
    app.world_mut().trigger(CutCloth { entity: cloth, from, to, reach: 2.0 });
    app.update();
    assert_eq!(get::<ClothPieces>(&app, cloth).pieces.len(), 2);
    run(&mut app, ticks(3.0));
    assert!(!is_asleep(&app, cloth));
    run_to_sleep(&mut app, cloth);
    assert_eq!(get::<ClothPieces>(&app, cloth).pieces.len(), 1);
}
