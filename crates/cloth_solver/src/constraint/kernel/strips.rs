//! Stretch of a mesh that is no grid, exact along strips of triangles, eight strips side by side.
//!
//! Along a strip (see [`crate::topology::strips`]) the constraints `C_k = |f_k| − 1` of its triangles are solved together, f the
//! column of the deformation gradient along the thread: what [`crate::constraint::kernel::triangles`] solves one by one and thereby lets
//! stretch. With p_k the direction in which triangle k pulls, its gradients are `c_ki p_k` at corner i, c from the rest shape
//! alone. So `A_kl = p_k·p_l Σ w c_ki c_lj` over the particles that both have; none are more than [`REACH`] triangles apart, and
//! the LDLᵀ factors of A have as narrow a band.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use crate::batch::{Packed, gather4, pack, scatter4, unpack};
use crate::constraint::kernel::lines::{How, Met, target};
use crate::constraint::kernel::links::GONE;
use crate::constraint::kernel::waves::Waves;
use crate::constraint::tension::Tensions;
use crate::constraint::wear::Wear;
use crate::lanes::{LANES, Vec3x8, load, select, splat, store};
use crate::topology::{Along, strips};
use crate::{Fabric, Particles, Soa3, Topology};

/// How many triangles apart in a strip two triangles with a common particle may be.
pub(super) const REACH: usize = 5;

/// Least part of a pivot that elimination may leave: what is less is rounding. Between pinned particles the constraints of very
/// stiff fabric depend on one another.
const SINGULAR: f32 = 1e-6;

/// The band of most strips: in a mesh of evenly cut quads no wider one is needed.
const NARROW: usize = 3;

/// No triangle.
const NONE: u32 = u32::MAX;

type Lanes = [f32; LANES];

/// A triangle of each of eight strips.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(super) struct Link {
    pub corners: [[u32; LANES]; 3],
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

impl Link {
    /// See [`Self::coefficient`].
    #[inline(always)]
    pub fn coefficients<S: Simd>(&self, simd: S) -> [f32x8<S>; 3] {
        let [a, b, c] = self.coefficient;
        [f32x8::simd_from(simd, a), f32x8::simd_from(simd, b), f32x8::simd_from(simd, c)]
    }

    /// Σ w c² over the corners, w their inverse masses.
    #[inline(always)]
    pub fn mobility<S: Simd>(&self, simd: S, w: [f32x8<S>; 3]) -> f32x8<S> {
        let c = self.coefficients(simd);
        w[0] * c[0] * c[0] + w[1] * c[1] * c[1] + w[2] * c[2] * c[2]
    }

    /// Σ w c c′ over the corners that the link `j` before has as well, c′ its coefficients.
    #[inline(always)]
    pub fn shared_mobility<S: Simd>(&self, simd: S, j: usize, w: [f32x8<S>; 3]) -> f32x8<S> {
        let [a, b, c] = self.coupling[j - 1];
        w[0] * f32x8::simd_from(simd, a) + w[1] * f32x8::simd_from(simd, b) + w[2] * f32x8::simd_from(simd, c)
    }
}

/// Eight strips.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
struct Eight {
    links: Vec<Link>,
    /// The furthest that links of these strips are coupled.
    band: usize,
    /// The multipliers of the substep so far, and what the first pass leaves for later ones.
    lambda: Vec<f32>,
    work: Work,
}

/// What the factorisation keeps for the way back and for later passes, eight lanes each.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
struct Work {
    pull: Soa3,
    /// [`REACH`] to a link.
    factor: Vec<f32>,
    /// 1/pivot.
    inverse: Vec<f32>,
    /// See [`crate::constraint::kernel::lines::Links8`].
    target: Vec<f32>,
    right: Vec<f32>,
    /// The multipliers of the pass.
    delta: Vec<f32>,
}

impl Work {
    fn new(longest: usize) -> Self {
        let numbers = || vec![0.0; (longest + 2 * REACH) * LANES];
        let factor = vec![0.0; (longest + 2 * REACH) * REACH * LANES];
        Self {
            pull: Soa3::zeros(numbers().len()),
            factor,
            inverse: numbers(),
            target: numbers(),
            right: numbers(),
            delta: numbers(),
        }
    }
}

