//! Order, damping and stability of the methods, on the smallest cloths that swing.

use cloth_solver::{Cloth, ClothError, Fabric, Method, Tick};
use glam::Vec3;

use super::closed;
use super::finding::{Bench, Bound, budget};
use super::rig::{self, G, GRAVITY, Swing};
use crate::plot::{Axis, Figure, Look, Panel, Series, Stroke};

use core::f64::consts::TAU;

/// Length of an oscillator's run, s.
const RUN: f64 = 20.0;

/// Where an oscillator is let go, m below its rest.
const PULL: f32 = 0.1;

/// A cell of 1 × 1 m whose upper two particles are held. The lower two, which carry σ/4 each on springs of Y/2, bob at
/// `√(2Y/σ)`: chosen to be 1 Hz.
fn oscillator(method: Method) -> Result<Cloth, ClothError> {
    let stiffness = (TAU * TAU * 0.5 * 0.15) as f32;
    let fabric = Fabric {
        areal_density: 0.15,
        stretch_warp: stiffness,
        stretch_weft: stiffness,
        shear: 0.0,
        bend_warp: 0.0,
        bend_weft: 0.0,
        damping: 0.0,
        ..Fabric::COTTON_POPLIN
    };
    let mut cloth = rig::rectangle([1.0, 1.0], [1, 1], &fabric, method)?;
    rig::hold(&mut cloth, |rest| rest.y > 0.0)?;
    for slot in 0..cloth.topology.slots() {
        if cloth.topology.rest[slot].y < 0.0 {
            cloth.particles.position.y[slot] -= PULL;
        }
    }
    Ok(cloth)
}

/// How far below its rest the oscillator is, m.
fn pulled(cloth: &Cloth) -> f64 {
    -0.5 - f64::from(rig::mean(cloth, |rest| rest.y < 0.0).y)
}

/// What `method` makes of an oscillation at steps of `h` s.
fn oscillate(method: Method, h: f64) -> Result<Swing, ClothError> {
    let mut cloth = oscillator(method)?;
    // Newton's and other iterations are to be converged: it is the integrator that is looked at.
    let tick = Tick { iterations: if method.iterates() { 10 } else { 1 }, ..Tick::fixed(h as f32, 1) };
    let mut samples = vec![pulled(&cloth)];
    // Explicit Euler would swing through its hinge before the end.
    let run = if method == Method::ExplicitEuler { 0.2 * RUN } else { RUN };
    for _ in 0..(run / h).round() as u32 {
        cloth.step(tick, Vec3::ZERO);
        samples.push(pulled(&cloth));
    }
    Ok(rig::swing(&samples, h, 1.0))
}

/// Error of phase of a 1 Hz oscillation after 20 s, rad, and its amplitude then.
fn errors(method: Method, h: f64) -> Result<(f64, f64), ClothError> {
    let swing = oscillate(method, h)?;
    Ok((TAU * (swing.frequency - 1.0).abs() * RUN, (swing.growth * RUN).exp()))
}

/// Order of convergence, and the published errors of phase or energy.
pub fn order(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "order of the method";
    // Errors of phase, rad: (ωh)²/24 of symplectic Euler and Verlet, (ωh)⁴/120 of Runge–Kutta, times ωt.
    let second = |h: f64| (TAU * h).powi(2) / 24.0 * TAU * RUN;
    let fourth = |h: f64| (TAU * h).powi(4) / 120.0 * TAU * RUN;
    let explicit = [Method::SymplecticEuler, Method::StormerVerlet, Method::RungeKutta4];
    for method in bench.only(&explicit) {
        let (order, theory): (f64, &dyn Fn(f64) -> f64) =
            if method == Method::RungeKutta4 { (4.0, &fourth) } else { (2.0, &second) };
        for rate in [60.0, 120.0, 240.0] {
            let (phase, _) = errors(method, 1.0 / rate)?;
            // What f32 leaves to see of 20 s is some 1e-5 rad.
            let bound = Bound::Absolute(0.1 * theory(1.0 / rate) + 1e-5);
            let what = format!("phase error after 20 s of 1 Hz at h = 1/{rate}, rad");
            bench.claim(CHECK, what, method, phase, theory(1.0 / rate), bound);
        }
        let slope = (errors(method, 1.0 / 15.0)?.0 / errors(method, 1.0 / 30.0)?.0).log2();
        bench.claim(CHECK, "order, from h = 1/15 to 1/30", method, slope, order, Bound::Absolute(0.15));
    }
    for method in bench.only(&[Method::ExplicitEuler]) {
        let grown = errors(method, 1.0 / 60.0)?.1.powi(2);
        let expected = (1.0 + (TAU / 60.0).powi(2)).powf(RUN * 60.0);
        bench.claim(
            CHECK,
            "ln of energy grown in 20 s of 1 Hz at h = 1/60",
            method,
            grown.ln(),
            expected.ln(),
            Bound::Relative(0.02),
        );
    }
    let methods = bench.methods.clone();
    let mut series = Vec::new();
    for method in methods {
        let mut points = Vec::new();
        for rate in [15.0, 30.0, 60.0, 120.0, 240.0, 480.0] {
            points.push((1.0 / rate, errors(method, 1.0 / rate)?.0));
        }
        series.push(Series { label: method.name().into(), look: Look::of(method), stroke: Stroke::Marked, points });
    }
    for (label, theory) in [("order 2", &second as &dyn Fn(f64) -> f64), ("order 4", &fourth)] {
        let points = [1.0 / 15.0, 1.0 / 480.0].map(|h| (h, theory(h))).to_vec();
        series.push(Series { label: label.into(), look: Look(0), stroke: Stroke::Dashed, points });
    }
    let panel = Panel {
        title: "1 Hz oscillator, 20 s".into(),
        x: Axis::log("step h, s"),
        y: Axis::log("error of phase, rad").within(1e-7, 1e2),
        series,
        ..Panel::default()
    };
    bench.figures.push(("validate-order", Figure::single(panel)));
    Ok(())
}

