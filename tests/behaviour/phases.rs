//! A user's system runs between any two phases of a tick, and what it does there counts.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;

#[derive(Resource, Default)]
struct Order(Vec<&'static str>);

fn note(name: &'static str) -> impl Fn(ResMut<Order>) + Clone {
    move |mut order: ResMut<Order>| order.0.push(name)
}

#[test]
fn phases_run_in_their_order() {
    let mut app = headless();
    let substeps = Substeps { count: 2, max: 2, ..default() };
    app.world_mut().spawn((Cloth::rectangle(0.2, 0.2), substeps));
    app.init_resource::<Order>();
    use ClothSystems::*;
    app.add_systems(ClothSchedule, note("prepared").after(Prepare).before(Forces));
    app.add_systems(ClothSchedule, note("forced").after(Forces).before(Substep));
    app.add_systems(ClothSchedule, note("substepped").after(Substep).before(Tear));
    app.add_systems(ClothSchedule, note("torn").after(Tear).before(Burn));
    app.add_systems(ClothSchedule, note("burnt").after(Burn).before(Writeback));
    app.add_systems(ClothSchedule, note("written").after(Writeback));
    app.add_systems(ClothSubstepSchedule, note("integrated").after(Integrate).before(Solve));
    app.add_systems(ClothSubstepSchedule, note("solved").after(Solve).before(Collide));
    app.add_systems(ClothSubstepSchedule, note("collided").after(Collide));
    app.update();
    let substep = ["integrated", "solved", "collided"];
    let tick = [&["prepared", "forced"], &substep[..], &substep, &["substepped", "torn", "burnt", "written"]].concat();
    assert_eq!(app.world().resource::<Order>().0, tick);
}

#[test]
fn a_force_set_between_the_phases_pushes_for_one_tick() {
    #[derive(Resource)]
    struct Push(bool);
    let mut app = headless();
    let cloth = (Cloth::rectangle(0.2, 0.2).with_cells(4, 4), Gravity(Vec3::ZERO));
    let cloth = app.world_mut().spawn(cloth).id();
    app.insert_resource(Push(true));
    let push = |mut cloths: Query<(&mut Particles, &ClothTopology)>, push: Res<Push>| {
        for (mut particles, topology) in cloths.iter_mut().filter(|_| push.0) {
            for slot in topology.particles() {
                let weight = particles.mass[slot as usize];
                particles.add_force(slot as usize, Vec3::Z * 2.0 * weight);
            }
        }
    };
    app.add_systems(ClothSchedule, push.in_set(ClothSystems::Forces));
    run(&mut app, 32);
    let speed = get::<Particles>(&app, cloth).velocity.get(0).z;
    // Velocities are those in the middle of the last substep.
    assert!((speed - 1.0).abs() < 2e-3, "2 m/s² for half a second give {speed} m/s");
    app.world_mut().resource_mut::<Push>().0 = false;
    run(&mut app, 32);
    let later = get::<Particles>(&app, cloth).velocity.get(0).z;
    assert!((later - speed).abs() < 1e-3, "without a force it goes on at {later} m/s");
}

#[test]
fn free_fall_is_half_g_t_squared() {
    let mut app = headless();
    let cloth = app.world_mut().spawn(Cloth::rectangle(0.5, 0.5).with_cells(8, 8)).id();
    run(&mut app, 64);
    let fallen = -centre(&app, cloth).y;
    assert!((fallen / 4.905 - 1.0).abs() < 0.005, "fell {fallen} m in a second");
}

#[test]
fn statistics_are_measured_for_those_that_ask() {
    let mut app = headless();
    let cloth = (Cloth::rectangle(0.5, 0.5).with_cells(4, 4), Gravity(Vec3::NEG_Y), ClothStats::default());
    let cloth = app.world_mut().spawn(cloth).id();
    run(&mut app, 64);
    let stats = get::<ClothStats>(&app, cloth);
    assert_eq!((stats.particles, stats.triangles, stats.substeps, stats.contacts), (25, 32, 10, 0));
    assert!(stats.constraints > 40 && stats.largest_strain < 1e-3);
    assert!((stats.rms_speed - 1.0).abs() < 0.01, "{} m/s after a second at 1 m/s²", stats.rms_speed);
    let energy = 0.5 * 0.25 * f64::from(Fabric::COTTON_POPLIN.areal_density);
    assert!((stats.kinetic_energy / energy - 1.0).abs() < 0.02, "{} J", stats.kinetic_energy);
}
