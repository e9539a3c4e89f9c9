//! Impact zones: particles that move nearly as one rigid body for a substep, because no impulses kept them apart (Provot 1997; Bridson,
//! Fedkiw, Anderson 2002). What moves rigidly does not pass through itself; nor does what goes on against the others up to where the
//! first pair of the zone meets, so that a jam works itself loose.

use glam::{DMat3, DQuat, DVec3, Vec3A};

use super::solve::Bodies;

/// The part of the way to the first meeting that particles of a zone still go, and the part below which they go none.
const LOOSE: f32 = 0.8;
const TIGHT: f32 = 0.02;

/// The zones of one substep.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Zones {
    /// Of each particle another of its zone, or itself.
    parent: Vec<u32>,
    /// The particles in zones, how far each would move and its velocity without.
    members: Vec<(u32, Vec3A, Vec3A)>,
    is_member: Vec<bool>,
    /// Of each zone, at its root, the part of the motion against the rigid one that is left, 0..1.
    loose: Vec<f32>,
}

/// How much heavier than free particles what is pinned counts in a zone.
const PINNED: f32 = 1e6;

impl Zones {
    pub fn new(slots: usize) -> Self {
        Self {
            parent: (0..slots as u32).collect(),
            members: Vec::new(),
            is_member: vec![false; slots],
            loose: vec![1.0; slots],
        }
    }

    /// Parts all zones.
    pub fn clear(&mut self) {
        for (slot, ..) in self.members.drain(..) {
            self.parent[slot as usize] = slot;
            self.is_member[slot as usize] = false;
            self.loose[slot as usize] = 1.0;
        }
    }

    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// The particles in zones.
    pub fn slots(&self) -> impl Iterator<Item = u32> {
        self.members.iter().map(|(slot, ..)| *slot)
    }

    fn root(&self, mut slot: u32) -> u32 {
        while self.parent[slot as usize] != slot {
            slot = self.parent[slot as usize];
        }
        slot
    }

    /// Whether four particles are in one zone that is quite rigid.
    pub fn holds(&self, ids: &[u32; 4]) -> bool {
        let root = self.root(ids[0]);
        self.loose[root as usize] <= 0.0 && ids[1..].iter().all(|id| self.root(*id) == root)
    }

    /// Makes one zone of those that four particles are in, which meet the part `t` (0..1) into the substep.
    pub fn join(&mut self, ids: &[u32; 4], t: f32, bodies: &Bodies) {
        let roots = ids.map(|id| self.root(id));
        let is_one = roots.iter().all(|root| *root == roots[0]);
        let mut loose = roots.iter().map(|root| self.loose[*root as usize]).fold(1.0, f32::min);
        // Rigid motion turns, so that less than up to the meeting is safe; what meets again is tightened.
        loose = if is_one { loose * (LOOSE * t).min(0.5) } else { loose.min(LOOSE * t) };
        let first = roots.iter().copied().min().unwrap_or(ids[0]);
        self.loose[first as usize] = if loose < TIGHT { 0.0 } else { loose };
        for (id, root) in ids.iter().zip(roots) {
            self.parent[root as usize] = first;
            if !std::mem::replace(&mut self.is_member[*id as usize], true) {
                self.members.push((*id, bodies.moved[*id as usize], bodies.velocity[*id as usize]));
            }
        }
    }

    /// Gives every zone the rigid motion of its momentum and angular momentum, and what is left of its own.
    pub fn stiffen(&mut self, bodies: &mut Bodies) {
        let mut by_zone: Vec<(u32, u32)> = Vec::with_capacity(self.members.len());
        for (slot, moved, velocity) in &self.members {
            by_zone.push((self.root(*slot), *slot));
            (bodies.moved[*slot as usize], bodies.velocity[*slot as usize]) = (*moved, *velocity);
        }
        by_zone.sort_unstable();
        for zone in by_zone.chunk_by(|a, b| a.0 == b.0) {
            stiffen(zone, f64::from(self.loose[zone[0].0 as usize]), bodies);
        }
    }
}

fn stiffen(zone: &[(u32, u32)], loose: f64, bodies: &mut Bodies) {
    let slots = || zone.iter().map(|(_, slot)| *slot as usize);
    let lightest = slots().map(|slot| bodies.inverse_mass[slot]).fold(0.0, f32::max);
    if lightest <= 0.0 {
        return;
    }
    let mass = |slot: usize| {
        let inverse = bodies.inverse_mass[slot];
        f64::from(if inverse > 0.0 { 1.0 / inverse } else { PINNED / lightest })
    };
    let total: f64 = slots().map(mass).sum();
    let mean = |of: &[Vec3A]| slots().map(|slot| of[slot].as_dvec3() * mass(slot)).sum::<DVec3>() / total;
    let (centre, drift, velocity) = (mean(&bodies.starts), mean(&bodies.moved), mean(&bodies.velocity));
    let arm = |slot: usize| bodies.starts[slot].as_dvec3() - centre;
    let turn = inverse_inertia(slots().map(|slot| (mass(slot), arm(slot))))
        * slots().map(|slot| arm(slot).cross(bodies.moved[slot].as_dvec3() - drift) * mass(slot)).sum::<DVec3>();
    let rotation = DQuat::from_scaled_axis(turn);
    // Velocities have the angular momentum that they had about where the particles would have been.
    let spin = inverse_inertia(slots().map(|slot| (mass(slot), rotation * arm(slot))))
        * slots()
            .map(|slot| {
                let end = arm(slot) + bodies.moved[slot].as_dvec3() - drift;
                end.cross(bodies.velocity[slot].as_dvec3() - velocity) * mass(slot)
            })
            .sum::<DVec3>();
    for slot in slots().filter(|slot| bodies.inverse_mass[*slot] > 0.0) {
        let from = bodies.starts[slot].as_dvec3() - centre;
        let to = rotation * from;
        let (moved, speed) = (drift + (to - from), velocity + spin.cross(to));
        bodies.moved[slot] = moved.lerp(bodies.moved[slot].as_dvec3(), loose).as_vec3a();
        bodies.velocity[slot] = speed.lerp(bodies.velocity[slot].as_dvec3(), loose).as_vec3a();
    }
}

/// The inverse of the moment of inertia of masses at these places about the origin, 1/(kg·m²).
fn inverse_inertia(masses: impl Iterator<Item = (f64, DVec3)>) -> DMat3 {
    let inertia = masses.fold(DMat3::ZERO, |sum, (m, x)| {
        let squares = DMat3::from_diagonal(DVec3::splat(x.length_squared()));
        sum + (squares - DMat3::from_cols(x * x.x, x * x.y, x * x.z)) * m
    });
    // Particles are never quite on a line, but nearly.
    let size = inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z;
    (inertia + DMat3::from_diagonal(DVec3::splat(1e-9 * size))).inverse()
}
