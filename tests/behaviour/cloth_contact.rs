//! Cloths with `SelfContact` keep off one another, wherever their entities are, and wake and fall asleep together.

use std::f32::consts::FRAC_PI_2;

use crate::common::sleep::*;
use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::cloth_solver::measure;
use bevy_cloth::*;

/// Edges through triangles, of each of two cloths through itself and the other.
fn crossings(app: &App, cloths: [Entity; 2]) -> usize {
    let of = |cloth| (&***get::<ClothTopology>(app, cloth), get::<Particles>(app, cloth));
    let [first, second] = cloths.map(of);
    let [pose, other] = cloths.map(|cloth| get::<ClothFrame>(app, cloth).pose);
    let own = [first, second].map(|(topology, particles)| measure::crossings(topology, particles).len());
    let between = measure::crossings_between(first, second, &pose.inverse_pose(&other)).map(|found| found.len());
    own.into_iter().chain(between).sum()
}

fn towel(cells: u32, height: f32, turn: f32) -> impl Bundle {
    let flat = Quat::from_rotation_y(turn) * Quat::from_rotation_z(0.1) * Quat::from_rotation_x(-FRAC_PI_2);
    (
        Cloth::rectangle(0.4, 0.3).with_cells(cells + 3, cells),
        Fabric::TERRY_TOWEL,
        Transform::from_xyz(0.05 * turn, height, 0.0).with_rotation(flat),
    )
}

/// Two towels over the ground, one above the other.
fn towels(components: [SelfContact; 2]) -> (App, [Entity; 2]) {
    let mut app = headless();
    app.world_mut().spawn(ClothCollider::Ground);
    let [lower, upper] = components;
    let lower = app.world_mut().spawn((towel(9, 0.06, 0.0), lower, ClothStats::default())).id();
    let upper = app.world_mut().spawn((towel(11, 0.25, 0.7), upper, ClothStats::default())).id();
    (app, [lower, upper])
}

/// The most crossings after any of so many ticks.
fn most_crossings(app: &mut App, cloths: [Entity; 2], ticks: usize) -> usize {
    let after = (0..ticks).map(|_| {
        app.update();
        crossings(app, cloths)
    });
    after.max().unwrap_or_default()
}

#[test]
fn one_towel_lands_on_another_and_passes_through_it_if_one_does_not_keep_off_others() {
    let (mut app, cloths) = towels([SelfContact::default(); 2]);
    assert_eq!(most_crossings(&mut app, cloths, 200), 0);
    for cloth in cloths {
        let stats = get::<ClothStats>(&app, cloth);
        assert!(stats.self_contacts > 0 && stats.tangled == 0, "{stats:?}");
    }
    let alone = SelfContact { others: false, ..default() };
    let (mut app, cloths) = towels([alone, SelfContact::default()]);
    assert!(most_crossings(&mut app, cloths, 100) > 0);
}

#[test]
fn a_cloth_thrown_onto_a_hanging_one_does_not_pass_while_their_entities_move_and_turn() {
    for (case, speed) in [1.0, 4.0, 9.0, 20.0].into_iter().enumerate() {
        let mut app = headless();
        let hanging = (
            Cloth::rectangle(0.8, 0.8).with_cells(14, 14),
            Pins::rods(5),
            SelfContact::default(),
            Transform::from_xyz(3.0, 1.0, 0.0).with_rotation(Quat::from_rotation_y(0.4)),
        );
        let hanging = app.world_mut().spawn(hanging).id();
        let thrown = (
            Cloth::rectangle(0.4, 0.3).with_cells(9, 9),
            SelfContact::default(),
            Transform::from_xyz(3.0, 1.0, 0.25).with_rotation(Quat::from_rotation_x(case as f32)),
        );
        let thrown = app.world_mut().spawn(thrown).id();
        app.update();
        let turn = get::<ClothFrame>(&app, thrown).pose.rotation.inverse();
        let mut particles = app.world_mut().get_mut::<Particles>(thrown).expect("it runs");
        particles.velocity.fill(turn * Vec3::NEG_Z * speed);
        let mut touching = 0;
        for tick in 0..80 {
            // What is free keeps its place in the world.
            let mut place = app.world_mut().get_mut::<Transform>(thrown).expect("it has a place");
            place.translation.x += 0.02;
            place.rotate_y(0.03);
            let mut place = app.world_mut().get_mut::<Transform>(hanging).expect("it has a place");
            place.translation.z += 0.002;
            app.update();
            assert_eq!(crossings(&app, [hanging, thrown]), 0, "{speed} m/s, tick {tick}");
            let own = get::<bevy_cloth::cloth_solver::contact::SelfContacts>(&app, thrown);
            touching = touching.max(own.touching());
        }
        assert!(touching > 0, "{speed} m/s");
    }
}

