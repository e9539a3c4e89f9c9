//! Shear and twist of the cells of a mesh of quads: [`cells`](super::cells) and [`shear`](super::shear) where every cell has a size and a
//! shape of its own and the surface may be bent at rest.
//!
//! The stress of shear is smoothed as that of a rectangle is, with `(1 + θ h² s Δ s)⁻¹` along rows and columns: s of a cell is `√(G A)` over
//! its width, Δ the differences across its ends times the mobility there; symmetric whatever the sizes. What resists twist follows the
//! normal of the cell: the force is the slope of an energy that no motion of the whole changes, and so turns nothing.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use crate::Soa3;
use crate::constraint::kernel::plan::Plan;
use crate::constraint::kernel::shear::{FASTEST, STIFFEST, relief};
use crate::lanes::{LANES, Vec3x8, load, splat, store};
use crate::topology::{FADING, QuadsRest};

/// 1/16 of ω² h² of the fastest wave of twist.
const FASTEST_TWIST: f32 = 0.3 / 16.0;

/// The cells of a mesh of quads, by their upper left corners, and working memory.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(in crate::constraint) struct QuadCells {
    plan: Plan,
    /// 1/2a and 1/2b, 1/m.
    half: [Vec<f32>; 2],
    shear: Vec<f32>,
    /// √(G A), and as soft as the shortest substep asks for; that over a and b.
    whole_root: Vec<f32>,
    root: Vec<f32>,
    over: [Vec<f32>; 2],
    /// That over a, eight rows in lanes.
    over_rows: Vec<f32>,
    /// 2 D/A, N/m, and the most of it times H², kg.
    twist: Vec<f32>,
    most_twist: Vec<f32>,
    skew: [Vec<f32>; 2],
    curl: Vec<f32>,
    fading: Vec<f32>,
    /// ω² of the fastest wave of shear of each cell, and of all, 1/s².
    waves: Vec<f32>,
    fastest: f32,
    /// The shortest substep that they are soft enough for, s.
    shortest: f32,
    /// Whether any cell is a trapezium or a saddle.
    is_skew: bool,
    /// √(G A) H C of each cell, smoothed.
    stress: Vec<f32>,
    lines: [Vec<f32>; 3],
    upper: Vec<f32>,
    ring: Vec<f32>,
    rows: [CellRow; 2],
}

/// Forces of a row of cells on their corners, as the slope of the energy: A along e, B along f and s of the twist.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
struct CellRow {
    a: Soa3,
    b: Soa3,
    s: Soa3,
}

/// The line of cells that is smoothed: values, where it begins, from one cell to the next, how many.
type Line<'a> = (&'a mut [f32], usize, usize, usize);

/// The sums of mobility at the ends of each cell are those of two particles, as they lie beside each other; and a factor.
type Mobility<'a> = (&'a [f32], &'a [f32], usize, f32);

impl QuadCells {
    /// `mass` is that of each slot were it in the middle of its cells, `worn` a factor on the stiffness of each cell.
    pub fn new(
        plan: Plan,
        rest: &QuadsRest,
        [shear, twist]: [f32; 2],
        mass: impl Fn(usize) -> f32,
        corners: impl Fn(usize) -> [usize; 4],
        worn: impl Fn(usize) -> f32,
    ) -> Self {
        let of = |value: &dyn Fn(usize) -> f32| {
            plan.numbers(|slot| if rest.cells[slot].area > 0.0 { value(slot) } else { 0.0 })
        };
        let cell = |slot: usize| &rest.cells[slot];
        let root = of(&|slot| (shear * cell(slot).area as f32 * worn(slot)).sqrt());
        let half = [of(&|slot| 0.5 / cell(slot).size.x as f32), of(&|slot| 0.5 / cell(slot).size.y as f32)];
        let lightest = |slot: usize| corners(slot).into_iter().map(&mass).fold(f32::INFINITY, f32::min);
        let waves = of(&|slot| {
            let size = cell(slot).size.as_vec2();
            4.0 * shear * cell(slot).area as f32 * (size * size).recip().element_sum() / lightest(slot)
        });
        let size = |slot: usize| cell(slot).area.sqrt();
        let is_skew =
            |slot: usize| cell(slot).skew.abs().max_element() > 1e-4 || cell(slot).twist.abs() > 1e-4 * size(slot);
        let line = (plan.stride + LANES).max(plan.rows) * LANES;
        let row = || Soa3::zeros(plan.pitch + LANES);
        Self {
            plan,
            shear: of(&|slot| cell(slot).shear as f32),
            over: half.each_ref().map(|_| Vec::new()),
            over_rows: Vec::new(),
            twist: of(&|slot| 2.0 * twist * worn(slot) / cell(slot).area as f32),
            most_twist: of(&|slot| FASTEST_TWIST * lightest(slot)),
            skew: [of(&|slot| cell(slot).skew.x as f32), of(&|slot| cell(slot).skew.y as f32)],
            curl: of(&|slot| cell(slot).twist as f32),
            fading: of(&|slot| fading(2.0 * cell(slot).area)),
            fastest: waves.iter().copied().fold(0.0, f32::max),
            waves,
            shortest: 0.0,
            is_skew: (0..rest.cells.len()).any(|slot| cell(slot).area > 0.0 && is_skew(slot)),
            stress: vec![0.0; plan.len()],
            lines: [vec![0.0; line], vec![0.0; line], vec![0.0; line]],
            upper: vec![0.0; line],
            ring: vec![0.0; line],
            rows: [(); 2].map(|()| CellRow { a: row(), b: row(), s: row() }),
            half,
            root: Vec::new(),
            whole_root: root,
        }
    }

