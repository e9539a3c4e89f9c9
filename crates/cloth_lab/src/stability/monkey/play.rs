//! Plays a plan and watches what must hold.

use cloth_solver::constraint::Grab;
use cloth_solver::contact::{Collider, Shape};
use cloth_solver::damage::fire::{Fire, Flammable, Surroundings};
use cloth_solver::damage::{Blade, Direction, Tear, Tearing};
use cloth_solver::forces::{Air, WindField};
use cloth_solver::topology::Change;
use cloth_solver::{Cloth, ClothError, Motion, Pose, Tick, measure};
use glam::{Quat, Vec3};

use super::plan::{Act, BALLS, Plan};
use crate::validate::rig::{G, GRAVITY};

/// Tension at which the cloth tears, N/m.
pub const STRENGTH: f32 = 800.0;
/// The hand: its strength, N, and the stiffness of its spring, N/m.
const HAND: [f32; 2] = [40.0, 200.0];
/// How many times as fast as what drives it a particle may be.
pub const FACTOR: f32 = 3.0;
/// The least that counts as a drive, m/s: the speed at which a ball pushes out what it appeared around.
const LEAST: f32 = 3.0;
/// What is left of a recoil in the next tick: a tenth after half a second.
const FADE: f32 = 0.93;
/// Half the length of a blade's rays, m.
const RAY: f32 = 3.0;
/// Part by which the mass may change where nothing burns.
const MASS: f64 = 1e-5;
/// How far a pinned particle may be from its pin, m.
const PINNED: f32 = 1e-6;

/// What did not hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// A number is not finite.
    NotFinite,
    /// A particle is faster than three times what drives it.
    TooFast,
    /// The mass changed by a cut, a tear or a step, or grew in a fire.
    Mass,
    /// A pinned particle is not on its pin.
    Pin,
    /// The cloth was refused.
    Refused,
}

/// What was seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// The first fault, and the tick it was found after.
    pub fault: Option<(Fault, u32)>,
    /// The largest speed, m/s.
    pub speed: f32,
    /// The largest speed over that of what drives the cloth.
    pub ratio: f32,
    /// The tick of that.
    pub tick: u32,
    /// Triangles and pieces at the end.
    pub left: [usize; 2],
    /// Sum over all ticks of substeps.
    pub substeps: u64,
    /// All bits of the last state, mixed.
    pub hash: u64,
}

/// A hand that holds the cloth.
#[derive(Clone, Copy, Debug)]
struct Hand {
    triangle: u32,
    at: Vec3,
    velocity: Vec3,
    left: u32,
}

/// A ball.
#[derive(Clone, Copy, Debug)]
struct Ball {
    radius: f32,
    at: Vec3,
    velocity: Vec3,
    left: u32,
}

/// A cloth in the hands of a monkey.
pub struct World {
    /// The cloth.
    pub cloth: Cloth,
    tear: Tear,
    tearing: Tearing,
    fire: Option<Fire>,
    wind: Vec3,
    hand: Option<Hand>,
    balls: [Option<Ball>; BALLS as usize],
    /// The fastest that drove it so far, without the fall, m/s.
    driven: f32,
    /// The speed at which the cloth snaps back where what stretches it lets go, m/s: T/√(Yσ), T its largest tension lately.
    recoil: f32,
    /// √(Y/σ) of the stiffer direction, m/s.
    sound: f32,
    /// The largest strain that counts for that: where cloth tears.
    tears_at: f32,
    /// The highest place of a particle so far, m.
    top: f32,
    mass: f64,
}

/// What a tick of the monkey takes.
const TICK: Tick = Tick::new(1.0 / 60.0);

impl World {
    /// The cloth of `plan` before anything is done to it.
    ///
    /// # Errors
    /// What the solver refuses in it.
    pub fn new(plan: &Plan) -> Result<Self, ClothError> {
        let fabric = plan.fabric().unwrap_or_default();
        let mut cloth = plan.cloth(&fabric)?;
        cloth.air = Some(Air::default());
        let fire = if plan.burns { Some(Fire::new(&cloth.topology, &fabric, &Flammable::default())?) } else { None };
        let top = highest(&cloth);
        let stiffness = fabric.stretch_warp.max(fabric.stretch_weft);
        Ok(Self {
            recoil: 0.0,
            sound: (stiffness / fabric.areal_density).sqrt(),
            tears_at: STRENGTH / stiffness,
            tear: Tear::new(&cloth.topology, Vec::new()),
            tearing: Tearing { reinforcement: 1.0, reach: 0.0, ..Tearing::at(STRENGTH) },
            fire,
            wind: Vec3::ZERO,
            hand: None,
            balls: [None; BALLS as usize],
            driven: LEAST,
            top,
            mass: mass(&cloth),
            cloth,
        })
    }

