//! Cloth pulls the bodies that it is pinned to.

use super::*;

with_engines! {
    a_crate_that_hangs_from_a_strip_bounces_no_higher_than_it_was
    a_crate_that_hangs_from_a_strip_comes_to_rest
    a_strip_tugs_a_crate_over_the_ground
    a_crate_and_the_strip_on_it_keep_their_momentum
    what_is_pinned_to_a_body_is_where_the_body_is
    two_strips_hold_a_crate_together
}

const CELLS: [u32; 2] = [4, 40];

/// A strip of a metre that hangs from `at` by its first row, and whose last row is pinned to `body`.
fn strip(app: &mut App, fabric: Fabric, at: Transform, body: Entity, is_held: bool) -> Entity {
    let row = |row: u32| (0..=CELLS[0]).map(move |column| row * (CELLS[0] + 1) + column);
    let low = Pins::vertices(row(CELLS[1])).to_entity(body);
    let pins = if is_held { Pins::vertices(row(0)).to_world().and(low) } else { low };
    let cloth = Cloth::rectangle(0.1, 1.0).with_cells(CELLS[0], CELLS[1]);
    app.world_mut().spawn((cloth, fabric, pins, at)).id()
}

fn crate_of(mass: f32) -> (Form, Option<f32>) {
    (Form::Cuboid(Vec3::new(0.3, 0.2, 0.3)), Some(mass))
}

fn a_crate_that_hangs_from_a_strip_bounces_no_higher_than_it_was<E: Engine>() {
    let crates = [(Fabric::COTTON_POPLIN, 0.01), (Fabric::COTTON_POPLIN, 2.0), (Fabric::CANVAS, 20.0)];
    for (fabric, mass) in crates.into_iter().step_by(cases(2, 1)) {
        let mut app = E::app();
        let (form, of) = crate_of(mass);
        let body = E::spawn(&mut app, form, of, Transform::from_xyz(0.0, -0.6, 0.0));
        strip(&mut app, Fabric { damping: 0.0, ..fabric }, Transform::IDENTITY, body, true);
        let mut highest = [f32::NEG_INFINITY; 4];
        for highest in &mut highest {
            for _ in 0..96 {
                app.update();
                *highest = highest.max(place(&app, body).y);
            }
        }
        println!("{mass} kg: {highest:?}");
        // Up to what the fabric is stretched by in the two ticks until it holds.
        assert!(highest.iter().all(|height| *height < -0.599), "{mass} kg rises to {highest:?} m");
    }
}

fn a_crate_that_hangs_from_a_strip_comes_to_rest<E: Engine>() {
    let crates =
        [(Fabric::COTTON_POPLIN, 0.005), (Fabric::COTTON_POPLIN, 2.0), (Fabric::CANVAS, 2.0), (Fabric::CANVAS, 20.0)];
    for (fabric, mass) in crates.into_iter().step_by(cases(3, 1)) {
        let mut app = E::app();
        let (form, of) = crate_of(mass);
        let body = E::spawn(&mut app, form, of, Transform::from_xyz(0.0, -0.6, 0.0));
        E::damp(&mut app, body, 12.0);
        strip(&mut app, Fabric { damping: 2.0, ..fabric }, Transform::IDENTITY, body, true);
        run(&mut app, 64 * 5);
        let (stands, mut farthest) = (place(&app, body), 0.0_f32);
        for _ in 0..64 {
            app.update();
            farthest = farthest.max(place(&app, body).distance(stands));
        }
        println!("{mass} kg: at {stands}, moves {farthest}");
        assert!((-1.2..-0.59).contains(&stands.y), "{mass} kg hangs at {stands}");
        assert!(farthest < 1e-3, "{mass} kg moves by {farthest} m");
    }
}