    /// Makes cells as soft as substeps of `shortest`, s, resolve: see [`STIFFEST`].
    pub fn soften(&mut self, shortest: f32) {
        if shortest == self.shortest {
            return;
        }
        self.shortest = shortest;
        let stiffest = STIFFEST / (shortest * shortest);
        let soft = |(root, wave): (&f32, &f32)| root * (stiffest / wave.max(stiffest)).sqrt();
        self.root = self.whole_root.iter().zip(&self.waves).map(soft).collect();
        let over = |half: &Vec<f32>| self.root.iter().zip(half).map(|(root, half)| 2.0 * root * half).collect();
        self.over = self.half.each_ref().map(over);
        self.over_rows = self.plan.lanes(&self.over[0], (self.plan.rows - 1).max(1));
    }

    /// ω² H² of the fastest wave of shear, unsmoothed.
    pub fn fastest(&self, square: f32) -> f32 {
        self.fastest * square
    }

    /// Finds the stress of every cell at `position`, for substeps of that square of their length; `inverse_mass` with a margin, too. After
    /// [`Self::soften`].
    #[inline(always)]
    pub fn find<S: Simd>(&mut self, simd: S, position: &Soa3, inverse_mass: &[f32], square: f32) {
        let Plan { rows, across, pitch, closed, .. } = self.plan;
        let scale = splat(simd, square.sqrt());
        for row in 0..rows - 1 {
            for column in (0..across).step_by(LANES) {
                let at = self.plan.at(row, column);
                let (e, f, _) = corners(simd, position, at, pitch);
                let (u, v) = ((e + f) * load(simd, &self.half[0], at), (e - f) * load(simd, &self.half[1], at));
                let strain = u.dot(v) - load(simd, &self.shear, at);
                store(strain * load(simd, &self.root, at) * scale * relief(simd, u, v), &mut self.stress, at);
            }
        }
        let fastest = self.fastest(square).min(STIFFEST * square / (self.shortest * self.shortest));
        let share = 1.0 / FASTEST - 1.0 / fastest;
        if share <= 0.0 || fastest <= 0.0 {
            return;
        }
        // Half, for the mean of two particles.
        let share = 0.5 * share * square;
        self.smooth_columns(simd, inverse_mass, 0.5 * share);
        for first in (0..rows - 1).step_by(LANES) {
            let (plan, [values, above, below]) = (self.plan, &mut self.lines);
            plan.gather(simd, &self.stress, values, rows - 1, first, across);
            // One column more, as there are more particles than cells.
            plan.gather(simd, inverse_mass, above, rows - 1, first, across + 1);
            plan.gather(simd, &inverse_mass[pitch..], below, rows - 1, first, across + 1);
            let over = &self.over_rows[plan.block(first)..];
            let (line, mobility) =
                ((values.as_mut_slice(), 0, LANES, across), (above.as_slice(), below.as_slice(), 0, share));
            if closed {
                smooth::<S, true>(simd, line, over, mobility, &mut self.upper, &mut self.ring);
            } else {
                smooth::<S, false>(simd, line, over, mobility, &mut self.upper, &mut self.ring);
            }
            plan.scatter(simd, values, &mut self.stress, rows - 1, first, across);
        }
        self.smooth_columns(simd, inverse_mass, 0.5 * share);
    }

    #[inline(always)]
    fn smooth_columns<S: Simd>(&mut self, simd: S, inverse_mass: &[f32], share: f32) {
        let Plan { rows, across, pitch, .. } = self.plan;
        for column in (0..across).step_by(LANES) {
            let at = self.plan.at(0, column);
            let line = (self.stress.as_mut_slice(), at, pitch, rows - 1);
            let mobility = (inverse_mass, &inverse_mass[1..], at, share);
            smooth::<S, false>(simd, line, &self.over[1][at..], mobility, &mut self.upper, &mut self.ring);
        }
    }