/// All strips along one direction.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(in crate::constraint) struct Strips {
    along: Along,
    /// Y, N/m.
    stiffness: f32,
    eights: Vec<Eight>,
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
        let eights = by_eights(topology, strips).into_iter().map(|strips| {
            let mut eight = Eight::new(strips.iter().map(Vec::len).max().unwrap_or_default(), topology.padding());
            for (lane, strip) in strips.iter().enumerate() {
                eight.add(topology, along, lane, strip, |triangle| {
                    let area = 0.5 * topology.triangle_rest[triangle as usize].determinant();
                    shares[triangle as usize] as f32 / (stiffness * area)
                });
            }
            eight
        });
        Self { along, stiffness, eights: eights.collect() }
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

    /// Adds the tensions in the last substep, of that [`crate::Substep::square`], weighed by area and by how much of it a particle feels:
    /// of strips beside one another the one solved first carries more than its share, and only what both carry is the tension
    /// of the thread between them.
    pub fn add_tensions(&self, square: f32, to: &mut Tensions) {
        for eight in &self.eights {
            for (k, link) in eight.links.iter().enumerate() {
                for lane in (0..LANES).filter(|lane| link.triangle[*lane] != NONE) {
                    // The part of the triangle's area that is this strip's: tension times that is −λ/h².
                    let area = 1.0 / (link.compliance[lane] * self.stiffness);
                    let lambda = eight.lambda[k * LANES + lane];
                    for (corner, coefficient) in link.corners.iter().zip(&link.coefficient) {
                        let felt = coefficient[lane].abs();
                        to.add(self.along, corner[lane], felt * -lambda / square, felt * area);
                    }
                }
            }
        }
    }
}

/// Puts strips together by eights of about the same length that share no particle.
fn by_eights(topology: &Topology, mut strips: Vec<Vec<u32>>) -> Vec<Vec<Vec<u32>>> {
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
        Self { links: vec![link; count], band: 0, lambda: vec![0.0; count * LANES], work: Work::new(count) }
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

    /// A pass with factors in a band of `BAND` beside the diagonal: see [`crate::constraint::kernel::lines::stretch`].
    #[inline(always)]
    fn solve<S: Simd, const BAND: usize, const FIRST: bool>(
        &mut self,
        simd: S,
        packs: &mut Packs,
        (square, how): (f32, How),
    ) -> Met<S> {
        let Packs { position, moved, .. } = packs;
        let Self { links, work, lambda: multipliers, .. } = self;
        let (zero, one, tiny) = (splat(simd, 0.0), splat(simd, 1.0), splat(simd, f32::MIN_POSITIVE));
        let per_step = splat(simd, 1.0 / square);
        let mut met = Met::nothing(simd);
        for (k, link) in links.iter().enumerate() {
            // What is kept of link k stands behind that of `REACH` links that are none.
            let at = k + REACH;
            let [a, b, c] = &link.corners;
            let coefficient = link.coefficients(simd);
            // Relative to the first corner, so that nothing is lost in large coordinates.
            let ((x_a, _), (x_b, _), (x_c, _)) =
                (gather4(simd, position, a), gather4(simd, position, b), gather4(simd, position, c));
            let ((by_a, w_a), (by_b, w_b), (by_c, w_c)) =
                (gather4(simd, moved, a), gather4(simd, moved, b), gather4(simd, moved, c));
            let before = (x_b - x_a) * coefficient[1] + (x_c - x_a) * coefficient[2];
            let turn = (by_b - by_a) * coefficient[1] + (by_c - by_a) * coefficient[2];
            let f = before + turn;
            met.change = met.change.max(turn.dot(turn));
            let rest = f32x8::simd_from(simd, link.worn[1]);
            let compliance = f32x8::simd_from(simd, link.compliance) * f32x8::simd_from(simd, link.worn[0]) * per_step;
            let mut right = if FIRST {
                let (had, length) = (before.length(), f.length());
                let (before, normal) = (before * (one / had.max(tiny)), f * (one / length.max(tiny)));
                let calm = splat(simd, how.turned());
                let is_calm = had.simd_gt(splat(simd, 1e-6)) & normal.dot(before).simd_gt(calm);
                let pull = select(is_calm, before, normal);
                let w = [w_a, w_b, w_c];
                let own = link.mobility(simd, w);
                let has_turned = !is_calm & own.simd_gt(zero) & compliance.simd_lt(splat(simd, GONE));
                met.turned = met.turned.max(has_turned.select(one, zero));
                // Row k of A, from the furthest: `u_j = A_{k,k−j} − Σ_{i>j} u_i L_{k−j,k−i}`, `L_{k,k−j} = u_j/d_{k−j}`.
                let mut pivot = own * pull.dot(pull) + compliance;
                let least = pivot * splat(simd, SINGULAR);
                let mut u = [zero; REACH];
                for j in (1..=BAND).rev() {
                    u[j - 1] =
                        link.shared_mobility(simd, j, w) * pull.dot(Vec3x8::load(simd, &work.pull, (at - j) * LANES));
                    for i in j + 1..=BAND {
                        let factor = load(simd, &work.factor, ((at - j) * REACH + i - j - 1) * LANES);
                        u[j - 1] -= u[i - 1] * factor;
                    }
                }
                for j in 1..=BAND {
                    let factor = u[j - 1] * load(simd, &work.inverse, (at - j) * LANES);
                    pivot -= u[j - 1] * factor;
                    store(factor, &mut work.factor, (at * REACH + j - 1) * LANES);
                }
                pull.store(&mut work.pull, at * LANES);
                store(one / pivot.max(least), &mut work.inverse, at * LANES);
                let along = f.dot(pull);
                let target = target(simd, f, pull, along, rest);
                store(target, &mut work.target, at * LANES);
                target - along
            } else {
                let pull = Vec3x8::load(simd, &work.pull, at * LANES);
                let along = f.dot(pull);
                if how.by_length {
                    let target = target(simd, f, pull, along, rest);
                    met.shift = met.shift.max((target - load(simd, &work.target, at * LANES)).abs());
                    store(target, &mut work.target, at * LANES);
                }
                load(simd, &work.target, at * LANES) - compliance * load(simd, multipliers, k * LANES) - along
            };
            for j in 1..=BAND {
                let factor = load(simd, &work.factor, (at * REACH + j - 1) * LANES);
                right -= factor * load(simd, &work.right, (at - j) * LANES);
            }
            store(right, &mut work.right, at * LANES);
        }
        for (k, link) in links.iter().enumerate().rev() {
            let at = k + REACH;
            let mut delta = load(simd, &work.right, at * LANES) * load(simd, &work.inverse, at * LANES);
            for j in 1..=BAND {
                let factor = load(simd, &work.factor, ((at + j) * REACH + j - 1) * LANES);
                delta -= factor * load(simd, &work.delta, (at + j) * LANES);
            }
            store(delta, &mut work.delta, at * LANES);
            let lambda = if FIRST {
                delta
            } else {
                delta *= splat(simd, how.relaxation);
                load(simd, multipliers, k * LANES) + delta
            };
            store(lambda, multipliers, k * LANES);
            let push = Vec3x8::load(simd, &work.pull, at * LANES) * delta;
            for i in 0..3 {
                let coefficient = f32x8::simd_from(simd, link.coefficient[i]);
                let (by, w) = gather4(simd, moved, &link.corners[i]);
                let weight = w * coefficient;
                scatter4(by + push * weight, w, moved, &link.corners[i]);
                let weight = weight * coefficient;
                // Twice, for the triangle on the other side of the thread.
                met.load = met.load.max(lambda * weight * splat(simd, -2.0));
                if !FIRST {
                    met.left = met.left.max((delta * weight).abs());
                }
            }
        }
        met
    }
}