fn a_strip_tugs_a_crate_over_the_ground<E: Engine>() {
    for mass in [0.5, 2.0, 50.0].into_iter().step_by(cases(2, 1)) {
        let mut app = E::app();
        E::spawn(&mut app, Form::Cuboid(Vec3::new(20.0, 1.0, 20.0)), None, Transform::from_xyz(0.0, -0.5, 0.0));
        let (form, of) = crate_of(mass);
        let body = E::spawn(&mut app, form, of, Transform::from_xyz(0.0, 0.101, 0.0));
        let hand = app.world_mut().spawn(Transform::from_xyz(1.2, 0.15, 0.0)).id();
        let row = |row: u32| (0..=CELLS[0]).map(move |column| row * (CELLS[0] + 1) + column);
        let pins = Pins::vertices(row(0)).to_entity(hand).and(Pins::vertices(row(CELLS[1])).to_entity(body));
        let lies = Quat::from_rotation_z(-std::f32::consts::FRAC_PI_2);
        let cloth = Cloth::rectangle(0.1, 1.0).with_cells(CELLS[0], CELLS[1]);
        let at = Transform::from_xyz(0.66, 0.15, 0.0).with_rotation(lies);
        app.world_mut().spawn((cloth, Fabric::CANVAS, pins, at));
        for _ in 0..128 {
            app.world_mut().get_mut::<Transform>(hand).unwrap().translation.x += 1.0 / 64.0;
            app.update();
        }
        let (at, speed) = (place(&app, body), E::velocity(&app, body));
        println!("{mass} kg: {at} {speed}");
        // Without friction it swings about the speed of the hand.
        assert!((1.2..3.0).contains(&at.x), "{mass} kg is at {at}");
        assert!(at.z.abs() < 0.4 && at.y < 0.25, "{mass} kg is at {at}");
        assert!(speed.x > -0.5 && speed.x < 2.5, "{mass} kg: {speed}");
    }
}

fn a_crate_and_the_strip_on_it_keep_their_momentum<E: Engine>() {
    for mass in [0.01, 0.1, 1.0, 30.0] {
        let mut app = E::app();
        E::set_gravity(&mut app, Vec3::ZERO);
        let (form, of) = crate_of(mass);
        let body = E::spawn(&mut app, form, of, Transform::from_xyz(0.0, -0.6, 0.0));
        let cloth = strip(&mut app, Fabric::CANVAS, Transform::IDENTITY, body, false);
        run(&mut app, 4);
        E::set_velocity(&mut app, body, Vec3::new(2.0, -3.0, 1.0));
        run(&mut app, 1);
        let total = |app: &App| momentum(app, cloth) + mass * E::velocity(app, body);
        let kinetic = |app: &App| {
            let of_cloth = cloth_solver::measure::kinetic_energy(get::<Particles>(app, cloth)) as f32;
            of_cloth + 0.5 * mass * E::velocity(app, body).length_squared()
        };
        let (begin, brought, mut worst, mut most) = (total(&app), kinetic(&app), 0.0_f32, 0.0_f32);
        for _ in 0..128 {
            app.update();
            worst = worst.max(total(&app).distance(begin));
            most = most.max(kinetic(&app));
        }
        println!("{mass} kg: off by {worst} of {begin}, {most} J of {brought} J");
        assert!(worst < 1e-3 * begin.length(), "{mass} kg: {worst} N·s of {begin}");
        assert!(most < 1.02 * brought, "{mass} kg: {most} J of {brought} J");
    }
}

fn what_is_pinned_to_a_body_is_where_the_body_is<E: Engine>() {
    let mut app = E::app();
    let (form, of) = crate_of(1.0);
    let body = E::spawn(&mut app, form, of, Transform::from_xyz(0.0, -0.6, 0.0));
    let cloth = strip(&mut app, Fabric::CANVAS, Transform::IDENTITY, body, true);
    run(&mut app, 4);
    E::set_velocity(&mut app, body, Vec3::new(1.5, 0.0, -0.5));
    let vertex = (CELLS[1] * (CELLS[0] + 1)) as usize;
    let local = |app: &App| {
        let pinned = world_positions(app, cloth)[vertex];
        get::<Transform>(app, body).compute_affine().inverse().transform_point3(pinned)
    };
    let before = local(&app);
    for _ in 0..64 {
        app.update();
        assert!(local(&app).distance(before) < 1e-4, "{} and {before}", local(&app));
    }
}

fn two_strips_hold_a_crate_together<E: Engine>() {
    let mut app = E::app();
    let (form, of) = crate_of(5.0);
    let body = E::spawn(&mut app, form, of, Transform::from_xyz(0.0, -0.6, 0.0));
    for side in [-0.1, 0.1] {
        let fabric = Fabric { damping: 2.0, ..Fabric::CANVAS };
        strip(&mut app, fabric, Transform::from_xyz(side, 0.0, 0.0), body, true);
    }
    E::damp(&mut app, body, 12.0);
    run(&mut app, 64 * 5);
    let stands = place(&app, body);
    let mut farthest = 0.0_f32;
    for _ in 0..64 {
        app.update();
        farthest = farthest.max(place(&app, body).distance(stands));
    }
    println!("at {stands}, moves {farthest}");
    assert_eq!(get::<ClothPush>(&app, body).cloths, 2);
    assert!((-0.7..-0.59).contains(&stands.y) && stands.x.abs() < 0.02, "it hangs at {stands}");
    assert!(farthest < 1e-3, "it moves by {farthest} m");
}
