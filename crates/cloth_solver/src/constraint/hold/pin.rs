//! Pins: particles that follow a frame exactly.

use glam::Vec3;

use crate::{Motion, Particles};

/// One particle held at a point of a frame.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pin {
    /// The particle held.
    pub particle: u32,
    /// Index into [`Pins::frames`].
    pub frame: u32,
    /// Where in that frame it is held, m.
    pub local: Vec3,
}

/// All pins of a cloth. A pinned particle has inverse mass 0.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub struct Pins {
    /// The frames pins hang on, as they move over this tick, in the cloth's frame. The caller updates them each tick.
    pub frames: Vec<Motion>,
    /// The pins. A particle pinned twice follows the last.
    pub pins: Vec<Pin>,
}

impl Pins {
    /// Lets every pinned particle move to where its frame is at the fraction `t` of the tick.
    pub(crate) fn apply(&self, particles: &mut Particles, t: f32) {
        for (index, frame) in self.frames.iter().enumerate() {
            let pose = frame.at(t);
            for pin in self.pins.iter().filter(|pin| pin.frame as usize == index) {
                let i = pin.particle as usize;
                particles.moved.set(i, pose.point(pin.local) - particles.position.get(i));
            }
        }
    }
}
