//! Cloth pushes the bodies that touch it.

use std::time::Duration;

use super::*;
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

with_engines! {
    a_ball_and_a_free_cloth_keep_their_momentum_whatever_they_weigh
    a_light_ball_is_not_thrown_off_by_heavy_cloth
    a_ball_bounces_off_a_trampoline_as_high_as_with_an_eighth_of_the_tick
    a_ball_comes_to_rest_on_a_trampoline
    nothing_passes_a_ball_that_is_fast
    frame_rate_does_not_change_how_they_move
    a_body_leaves_no_axis_that_is_locked
}

const RADIUS: f32 = 0.12;

/// A trampoline of a square metre, held all around.
fn trampoline(app: &mut App) -> Entity {
    let cells = 20;
    let rim = (0..=cells).flat_map(|i| [i, cells * (cells + 1) + i, i * (cells + 1), i * (cells + 1) + cells]);
    let fabric = Fabric { damping: 0.0, ..Fabric::CANVAS };
    let cloth = flat(Vec2::ONE, [cells; 2], fabric, Vec3::ZERO);
    app.world_mut().spawn((cloth, Pins::vertices(rim))).id()
}

fn a_ball_and_a_free_cloth_keep_their_momentum_whatever_they_weigh<E: Engine>() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
    for _ in 0..cases(3, 8) {
        let mut app = E::app();
        E::set_gravity(&mut app, Vec3::ZERO);
        let cloth = app.world_mut().spawn(flat(Vec2::splat(0.6), [12; 2], Fabric::TERRY_TOWEL, Vec3::ZERO)).id();
        let mass = 10_f32.powf(random.random_range(-2.0..2.0));
        let speed = random.random_range(0.5..8.0);
        let form = match random.random_bool(0.5) {
            true => Form::Ball(0.1),
            false => Form::Cuboid(Vec3::new(0.1, 0.2, 0.15)),
        };
        let at = Vec3::new(random.random_range(-0.1..0.1), 0.15, random.random_range(-0.1..0.1));
        let turn = Quat::from_rotation_z(random.random_range(0.0..0.4));
        let body = E::spawn(&mut app, form, Some(mass), Transform::from_translation(at).with_rotation(turn));
        run(&mut app, 4);
        let given = Vec3::new(0.3, -1.0, 0.1).normalize() * speed;
        E::set_velocity(&mut app, body, given);
        run(&mut app, 1);
        let total = |app: &App| momentum(app, cloth) + mass * E::velocity(app, body);
        let (mut touched, mut worst) = (0, 0.0_f32);
        for _ in 0..96 {
            app.update();
            worst = worst.max(total(&app).distance(mass * given));
            touched += u32::from(get::<ClothPush>(&app, body).cloths > 0);
        }
        println!("{form:?} {mass} kg {speed} m/s: {touched} ticks, off by {worst} of {}", mass * speed);
        assert!(touched > 0, "{mass} kg at {speed} m/s met nothing");
        assert!(worst < 1e-4 * mass * speed + 1e-6, "{mass} kg at {speed} m/s: {worst} N·s of {}", mass * speed);
    }
}

fn a_light_ball_is_not_thrown_off_by_heavy_cloth<E: Engine>() {
    for mass in [0.002, 0.02, 0.2] {
        let mut app = E::app();
        E::set_gravity(&mut app, Vec3::ZERO);
        let cloth = app.world_mut().spawn(flat(Vec2::splat(0.6), [12; 2], Fabric::TERRY_TOWEL, Vec3::ZERO)).id();
        let body = E::spawn(&mut app, Form::Ball(0.1), Some(mass), Transform::from_xyz(0.0, 0.15, 0.0));
        run(&mut app, 4);
        // The cloth flies at the ball.
        let particles = &mut *app.world_mut().get_mut::<Particles>(cloth).unwrap();
        particles.velocity.fill(Vec3::Z * 4.0);
        let kinetic = |app: &App| {
            let of_cloth = cloth_solver::measure::kinetic_energy(get::<Particles>(app, cloth)) as f32;
            of_cloth + 0.5 * mass * E::velocity(app, body).length_squared()
        };
        let brought = kinetic(&app);
        for _ in 0..64 {
            app.update();
            assert!(kinetic(&app) < 1.01 * brought, "{mass} kg: {} J of {brought} J", kinetic(&app));
        }
        println!("{mass} kg: {} m/s", E::velocity(&app, body));
        assert!((1.0..8.1).contains(&E::velocity(&app, body).y), "{mass} kg: {}", E::velocity(&app, body));
    }
}

/// How high over the trampoline the ball gets after its first bounce, m.
fn bounce<E: Engine>(mass: f32, drop: f32, tick: Duration) -> f32 {
    let mut app = E::app_of(tick);
    trampoline(&mut app);
    let ball = E::spawn(&mut app, Form::Ball(RADIUS), Some(mass), Transform::from_xyz(0.0, drop + RADIUS, 0.0));
    let (mut rises, mut highest, mut time) = (false, 0.0_f32, 0.0);
    while time < 4.0 {
        app.update();
        time += tick.as_secs_f32();
        let (height, speed) = (place(&app, ball).y - RADIUS, E::velocity(&app, ball).y);
        rises |= speed > 0.2;
        if rises {
            highest = highest.max(height);
            if speed < -0.3 && height > 0.0 {
                break;
            }
        }
    }
    highest
}

