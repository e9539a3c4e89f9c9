//! Whole cloth struck by solids of any size from any side, also in the jumps of slow frames.

use cloth_solver::contact::{Collider, Shape};
use cloth_solver::{Cloth, Fabric, Motion, Pose};
use glam::{Quat, Vec2, Vec3};

use super::sheet::{TICK, direction, fastest, ground, hold, in_air, rms, run, sheet, strain, top};
use super::{Outcome, Part, Row, Trial};
use crate::stability::random::Random;
use crate::validate::hang::level;
use crate::validate::rig::{self, GRAVITY};

/// Trials.
const TRIALS: u64 = 240;
/// The slowest and the fastest solid, m/s.
const SPEED: [f64; 2] = [0.5, 20.0];
/// How many times as fast as the solid a particle may be.
const FACTOR: f32 = 3.0;
/// Below this rms speed a cloth is at rest, m/s.
const AT_REST: f32 = 0.03;
/// The solids.
const THINGS: [&str; 4] = ["ball", "bar", "box", "pyramid"];
/// What is struck.
const SCENES: [&str; 3] = ["hanging", "lying", "thrown"];
/// Side of the cloth, m, and cells along it.
const CLOTH: (f32, u32) = (0.6, 20);

/// Row 33.
pub fn rows(part: Part, seed: u64) -> Vec<Row> {
    let scene = "hanging, lying and thrown cloth struck by ball, bar, box, pyramid of 1–20 cells at 0.5…20 m/s from any side, also in jumps of 2…15 ticks";
    let must = "no particle above 3 × what drives it, at rest and strain within the fabric's limit 5 s after";
    let trials = (0..part.of(TRIALS, 6)).map(|number| trial(seed.wrapping_add(number))).collect();
    vec![Row { number: 33, scene, must, trials }]
}

fn trial(seed: u64) -> Trial {
    let mut random = Random::new(seed);
    let (thing, scene) = (THINGS[random.below(4)], SCENES[random.below(3)]);
    let speed = random.between(SPEED[0], SPEED[1]);
    let at = format!("seed {seed}: {scene}, {thing}, {speed:.1} m/s");
    Trial::new(at, move || strike(thing, scene, speed as f32, random_of(seed))).placed(thing, speed)
}

/// The numbers after those that the trial's name was made of.
fn random_of(seed: u64) -> Random {
    let mut random = Random::new(seed);
    (0..3).for_each(|_| _ = random.part());
    random
}

fn shape(thing: &str, size: f32) -> Shape {
    let shape = match thing {
        "ball" => Shape::sphere(0.5 * size),
        "bar" => Shape::capsule(0.25 * size, 2.0 * size),
        "box" => Shape::cuboid(Vec3::new(size, 0.7 * size, 1.2 * size)),
        _ => Shape::pyramid(Vec2::splat(size), size),
    };
    shape.unwrap_or_else(|error| panic!("{error}"))
}

fn strike(thing: &str, scene: &str, speed: f32, mut random: Random) -> Outcome {
    let fabrics = [Fabric::COTTON_POPLIN, Fabric::SILK_CHARMEUSE, Fabric::VELVET_CURTAIN, Fabric::DENIM_11_OZ];
    let fabric = fabrics[random.below(4)];
    let (side, cells) = CLOTH;
    let kind = random.below(2);
    let mut cloth = in_air(sheet(kind, [side; 2], [cells; 2], &fabric));
    let size = side / cells as f32 * random.between(1.0, f64::from(cells)) as f32;
    let shape = shape(thing, size);
    let jump = [1, 1, 2, 5, 15][random.below(5)];
    let way = direction(&mut random);
    let rotation = Quat::from_rotation_arc(Vec3::Y, direction(&mut random));
    let floor = match scene {
        "lying" => {
            rig::put(&mut cloth, |rest| level(rest) + Vec3::Y * 0.01);
            vec![ground(0.0)]
        }
        "hanging" => {
            hold(&mut cloth, top(side));
            vec![ground(-1.0)]
        }
        _ => vec![ground(-1.0)],
    };
    cloth.contacts.set_colliders(floor.clone());
    if scene != "thrown" {
        run(&mut cloth, 0.5);
    }
    let thrown = if scene == "thrown" { -speed * way } else { Vec3::ZERO };
    cloth.particles.velocity.fill(thrown);
    let hold_still = |cloth: &mut Cloth| {
        for slot in 0..cloth.topology.slots() {
            if cloth.particles.inverse_mass[slot] == 0.0 {
                cloth.particles.velocity.set(slot, Vec3::ZERO);
            }
        }
    };
    hold_still(&mut cloth);
    let reach = 0.3 + size;
    let aim = if scene == "lying" { Vec3::Y * 0.5 * size } else { Vec3::ZERO };
    let pose = |distance: f32| Pose::new(aim + way * (distance - reach), rotation);
    let (mut at, mut fast) = (0.0_f32, 0.0_f32);
    // A thrown cloth falls while it flies.
    let approach = if scene == "thrown" { 2.0 * speed } else { speed };
    let driven = |time: f32| approach.max(3.0).max(9.81 * time.min(0.45));
    let ticks = (2.0 * reach / (speed * TICK.dt)).ceil() as u32;
    let (mut ratio, mut jumped) = (0.0_f32, 0.0_f32);
    for tick in 1..=ticks {
        let next = if tick % jump == 0 { (speed * TICK.dt * tick as f32).min(2.0 * reach) } else { at };
        let motion = Motion { from: pose(at), to: pose(next) };
        let mut solids = floor.clone();
        solids.push(Collider { shape: shape.clone(), motion, friction: 0.3 });
        cloth.contacts.set_colliders(solids);
        cloth.step(TICK, GRAVITY);
        // A jump of a slow frame is as fast as it looks within its tick.
        jumped = jumped.max((next - at) / TICK.dt);
        at = next;
        fast = fast.max(fastest(&cloth));
        ratio = ratio.max(fastest(&cloth) / driven(tick as f32 * TICK.dt).max(jumped));
        if !cloth.particles.is_finite() {
            return Outcome::new(false, "not finite".into());
        }
    }
    cloth.contacts.set_colliders(floor);
    run(&mut cloth, 5.0);
    let held = ratio <= FACTOR && rms(&cloth) < AT_REST && strain(&cloth) < fabric.stretch_limit;
    let told = format!(
        "jumps of {jump} ticks, {size:.2} m: {fast:.1} m/s, {ratio:.2} × its drive; 5 s after rms {:.3} m/s, strain {:.2} %",
        rms(&cloth),
        100.0 * strain(&cloth)
    );
    Outcome::new(held, told)
}
