//! The rigid motion of each piece: all that internal friction leaves, and what pulls within the fabric must not change.

use fearless_simd::Simd;
use glam::{DMat3, DVec3};

use crate::constraint::hold::pin::Pins;
use crate::lanes::LANES;
use crate::topology::Pieces;
use crate::{Motion, Particles, Soa3};

/// Sums over particles of mass m at x with velocity v: of m, m x, m x², m (y z, z x, x y), m v and m x × v, in this order.
type Sums = [f64; 16];

/// The motion of one piece as if it were rigid.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::constraint) struct Body {
    sums: Sums,
    /// What [`note`] found.
    noted: Sums,
    centre: DVec3,
    drift: DVec3,
    spin: DVec3,
    /// The number of its pins, and the sums of the drift at the origin and of the spin of their frames.
    held: (f64, DVec3, DVec3),
}

/// [`Sums`] in eight lanes, that compile to vector code: a single sum of floats may not be taken out of order.
#[derive(Clone, Copy, Default)]
struct Moments([[f64; LANES]; 16]);

impl Moments {
    /// Adds eight particles.
    #[inline(always)]
    fn add(&mut self, m: &[f64; LANES], [x, y, z]: &[[f64; LANES]; 3], [u, v, w]: &[[f64; LANES]; 3]) {
        let mut p = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            p[0][lane] = m[lane] * x[lane];
            p[1][lane] = m[lane] * y[lane];
            p[2][lane] = m[lane] * z[lane];
        }
        let [px, py, pz] = &p;
        let sums = &mut self.0;
        for lane in 0..LANES {
            sums[0][lane] += m[lane];
            sums[1][lane] += px[lane];
            sums[2][lane] += py[lane];
            sums[3][lane] += pz[lane];
        }
        add_products(&mut sums[4], px, x);
        add_products(&mut sums[5], py, y);
        add_products(&mut sums[6], pz, z);
        add_products(&mut sums[7], py, z);
        add_products(&mut sums[8], pz, x);
        add_products(&mut sums[9], px, y);
        add_products(&mut sums[10], m, u);
        add_products(&mut sums[11], m, v);
        add_products(&mut sums[12], m, w);
        add_crossed(&mut sums[13], [py, w], [pz, v]);
        add_crossed(&mut sums[14], [pz, u], [px, w]);
        add_crossed(&mut sums[15], [px, v], [py, u]);
    }

    fn sums(&self) -> Sums {
        self.0.map(|lanes| lanes.iter().sum())
    }
}

impl Body {
    fn new(sums: Sums, held: (f64, DVec3, DVec3)) -> Self {
        let (pins, drift, spin) = held;
        if pins > 0.0 {
            return Self { sums, drift: drift / pins, spin: spin / pins, held, ..Self::default() };
        }
        let mass = sums[0];
        if mass <= 0.0 {
            return Self::default();
        }
        let [first, squares, products, momentum, angular] = [1, 4, 7, 10, 13].map(|k| DVec3::from_slice(&sums[k..]));
        let (c, drift) = (first / mass, momentum / mass);
        // About the centre.
        let s = squares - c * c * mass;
        let p = products - DVec3::new(c.y * c.z, c.z * c.x, c.x * c.y) * mass;
        let angular = angular - first.cross(drift);
        let inertia = DMat3::from_cols(
            DVec3::new(s.y + s.z, -p.z, -p.y),
            DVec3::new(-p.z, s.z + s.x, -p.x),
            DVec3::new(-p.y, -p.x, s.x + s.y),
        );
        let size = 2.0 * s.element_sum();
        // Particles on a line resist no rotation about it.
        let singular = inertia.determinant() <= 1e-9 * size * size * size;
        let spin = if singular { DVec3::ZERO } else { inertia.inverse() * angular };
        Self { sums, centre: c, drift, spin, held, ..Self::default() }
    }
}

