//! Rigid poses and how they move over one tick.

use glam::{Quat, Vec3};

/// A rigid placement: `world = position + rotation * local`. Metres; the rotation has unit length.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Origin of the frame, m.
    pub position: Vec3,
    /// Orientation of the frame.
    pub rotation: Quat,
}

impl Pose {
    /// The frame itself.
    pub const IDENTITY: Self = Self { position: Vec3::ZERO, rotation: Quat::IDENTITY };

    /// A pose from its place and orientation.
    pub const fn new(position: Vec3, rotation: Quat) -> Self {
        Self { position, rotation }
    }

    /// Takes a point of the frame to the space the frame is placed in.
    pub fn point(&self, local: Vec3) -> Vec3 {
        self.position + self.rotation * local
    }

    /// Takes a point of the space the frame is placed in to the frame.
    pub fn inverse_point(&self, point: Vec3) -> Vec3 {
        self.rotation.conjugate() * (point - self.position)
    }

    /// `self⁻¹ ∘ other`: the pose `other` as seen from this frame.
    pub fn inverse_pose(&self, other: &Self) -> Self {
        let inverse = self.rotation.conjugate();
        Self { position: inverse * (other.position - self.position), rotation: (inverse * other.rotation).normalize() }
    }

    /// Linear in place, constant angular speed in orientation; `t` in 0..=1.
    pub fn interpolate(&self, other: &Self, t: f32) -> Self {
        Self { position: self.position.lerp(other.position, t), rotation: self.rotation.slerp(other.rotation, t) }
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        self.position.is_finite() && self.rotation.is_finite()
    }
}

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

/// A pose at the start and at the end of one tick; between them it is interpolated.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Pose at the start of the tick.
    pub from: Pose,
    /// Pose at the end of the tick.
    pub to: Pose,
}

impl Motion {
    /// A pose that does not move in this tick.
    pub const fn at_rest(pose: Pose) -> Self {
        Self { from: pose, to: pose }
    }

    /// The pose at the fraction `t` of the tick, 0..=1. At rest and at the end it is exactly `to`.
    pub fn at(&self, t: f32) -> Pose {
        if self.from == self.to || t >= 1.0 { self.to } else { self.from.interpolate(&self.to, t) }
    }
}
