//! Impact zones: particles that move as one rigid body for a substep, because no impulses kept them apart (Provot 1997; Bridson,
//! Fedkiw, Anderson 2002). What moves rigidly does not pass through itself.

use glam::{Mat3A, Quat, Vec3A};

use super::solve::Bodies;

/// The zones of one substep.
#[derive(Clone, Debug, Default)]
pub(super) struct Zones {
    /// Of each particle another of its zone, or itself.
    parent: Vec<u32>,
    /// The particles in zones.
    members: Vec<u32>,
}

/// How much heavier than free particles what is pinned counts in a zone.
const PINNED: f32 = 1e6;

impl Zones {
    pub fn new(slots: usize) -> Self {
        Self { parent: (0..slots as u32).collect(), members: Vec::new() }
    }

    /// Parts all zones.
    pub fn clear(&mut self) {
        for slot in self.members.drain(..) {
            self.parent[slot as usize] = slot;
        }
    }

    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    fn root(&self, mut slot: u32) -> u32 {
        while self.parent[slot as usize] != slot {
            slot = self.parent[slot as usize];
        }
        slot
    }

    /// Whether four particles are in one zone.
    pub fn holds(&self, ids: &[u32; 4]) -> bool {
        !self.members.is_empty() && ids[1..].iter().all(|id| self.root(*id) == self.root(ids[0]))
    }

    /// Makes one zone of those that four particles are in.
    pub fn join(&mut self, ids: &[u32; 4]) {
        self.members.extend(ids);
        let first = ids.iter().map(|id| self.root(*id)).min().unwrap_or(ids[0]);
        for id in ids {
            let root = self.root(*id);
            self.parent[root as usize] = first;
            self.parent[*id as usize] = first;
        }
    }

    /// Gives every zone the rigid motion of its momentum and angular momentum.
    pub fn stiffen(&mut self, bodies: &mut Bodies) {
        self.members.sort_unstable();
        self.members.dedup();
        let mut by_zone: Vec<(u32, u32)> = self.members.iter().map(|slot| (self.root(*slot), *slot)).collect();
        by_zone.sort_unstable();
        for zone in by_zone.chunk_by(|a, b| a.0 == b.0) {
            stiffen(zone, bodies);
        }
    }
}

fn stiffen(zone: &[(u32, u32)], bodies: &mut Bodies) {
    let slots = || zone.iter().map(|(_, slot)| *slot as usize);
    let lightest = slots().map(|slot| bodies.inverse_mass[slot]).fold(0.0, f32::max);
    if lightest <= 0.0 {
        return;
    }
    let mass = |slot: usize| if bodies.inverse_mass[slot] > 0.0 { 1.0 / bodies.inverse_mass[slot] } else { PINNED / lightest };
    let total: f32 = slots().map(mass).sum();
    let mean = |of: &[Vec3A]| slots().map(|slot| of[slot] * mass(slot)).sum::<Vec3A>() / total;
    let (centre, drift, velocity) = (mean(&bodies.starts), mean(&bodies.moved), mean(&bodies.velocity));
    let (mut inertia, mut turn, mut spin) = (Mat3A::ZERO, Vec3A::ZERO, Vec3A::ZERO);
    for slot in slots() {
        let arm = bodies.starts[slot] - centre;
        let m = mass(slot);
        inertia += Mat3A::from_diagonal(glam::Vec3::splat(m * arm.length_squared()))
            - Mat3A::from_cols(arm * (m * arm.x), arm * (m * arm.y), arm * (m * arm.z));
        turn += arm.cross(bodies.moved[slot] - drift) * m;
        spin += arm.cross(bodies.velocity[slot] - velocity) * m;
    }
    // Four particles are never quite on a line, but nearly.
    let size = inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z;
    let inverse = (inertia + Mat3A::from_diagonal(glam::Vec3::splat(1e-5 * size))).inverse();
    let (turn, spin) = (inverse * turn, inverse * spin);
    let rotation = Quat::from_scaled_axis(turn.into());
    for slot in slots() {
        if bodies.inverse_mass[slot] > 0.0 {
            let arm = bodies.starts[slot] - centre;
            bodies.moved[slot] = drift + (rotation * arm - arm);
            bodies.velocity[slot] = velocity + spin.cross(arm);
        }
    }
}