    /// Moves every particle by `share` of the forces of its cells, for substeps of that square of their length.
    #[inline(always)]
    pub fn push<S: Simd>(
        &mut self,
        simd: S,
        position: &Soa3,
        inverse_mass: &[f32],
        moved: &mut Soa3,
        (square, share): (f32, f32),
    ) {
        let plan = self.plan;
        let share = splat(simd, share);
        let [mut above, mut below] = std::mem::take(&mut self.rows);
        above.clear();
        for row in 0..plan.rows {
            if row + 1 < plan.rows {
                self.row(simd, position, row, square, &mut below);
            } else {
                below.clear();
            }
            for column in (0..plan.stride).step_by(LANES) {
                let (right, left) = (LANES + column, LANES + column - 1);
                // The cells at the right and left below, then above; slopes, so with their signs turned.
                let slope = below.upper_left(simd, right)
                    + below.upper_right(simd, left)
                    + above.lower_left(simd, right)
                    + above.lower_right(simd, left);
                let at = row * plan.stride + column;
                let w = load(simd, inverse_mass, at) * share;
                (Vec3x8::load(simd, moved, at) - slope * w).store(moved, at);
            }
            std::mem::swap(&mut above, &mut below);
        }
        self.rows = [above, below];
    }

    /// The forces of the cells below `row`.
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, position: &Soa3, row: usize, square: f32, to: &mut CellRow) {
        let Plan { across, pitch, closed, .. } = self.plan;
        let (squared, length) = (splat(simd, square), splat(simd, square.sqrt()));
        for column in (0..across).step_by(LANES) {
            let at = self.plan.at(row, column);
            let (e, f, twist) = corners(simd, position, at, pitch);
            let (half_a, half_b) = (load(simd, &self.half[0], at), load(simd, &self.half[1], at));
            let (u, v) = ((e + f) * half_a, (e - f) * half_b);
            let (p, q) = (v * half_a, u * half_b);
            let stress = load(simd, &self.stress, at) * load(simd, &self.root, at) * length;
            let (mut a, mut b) = ((p + q) * stress, (p - q) * stress);
            let stiffness = (load(simd, &self.twist, at) * squared).min(load(simd, &self.most_twist, at));
            let mut s = twist * stiffness;
            if self.is_skew {
                let (skew_e, skew_f) = (load(simd, &self.skew[0], at), load(simd, &self.skew[1], at));
                let curl = load(simd, &self.curl, at);
                let normal = Normal::new(simd, e, f, load(simd, &self.fading, at));
                s = (twist - e * skew_e - f * skew_f - normal.n * curl) * stiffness;
                let turn = normal.slope(simd, s * curl);
                a = a - s * skew_e - f.cross(turn);
                b = b - s * skew_f - turn.cross(e);
            }
            let to_at = LANES + column;
            a.store(&mut to.a, to_at);
            b.store(&mut to.b, to_at);
            s.store(&mut to.s, to_at);
        }
        if closed {
            for all in [&mut to.a, &mut to.b, &mut to.s] {
                let last = all.get(LANES + across - 1);
                all.set(LANES - 1, last);
            }
        }
    }
}

/// The [`normal`](crate::topology::normal) of what lies between four particles, for energies that follow it.
#[derive(Clone, Copy)]
pub(super) struct Normal<S: Simd> {
    pub n: Vec3x8<S>,
    /// 1/N.
    inverse: f32x8<S>,
}

/// What [`Normal::new`] asks of |A × B| at rest.
pub(super) fn fading(at_rest: f64) -> f32 {
    (FADING * FADING / (1.0 + FADING * FADING) * at_rest * at_rest) as f32
}

impl<S: Simd> Normal<S> {
    /// Of `a` × `b`.
    #[inline(always)]
    pub fn new(simd: S, a: Vec3x8<S>, b: Vec3x8<S>, fading: f32x8<S>) -> Self {
        let across = a.cross(b);
        let square = across.dot(across) * splat(simd, STEEP) + fading;
        let inverse = splat(simd, 1.0) / square.max(splat(simd, f32::MIN_POSITIVE)).sqrt();
        Self { n: across * inverse, inverse }
    }

    /// q of `of`, with which the slope of `of · n` is `b × q` for a and `q × a` for b.
    #[inline(always)]
    pub fn slope(self, simd: S, of: Vec3x8<S>) -> Vec3x8<S> {
        (of - self.n * (of.dot(self.n) * splat(simd, STEEP))) * self.inverse
    }
}