/// Numerical damping of implicit methods: the amplitude falls by (1 + ω²h²)^(−1/2) a step, the period is ωh/atan(ωh)
/// times too long.
pub fn damping(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "numerical damping";
    const H: f64 = 1.0 / 60.0;
    for method in bench.only(&[Method::XpbdSweeps, Method::XpbdLines]) {
        let swing = oscillate(method, H)?;
        let turn = TAU * H;
        let growth = -0.5 * (turn * turn).ln_1p() / H;
        bench.claim(CHECK, "growth of 1 Hz at h = 1/60, 1/s", method, swing.growth, growth, Bound::Relative(0.02));
        let (period, expected) = (1.0 / swing.frequency, turn / turn.atan());
        bench.claim(CHECK, "period of 1 Hz at h = 1/60, s", method, period, expected, Bound::Absolute(2e-4));
    }
    Ok(())
}

/// Whether explicit methods live just below their limit and explode just above it.
pub fn stability(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "stability limit";
    let limits = [
        (Method::SymplecticEuler, 2.0),
        (Method::StormerVerlet, 2.0),
        (Method::RungeKutta4, 2.0 * core::f64::consts::SQRT_2),
    ];
    for (method, limit) in limits {
        if !bench.methods.contains(&method) {
            continue;
        }
        for part in [0.95, 1.05] {
            let mut cloth = oscillator(method)?;
            let tick = Tick::fixed((part * limit / TAU) as f32, 1);
            let mut largest: f64 = 0.0;
            for _ in 0..500 {
                cloth.step(tick, Vec3::ZERO);
                let now = pulled(&cloth).abs();
                largest = if now.is_finite() { largest.max(now) } else { f64::INFINITY };
            }
            let grown = (largest / f64::from(PULL)).min(1e6);
            let (what, bound) = if part < 1.0 { ("below", Bound::AtMost) } else { ("above", Bound::AtLeast) };
            let quantity = format!("largest swing over the first at {part} × {limit:.3}/ω, {what} the limit");
            bench.claim(CHECK, quantity, method, grown, 10.0, bound);
        }
    }
    Ok(())
}

/// A cell of 1 × 1 m held by its top: all that moves hangs 1 m below, a pendulum of that length.
fn pendulum_at(method: Method, amplitude: f32) -> Result<Cloth, ClothError> {
    // So stiff that its own weight stretches it by a millionth.
    let fabric = Fabric {
        areal_density: 0.15,
        stretch_warp: 1e6,
        stretch_weft: 1e6,
        shear: 1e4,
        bend_warp: 0.0,
        bend_weft: 0.0,
        damping: 0.0,
        ..Fabric::COTTON_POPLIN
    };
    let mut cloth = rig::rectangle([1.0, 1.0], [1, 1], &fabric, method)?;
    let (sin, cos) = amplitude.sin_cos();
    rig::put(&mut cloth, |rest| Vec3::new(rest.x, (rest.y - 0.5) * cos, (rest.y - 0.5) * sin));
    rig::hold(&mut cloth, |rest| rest.y > 0.0)?;
    Ok(cloth)
}

/// Kinetic energy and that of height above the lowest point over the weight of the bob, m.
fn head(cloth: &Cloth) -> f64 {
    let slot = cloth.topology.grid.map_or(0, |grid| grid.slot(1, 0)) as usize;
    let speed = f64::from(cloth.particles.velocity.get(slot).length_squared());
    1.0 + f64::from(cloth.particles.position.y[slot]) + 0.5 * speed / G
}

/// Periods of a pendulum, and what projection takes of its energy.
pub fn pendulum(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "pendulum";
    let small = TAU / G.sqrt();
    for method in bench.with_default(&[Method::XpbdLines]) {
        for degrees in [10.0_f64, 45.0, 90.0, 150.0] {
            let mut cloth = pendulum_at(method, degrees.to_radians() as f32)?;
            let bob = |cloth: &Cloth| f64::from(rig::mean(cloth, |rest| rest.y < 0.0).z);
            let tick = budget(method);
            let (mut before, mut ticks) = (bob(&cloth), 0);
            let quarter = loop {
                cloth.step(tick, GRAVITY);
                ticks += 1;
                let now = bob(&cloth);
                if now.signum() != before.signum() || !now.is_finite() || ticks > 1000 {
                    break f64::from(tick.dt) * (f64::from(ticks) - now / (now - before));
                }
                before = now;
            };
            let what = format!("period over that of small swings, let go at {degrees}°");
            let expected = closed::pendulum(degrees.to_radians());
            bench.claim(CHECK, what, method, 4.0 * quarter / small, expected, Bound::Relative(0.01));
        }
    }
    for method in bench.only(&[Method::Pbd]) {
        for (substeps, kept, within) in [(1, 0.010, 0.02), (10, 0.508, 0.05)] {
            let mut cloth = pendulum_at(method, core::f32::consts::FRAC_PI_2)?;
            let first = head(&cloth);
            let seconds = 10.0 * small * closed::pendulum(TAU / 4.0);
            rig::run(&mut cloth, Tick::at_least(1.0 / 60.0, substeps), GRAVITY, seconds as f32);
            let what = format!("energy kept after 10 periods from 90° at h = 1/{}", 60 * substeps);
            bench.claim(CHECK, what, method, head(&cloth) / first, kept, Bound::Absolute(within));
        }
    }
    Ok(())
}
