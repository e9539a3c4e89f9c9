//! Impact zones: particles that move as one rigid body for a substep, because no impulses kept them apart (Provot 1997; Bridson,
//! Fedkiw, Anderson 2002). What moves rigidly does not pass through itself.

use glam::{DMat3, DQuat, DVec3, Vec3A};

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
        bodies.moved[slot] = (drift + (to - from)).as_vec3a();
        bodies.velocity[slot] = (velocity + spin.cross(to)).as_vec3a();
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
