//! What holds for any cloth, tried on random ones: momentum, energy, rest, and what a ball or a monkey does to them.

use crate::common::*;
use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::contact::{Collider, Shape};
use cloth_solver::damage::Blade;
use cloth_solver::forces::Air;
use cloth_solver::{Cloth, Fabric, Motion, Pose, Tick, measure};
use glam::{DVec3, Quat, Vec2, Vec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// A cloth drawn at random.
#[derive(Clone, Debug)]
struct Drawn {
    preset: usize,
    cells: [u32; 2],
    size: Vec2,
    is_mesh: bool,
    seed: u32,
}

impl Drawn {
    fn fabric(&self) -> Fabric {
        Fabric::PRESETS[self.preset].1
    }

    fn cloth(&self, fabric: &Fabric) -> Cloth {
        let [columns, rows] = self.cells;
        if self.is_mesh {
            irregular_mesh(self.size, self.cells, fabric)
        } else {
            rectangle(self.size.x, self.size.y, columns, rows, fabric)
        }
    }

    /// A number in −1..1 for each particle.
    fn noise(&self, i: usize) -> f32 {
        let hash = (i as u32 ^ self.seed.rotate_left(16)).wrapping_mul(0x9E37_79B9);
        ((hash ^ (hash >> 15)).wrapping_mul(0x85EB_CA6B) >> 8) as f32 / 8_388_608.0 - 1.0
    }
}

prop_compose! {
    fn drawn(most: u32)(
        preset in 0..Fabric::PRESETS.len(),
        columns in 1..=most,
        rows in 1..=most,
        spacing in 0.01_f32..0.06,
        aspect in -1.5_f32..1.5,
        is_mesh in any::<bool>(),
        seed in any::<u32>(),
    ) -> Drawn {
        let cell = Vec2::new(spacing * aspect.exp2(), spacing / aspect.exp2());
        Drawn { preset, cells: [columns, rows], size: cell * Vec2::new(columns as f32, rows as f32), is_mesh, seed }
    }
}

fn set(cloth: &mut Cloth, slot: usize, x: Vec3) {
    cloth.particles.position.set(slot, x);
    cloth.particles.previous.set(slot, x);
}

/// Pins what of the rest shape is held so.
fn hold_by(cloth: &mut Cloth, how: usize) {
    let rest: Vec<(u32, Vec3)> = cloth.topology.particles().map(|p| (p, cloth.topology.rest[p as usize])).collect();
    let (low, high) = rest.iter().fold((Vec3::MAX, Vec3::MIN), |(low, high), (_, x)| (low.min(*x), high.max(*x)));
    let is_held = |x: Vec3| {
        let (top, left, right) = (x.y > high.y - 1e-4, x.x < low.x + 1e-4, x.x > high.x - 1e-4);
        match how {
            0 => top,
            1 => left,
            2 => top && (left || right),
            _ => top && left,
        }
    };
    let held = rest.iter().filter(|(_, x)| is_held(*x));
    let pins = held.map(|(p, _)| Pin { particle: *p, frame: 0, local: cloth.particles.position.get(*p as usize) });
    let pins = Pins { frames: vec![Motion::default()], pins: pins.collect() };
    cloth.constraints.set_pins(&mut cloth.particles, pins).unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(6, 24), failure_persistence: None, rng_seed: RngSeed::Fixed(17), ..ProptestConfig::default() })]

    #[test]
    fn free_cloth_keeps_its_momentum_however_crumpled_and_cut(
        drawn in drawn(14), crumple in 0.85_f32..1.0, is_cut in any::<bool>(), substeps in 5_u32..=20,
    ) {
        let fabric = Fabric { damping: 0.0, ..drawn.fabric() };
        let mut cloth = drawn.cloth(&fabric);
        if is_cut {
            let across = drawn.size.x;
            let ray = |x: f32| [Vec3::new(x, 0.1 * across, 1.0), Vec3::new(x, 0.1 * across, -1.0)];
            cloth.cut(&Blade { from: ray(-0.4 * across), to: ray(0.2 * across) });
        }
        for slot in 0..cloth.topology.slots() {
            let (x, noise) = (cloth.topology.rest[slot], drawn.noise(slot));
            let size = drawn.size.max_element();
            let wave = 0.1 * size * (7.0 * x.x / size + 5.0 * x.y / size).sin() + 0.002 * noise;
            if cloth.particles.mass[slot] > 0.0 {
                set(&mut cloth, slot, Vec3::new(x.x * crumple, x.y, wave));
                cloth.particles.velocity.set(slot, Vec3::new(0.3 + x.y, -x.x, 0.3 * noise));
            }
        }
        let mass: f64 = cloth.particles.mass.iter().map(|m| f64::from(*m)).sum();
        let size = f64::from(drawn.size.max_element());
        // From the first tick on: before it the velocities are those where the particles are.
        let tick = Tick::at_least(1.0 / 60.0, substeps);
        let linear = measure::linear_momentum(&cloth.particles);
        cloth.step(tick, Vec3::ZERO);
        let angular = measure::angular_momentum(&cloth.particles, DVec3::ZERO);
        let mut speed = 1.0_f64;
        for _ in 0..120 {
            cloth.step(tick, Vec3::ZERO);
            speed = speed.max(f64::from(fastest(&cloth)));
        }
        prop_assert!(cloth.particles.is_finite());
        let drift = (measure::linear_momentum(&cloth.particles) - linear).length() / (mass * speed);
        let turn = (measure::angular_momentum(&cloth.particles, DVec3::ZERO) - angular).length() / (mass * speed * size);
        prop_assert!(drift < 2e-5, "linear {drift}");
        prop_assert!(turn < 1e-4, "angular {turn}");
    }

    #[test]
    fn cloth_at_rest_in_air_stays_or_comes_to_rest_however_it_is_held(drawn in drawn(16), how in 0_usize..4) {
        let mut cloth = drawn.cloth(&drawn.fabric());
        cloth.air = Some(Air::default());
        hold_by(&mut cloth, how);
        let mut late = 0.0_f32;
        for second in 0..20 {
            run(&mut cloth, 1.0);
            if second == 19 {
                late = measure::rms_speed(&cloth.topology, &cloth.particles);
            }
        }
        prop_assert!(cloth.particles.is_finite());
        prop_assert!(late < 0.03, "{late} m/s after 20 s");
    }

    #[test]
    fn a_swing_of_a_rectangle_gains_no_energy(drawn in drawn(12), angle in 5.0_f32..25.0, substeps in prop::sample::select(vec![5_u32, 10, 20])) {
        // A pendulum of a few centimetres turns too far in a fifth of a tick.
        prop_assume!(drawn.size.y > 0.12);
        let drawn = Drawn { is_mesh: false, ..drawn };
        let fabric = Fabric { damping: 0.0, ..drawn.fabric() };
        let mut cloth = drawn.cloth(&fabric);
        let tilt = Quat::from_rotation_x(angle.to_radians());
        let hinge = Vec3::Y * (0.5 * drawn.size.y);
        hold_by(&mut cloth, 0);
        let hanging = measure::gravitational_energy(&cloth.particles, GRAVITY);
        for slot in 0..cloth.topology.slots() {
            let x = cloth.topology.rest[slot];
            set(&mut cloth, slot, hinge + tilt * (x - hinge));
        }
        let swing = measure::gravitational_energy(&cloth.particles, GRAVITY) - hanging;
        let tick = Tick::at_least(1.0 / 60.0, substeps);
        let mut lowest: Vec<f64> = Vec::new();
        for _ in 0..180 {
            cloth.step(tick, GRAVITY);
            let now = measure::total_energy(&cloth.topology, &cloth.particles, &fabric, GRAVITY);
            let second = lowest.len().saturating_sub(60);
            let risen = lowest[second..].iter().fold(0.0_f64, |most, before| most.max(now - before));
            prop_assert!(risen < 1e-3 * swing, "it gains {} of its swing", risen / swing);
            lowest.push(now);
        }
    }
}