fn a_ball_bounces_off_a_trampoline_as_high_as_with_an_eighth_of_the_tick<E: Engine>() {
    // The heavy ball bounces 5.4 to 6.2 % too high.
    let balls = [(0.2, 0.5, 0.05), (0.5, 0.3, 0.05), (0.5, 1.0, 0.05), (5.0, 0.5, 0.08)];
    for (mass, drop, allowed) in balls.into_iter().step_by(cases(3, 1)) {
        let [coarse, fine] = [1, 8].map(|parts| bounce::<E>(mass, drop, TICK / parts));
        println!("{mass} kg from {drop} m: {coarse} m, {fine} m with an eighth of the tick");
        assert!((coarse / fine - 1.0).abs() < allowed, "{mass} kg from {drop} m: {coarse} m, {fine} m expected");
        assert!(coarse > 0.1 * drop && coarse < 1.02 * drop, "{mass} kg from {drop} m: {coarse} m");
    }
}

fn a_ball_comes_to_rest_on_a_trampoline<E: Engine>() {
    for mass in [0.02, 0.5, 5.0].into_iter().step_by(cases(2, 1)) {
        let mut app = E::app();
        let cloth = trampoline(&mut app);
        app.world_mut().entity_mut(cloth).insert(Fabric { damping: 1.0, ..Fabric::CANVAS });
        let ball = E::spawn(&mut app, Form::Ball(RADIUS), Some(mass), Transform::from_xyz(0.0, 0.2, 0.0));
        E::damp(&mut app, ball, 12.0);
        run(&mut app, 64 * 6);
        let stands = place(&app, ball);
        let mut farthest = 0.0_f32;
        for _ in 0..64 {
            app.update();
            farthest = farthest.max(place(&app, ball).distance(stands));
        }
        println!("{mass} kg at {stands}, moves {farthest} m");
        assert!((-0.2..RADIUS).contains(&stands.y) && stands.xz().length() < 0.05, "{mass} kg is at {stands}");
        // It may still roll to the middle.
        assert!(farthest < 3e-3, "{mass} kg moves by {farthest} m");
    }
}

fn nothing_passes_a_ball_that_is_fast<E: Engine>() {
    for speed in [5.0, 20.0, 40.0] {
        let mut app = E::app();
        E::set_gravity(&mut app, Vec3::ZERO);
        let cloth = app.world_mut().spawn(flat(Vec2::splat(0.5), [16; 2], Fabric::COTTON_POPLIN, Vec3::ZERO)).id();
        let ball = E::spawn(&mut app, Form::Ball(0.1), Some(10.0), Transform::from_xyz(0.0, 0.6, 0.0));
        run(&mut app, 4);
        E::set_velocity(&mut app, ball, Vec3::NEG_Y * speed);
        run(&mut app, (1.5 / speed * 64.0) as usize + 2);
        let at = place(&app, ball);
        assert!(at.y < -0.5, "the ball is at {at}");
        let nearest = world_positions(&app, cloth).iter().map(|p| p.distance(at)).fold(f32::INFINITY, f32::min);
        assert!(nearest > 0.098, "{speed} m/s: a particle is {nearest} m from its middle");
        let behind = world_positions(&app, cloth)[8 * 17 + 8].y - at.y;
        assert!(behind < 0.0, "{speed} m/s: the middle of the cloth is {behind} m behind");
    }
}

fn frame_rate_does_not_change_how_they_move<E: Engine>() {
    let fly = |ticks: u32| {
        let mut app = E::app();
        trampoline(&mut app);
        let ball = E::spawn(&mut app, Form::Ball(RADIUS), Some(0.5), Transform::from_xyz(0.02, 0.2, 0.0));
        app.insert_resource(TimeUpdateStrategy::ManualDuration(TICK * ticks));
        run(&mut app, (64 / ticks) as usize);
        place(&app, ball)
    };
    let [one, four] = [1, 4].map(fly);
    assert!(one.distance(four) < 1e-4, "{one} and {four}");
}

fn a_body_leaves_no_axis_that_is_locked<E: Engine>() {
    // A crate that meets a slope of cloth off its middle.
    let motion = |is_locked: bool| {
        let mut app = E::app();
        E::set_gravity(&mut app, Vec3::ZERO);
        let slope = Transform::from_rotation(Quat::from_rotation_z(0.5) * Quat::from_rotation_x(0.3));
        let cloth = flat(Vec2::ONE, [16; 2], Fabric::CANVAS, Vec3::ZERO);
        app.world_mut().spawn((cloth, Pins::corners())).insert(slope);
        let at = Transform::from_xyz(0.1, 0.3, 0.05);
        let body = E::spawn(&mut app, Form::Cuboid(Vec3::new(0.1, 0.2, 0.15)), Some(0.3), at);
        if is_locked {
            E::lock(&mut app, body);
        }
        run(&mut app, 4);
        E::set_velocity(&mut app, body, Vec3::NEG_Y * 2.0);
        let mut touched = 0;
        for _ in 0..48 {
            app.update();
            touched += u32::from(get::<ClothPush>(&app, body).cloths > 0);
        }
        assert!(touched > 0, "it met nothing");
        let now = *get::<Transform>(&app, body);
        let aside = (now.translation - at.translation).with_y(0.0).length();
        (aside, now.rotation.angle_between(at.rotation), E::velocity(&app, body))
    };
    let (aside, turned, _) = motion(false);
    assert!(aside > 0.01 && turned > 0.1, "free it goes {aside} m aside and turns by {turned} rad");
    let (aside, turned, velocity) = motion(true);
    assert!(aside < 1e-6 && turned < 1e-3, "locked it goes {aside} m aside and turns by {turned} rad");
    assert!(velocity.with_y(0.0).length() < 1e-6 && velocity.y > -1.0, "{velocity} m/s");
}
