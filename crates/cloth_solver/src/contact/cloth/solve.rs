//! The impulses that keep pairs apart, and how pairs that are too near are moved apart.
//!
//! A pair may approach by no more than what it is farther apart than the distance kept: `n·Σ bᵢ vᵢ ≥ −(d − keep)/h`. Gauss–Seidel on the
//! accumulated impulses of that (Moreau, Jean 1996; Erleben 2007) is an ascent of the dual problem: however few sweeps there are, it
//! adds no kinetic energy. Impulses act along the line between the nearest points where they are then, so they have no moment, and they
//! change the place at the end of the substep by what the changed velocity does from there on.

use glam::Vec3A;

use super::nearest::{Kind, Nearest};
use super::stop::Stop;
use super::surfaces::Surfaces;
use crate::contact::DEPENETRATION_SPEED;

/// Sweeps over the velocities.
const SWEEPS: u32 = 3;

/// Sweeps over the positions.
const POSITION_SWEEPS: u32 = 1;

/// The state of the particles in one substep.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Bodies {
    /// Where each was when the substep began, m.
    pub starts: Vec<Vec3A>,
    /// How far it has moved since, m.
    pub moved: Vec<Vec3A>,
    /// Velocity, m/s.
    pub velocity: Vec<Vec3A>,
    /// 1/mass, 1/kg; 0 of what is pinned.
    pub inverse_mass: Vec<f32>,
    /// The normal of the collider that holds it, or zero.
    pub held: Vec<Vec3A>,
}

impl Bodies {
    pub fn new(slots: usize) -> Self {
        let zeros = vec![Vec3A::ZERO; slots];
        Self {
            starts: zeros.clone(),
            moved: zeros.clone(),
            velocity: zeros.clone(),
            inverse_mass: vec![0.0; slots],
            held: zeros,
        }
    }
}

#[inline(always)]
fn weighted(all: &[Vec3A], ids: &[u32; 4], weights: &[f32; 4]) -> Vec3A {
    all[ids[0] as usize] * weights[0]
        + all[ids[1] as usize] * weights[1]
        + all[ids[2] as usize] * weights[2]
        + all[ids[3] as usize] * weights[3]
}

/// Two points of cloth that press on each other.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    pub ids: [u32; 4],
    pub patches: [u32; 2],
    weights: [f32; 4],
    /// From the second point to the first, of unit length.
    normal: Vec3A,
    /// Mass that an impulse between the points moves, kg; and one along the normal, which moves nothing that is held against it.
    mass: f32,
    pushed_mass: f32,
    /// How each particle yields to an impulse along the normal, 1/kg.
    yields: [Vec3A; 4],
    /// What an impulse of friction on the points turns into along the normal on each particle, so that it has no moment although the
    /// points are apart, dimensionless.
    levers: [Vec3A; 4],
    /// Speed at which they may approach, m/s.
    allowed: f32,
    /// From where the normal was taken to the end of the substep, s.
    left: f32,
    /// Distance at which the pair has to end, m; none of one that meets within the substep.
    target: f32,
    friction: f32,
    /// Impulse along the normal so far, kg·m/s.
    push: f32,
    /// Impulse of friction so far, kg·m/s.
    rub: Vec3A,
}

/// What is the same for all contacts of a substep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Law<'a> {
    pub surfaces: &'a Surfaces,
    /// Length of the substep, s.
    pub h: f32,
}

impl Contact {
    /// Of a pair that keeps `keep` m and has these nearest points the part `t` (0..1) into the substep. `None` if nothing of it can move.
    pub fn new(
        kind: Kind,
        ids: [u32; 4],
        patches: [u32; 2],
        found: &Nearest,
        keep: f32,
        t: f32,
        bodies: &Bodies,
        law: &Law,
    ) -> Option<Self> {
        let Nearest { weights, between } = *found;
        let distance = between.length();
        let normal = between / distance;
        // What lies on a collider does not yield towards it (shock propagation: Guendelman, Bridson, Fedkiw 2003).
        let yields: [Vec3A; 4] = core::array::from_fn(|i| {
            let id = ids[i] as usize;
            let into = bodies.held[id].dot(normal);
            let along = if weights[i] * into < 0.0 { normal - bodies.held[id] * into } else { normal };
            along * (bodies.inverse_mass[id] * weights[i])
        });
        let pushed: f32 = (0..4).map(|i| yields[i].dot(normal) * weights[i]).sum();
        // Nothing to move, but for rounding.
        let free: f32 = (0..4).map(|i| bodies.inverse_mass[ids[i] as usize] * weights[i] * weights[i]).sum();
        if pushed <= 1e-4 * free || distance <= 0.0 {
            return None;
        }
        let levers = levers(kind, &ids.map(|id| bodies.starts[id as usize]), &weights, between);
        let inertia: f32 = (0..4)
            .map(|i| bodies.inverse_mass[ids[i] as usize] * (weights[i] * weights[i] + levers[i].length_squared()))
            .sum();
        let left = (1.0 - t) * law.h;
        let missing = (keep - distance).max(0.0);
        let between = law.surfaces.between(ids[0], ids[3]);
        let made_up = (between.made_up * missing).min(DEPENETRATION_SPEED * law.h);
        Some(Self {
            ids,
            patches,
            weights,
            normal,
            mass: 1.0 / inertia,
            pushed_mass: 1.0 / pushed,
            yields,
            levers,
            allowed: if t > 0.0 { 0.0 } else { (distance - keep).max(0.0) / law.h },
            left,
            target: if t > 0.0 { f32::NEG_INFINITY } else { keep.min(distance) + made_up },
            friction: between.friction,
            push: 0.0,
            rub: Vec3A::ZERO,
        })
    }

