//! Grab: a stiff, force-limited spring between a point of the cloth and a point in space.

use glam::Vec3;

use crate::Particles;
use crate::tick::Substep;

/// A hand on the cloth. It holds a point of one triangle and pulls it towards a target.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grab {
    /// The particles of the triangle held.
    pub particles: [u32; 3],
    /// Barycentric weights of the point held, each in 0..=1; they sum to 1.
    pub weights: [f32; 3],
    /// Target at the start of the tick, cloth frame, m.
    pub from: Vec3,
    /// Target at the end of the tick, cloth frame, m.
    pub to: Vec3,
    /// Stiffness of the spring, N/m, above 0.
    pub stiffness: f32,
    /// The hand never pulls harder than this, N.
    pub max_force: f32,
}

/// What a fingertip that pinches the cloth weighs, kg. Without it a spring stiff enough to drag a curtain would act
/// on a few hundredths of a gram, which no step can resolve (a sweep makes no spring stiffer than m/h²).
const FINGERTIP_MASS: f32 = 0.02;

impl Grab {
    /// Adds the fingertip's inertia to that of the three particles, for one substep.
    pub(crate) fn take_hold(&self, particles: &mut Particles) {
        self.weigh(particles, FINGERTIP_MASS);
    }

    /// Takes it off again.
    pub(crate) fn let_go(&self, particles: &mut Particles) {
        self.weigh(particles, 0.0);
    }

    fn weigh(&self, particles: &mut Particles, fingertip: f32) {
        for (&particle, share) in self.particles.iter().zip(self.weights) {
            let (w, mass) = (&mut particles.inverse_mass[particle as usize], particles.mass[particle as usize]);
            if *w > 0.0 {
                *w = 1.0 / (mass + fingertip * share);
            }
        }
    }

    /// Adds the pull of the spring at `position` to `force`, N, for methods that step forces. `t` is the part of the tick
    /// that has passed.
    pub(crate) fn add_force(&self, position: &crate::Soa3, force: &mut crate::Soa3, t: f32) {
        let slots = self.particles.map(|p| p as usize);
        let held: Vec3 = (0..3).map(|i| position.get(slots[i]) * self.weights[i]).sum();
        let pull = ((self.from.lerp(self.to, t) - held) * self.stiffness).clamp_length_max(self.max_force);
        for i in 0..3 {
            force.set(slots[i], force.get(slots[i]) + pull * self.weights[i]);
        }
    }

    /// One implicit Euler step of a critically damped spring between the held point and its target, whose pull is cut
    /// off at `max_force`.
    pub(crate) fn apply(&self, particles: &mut Particles, sub: &Substep) {
        let slots = self.particles.map(|p| p as usize);
        let point = |v: &crate::Soa3| -> Vec3 { (0..3).map(|i| v.get(slots[i]) * self.weights[i]).sum() };
        let w: f32 = (0..3).map(|i| particles.inverse_mass[slots[i]] * self.weights[i] * self.weights[i]).sum();
        if w <= 0.0 {
            return;
        }
        let mass = 1.0 / w;
        let damping = 2.0 * (self.stiffness * mass).sqrt();
        let start = point(&particles.position);
        let now = start + point(&particles.moved) - self.from.lerp(self.to, sub.end);
        let before = start - self.from.lerp(self.to, sub.start);
        let inertia = mass / (sub.h * sub.h);
        let drag = damping / sub.h;
        let after = (now * inertia + before * drag) / (inertia + self.stiffness + drag);
        let force = ((after - now) * inertia).clamp_length_max(self.max_force);
        for i in 0..3 {
            let pull = force * (sub.h * sub.h * particles.inverse_mass[slots[i]] * self.weights[i]);
            particles.moved.set(slots[i], particles.moved.get(slots[i]) + pull);
        }
    }
}