#[test]
fn a_ball_at_any_speed_pushes_a_curtain_aside_and_leaves_it_at_rest() {
    let balls = [(1.0_f32, 0.15), (2.0, 0.2), (5.0, 0.5), (10.0, 1.5), (20.0, 3.0)];
    for (speed, strain) in balls.into_iter().step_by(cases(2, 1)) {
        let mut cloth = rectangle(1.0, 0.9, 40, 36, &Fabric::VELVET_CURTAIN);
        cloth.air = Some(Air::default());
        pin_top(&mut cloth, [0, 8, 16, 24, 32, 40]);
        run(&mut cloth, 2.0);
        let (mut at, end) = (0.6, -0.6);
        let (mut most, mut stretched) = (0.0_f32, 0.0_f32);
        let mut rest = 0.0;
        for _ in 0..((1.2 / speed / TICK.dt).ceil() as u32 + 300) {
            let to = f32::max(at - speed * TICK.dt, end);
            let pose = |z| Pose::new(Vec3::new(0.0, -0.1, z), Quat::IDENTITY);
            let motion = Motion { from: pose(at), to: pose(to) };
            cloth.contacts.set_colliders([Collider { shape: Shape::sphere(0.15).unwrap(), motion, friction: 0.3 }]);
            at = to;
            cloth.step(TICK, GRAVITY);
            most = most.max(fastest(&cloth));
            stretched = stretched.max(measure::largest_strain(&cloth.topology, &cloth.particles));
            rest = measure::rms_speed(&cloth.topology, &cloth.particles);
        }
        assert!(cloth.particles.is_finite());
        assert!(most < 5.0 * speed.max(2.0), "{most} m/s after a ball at {speed} m/s");
        assert!(stretched < strain, "a strain of {stretched} from a ball at {speed} m/s");
        assert!(rest < 0.1, "{rest} m/s 5 s after a ball at {speed} m/s");
    }
}

