//! Internal friction: what is not rigid motion fades (Müller et al. 2007, §3.5).
//!
//! It takes no momentum, linear or angular, and leaves free fall and rigid swings alone. Local dashpots on shear and
//! bending were tried and left the slow swings of hanging flaps, which hardly shear or bend, as they were.

use fearless_simd::Simd;
use glam::{DMat3, DVec3};

use crate::Particles;
use crate::topology::Pieces;

/// The motion of one piece as if it were rigid.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Body {
    sums: Sums,
    centre: DVec3,
    drift: DVec3,
    spin: DVec3,
}

/// Sums over particles of mass m at x with velocity v.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// Σ m.
    mass: f64,
    /// Σ m x.
    first: DVec3,
    /// Σ m x².
    squares: DVec3,
    /// Σ m (y z, z x, x y).
    products: DVec3,
    /// Σ m v.
    momentum: DVec3,
    /// Σ m x × v.
    angular: DVec3,
}

impl Sums {
    #[inline(always)]
    fn add(&mut self, m: f64, x: DVec3, v: DVec3) {
        let p = x * m;
        self.mass += m;
        self.first += p;
        self.squares += p * x;
        self.products += DVec3::new(p.y * x.z, p.z * x.x, p.x * x.y);
        self.momentum += v * m;
        self.angular += p.cross(v);
    }
}

impl std::ops::AddAssign for Sums {
    fn add_assign(&mut self, other: Self) {
        self.mass += other.mass;
        self.first += other.first;
        self.squares += other.squares;
        self.products += other.products;
        self.momentum += other.momentum;
        self.angular += other.angular;
    }
}

impl Body {
    fn new(sums: Sums) -> Self {
        if sums.mass <= 0.0 {
            return Self::default();
        }
        let (centre, drift) = (sums.first / sums.mass, sums.momentum / sums.mass);
        let (c, moved) = (centre, DVec3::new(centre.y * centre.z, centre.z * centre.x, centre.x * centre.y));
        let (s, p) = (sums.squares - c * c * sums.mass, sums.products - moved * sums.mass);
        let inertia = DMat3::from_cols(
            DVec3::new(s.y + s.z, -p.z, -p.y),
            DVec3::new(-p.z, s.z + s.x, -p.x),
            DVec3::new(-p.y, -p.x, s.x + s.y),
        );
        let size = 2.0 * s.element_sum();
        // Particles on a line resist no rotation about it.
        let singular = inertia.determinant() <= 1e-9 * size * size * size;
        let about_centre = sums.angular - sums.first.cross(drift);
        let spin = if singular { DVec3::ZERO } else { inertia.inverse() * about_centre };
        Self { sums, centre, drift, spin }
    }
}

/// Moves the velocity of every free particle towards that of the rigid motion of its piece, by `1 − exp(−rate dt)`. A cloth
/// in one piece has no `pieces`. `bodies` is working memory.
#[inline(always)]
pub(super) fn damp<S: Simd>(
    _: S,
    particles: &mut Particles,
    pieces: Option<&Pieces>,
    bodies: &mut Vec<Body>,
    rate: f32,
    dt: f32,
) {
    let Particles { position: x, velocity: v, mass, inverse_mass, .. } = particles;
    bodies.clear();
    bodies.resize(pieces.map_or(1, |pieces| pieces.triangles.len()), Body::default());
    let mut start = 0;
    while let Some((piece, end)) = run(pieces, start, mass.len()) {
        let mut sums = Sums::default();
        for i in start..end {
            let m = if inverse_mass[i] > 0.0 { mass[i] } else { 0.0 };
            let at = DVec3::new(f64::from(x.x[i]), f64::from(x.y[i]), f64::from(x.z[i]));
            sums.add(f64::from(m), at, DVec3::new(f64::from(v.x[i]), f64::from(v.y[i]), f64::from(v.z[i])));
        }
        if let Some(body) = bodies.get_mut(piece) {
            body.sums += sums;
        }
        start = end;
    }
    for body in bodies.iter_mut() {
        *body = Body::new(body.sums);
    }
    let fade = 1.0 - libm::expf(-rate * dt);
    start = 0;
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

/// The piece of slot `start` (no piece's number for padding), and where the slots after it end that belong to the same
/// one; `None` behind the last.
fn run(pieces: Option<&Pieces>, start: usize, slots: usize) -> Option<(usize, usize)> {
    let Some(pieces) = pieces else { return (start < slots).then_some((0, slots)) };
    let rest = &pieces.of_slot[start.min(slots)..slots];
    let piece = *rest.first()?;
    let len = rest.iter().position(|other| *other != piece).unwrap_or(rest.len());
    Some((piece as usize, start + len))
}
