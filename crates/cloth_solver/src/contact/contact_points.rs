//! Where a cloth touches, point by point: for debug views.

use glam::Vec3;

use super::Contacts;
use crate::{Particles, Topology};

/// A point at which something touches a cloth, in the cloth's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// Where, m: on the surface of the solid, or half-way between two layers.
    pub point: Vec3,
    /// The way that the cloth is pushed there, of unit length; of two layers that of the first.
    pub normal: Vec3,
}

impl Contacts {
    /// Every particle that touches a solid where that stands at the end of the tick, as [`Contacts::touches`] does. Contacts of triangles
    /// and edges between their particles are not among them.
    pub fn points(&self, topology: &Topology, particles: &Particles) -> Vec<ContactPoint> {
        let mut found = Vec::new();
        for collider in &self.colliders {
            let (pose, most) = (collider.motion.to, 1.1 * self.margin(&collider.shape));
            for slot in topology.particles() {
                let at = particles.position.get(slot as usize);
                let (distance, normal) = collider.shape.distance_and_normal(pose.inverse_point(at));
                if distance < most {
                    let normal = pose.rotation * normal;
                    found.push(ContactPoint { point: at - distance * normal, normal });
                }
            }
        }
        found
    }
}