/// 1/(1 + ε²), ε [`FADING`].
const STEEP: f32 = (1.0 / (1.0 + FADING * FADING)) as f32;

impl CellRow {
    fn clear(&mut self) {
        for all in [&mut self.a, &mut self.b, &mut self.s] {
            all.fill(glam::Vec3::ZERO);
        }
    }

    #[inline(always)]
    fn upper_left<S: Simd>(&self, simd: S, at: usize) -> Vec3x8<S> {
        Vec3x8::load(simd, &self.s, at) - Vec3x8::load(simd, &self.a, at)
    }

    #[inline(always)]
    fn lower_right<S: Simd>(&self, simd: S, at: usize) -> Vec3x8<S> {
        Vec3x8::load(simd, &self.s, at) + Vec3x8::load(simd, &self.a, at)
    }

    #[inline(always)]
    fn upper_right<S: Simd>(&self, simd: S, at: usize) -> Vec3x8<S> {
        Vec3x8::load(simd, &self.b, at) - Vec3x8::load(simd, &self.s, at)
    }

    #[inline(always)]
    fn lower_left<S: Simd>(&self, simd: S, at: usize) -> Vec3x8<S> {
        Vec3x8::splat(simd, glam::Vec3::ZERO) - Vec3x8::load(simd, &self.b, at) - Vec3x8::load(simd, &self.s, at)
    }
}

/// e, f and twist of the cells at `at`.
#[inline(always)]
fn corners<S: Simd>(simd: S, position: &Soa3, at: usize, pitch: usize) -> (Vec3x8<S>, Vec3x8<S>, Vec3x8<S>) {
    let (p00, p10) = (Vec3x8::load(simd, position, at), Vec3x8::load(simd, position, at + 1));
    let (p01, p11) = (Vec3x8::load(simd, position, at + pitch), Vec3x8::load(simd, position, at + pitch + 1));
    (p11 - p00, p10 - p01, (p00 - p10) + (p11 - p01))
}

/// Smooths eight lines of cells at once: `(1 + s Δ s) y = x`, by LDLᵀ of the tridiagonal system; of closed lines the last cell is
/// eliminated last, see [`lines::stretch`](super::lines::stretch).
// No closure here: it would be compiled without the instruction set that is dispatched to.
#[inline(always)]
fn smooth<S: Simd, const CLOSED: bool>(
    simd: S,
    (values, base, stride, count): Line<'_>,
    over: &[f32],
    (one_side, other_side, at_first, scale): Mobility<'_>,
    upper: &mut [f32],
    ring: &mut [f32],
) {
    let (zero, one, scale) = (splat(simd, 0.0), splat(simd, 1.0), splat(simd, scale));
    let first = (load(simd, one_side, at_first) + load(simd, other_side, at_first)) * scale;
    let (first_over, last_over) = (load(simd, over, 0), load(simd, over, (count - 1) * stride));
    let (mut before, mut s_before) = (first, zero);
    let (mut last, mut last_inverse) = (zero, zero);
    let (mut column, mut around, mut both) = (zero, zero, zero);
    for k in 0..count {
        let (at, node) = (base + k * stride, at_first + (k + 1) * stride);
        let s = load(simd, over, k * stride);
        let is_last = CLOSED && k + 1 == count;
        let after = if is_last { first } else { (load(simd, one_side, node) + load(simd, other_side, node)) * scale };
        let diagonal = one + s * s * (before + after);
        let value = load(simd, values, at);
        if is_last {
            last = (value - around) / (diagonal - both);
            break;
        }
        let off = s * s_before * before;
        let up = off * last_inverse;
        if k > 0 {
            store(up, upper, (k - 1) * LANES);
        }
        let inverse = one / (diagonal - off * up);
        let numerator = value + off * last;
        if CLOSED {
            column = up * column;
            if k == 0 {
                column -= first_over * last_over * first;
            }
            if k + 2 == count {
                column -= s * last_over * after;
            }
            let factor = column * inverse;
            around += factor * numerator;
            both += column * factor;
            store(factor, ring, k * LANES);
        }
        last = numerator * inverse;
        store(last, values, at);
        (last_inverse, before, s_before) = (inverse, after, s);
    }
    let around = last;
    if CLOSED {
        store(last, values, base + (count - 1) * stride);
        last = load(simd, values, base + (count - 2) * stride) - load(simd, ring, (count - 2) * LANES) * around;
        store(last, values, base + (count - 2) * stride);
    }
    for k in (0..count - if CLOSED { 2 } else { 1 }).rev() {
        let at = base + k * stride;
        last = load(simd, values, at) + load(simd, upper, k * LANES) * last;
        if CLOSED {
            last -= load(simd, ring, k * LANES) * around;
        }
        store(last, values, at);
    }
}
