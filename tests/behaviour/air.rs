//! Air slows what falls and carries what flies, in the world whatever the cloth's frame does, and without it nothing does.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;

/// A sheet that keeps its form.
const BOARD: Fabric = Fabric { bend_warp: 1.0, bend_weft: 1.0, damping: 10.0, ..Fabric::COTTON_POPLIN };

/// Lies on its back, face up.
fn flat() -> Transform {
    Transform::from_xyz(0.0, 100.0, 0.0).with_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2))
}

fn flag(app: &mut App) -> Entity {
    let cloth = Cloth::rectangle(1.0, 0.5).with_cells(20, 10);
    let pole = Pins::vertices((0..=10).map(|row| row * 21));
    app.world_mut().spawn((cloth, Fabric::FLAG_POLYESTER, pole)).id()
}

/// Mean place of the edge that flies, m.
fn free_edge(app: &App, flag: Entity) -> Vec3 {
    let positions = world_positions(app, flag);
    (0..=10).map(|row| positions[row * 21 + 20]).sum::<Vec3>() / 11.0
}

#[test]
fn a_flat_sheet_broadside_falls_at_its_terminal_velocity() {
    let mut app = headless();
    let air = Air::default();
    let cloth = Cloth::rectangle(1.0, 1.0).with_cells(10, 10);
    let cloth = app.world_mut().spawn((cloth, BOARD, air, flat())).id();
    run(&mut app, 100);
    let from = centre(&app, cloth).y;
    run(&mut app, 20);
    let speed = (from - centre(&app, cloth).y) / (20.0 * TICK.as_secs_f32());
    let expected = (2.0 * BOARD.areal_density * 9.81 / (air.density * air.normal)).sqrt();
    assert!((speed / expected - 1.0).abs() < 0.01, "falls at {speed} m/s, expected are {expected} m/s");
}

#[test]
fn a_flag_streams_out_in_the_wind_and_hangs_down_in_a_calm() {
    let mut app = headless();
    let (streaming, hanging) = (flag(&mut app), flag(&mut app));
    app.world_mut().entity_mut(streaming).insert((Air::default(), Wind(Vec3::new(12.0, 0.0, 1.0))));
    // A breath, or it would stand for ever in its own plane.
    app.world_mut().entity_mut(hanging).insert((Air::default(), Wind(Vec3::Z * 0.3)));
    run(&mut app, 256);
    let (streams, hangs) = (free_edge(&app, streaming), free_edge(&app, hanging));
    assert!(streams.x > 0.25, "in the wind the free edge is at {streams}");
    assert!(hangs.x < -0.2 && hangs.y < streams.y - 0.2, "in a calm at {hangs}, in the wind at {streams}");
}

#[test]
fn the_shared_wind_blows_where_there_is_none_of_ones_own() {
    let mut app = headless();
    app.insert_resource(Shared(Gravity(Vec3::ZERO))).insert_resource(Shared(Wind(Vec3::Z * 3.0)));
    let cloth = || (Cloth::rectangle(0.4, 0.4).with_cells(4, 4), Air::default());
    let shared = app.world_mut().spawn(cloth()).id();
    let own = app.world_mut().spawn((cloth(), Wind(Vec3::NEG_Z))).id();
    run(&mut app, 64);
    let (shared, own) = (centre(&app, shared).z, centre(&app, own).z);
    assert!(shared > 0.5 && own < -0.1, "{shared} m and {own} m along z");
}

#[test]
fn without_air_the_wind_changes_not_a_bit() {
    let mut app = headless();
    let (calm, windy) = (flag(&mut app), flag(&mut app));
    app.world_mut().entity_mut(windy).insert(Wind(Vec3::new(50.0, 3.0, 20.0)));
    run(&mut app, 64);
    assert_eq!(bits(&app, calm), bits(&app, windy));
    assert!(get::<Particles>(&app, windy).airflow.is_none(), "no memory either");
}

#[test]
fn air_that_is_taken_away_lets_the_cloth_fall_freely() {
    let mut app = headless();
    let cloth =
        app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(6, 6), BOARD, Air::default(), flat())).id();
    run(&mut app, 64);
    app.world_mut().entity_mut(cloth).remove::<Air>();
    let speed = |app: &App| {
        let particles = get::<Particles>(app, cloth);
        let masses: f32 = particles.mass.iter().sum();
        (0..particles.slots()).map(|i| particles.velocity.get(i) * particles.mass[i]).sum::<Vec3>().length() / masses
    };
    let before = speed(&app);
    run(&mut app, 32);
    let gained = speed(&app) - before;
    assert!((gained - 9.81 * 0.5).abs() < 0.01, "gained {gained} m/s in half a second");
    assert!(get::<Particles>(&app, cloth).airflow.is_none());
}