    /// Does one act.
    pub fn act(&mut self, act: &Act) {
        match *act {
            Act::Cut { between, along } => {
                let Some([a, b]) = self.particle(between[0]).zip(self.particle(between[1])).map(<[u32; 2]>::from)
                else {
                    return;
                };
                let ray = |slot: u32| {
                    let at = self.cloth.particles.position.get(slot as usize);
                    [at - along * RAY, at + along * RAY]
                };
                let blade = Blade { from: ray(a), to: ray(b) };
                let cut = self.cloth.cut(&blade);
                self.follow(cut.map(|cut| cut.change).as_ref(), true);
            }
            Act::Tear { at, weft } => {
                let Some(particle) = self.particle(at) else { return };
                let pull = if weft { Direction::Weft } else { Direction::Warp };
                let change = self.cloth.tear_at(particle, pull);
                self.follow(change.as_ref(), true);
            }
            Act::Grab { at, velocity, ticks } => {
                let count = self.cloth.topology.triangles.len();
                if count > 0 {
                    let triangle = ((at * count as f32) as u32).min(count as u32 - 1);
                    let corners = self.cloth.topology.triangles[triangle as usize];
                    let at = corners.iter().map(|slot| self.cloth.particles.position.get(*slot as usize) / 3.0).sum();
                    self.hand = Some(Hand { triangle, at, velocity, left: ticks });
                }
            }
            Act::LetGo => self.hand = None,
            Act::Wind(velocity) => self.wind = velocity,
            Act::Light { at, radius } => {
                if let (Some(particle), Some(fire)) = (self.particle(at), &mut self.fire) {
                    let centre = self.cloth.particles.position.get(particle as usize);
                    let _ = fire.ignite(&self.cloth.particles, centre, radius);
                }
            }
            Act::Put { ball, at, off, radius } => {
                if let Some(particle) = self.particle(at) {
                    let at = self.cloth.particles.position.get(particle as usize) + off;
                    self.balls[ball as usize] = Some(Ball { radius, at, velocity: Vec3::ZERO, left: 0 });
                }
            }
            Act::Throw { ball, velocity, ticks } => {
                if let Some(ball) = &mut self.balls[ball as usize] {
                    (ball.velocity, ball.left) = (velocity, ticks);
                }
            }
        }
    }

    /// Advances by one tick; `Err` if that breaks something.
    pub fn tick(&mut self) -> Result<(), Fault> {
        self.prepare();
        self.cloth.step(TICK, GRAVITY);
        self.after()
    }

    /// Moves what is not cloth.
    fn prepare(&mut self) {
        let mut solids = Vec::new();
        for ball in self.balls.iter_mut().flatten() {
            let from = ball.at;
            if ball.left > 0 {
                (ball.at, ball.left) = (from + ball.velocity * TICK.dt, ball.left - 1);
                self.driven = self.driven.max(ball.velocity.length());
            }
            let pose = |at| Pose::new(at, Quat::IDENTITY);
            if let Ok(shape) = Shape::sphere(ball.radius) {
                solids.push(Collider { shape, motion: Motion { from: pose(from), to: pose(ball.at) }, friction: 0.3 });
            }
        }
        self.cloth.contacts.set_colliders(solids);
        self.cloth.wind = WindField::uniform(self.wind);
        self.driven = self.driven.max(self.wind.length());
        self.cloth.constraints.grabs.clear();
        if let Some(hand) = &mut self.hand {
            let from = hand.at;
            if hand.left > 0 {
                (hand.at, hand.left) = (from + hand.velocity * TICK.dt, hand.left - 1);
                let corners = self.cloth.topology.triangles[hand.triangle as usize];
                let free = corners.iter().filter(|slot| !is_pinned(&self.cloth, **slot)).count();
                // Between pins the one corner that is free goes three times as far as the point that is held.
                self.driven = self.driven.max(hand.velocity.length() * 3.0 / free.max(1) as f32);
            }
            let particles = self.cloth.topology.triangles[hand.triangle as usize];
            let [max_force, stiffness] = HAND;
            let grab = Grab { particles, weights: [1.0 / 3.0; 3], from, to: hand.at, stiffness, max_force };
            self.cloth.constraints.grabs.push(grab);
        }
    }

