//! Where colliders stop particles: the planes that layers pressed onto them must not be pushed through.

use glam::Vec3A;

use super::state::Solids;
use crate::Particles;
use crate::contact::Contacts;
use crate::tick::Substep;

/// A particle near a collider, and the plane it stays above.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug)]
pub(super) struct Stop {
    pub particle: u32,
    pub normal: Vec3A,
    /// Height of the plane above the origin at the end of the substep, m.
    level: f32,
    /// How fast it rises, m/s.
    rise: f32,
}

impl Stop {
    /// Adds those of the particles in `slots`, in ascending order, that a collider may stop before the tick is over. `sub` is the substep
    /// at hand.
    pub fn find(all: &mut Vec<Self>, slots: &[u32], particles: &Particles, solids: &[Solids], sub: &Substep) {
        for cloth in solids {
            let [first, end] =
                [cloth.slots.start, cloth.slots.end].map(|end| slots.partition_point(|slot| *slot < end));
            Self::find_of(all, &slots[first..end], particles, cloth.contacts, sub);
        }
    }

    fn find_of(all: &mut Vec<Self>, slots: &[u32], particles: &Particles, contacts: &Contacts, sub: &Substep) {
        let tick = sub.h / (sub.end - sub.start);
        for collider in &contacts.colliders {
            let pose = collider.motion.at(sub.end);
            let margin = contacts.margin(&collider.shape);
            for &slot in slots {
                let x = particles.position.get(slot as usize);
                let reach = 2.0 * margin + particles.velocity.get(slot as usize).length() * tick;
                if (x - pose.position).length() > collider.shape.bounding_radius() + reach {
                    continue;
                }
                let local = pose.inverse_point(x);
                let (distance, normal) = collider.shape.distance_and_normal(local);
                if distance > reach {
                    continue;
                }
                let normal = pose.rotation * normal;
                let carried = collider.motion.to.point(local) - collider.motion.from.point(local);
                let level = normal.dot(x) - (distance - margin).max(0.0);
                all.push(Self { particle: slot, normal: normal.into(), level, rise: carried.dot(normal) / tick });
            }
        }
    }

    /// Moves the plane on by a substep.
    pub fn advance(&mut self, h: f32) {
        self.level += self.rise * h;
    }

    /// How fast its particle, which began the substep at `start`, may at least go along the normal, m/s.
    #[inline(always)]
    pub fn least_speed(&self, start: Vec3A, h: f32) -> f32 {
        self.rise - self.height(start, h).max(0.0) / h
    }

    /// How far above the plane `start` is where the substep begins, m.
    #[inline(always)]
    pub fn height(&self, start: Vec3A, h: f32) -> f32 {
        self.normal.dot(start) - (self.level - self.rise * h)
    }

    /// How far below the plane `x` is, m.
    #[inline(always)]
    pub fn depth(&self, x: Vec3A) -> f32 {
        self.level - self.normal.dot(x)
    }
}