#[test]
fn a_frame_that_moves_or_turns_makes_no_wind() {
    let mut app = headless();
    app.insert_resource(Shared(Gravity(Vec3::ZERO)));
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(6, 6), BOARD, Air::default())).id();
    run(&mut app, 2);
    let before = world_positions(&app, cloth);
    for _ in 0..64 {
        let mut transform = app.world_mut().get_mut::<Transform>(cloth).unwrap();
        transform.translation += Vec3::new(0.01, 0.0, 0.05);
        transform.rotate_y(0.03);
        app.update();
    }
    let moved = largest_move(&before, &world_positions(&app, cloth));
    assert!(moved < 1e-4, "a sheet at rest went {moved} m with its frame");
}

#[test]
fn wind_comes_from_the_same_side_however_the_cloth_is_turned() {
    let blown = |rotation: Quat| {
        let mut app = headless();
        app.insert_resource(Shared(Gravity(Vec3::ZERO)));
        let cloth = Cloth::rectangle(0.4, 0.4).with_cells(4, 4);
        let place = Transform::from_rotation(rotation);
        let cloth = app.world_mut().spawn((cloth, BOARD, Air::default(), Wind(Vec3::Z * 2.0), place)).id();
        run(&mut app, 64);
        centre(&app, cloth)
    };
    let (plain, turned) = (blown(Quat::IDENTITY), blown(Quat::from_rotation_y(std::f32::consts::PI)));
    assert!(plain.z > 0.3 && (plain.z - turned.z).abs() < 1e-3, "{plain} and {turned}");
    assert!(plain.distance(turned) < 0.02 * plain.z, "{plain} and {turned}");
}

#[test]
fn wrong_air_and_wind_are_refused_by_name() {
    let mut app = headless();
    let cloth = app.world_mut().spawn(Cloth::rectangle(0.4, 0.4).with_cells(4, 4)).id();
    run(&mut app, 2);
    app.world_mut().entity_mut(cloth).insert(Air { porosity: 2.0, ..default() });
    run(&mut app, 2);
    assert!(get::<ClothRejection>(&app, cloth).error().to_string().contains("`Air::porosity` is 2, allowed is 0..=1"));
    app.world_mut().entity_mut(cloth).insert((Air::default(), Wind(Vec3::new(0.0, f32::NAN, 0.0))));
    run(&mut app, 2);
    assert!(get::<ClothRejection>(&app, cloth).error().to_string().contains("`Wind` is NaN"));
    app.world_mut().entity_mut(cloth).insert(Wind::default());
    run(&mut app, 2);
    assert!(app.world().get::<ClothRejection>(cloth).is_none());
}

/// A free sheet in a wind along z, with gusts of its own or those of all.
fn in_gusts(seed: u64, own: bool) -> (App, Entity) {
    let mut app = headless();
    let gusts = Gusts { intensity: 0.3, length: 1.0, seed };
    app.insert_resource(Shared(Gravity(Vec3::ZERO))).insert_resource(Shared(Wind(Vec3::Z * 4.0)));
    let sheet = app.world_mut().spawn((Cloth::rectangle(0.5, 0.5).with_cells(5, 5), Air::default())).id();
    if own {
        app.world_mut().entity_mut(sheet).insert(gusts);
    } else {
        app.insert_resource(Shared(gusts));
    }
    run(&mut app, 64);
    (app, sheet)
}

#[test]
fn gusts_toss_a_sheet_and_the_same_seed_tosses_it_to_the_same_bits() {
    let after = |seed, own| {
        let (app, sheet) = in_gusts(seed, own);
        (bits(&app, sheet), centre(&app, sheet))
    };
    let (first, place) = after(1, false);
    assert!(place.truncate().length() > 0.02 && place.z > 1.0, "at {place}: not tossed aside");
    assert_eq!(first, after(1, false).0);
    assert_eq!(first, after(1, true).0, "a cloth's own gusts are those of all from the same seed");
    assert_ne!(first, after(2, false).0);
}