    /// Its particles, their weights, and the way from the second point to the first.
    pub fn points(&self) -> (&[u32; 4], &[f32; 4], Vec3A) {
        (&self.ids, &self.weights, self.normal)
    }

    /// Whether it presses.
    pub fn presses(&self) -> bool {
        self.push > 0.0
    }

    #[inline(always)]
    fn solve_velocity(&mut self, bodies: &mut Bodies) {
        let relative = weighted(&bodies.velocity, &self.ids, &self.weights);
        let along = relative.dot(self.normal);
        let push = (self.push - (along + self.allowed) * self.pushed_mass).max(0.0);
        if push == 0.0 && self.push == 0.0 {
            return;
        }
        let pushed = push - self.push;
        // Friction stops what slides once that impulse has acted, as far as the whole of it allows.
        let mut sliding = relative - self.normal * along;
        for i in 0..4 {
            sliding += self.levers[i] * bodies.velocity[self.ids[i] as usize].dot(self.normal);
        }
        let rub = (self.rub - sliding * self.mass).clamp_length_max(self.friction * push);
        let rubbed = rub - self.rub;
        (self.push, self.rub) = (push, rub);
        for i in 0..4 {
            let id = self.ids[i] as usize;
            let turned = rubbed * self.weights[i] + self.normal * self.levers[i].dot(rubbed);
            let change = self.yields[i] * pushed + turned * bodies.inverse_mass[id];
            bodies.velocity[id] += change;
            bodies.moved[id] += change * self.left;
        }
    }

    #[inline(always)]
    fn solve_position(&self, bodies: &mut Bodies) {
        let from = weighted(&bodies.starts, &self.ids, &self.weights);
        let gap = (from + weighted(&bodies.moved, &self.ids, &self.weights)).dot(self.normal);
        if gap < self.target {
            let shift = (self.target - gap) * self.pushed_mass;
            for i in 0..4 {
                let id = self.ids[i] as usize;
                bodies.moved[id] += self.yields[i] * shift;
            }
        }
    }
}

/// See [`Contact::levers`]: the velocity of the second feature is taken where the first one's point is, as if it were rigid.
#[inline(always)]
fn levers(kind: Kind, points: &[Vec3A; 4], weights: &[f32; 4], between: Vec3A) -> [Vec3A; 4] {
    let none = [Vec3A::ZERO; 4];
    if weights.contains(&0.0) {
        return none;
    }
    match kind {
        Kind::VertexTriangle => {
            let [_, a, b, c] = *points;
            let normal = (b - a).cross(c - a);
            let scale = between.length() / normal.length_squared();
            [Vec3A::ZERO, normal.cross(c - b) * scale, normal.cross(a - c) * scale, normal.cross(b - a) * scale]
        }
        Kind::EdgeEdge => {
            let (first, second) = (points[1] - points[0], points[3] - points[2]);
            let parallelogram = between.dot(first.cross(second));
            // Nearly parallel edges would be turned far too much.
            if parallelogram.abs() < 0.2 * between.length() * first.length() * second.length() {
                return none;
            }
            let scale = between.length_squared() / parallelogram;
            let normal = between.normalize();
            let (on_first, on_second) = (second.cross(normal) * scale, normal.cross(first) * scale);
            [-on_first, on_first, -on_second, on_second]
        }
    }
}

/// Solves all contacts, one after the other and then again from the last to the first.
pub(super) fn solve(bodies: &mut Bodies, contacts: &mut [Contact], stops: &[Stop], law: &Law) {
    for sweep in 0..SWEEPS {
        if sweep % 2 == 0 {
            contacts.iter_mut().for_each(|contact| contact.solve_velocity(bodies));
        } else {
            contacts.iter_mut().rev().for_each(|contact| contact.solve_velocity(bodies));
        }
        for stop in stops {
            let id = stop.particle as usize;
            let missing = stop.least_speed(bodies.starts[id], law.h) - bodies.velocity[id].dot(stop.normal);
            if missing > 0.0 && bodies.inverse_mass[id] > 0.0 {
                bodies.velocity[id] += stop.normal * missing;
                bodies.moved[id] += stop.normal * (missing * law.h);
            }
        }
    }
    for _ in 0..POSITION_SWEEPS {
        contacts.iter().for_each(|contact| contact.solve_position(bodies));
        for stop in stops {
            let id = stop.particle as usize;
            let depth = stop.depth(bodies.starts[id] + bodies.moved[id]);
            if depth > 0.0 && bodies.inverse_mass[id] > 0.0 {
                bodies.moved[id] += stop.normal * depth;
            }
        }
    }
}
