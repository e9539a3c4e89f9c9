//! Stretch of a mesh that is no grid, exact along strips of triangles, eight strips side by side.
//!
//! Along a strip (see [`crate::topology::strips`]) the constraints `C_k = |f_k| − 1` of its triangles are solved together, f the
//! column of the deformation gradient along the thread: what [`super::triangles`] solves one by one and thereby lets
//! stretch. With p_k the direction in which triangle k pulls, its gradients are `c_ki p_k` at corner i, c from the rest shape
//! alone. So `A_kl = p_k·p_l Σ w c_ki c_lj` over the particles that both have; none are more than [`REACH`] triangles apart, and
//! the LDLᵀ factors of A have as narrow a band.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::batch::{gather, gather3, scatter3};
use super::lines::calm;
use super::tension::Tensions;
use super::wear::{GONE, Wear};
use crate::lanes::{LANES, Vec3x8, load, splat, store};
use crate::topology::{Along, strips};
use crate::{Fabric, Particles, Soa3, Topology};

/// How many triangles apart in a strip two triangles with a common particle may be.
const REACH: usize = 5;

/// T h²/(m l) that a particle under a lasting load is given the inertia for: see [`crate::method::xpbd`].
const STATIC_LOAD: f32 = 0.25;

/// No triangle.
const NONE: u32 = u32::MAX;

type Lanes = [f32; LANES];

/// A triangle of each of eight strips.
#[derive(Clone, Debug)]
struct Link {
    corners: [[u32; LANES]; 3],
    /// Of f, by corner, 1/m.
    coefficient: [Lanes; 3],
    /// `[j]`: by corner, its coefficient times that which the same particle has in the link `j + 1` before; 0 if it has none.
    coupling: [[Lanes; 3]; REACH],
    /// 1/(Y A) of the part of the triangle's area A that is this strip's, 1/J.
    compliance: Lanes,
    /// As worn: factors on compliance and rest length.
    worn: [Lanes; 2],
    triangle: [u32; LANES],
}

/// Eight strips.
#[derive(Clone, Debug)]
struct Eight {
    links: Vec<Link>,
    /// The furthest that links of these strips are coupled.
    band: usize,
    lambda: Vec<f32>,
}

/// What the factorisation keeps for the way back, eight lanes each.
#[derive(Clone, Debug, Default)]
struct Work {
    pull: Soa3,
    /// [`REACH`] to a link.
    factor: Vec<f32>,
    /// 1/pivot.
    pivot: Vec<f32>,
    right: Vec<f32>,
}

impl Work {
    fn new(longest: usize) -> Self {
        let len = longest * LANES;
        let [pivot, right] = [vec![0.0; len], vec![0.0; len]];
        Self { pull: Soa3::zeros(len), factor: vec![0.0; len * REACH], pivot, right }
    }
}

/// All strips along one direction.
#[derive(Clone, Debug)]
pub(super) struct Strips {
    along: Along,
    eights: Vec<Eight>,
    work: Work,
}

impl Strips {
    pub fn new(topology: &Topology, along: Along, fabric: &Fabric) -> Self {
        let stiffness = match along {
            Along::Weft => fabric.stretch_weft,
            Along::Warp => fabric.stretch_warp,
        };
        let strips = strips(topology, along, REACH);
        let mut shares = vec![0_u32; topology.triangles.len()];
        strips.iter().flatten().for_each(|triangle| shares[*triangle as usize] += 1);
        let eights = pack(topology, strips).into_iter().map(|strips| {
            let mut eight = Eight::new(strips.iter().map(Vec::len).max().unwrap_or_default(), topology.padding());
            for (lane, strip) in strips.iter().enumerate() {
                eight.add(topology, along, lane, strip, |triangle| {
                    let area = 0.5 * topology.triangle_rest[triangle as usize].determinant();
                    shares[triangle as usize] as f32 / (stiffness * area)
                });
            }
            eight
        });
        let eights: Vec<Eight> = eights.collect();
        let longest = eights.iter().map(|eight| eight.links.len()).max().unwrap_or_default();
        Self { along, eights, work: Work::new(longest) }
    }

    /// Takes over what became of the particles; `None` makes all as good as new.
    pub fn wear(&mut self, wear: Option<Wear<'_>>) {
        for link in self.eights.iter_mut().flat_map(|eight| &mut eight.links) {
            for lane in (0..LANES).filter(|lane| link.triangle[*lane] != NONE) {
                let corners = [link.corners[0][lane], link.corners[1][lane], link.corners[2][lane]];
                let (compliance, rest) = wear.map_or((1.0, 1.0), |wear| wear.of_triangle(corners));
                (link.worn[0][lane], link.worn[1][lane]) = (compliance, rest);
            }
        }
    }

