//! What a cloth does to a collider.

use glam::Vec3;

/// What one collider met in one tick, in the cloth's frame.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Touch {
    /// Most contacts of particles, triangles and edges with it in one substep.
    pub touching: u32,
    /// What the cloth gave to it: minus what it gave to the particles, N·s.
    pub impulse: Vec3,
    /// The moment of that about the origin of the collider's frame, N·m·s.
    pub moment: Vec3,
    /// The largest speed along the normal at which a point of the cloth came against it, m/s.
    pub speed: f32,
}

impl Touch {
    /// Adds what happened in the same substep.
    pub(super) fn join(&mut self, more: &Self) {
        let touching = self.touching + more.touching;
        self.add(more);
        self.touching = touching;
    }

    /// Adds what happened in a further substep.
    pub fn add(&mut self, substep: &Self) {
        self.touching = self.touching.max(substep.touching);
        self.impulse += substep.impulse;
        self.moment += substep.moment;
        self.speed = self.speed.max(substep.speed);
    }
}