/// The velocity at the origin and the spin of a frame that moves within `dt`.
fn motion(frame: &Motion, dt: f64) -> (DVec3, DVec3) {
    if frame.from == frame.to {
        return (DVec3::ZERO, DVec3::ZERO);
    }
    let turn = (frame.to.rotation * frame.from.rotation.conjugate()).normalize().to_scaled_axis().as_dvec3();
    let spin = turn / dt;
    let (from, to) = (frame.from.position.as_dvec3(), frame.to.position.as_dvec3());
    ((to - from) / dt - spin.cross(to), spin)
}

/// Internal friction: what is not rigid motion of a piece fades (Müller et al. 2007, §3.5), and of a piece that is pinned what is
/// not the motion of its pins: the velocity of every free particle moves towards that by `1 − exp(−rate dt)`. A cloth in one piece has
/// no `pieces`. `bodies` is working memory.
///
/// Of what hangs on nothing it takes no momentum, linear or angular: free fall and spin stay. A piece that is held would, without
/// air, swing for ever about a corner or a line: that is rigid motion, too. Real cloth does not, it rubs where it is held. Local
/// dashpots on shear and bending were tried and left the slow swings of hanging flaps, which hardly shear or bend, as they were.
#[inline(always)]
pub(in crate::constraint) fn damp<S: Simd>(
    _: S,
    particles: &mut Particles,
    pieces: Option<&Pieces>,
    (pins, is_held): (&Pins, impl Fn(u32) -> bool),
    bodies: &mut Vec<Body>,
    rate: f32,
    dt: f32,
) {
    let Particles { position: x, velocity: v, mass, inverse_mass, .. } = particles;
    bodies.clear();
    bodies.resize(pieces.map_or(1, |pieces| pieces.triangles.len()), Body::default());
    for pin in pins.pins.iter().filter(|pin| is_held(pin.frame)) {
        let piece = pieces.map_or(0, |pieces| pieces.of_slot[pin.particle as usize] as usize);
        let (Some(body), Some(frame)) = (bodies.get_mut(piece), pins.frames.get(pin.frame as usize)) else { continue };
        let (drift, spin) = motion(frame, f64::from(dt));
        body.held = (body.held.0 + 1.0, body.held.1 + drift, body.held.2 + spin);
    }
    add_up(inverse_mass, x, v, pieces, bodies);
    for body in bodies.iter_mut() {
        *body = Body::new(body.sums, body.held);
    }
    let fade = 1.0 - libm::expf(-rate * dt);
    let mut start = 0;
    while let Some((piece, end)) = run(pieces, start, mass.len()) {
        let Body { drift, spin, centre, .. } = bodies.get(piece).copied().unwrap_or_default();
        let (d, s, c) = (drift.as_vec3(), spin.as_vec3(), centre.as_vec3());
        for i in start..end {
            let fade = if inverse_mass[i] > 0.0 { fade } else { 0.0 };
            let (rx, ry, rz) = (x.x[i] - c.x, x.y[i] - c.y, x.z[i] - c.z);
            v.x[i] += (d.x + (s.y * rz - ry * s.z) - v.x[i]) * fade;
            v.y[i] += (d.y + (s.z * rx - rz * s.x) - v.y[i]) * fade;
            v.z[i] += (d.z + (s.x * ry - rx * s.y) - v.z[i]) * fade;
        }
        start = end;
    }
}

/// Adds what moves, with the velocities or moves `v`, to the sums of its pieces.
#[inline(always)]
fn add_up(inverse_mass: &[f32], x: &Soa3, v: &Soa3, pieces: Option<&Pieces>, bodies: &mut [Body]) {
    let mut start = 0;
    while let Some((piece, end)) = run(pieces, start, inverse_mass.len()) {
        let mut moments = Moments::default();
        for i in (start..end).step_by(LANES) {
            let len = LANES.min(end - i);
            let (mut m, mut at, mut velocity) = ([0.0; LANES], [[0.0; LANES]; 3], [[0.0; LANES]; 3]);
            for k in 0..len {
                m[k] = if inverse_mass[i + k] > 0.0 { 1.0 / f64::from(inverse_mass[i + k]) } else { 0.0 };
            }
            widen(&mut at, x, i, len);
            widen(&mut velocity, v, i, len);
            moments.add(&m, &at, &velocity);
        }
        let sums = moments.sums();
        if let Some(body) = bodies.get_mut(piece) {
            for (sum, more) in body.sums.iter_mut().zip(sums) {
                *sum += more;
            }
        }
        start = end;
    }
}