    /// Number of constraints.
    pub fn count(&self) -> usize {
        self.eights.iter().flat_map(|eight| &eight.links).flat_map(|link| link.triangle).filter(|t| *t != NONE).count()
    }

    /// Adds the tensions in the last solve of a substep of length `h`, weighed by area and by how much of it a particle feels:
    /// of strips beside one another the one solved first carries more than its share, and only what both carry is the tension
    /// of the thread between them.
    pub fn add_tensions(&self, topology: &Topology, h: f32, to: &mut Tensions) {
        for eight in &self.eights {
            for (k, link) in eight.links.iter().enumerate() {
                for lane in (0..LANES).filter(|lane| link.triangle[*lane] != NONE) {
                    let area = 0.5 * topology.triangle_rest[link.triangle[lane] as usize].determinant();
                    let lambda = eight.lambda[k * LANES + lane];
                    for (corner, coefficient) in link.corners.iter().zip(&link.coefficient) {
                        let felt = coefficient[lane].abs();
                        to.add(self.along, corner[lane], felt * -lambda / (h * h), felt * area);
                    }
                }
            }
        }
    }

    /// Solves every strip once.
    #[inline(always)]
    pub fn solve<S: Simd>(&mut self, simd: S, particles: &mut Particles, h: f32) {
        for eight in &mut self.eights {
            eight.solve(simd, particles, h, &mut self.work);
        }
    }
}

/// Puts strips together by eights of about the same length that share no particle.
fn pack(topology: &Topology, mut strips: Vec<Vec<u32>>) -> Vec<Vec<Vec<u32>>> {
    strips.sort_by_key(|strip| std::cmp::Reverse(strip.len()));
    let words = topology.slots().div_ceil(64);
    let mut eights: Vec<(Vec<Vec<u32>>, Vec<u64>)> = Vec::new();
    for strip in strips {
        let slots: Vec<u32> = strip.iter().flat_map(|triangle| topology.triangles[*triangle as usize]).collect();
        let free = |(eight, taken): &(Vec<Vec<u32>>, Vec<u64>)| {
            eight.len() < LANES && slots.iter().all(|slot| taken[*slot as usize / 64] >> (slot % 64) & 1 == 0)
        };
        let at = eights.iter().position(free).unwrap_or_else(|| {
            eights.push((Vec::new(), vec![0; words]));
            eights.len() - 1
        });
        slots.iter().for_each(|slot| eights[at].1[*slot as usize / 64] |= 1 << (slot % 64));
        eights[at].0.push(strip);
    }
    eights.into_iter().map(|(eight, _)| eight).collect()
}

impl Eight {
    fn new(count: usize, padding: u32) -> Self {
        let link = Link {
            corners: [[padding; LANES]; 3],
            coefficient: [[0.0; LANES]; 3],
            coupling: [[[0.0; LANES]; 3]; REACH],
            compliance: [GONE; LANES],
            worn: [[1.0; LANES]; 2],
            triangle: [NONE; LANES],
        };
        Self { links: vec![link; count], band: 0, lambda: vec![0.0; count * LANES] }
    }