    /// Tears, looks and burns.
    fn after(&mut self) -> Result<(), Fault> {
        self.tear.watch(&self.cloth.topology, &self.cloth.particles, &mut self.cloth.constraints, TICK.dt);
        let torn = self.cloth.tear(&mut self.tear, &self.tearing);
        // `tear` has followed what it did itself.
        self.follow(torn.map(|torn| torn.change).as_ref(), false);
        self.look()?;
        self.burn()
    }

    fn burn(&mut self) -> Result<(), Fault> {
        if let Some(fire) = &mut self.fire {
            let around = Surroundings { wind: self.wind, ..Surroundings::default() };
            // All numbers are in their ranges.
            let change = self.cloth.burn(fire, &around, TICK.dt).unwrap_or_default();
            if let Some(change) = &change {
                self.tear.follow(change);
                self.hold_on(change);
            }
            let now = mass(&self.cloth);
            if now > self.mass * (1.0 + MASS) {
                return Err(Fault::Mass);
            }
            self.mass = now;
        }
        Ok(())
    }

    /// What must hold after a step.
    fn look(&mut self) -> Result<(), Fault> {
        if !self.cloth.particles.is_finite() {
            return Err(Fault::NotFinite);
        }
        if (mass(&self.cloth) / self.mass - 1.0).abs() > MASS && self.mass > 0.0 {
            return Err(Fault::Mass);
        }
        let pins = self.cloth.constraints.pins();
        let is_off = |pin: &cloth_solver::constraint::Pin| {
            self.cloth.particles.position.get(pin.particle as usize).distance(pin.local) > PINNED
        };
        if pins.pins.iter().any(is_off) {
            return Err(Fault::Pin);
        }
        self.top = self.top.max(highest(&self.cloth));
        let held = self.fastest()[1] <= FACTOR;
        let recoil = strain(&self.cloth).min(self.tears_at) * self.sound;
        self.recoil = recoil.max(FADE * self.recoil);
        if held { Ok(()) } else { Err(Fault::TooFast) }
    }

    /// The largest speed, m/s, and the largest one over that of what drives the particle.
    pub fn fastest(&self) -> [f32; 2] {
        self.cloth.topology.particles().map(|slot| slot as usize).fold([0.0; 2], |[most, ratio], slot| {
            let speed = self.cloth.particles.velocity.get(slot).length();
            let fallen = (self.top - self.cloth.particles.position.y[slot]).max(0.0);
            let driven = self.driven.max(self.recoil).max((2.0 * G as f32 * fallen).sqrt());
            [most.max(speed), ratio.max(speed / driven)]
        })
    }

    fn particle(&self, part: f32) -> Option<u32> {
        let count = self.cloth.topology.particles().count();
        self.cloth.topology.particles().nth(((part * count as f32) as usize).min(count.saturating_sub(1)))
    }

    /// Lets everything else know of a change; loads too, unless they know.
    fn follow(&mut self, change: Option<&Change>, loads: bool) {
        let Some(change) = change else { return };
        if loads {
            self.tear.follow(change);
        }
        if let Some(fire) = &mut self.fire {
            fire.follow(&self.cloth.topology, change);
        }
        self.hold_on(change);
    }

    /// The hand keeps the first part of what it holds, and lets go of what is gone.
    fn hold_on(&mut self, change: &Change) {
        self.hand = self.hand.and_then(|hand| {
            let triangle = change.triangles.iter().position(|source| *source == hand.triangle)? as u32;
            Some(Hand { triangle, ..hand })
        });
    }
}

/// Plays `plan` up to its first fault.
pub fn play(plan: &Plan) -> Seen {
    watch(plan, |_, _| ())
}