/// The momentum of the moves of each piece before the forces within the fabric act, for [`keep`].
pub(in crate::constraint) fn note(particles: &Particles, pieces: Option<&Pieces>, bodies: &mut Vec<Body>) {
    bodies.clear();
    bodies.resize(pieces.map_or(1, |pieces| pieces.triangles.len()), Body::default());
    add_up(&particles.inverse_mass, &particles.position, &particles.moved, pieces, bodies);
}

/// Gives every piece that nothing holds the momentum back that [`note`] found, by a rigid move of the whole: where links turn so far
/// within a substep that they are pulled along where they point then, they turn the whole.
pub(in crate::constraint) fn keep(
    particles: &mut Particles,
    pieces: Option<&Pieces>,
    held: impl Iterator<Item = u32>,
    bodies: &mut [Body],
) {
    for body in bodies.iter_mut() {
        body.noted = std::mem::take(&mut body.sums);
    }
    add_up(&particles.inverse_mass, &particles.position, &particles.moved, pieces, bodies);
    for body in bodies.iter_mut() {
        for k in 10..16 {
            body.sums[k] = body.noted[k] - body.sums[k];
        }
        *body = Body::new(body.sums, body.held);
    }
    for particle in held {
        let piece = pieces.map_or(0, |pieces| pieces.of_slot[particle as usize] as usize);
        if let Some(body) = bodies.get_mut(piece) {
            *body = Body::default();
        }
    }
    let Particles { position, moved, inverse_mass, .. } = particles;
    for (i, _) in inverse_mass.iter().enumerate().filter(|(_, w)| **w > 0.0) {
        let piece = pieces.map_or(0, |pieces| pieces.of_slot[i] as usize);
        let Some(Body { drift, spin, centre, .. }) = bodies.get(piece) else { continue };
        let arm = position.get(i).as_dvec3() - centre;
        moved.set(i, moved.get(i) + (*drift + spin.cross(arm)).as_vec3());
    }
}

#[inline(always)]
fn add_products(sum: &mut [f64; LANES], a: &[f64; LANES], b: &[f64; LANES]) {
    for lane in 0..LANES {
        sum[lane] += a[lane] * b[lane];
    }
}

#[inline(always)]
fn add_crossed(sum: &mut [f64; LANES], [a, b]: [&[f64; LANES]; 2], [c, d]: [&[f64; LANES]; 2]) {
    for lane in 0..LANES {
        sum[lane] += a[lane] * b[lane] - c[lane] * d[lane];
    }
}

/// Writes `vectors[i..i + len]` to the first lanes.
#[inline(always)]
fn widen(lanes: &mut [[f64; LANES]; 3], vectors: &Soa3, i: usize, len: usize) {
    let [x, y, z] = lanes;
    for (lanes, axis) in [(x, &vectors.x), (y, &vectors.y), (z, &vectors.z)] {
        for (wide, narrow) in lanes.iter_mut().zip(&axis[i..i + len]) {
            *wide = f64::from(*narrow);
        }
    }
}

/// The piece of slot `start` (no piece's number for padding), and where the slots after it end that belong to the same
/// one; `None` behind the last.
fn run(pieces: Option<&Pieces>, start: usize, slots: usize) -> Option<(usize, usize)> {
    let Some(pieces) = pieces else { return (start < slots).then_some((0, slots)) };
    let rest = &pieces.of_slot[start.min(slots)..slots];
    let piece = *rest.first()?;
    let len = rest.iter().position(|other| *other != piece).unwrap_or(rest.len());
    Some((piece as usize, start + len))
}
