//! Internal friction: what is not rigid motion fades (Müller et al. 2007, §3.5).
//!
//! It takes no momentum, linear or angular, and leaves free fall and rigid swings alone. Local dashpots on shear and
//! bending were tried and left the slow swings of hanging flaps, which hardly shear or bend, as they were.

use glam::{DMat3, DVec3};

use crate::Particles;

/// Moves the velocity of every free particle towards that of the rigid motion of them all, by `1 − exp(−rate dt)`.
pub(super) fn damp(particles: &mut Particles, rate: f32, dt: f32) {
    let Particles { position, velocity, mass, inverse_mass, .. } = particles;
    let free = |i: &usize| inverse_mass[*i] > 0.0;
    let at = |v: &crate::Soa3, i: usize| v.get(i).as_dvec3();
    let (mut total, mut centre, mut drift) = (0.0, DVec3::ZERO, DVec3::ZERO);
    for i in (0..mass.len()).filter(free) {
        let m = f64::from(mass[i]);
        total += m;
        centre += m * at(position, i);
        drift += m * at(velocity, i);
    }
    if total <= 0.0 {
        return;
    }
    (centre, drift) = (centre / total, drift / total);
    let (mut spin, mut inertia) = (DVec3::ZERO, DMat3::ZERO);
    for i in (0..mass.len()).filter(free) {
        let (m, r) = (f64::from(mass[i]), at(position, i) - centre);
        spin += m * r.cross(at(velocity, i));
        inertia += DMat3::from_diagonal(DVec3::splat(m * r.length_squared()))
            - DMat3::from_cols(r * (m * r.x), r * (m * r.y), r * (m * r.z));
    }
    // Particles on a line resist no rotation about it.
    let size = inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z;
    let singular = inertia.determinant() <= 1e-9 * size * size * size;
    let turn = if singular { DVec3::ZERO } else { inertia.inverse() * spin };
    let (centre, drift, turn) = (centre.as_vec3(), drift.as_vec3(), turn.as_vec3());
    let fade = 1.0 - (-rate * dt).exp();
    for i in 0..mass.len() {
        if inverse_mass[i] > 0.0 {
            let rigid = drift + turn.cross(position.get(i) - centre);
            let v = velocity.get(i);
            velocity.set(i, v + (rigid - v) * fade);
        }
    }
}
