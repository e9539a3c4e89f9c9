//! What cloth and a body that it touches give each other.
//!
//! Contact answers as if nothing moved the solid. Then the body takes the impulse, and what touches it goes along with it: both get the
//! velocities that they would get together,
//!
//! (W⁻¹ + A) δ = j
//!
//! with the impulse j on the body as if nothing moved it, its inverse mass and inertia W, and A = Σ m d dᵀ the mass of what touches it,
//! each particle along the direction d in which it was pushed. Without A heavy cloth would throw a light body off, with more energy
//! than it has itself.

use glam::Vec3;

use super::Touch;

use crate::body::{Body, Six, identity_plus_product, solve};
use crate::{Particles, Soa3};

/// The velocities before contact with one collider.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Exchange {
    before: Soa3,
}

impl Exchange {
    /// Takes note of the velocities before a collider is met.
    pub fn begin(&mut self, particles: &Particles) {
        if self.before.len() != particles.slots() {
            self.before = Soa3::zeros(particles.slots());
        }
        self.before.copy_from(&particles.velocity);
    }

    /// Gives `body`, which is at the part `t` of the tick, what it was pushed, and takes what touches it along. `touch`, about `origin`,
    /// then says what it was given in fact.
    pub fn settle(&self, particles: &mut Particles, body: &mut Body, t: f32, origin: Vec3, touch: &mut Touch) {
        let center = body.center_at(t);
        let (mut impulse, mut moment) = (Vec3::ZERO, Vec3::ZERO);
        let mut mass = [[0.0_f64; 6]; 6];
        for i in 0..particles.slots() {
            let change = particles.velocity.get(i) - self.before.get(i);
            let m = particles.mass[i];
            let Some(direction) = change.try_normalize().filter(|_| m > 0.0) else { continue };
            let arm = particles.position.get(i) - center;
            impulse -= change * m;
            moment -= arm.cross(change * m);
            let row = six(direction, arm.cross(direction));
            for j in 0..6 {
                for k in 0..6 {
                    mass[j][k] += f64::from(m) * row[j] * row[k];
                }
            }
        }
        let mobility = body.mobility();
        let shared = solve(identity_plus_product(&mobility, &mass), times(&mobility, &six(impulse, moment)));
        let (velocity, spin) = vectors(&shared);
        let (mut kept, mut kept_moment) = (Vec3::ZERO, Vec3::ZERO);
        for i in 0..particles.slots() {
            let v = particles.velocity.get(i);
            let m = particles.mass[i];
            let Some(direction) = (v - self.before.get(i)).try_normalize().filter(|_| m > 0.0) else { continue };
            let arm = particles.position.get(i) - center;
            let along = direction * direction.dot(velocity + spin.cross(arm));
            particles.velocity.set(i, v + along);
            kept += along * m;
            kept_moment += arm.cross(along * m);
        }
        let (impulse, moment) = (impulse - kept, moment - kept_moment);
        body.give(impulse, moment);
        touch.impulse = impulse;
        touch.moment = moment + (center - origin).cross(impulse);
    }
}

fn six(first: Vec3, second: Vec3) -> Six {
    [first.x, first.y, first.z, second.x, second.y, second.z].map(f64::from)
}

fn vectors(six: &Six) -> (Vec3, Vec3) {
    let six = six.map(|number| number as f32);
    (Vec3::from_slice(&six[..3]), Vec3::from_slice(&six[3..]))
}

fn times(m: &[Six; 6], v: &Six) -> Six {
    m.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum())
}