/// What strips work on.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(in crate::constraint) struct Packs {
    /// Positions.
    position: Vec<Packed>,
    /// Moves and inverse masses.
    moved: Vec<Packed>,
    waves: Waves,
}

impl Packs {
    /// For that many slots.
    pub fn new(slots: usize) -> Self {
        let [position, moved] = [(); 2].map(|()| vec![[0.0; 4]; slots]);
        Self { position, moved, waves: Waves::default() }
    }

    /// Makes room for [`Self::slow_waves`].
    pub fn fit(&mut self, all: &[Strips]) {
        let strips = all.iter().flat_map(|strips| &strips.eights);
        self.waves = Waves::new(strips.map(|eight| eight.links.len()).max().unwrap_or_default());
    }

    /// Slows the waves across every strip of `all` after its first pass: see [`super::waves`].
    #[inline(always)]
    pub fn slow_waves<S: Simd>(&mut self, simd: S, all: &mut [Strips]) {
        let Self { position, moved, waves } = self;
        for eight in all.iter_mut().flat_map(|strips| &mut strips.eights) {
            let Eight { links, work, lambda, .. } = eight;
            waves.slow(simd, links, &work.pull, lambda, [position, moved]);
        }
    }

    /// Takes the particles over.
    pub fn take(&mut self, particles: &Particles) {
        pack(&particles.position, &particles.inverse_mass, &mut self.position);
        pack(&particles.moved, &particles.inverse_mass, &mut self.moved);
    }

    /// Gives back how they move.
    pub fn give(&self, particles: &mut Particles) {
        unpack(&self.moved, &mut particles.moved);
    }

    /// A pass over every strip of `all`, in a substep of that [`crate::Substep::square`].
    #[inline(always)]
    pub fn solve<S: Simd, const FIRST: bool>(&mut self, simd: S, all: &mut [Strips], how: (f32, How)) -> Met<S> {
        let mut met = Met::nothing(simd);
        for Strips { eights, .. } in all {
            for eight in eights {
                met = met.and(if eight.band <= NARROW {
                    eight.solve::<S, NARROW, FIRST>(simd, self, how)
                } else {
                    eight.solve::<S, REACH, FIRST>(simd, self, how)
                });
            }
        }
        met
    }
}