#[test]
fn towels_that_lie_on_each_other_fall_asleep_together_and_wake_together() {
    let (mut app, [lower, upper]) = towels([SelfContact::default(); 2]);
    note_events::<ClothWoke>(&mut app);
    run_to_sleep(&mut app, upper);
    assert!(is_asleep(&app, lower));
    let before = [lower, upper].map(|cloth| bits(&app, cloth));
    run(&mut app, 10);
    assert_eq!([lower, upper].map(|cloth| bits(&app, cloth)), before);
    app.world_mut().trigger(WakeCloth { entity: lower });
    run(&mut app, 2);
    assert!(!is_asleep(&app, upper));
    assert!(seen::<ClothWoke>(&app).contains(&ClothWoke { entity: upper, cause: WakeCause::Cloth }));
    run_to_sleep(&mut app, lower);
    assert!(is_asleep(&app, upper));
}

#[test]
fn a_cloth_far_from_one_that_wakes_sleeps_on_and_one_that_is_taken_away_is_no_neighbor() {
    let (mut app, [lower, upper]) = towels([SelfContact::default(); 2]);
    let far = (towel(6, 0.05, 0.0), SelfContact::default());
    let far = app.world_mut().spawn(far).id();
    app.world_mut().get_mut::<Transform>(far).expect("it has a place").translation.x = 5.0;
    run_to_sleep(&mut app, upper);
    run_to_sleep(&mut app, far);
    app.world_mut().trigger(WakeCloth { entity: far });
    run(&mut app, 3);
    assert!(!is_asleep(&app, far) && is_asleep(&app, lower) && is_asleep(&app, upper));
    app.world_mut().trigger(WakeCloth { entity: lower });
    run(&mut app, 3);
    assert!(!is_asleep(&app, upper));
    app.world_mut().despawn(upper);
    run(&mut app, 3);
    run_to_sleep(&mut app, lower);
}

#[test]
fn two_cloths_move_the_same_to_the_last_bit_in_two_runs_at_any_frame_rate() {
    let run_at = |ticks_per_frame: u32| {
        let (mut app, cloths) = towels([SelfContact::default(); 2]);
        app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(TICK * ticks_per_frame));
        run(&mut app, 96 / ticks_per_frame as usize);
        cloths.map(|cloth| bits(&app, cloth))
    };
    let once = run_at(1);
    assert_eq!(once, run_at(1));
    assert_eq!(once, run_at(4));
}

#[test]
fn one_that_is_cut_while_it_lies_on_another_does_not_pass_through_it() {
    let (mut app, cloths) = towels([SelfContact::default(); 2]);
    assert_eq!(most_crossings(&mut app, cloths, 40), 0);
    let ray = |x: f32| Ray3d::new(Vec3::new(x, 2.0, 0.02), Dir3::NEG_Y);
    app.world_mut().trigger(CutCloth { entity: cloths[1], from: ray(-1.0), to: ray(1.0), reach: 10.0 });
    app.update();
    assert!(get::<ClothPieces>(&app, cloths[1]).pieces.len() > 1);
    assert_eq!(most_crossings(&mut app, cloths, 120), 0);
}