    fn add(&mut self, topology: &Topology, along: Along, lane: usize, strip: &[u32], compliance: impl Fn(u32) -> f32) {
        let coefficients = |triangle: u32| {
            let inverse = topology.triangle_rest[triangle as usize].inverse();
            let [b, c] = match along {
                Along::Weft => inverse.x_axis,
                Along::Warp => inverse.y_axis,
            }
            .to_array();
            [-(b + c), b, c]
        };
        for (k, triangle) in strip.iter().enumerate() {
            let (corners, own) = (topology.triangles[*triangle as usize], coefficients(*triangle));
            let link = &mut self.links[k];
            link.triangle[lane] = *triangle;
            link.compliance[lane] = compliance(*triangle);
            for i in 0..3 {
                link.corners[i][lane] = corners[i];
                link.coefficient[i][lane] = own[i];
            }
            for j in 1..=REACH.min(k) {
                let other = strip[k - j];
                let (others, theirs) = (topology.triangles[other as usize], coefficients(other));
                for i in 0..3 {
                    if let Some(at) = others.iter().position(|slot| *slot == corners[i]) {
                        link.coupling[j - 1][i][lane] = own[i] * theirs[at];
                        self.band = self.band.max(j);
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn solve<S: Simd>(&mut self, simd: S, particles: &mut Particles, h: f32, work: &mut Work) {
        let Particles { position, moved, inverse_mass, load: inertia, .. } = particles;
        let (zero, one, tiny) = (splat(simd, 0.0), splat(simd, 1.0), splat(simd, f32::MIN_POSITIVE));
        let per_step = splat(simd, 1.0 / (h * h));
        for k in 0..self.links.len() {
            let link = &self.links[k];
            // No `map` over arrays here: its closure would be compiled without the instruction set this is dispatched to.
            let [a, b, c] = &link.corners;
            let w = [gather(simd, inverse_mass, a), gather(simd, inverse_mass, b), gather(simd, inverse_mass, c)];
            let coefficient = [
                f32x8::simd_from(simd, link.coefficient[0]),
                f32x8::simd_from(simd, link.coefficient[1]),
                f32x8::simd_from(simd, link.coefficient[2]),
            ];
            // Relative to the first corner, so that nothing is lost in large coordinates.
            let (x, by) = (gather3(simd, position, a), gather3(simd, moved, a));
            let before =
                (gather3(simd, position, b) - x) * coefficient[1] + (gather3(simd, position, c) - x) * coefficient[2];
            let f = before
                + (gather3(simd, moved, b) - by) * coefficient[1]
                + (gather3(simd, moved, c) - by) * coefficient[2];
            let length = f.length();
            let normal = f * (one / length.max(tiny));
            let before = before * (one / before.length().max(tiny));
            let rest = f32x8::simd_from(simd, link.worn[1]);
            let [w_a, w_b, w_c] = [
                w[0] * coefficient[0] * coefficient[0],
                w[1] * coefficient[1] * coefficient[1],
                w[2] * coefficient[2] * coefficient[2],
            ];
            let last = load(simd, &self.lambda, k * LANES);
            // Twice, for the triangle on the other side of the thread.
            let load_ratio = last * w_a.max(w_b).max(w_c) * splat(simd, -2.0);
            let share = calm(simd, load_ratio, length - rest, one - before.dot(normal));
            let pull = normal + (before - normal) * share;
            // Row k of A, from the furthest: `u_j = A_{k,k−j} − Σ_{i>j} u_i L_{k−j,k−i}`, `L_{k,k−j} = u_j/d_{k−j}`.
            let own = f32x8::simd_from(simd, link.compliance) * f32x8::simd_from(simd, link.worn[0]) * per_step;
            let mut pivot = (w_a + w_b + w_c) * pull.dot(pull) + own;
            let mut right = rest - length;
            let mut u = [zero; REACH];
            for j in (1..=self.band.min(k)).rev() {
                let coupling = &link.coupling[j - 1];
                let shared = w[0] * f32x8::simd_from(simd, coupling[0])
                    + w[1] * f32x8::simd_from(simd, coupling[1])
                    + w[2] * f32x8::simd_from(simd, coupling[2]);
                let mut entry = shared * pull.dot(Vec3x8::load(simd, &work.pull, (k - j) * LANES));
                for i in j + 1..=self.band.min(k) {
                    entry = entry - u[i - 1] * load(simd, &work.factor, ((k - j) * REACH + i - j - 1) * LANES);
                }
                u[j - 1] = entry;
            }
            for j in 1..=self.band.min(k) {
                let before = k - j;
                let factor = u[j - 1] * load(simd, &work.pivot, before * LANES);
                pivot = pivot - u[j - 1] * factor;
                right = right - factor * load(simd, &work.right, before * LANES);
                store(factor, &mut work.factor, (k * REACH + j - 1) * LANES);
            }
            pull.store(&mut work.pull, k * LANES);
            store(one / pivot.max(tiny), &mut work.pivot, k * LANES);
            store(right, &mut work.right, k * LANES);
        }
        let half = splat(simd, 0.5 / STATIC_LOAD);
        for k in (0..self.links.len()).rev() {
            let link = &self.links[k];
            let mut lambda = load(simd, &work.right, k * LANES) * load(simd, &work.pivot, k * LANES);
            for j in 1..=self.band.min(self.links.len() - 1 - k) {
                let after = k + j;
                lambda = lambda
                    - load(simd, &work.factor, (after * REACH + j - 1) * LANES)
                        * load(simd, &self.lambda, after * LANES);
            }
            store(lambda, &mut self.lambda, k * LANES);
            let push = Vec3x8::load(simd, &work.pull, k * LANES) * lambda;
            let wanted = (zero - lambda).max(zero) * half;
            for i in 0..3 {
                let corners = &link.corners[i];
                let coefficient = f32x8::simd_from(simd, link.coefficient[i]);
                let w = gather(simd, inverse_mass, corners);
                scatter3(gather3(simd, moved, corners) + push * (w * coefficient), moved, corners);
                let sum = gather(simd, inertia, corners) + wanted * coefficient * coefficient;
                for lane in 0..LANES {
                    inertia[corners[lane] as usize] = sum[lane];
                }
            }
        }
    }
}