/// Plays `plan` up to its first fault, and shows it after every tick.
pub fn watch(plan: &Plan, mut show: impl FnMut(&World, u32)) -> Seen {
    let mut seen = Seen::default();
    let Ok(mut world) = World::new(plan) else { return Seen { fault: Some((Fault::Refused, 0)), ..seen } };
    let mut acts = plan.acts.iter().peekable();
    for tick in 0..plan.ticks {
        while let Some(due) = acts.next_if(|due| due.tick <= tick) {
            world.act(&due.act);
        }
        let held = world.tick();
        seen.substeps += u64::from(world.cloth.pace.taken());
        let [speed, ratio] = world.fastest();
        show(&world, tick);
        seen.speed = seen.speed.max(speed);
        if ratio > seen.ratio {
            (seen.ratio, seen.tick) = (ratio, tick);
        }
        if let Err(fault) = held {
            seen.fault = Some((fault, tick));
            break;
        }
    }
    let topology = &world.cloth.topology;
    seen.left = [topology.triangles.len(), topology.pieces().triangles.len()];
    seen.hash = hash(&world.cloth);
    seen
}

fn hash(cloth: &Cloth) -> u64 {
    let numbers = [&cloth.particles.position, &cloth.particles.velocity];
    let numbers = numbers.into_iter().flat_map(|all| all.x.iter().chain(&all.y).chain(&all.z));
    numbers.fold(0, |mixed: u64, number| {
        (mixed.rotate_left(5) ^ u64::from(number.to_bits())).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    })
}

fn is_pinned(cloth: &Cloth, slot: u32) -> bool {
    cloth.constraints.pins().pins.iter().any(|pin| pin.particle == slot)
}

fn mass(cloth: &Cloth) -> f64 {
    cloth.particles.mass.iter().map(|mass| f64::from(*mass)).sum()
}

fn highest(cloth: &Cloth) -> f32 {
    cloth.topology.particles().map(|slot| cloth.particles.position.y[slot as usize]).fold(f32::MIN, f32::max)
}

/// The largest strain of the cloth now.
pub fn strain(cloth: &Cloth) -> f32 {
    measure::largest_strain(&cloth.topology, &cloth.particles)
}

#[cfg(test)]
mod tests {
    use cloth_cases::cases;

    use super::*;
    use crate::stability::monkey::{Held, Tool};

    fn world() -> World {
        let plan = (0..).map(|seed| Plan::new(seed, 1, &[])).find(|plan| plan.held == Held::Top).unwrap();
        World::new(&plan).unwrap()
    }

    fn lowest(world: &World) -> usize {
        let height = |slot: &u32| (1e6 * world.cloth.particles.position.y[*slot as usize]) as i64;
        world.cloth.topology.particles().min_by_key(height).unwrap() as usize
    }

    #[test]
    fn what_is_spoilt_is_found() {
        assert_eq!(world().tick(), Ok(()));
        let mut fast = world();
        let slot = lowest(&fast);
        fast.cloth.particles.velocity.set(slot, Vec3::Z * 1e4);
        assert_eq!(fast.tick(), Err(Fault::TooFast));
        let mut heavy = world();
        heavy.cloth.particles.mass[slot] *= 2.0;
        assert_eq!(heavy.tick(), Err(Fault::Mass));
        let mut spoilt = world();
        spoilt.cloth.particles.position.x[slot] = f32::NAN;
        assert_eq!(spoilt.tick(), Err(Fault::NotFinite));
        let mut torn_off = world();
        torn_off.cloth.constraints.pin_frames_mut()[0] = Motion::at_rest(Pose::new(Vec3::Y * 1e-3, Quat::IDENTITY));
        assert_eq!(torn_off.tick(), Err(Fault::Pin));
    }

    #[test]
    fn the_same_seed_does_the_same_to_the_last_bit_and_another_something_else() {
        let play = |seed| play(&Plan::new(seed, 120, &Tool::ALL)).hash;
        assert_eq!(play(5), play(5));
        assert_ne!(play(5), play(6));
    }

    #[test]
    fn cloth_holds_what_wind_blades_tears_and_fire_do_to_it() {
        let tools = [Tool::Wind, Tool::Blade, Tool::Tear, Tool::Fire];
        let mut parted = 0;
        for seed in 1..=cases(3, 12) {
            let seen = play(&Plan::new(seed, 300, &tools));
            assert_eq!(seen.fault, None, "seed {seed}: {} m/s, {} times its drive", seen.speed, seen.ratio);
            parted += usize::from(seen.left[1] > 1);
        }
        assert!(parted > cases(0, 3), "only {parted} of them came apart");
    }
}