#[test]
fn stiff_sheets_that_are_not_quite_flat_come_to_rest() {
    let sheets = [
        (Fabric::PAPER, [0.79, 1.31], [21, 10], 3),
        (Fabric::PAPER, [0.84, 0.9], [8, 14], 1),
        (Fabric::LEATHER_GARMENT, [0.62, 1.53], [40, 20], 3),
    ];
    for (fabric, size, cells, how) in sheets.into_iter().take(cases(2, 3)) {
        let mut cloth = rectangle(size[0], size[1], cells[0], cells[1], &fabric);
        cloth.air = Some(Air::default());
        hold_by(&mut cloth, how);
        for slot in 0..cloth.topology.slots() {
            if cloth.particles.inverse_mass[slot] > 0.0 {
                let noise = (slot as u32).wrapping_mul(2_654_435_761) as f32 / u32::MAX as f32 - 0.5;
                let x = cloth.topology.rest[slot] + Vec3::Z * 0.001 * noise;
                set(&mut cloth, slot, x);
            }
        }
        run(&mut cloth, 20.0);
        let speed = measure::rms_speed(&cloth.topology, &cloth.particles);
        assert!(speed < 0.03, "{speed} m/s: {size:?} m of {cells:?} cells");
    }
}

#[test]
fn ribbons_of_one_to_seven_columns_hang_still() {
    for columns in 1..8 {
        let mut cloth = rectangle(1.0, 1.0, columns, 20, &Fabric::COTTON_POPLIN);
        pin_top(&mut cloth, 0..=columns);
        run(&mut cloth, 5.0);
        let speed = measure::rms_speed(&cloth.topology, &cloth.particles);
        assert!(speed < 0.01, "{speed} m/s with {columns} columns");
    }
}

#[test]
fn a_flag_comes_to_rest_at_its_pole_and_gains_nothing_without_air() {
    let [columns, rows] = cases([24, 16], [36, 24]);
    let mut flag = rectangle(0.9, 0.6, columns, rows, &Fabric::COTTON_POPLIN);
    flag.air = Some(Air::default());
    hold_by(&mut flag, 1);
    run(&mut flag, 20.0);
    assert!(measure::rms_speed(&flag.topology, &flag.particles) < 0.03);

    let mut flag = rectangle(0.9, 0.6, columns, rows, &UNDAMPED);
    hold_by(&mut flag, 1);
    run(&mut flag, 5.0);
    let before = measure::total_energy(&flag.topology, &flag.particles, &UNDAMPED, GRAVITY);
    run(&mut flag, 10.0);
    let after = measure::total_energy(&flag.topology, &flag.particles, &UNDAMPED, GRAVITY);
    assert!(after < before, "{before} J became {after} J");
}
