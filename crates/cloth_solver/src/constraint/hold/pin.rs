//! Pins: particles that follow a frame exactly.

use glam::Vec3;

use crate::body::Body;
use crate::tick::Substep;
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

/// What hangs on rigid bodies that cloth pulls. A particle pinned to one is as heavy as its share of the body there, and so the solve
/// of the cloth finds how both move. What a frame is fixed to is set anew each tick.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(in crate::constraint) struct Towed {
    /// The bodies of this tick.
    pub bodies: Vec<Body>,
    /// The body that each frame of the pins is fixed to.
    of_frame: Vec<Option<u32>>,
    /// The pins on bodies.
    pins: Vec<TowedPin>,
}

#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug)]
struct TowedPin {
    pin: Pin,
    body: u32,
    /// Its share of the body, kg.
    mass: f32,
}

impl Towed {
    /// Begins a tick.
    pub fn begin(
        &mut self,
        particles: &Particles,
        pins: &Pins,
        bodies: impl IntoIterator<Item = Body>,
        of_frame: impl IntoIterator<Item = Option<u32>>,
    ) {
        self.bodies.clear();
        self.bodies.extend(bodies);
        self.of_frame.clear();
        self.of_frame.extend(of_frame);
        self.pins.clear();
        if self.of_frame.is_empty() {
            return;
        }
        for pin in &pins.pins {
            let Some(body) = self.body_of(pin.frame) else { continue };
            let at = pins.frames[pin.frame as usize].from.point(pin.local);
            let arm = at - self.bodies[body as usize].center[0];
            self.bodies[body as usize].load(particles.mass[pin.particle as usize], arm);
            self.pins.push(TowedPin { pin: *pin, body, mass: 0.0 });
        }
        for index in 0..self.pins.len() {
            let TowedPin { pin, body, .. } = self.pins[index];
            let count = self.pins.iter().filter(|other| other.body == body).count() as f32;
            let body = &mut self.bodies[body as usize];
            let at = pins.frames[pin.frame as usize].from.point(pin.local);
            self.pins[index].mass = body.mass_at(at - body.center[0]) / count;
            body.push.touched = true;
        }
    }

    /// The body that a frame is fixed to, if anything can move that.
    pub fn body_of(&self, frame: u32) -> Option<u32> {
        let body = self.of_frame.get(frame as usize).copied().flatten()?;
        self.bodies.get(body as usize).filter(|body| body.is_movable()).map(|_| body)
    }

    /// Gives what is pinned to bodies its share of them as inertia, for one substep.
    pub fn take_hold(&self, particles: &mut Particles) {
        for TowedPin { pin, mass, .. } in &self.pins {
            particles.inverse_mass[pin.particle as usize] = 1.0 / mass;
        }
    }

    /// Predicts where what is pinned to bodies moves.
    pub fn predict(&self, pins: &Pins, particles: &mut Particles, sub: &Substep) {
        for TowedPin { pin, body, .. } in &self.pins {
            let ahead = self.bodies[*body as usize].ahead(sub.h);
            let pose = ahead.carry(pins.frames[pin.frame as usize].at(sub.end), sub.end);
            let i = pin.particle as usize;
            particles.moved.set(i, pose.point(pin.local) - particles.position.get(i));
        }
    }

    /// Gives the bodies what the solve gave to what is pinned to them, moves them on, and puts the pins where they are then.
    pub fn accept(&mut self, pins: &Pins, particles: &mut Particles, sub: &Substep) {
        for index in 0..self.pins.len() {
            let TowedPin { pin, body, mass } = self.pins[index];
            let ahead = self.bodies[body as usize].ahead(sub.h);
            let i = pin.particle as usize;
            let at = ahead.carry(pins.frames[pin.frame as usize].at(sub.end), sub.end).point(pin.local);
            // All of them are pulled from where the body was about to be.
            let expected = at - particles.position.get(i);
            let pulled = (particles.moved.get(i) - expected) * (mass / sub.h);
            // The body takes along what is pinned to it, whose weight it bears.
            let own = particles.acceleration * sub.kick + particles.velocity.get(i) - expected / sub.h;
            let impulse = pulled + own * particles.mass[i];
            let arm = particles.position.get(i) - self.bodies[body as usize].center_at(sub.start);
            particles.moved.set(i, impulse);
            particles.previous.set(i, arm);
        }
        for TowedPin { pin, body, .. } in &self.pins {
            let i = pin.particle as usize;
            let (impulse, arm) = (particles.moved.get(i), particles.previous.get(i));
            self.bodies[*body as usize].give(impulse, arm.cross(impulse));
        }
        for body in &mut self.bodies {
            body.advance(sub.h);
        }
        for TowedPin { pin, body, .. } in &self.pins {
            let pose = self.bodies[*body as usize].carry(pins.frames[pin.frame as usize].at(sub.end), sub.end);
            let i = pin.particle as usize;
            particles.moved.set(i, pose.point(pin.local) - particles.position.get(i));
        }
    }

    /// Pins hold again.
    pub fn let_go(&self, particles: &mut Particles) {
        for TowedPin { pin, .. } in &self.pins {
            particles.inverse_mass[pin.particle as usize] = 0.0;
        }
    }

    /// Takes out the pins that are gone.
    pub fn retain(&mut self, is_there: impl Fn(&Pin) -> bool) {
        self.pins.retain(|towed| is_there(&towed.pin));
    }
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
