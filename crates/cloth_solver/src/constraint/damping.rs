//! Internal friction: what is not rigid motion fades (Müller et al. 2007, §3.5).
//!
//! It takes no momentum, linear or angular, and leaves free fall and rigid swings alone. Local dashpots on shear and
//! bending were tried and left the slow swings of hanging flaps, which hardly shear or bend, as they were.

use glam::{DMat3, DVec3, Vec3};

use crate::topology::Pieces;
use crate::{Particles, Soa3};

/// The motion of one piece as if it were rigid.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Body {
    mass: f64,
    centre: DVec3,
    drift: DVec3,
    spin: DVec3,
    inertia: DMat3,
}

impl Body {
    fn turn(&self) -> DVec3 {
        // Particles on a line resist no rotation about it.
        let size = self.inertia.x_axis.x + self.inertia.y_axis.y + self.inertia.z_axis.z;
        let singular = self.inertia.determinant() <= 1e-9 * size * size * size;
        if singular { DVec3::ZERO } else { self.inertia.inverse() * self.spin }
    }
}

/// Moves the velocity of every free particle towards that of the rigid motion of its piece, by `1 − exp(−rate dt)`. A cloth
/// in one piece has no `pieces`. `bodies` is working memory.
pub(super) fn damp(particles: &mut Particles, pieces: Option<&Pieces>, bodies: &mut Vec<Body>, rate: f32, dt: f32) {
    let Particles { position, velocity, mass, inverse_mass, .. } = particles;
    let piece = |slot: usize| pieces.map_or(0, |pieces| pieces.of_slot[slot] as usize);
    let free = |slot: &usize| inverse_mass[*slot] > 0.0;
    let at = |v: &Soa3, slot: usize| v.get(slot).as_dvec3();
    bodies.clear();
    bodies.resize(pieces.map_or(1, |pieces| pieces.triangles.len()), Body::default());
    for slot in (0..mass.len()).filter(free) {
        let (body, m) = (&mut bodies[piece(slot)], f64::from(mass[slot]));
        body.mass += m;
        body.centre += m * at(position, slot);
        body.drift += m * at(velocity, slot);
    }
    for body in bodies.iter_mut().filter(|body| body.mass > 0.0) {
        (body.centre, body.drift) = (body.centre / body.mass, body.drift / body.mass);
    }
    for slot in (0..mass.len()).filter(free) {
        let body = &mut bodies[piece(slot)];
        let (m, r) = (f64::from(mass[slot]), at(position, slot) - body.centre);
        body.spin += m * r.cross(at(velocity, slot));
        body.inertia += DMat3::from_diagonal(DVec3::splat(m * r.length_squared()))
            - DMat3::from_cols(r * (m * r.x), r * (m * r.y), r * (m * r.z));
    }
    for body in bodies.iter_mut() {
        body.spin = body.turn();
    }
    let fade = 1.0 - libm::expf(-rate * dt);
    for slot in 0..mass.len() {
        if inverse_mass[slot] > 0.0 {
            let Body { drift, spin, centre, .. } = &bodies[piece(slot)];
            let arm: Vec3 = position.get(slot) - centre.as_vec3();
            let rigid = drift.as_vec3() + spin.as_vec3().cross(arm);
            let v = velocity.get(slot);
            velocity.set(slot, v + (rigid - v) * fade);
        }
    }
}