#[test]
fn cloths_that_share_a_wind_share_its_gusts_whenever_they_came() {
    let (mut app, _) = in_gusts(3, false);
    let sheet = || (Cloth::rectangle(0.5, 0.5).with_cells(5, 5), Air::default());
    let pair = [app.world_mut().spawn(sheet()).id(), app.world_mut().spawn(sheet()).id()];
    run(&mut app, 32);
    assert_eq!(bits(&app, pair[0]), bits(&app, pair[1]));
    assert!(centre(&app, pair[0]).z > 0.1);
}

#[test]
fn wrong_gusts_are_refused_by_name_on_a_cloth_and_as_a_setting_of_all() {
    let (mut app, sheet) = in_gusts(1, false);
    app.insert_resource(Shared(Gusts { intensity: f32::NAN, ..default() }));
    run(&mut app, 2);
    assert!(get::<ClothRejection>(&app, sheet).error().to_string().contains("`Gusts::intensity` is NaN"));
    app.world_mut().entity_mut(sheet).insert(Gusts { length: 0.0, ..default() });
    run(&mut app, 2);
    assert!(get::<ClothRejection>(&app, sheet).error().to_string().contains("`Gusts::length` is 0"));
    app.world_mut().entity_mut(sheet).insert(Gusts::default());
    run(&mut app, 2);
    assert!(app.world().get::<ClothRejection>(sheet).is_none());
}

#[test]
fn a_shared_wind_that_was_no_number_for_a_while_blows_on_once_it_is_mended() {
    let (mut app, sheet) = in_gusts(1, false);
    app.insert_resource(Shared(Wind(Vec3::NAN)));
    run(&mut app, 3);
    assert!(app.world().get::<ClothRejection>(sheet).is_some());
    note_events::<ClothRecovered>(&mut app);
    let before = centre(&app, sheet);
    app.insert_resource(Shared(Wind(Vec3::Z * 4.0)));
    run(&mut app, 32);
    assert!(centre(&app, sheet).z > before.z + 1.0, "from {before} to {}", centre(&app, sheet));
    assert!(seen::<ClothRecovered>(&app).is_empty());
}

#[test]
fn a_wind_of_a_million_metres_a_second_is_survived_and_the_flag_comes_back() {
    let mut app = headless();
    let flag = flag(&mut app);
    app.world_mut().entity_mut(flag).insert((Air::default(), Wind(Vec3::new(1e6, 1e5, 1e5)), Gusts::default()));
    app.insert_resource(Shared(Gusts { intensity: 0.3, ..default() }));
    note_events::<ClothRecovered>(&mut app);
    run(&mut app, 20);
    app.world_mut().entity_mut(flag).insert(Wind(Vec3::ZERO));
    run(&mut app, 64);
    let (particles, topology) = (get::<Particles>(&app, flag), get::<ClothTopology>(&app, flag));
    let strain = cloth_solver::measure::largest_strain(topology, particles);
    assert!(strain < Fabric::FLAG_POLYESTER.stretch_limit, "still stretched by {strain}");
    assert!(seen::<ClothRecovered>(&app).is_empty(), "without the help of its last finite shape");
}

#[test]
fn while_time_stands_and_a_hand_holds_no_wind_blows() {
    let mut app = headless();
    app.insert_resource(Shared(Gravity(Vec3::ZERO)));
    let sheet = (Cloth::rectangle(0.4, 0.4).with_cells(4, 4), Air::default(), Wind(Vec3::Z * 10.0));
    let sheet = app.world_mut().spawn(sheet).id();
    run(&mut app, 16);
    app.world_mut().resource_mut::<Time<ClothClock>>().pause();
    let before = world_positions(&app, sheet);
    let [a, b, c] = get::<ClothTopology>(&app, sheet).triangles[0].map(|slot| slot as usize);
    let position = &get::<Particles>(&app, sheet).position;
    let target = (position.get(a) + position.get(b) + position.get(c)) / 3.0;
    app.world_mut().entity_mut(sheet).insert(Grabs(vec![Grab { target, ..default() }]));
    run(&mut app, 16);
    let moved = largest_move(&before, &world_positions(&app, sheet));
    assert!(moved < 1e-3, "moved {moved} m");
    app.world_mut().entity_mut(sheet).remove::<Grabs>();
    app.world_mut().resource_mut::<Time<ClothClock>>().unpause();
    run(&mut app, 16);
    assert!(largest_move(&before, &world_positions(&app, sheet)) > 0.5);
}
