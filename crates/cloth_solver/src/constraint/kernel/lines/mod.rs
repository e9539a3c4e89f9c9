//! Straight runs of particles, eight side by side: stretch solved exactly along each, and bending of each.
//!
//! A run is a row (weft) or a column (warp) of a grid. Eight runs are solved at once, one in each lane, so every
//! access is at unit stride:
//!
//! ```text
//!            lane  0  1  2  3  4  5  6  7
//!   particle 0     o  o  o  o  o  o  o  o      k-th vector of a block starts at base + k * stride
//!                  │  │  │  │  │  │  │  │
//!   particle 1     o  o  o  o  o  o  o  o
//! ```
//!
//! Columns are such blocks as they lie in memory (stride = the grid's); rows are first transposed, eight at a time,
//! into working memory (stride 8).

mod bend;
mod filter;
mod rows;

pub(crate) use bend::{Bend, bend};
pub(crate) use filter::{UNFILTERED_LOAD, filter};
pub(crate) use rows::{Rows, gather_rows, scatter_rows};

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};

use crate::Soa3;
use crate::constraint::kernel::links::{Block, Links};
use crate::lanes::{LANES, Vec3x8, load, select, splat, store};

/// Cosine of the turn within a substep from which on a link is pulled along the direction that it is predicted to have: see
/// [`stretch`].
pub(in crate::constraint) const TURNED: f32 = 0.5;

/// How a pass takes links.
#[derive(Clone, Copy, Debug)]
pub(in crate::constraint) struct How {
    /// See [`crate::Substep::implicit`].
    pub implicit: bool,
    /// Whether a later pass finds anew how long links are to be along their pulls. Without, what is left is a symmetric linear system,
    /// over which passes always converge; with it they may diverge in cloth that is near to jammed.
    pub by_length: bool,
    /// How far a later pass goes, over what solves its own links: 1, or [`OVER_RELAXATION`].
    pub relaxation: f32,
}

impl How {
    /// The cosine up to which links keep the direction that they had.
    pub const fn turned(self) -> f32 {
        if self.implicit { 2.0 } else { TURNED }
    }
}

/// Later passes go so much further than to their own solution: rows and columns, or the strips of a mesh, are blocks that take turns,
/// for which over-relaxation is known to converge faster (Young 1954).
pub(in crate::constraint) const OVER_RELAXATION: f32 = 1.25;

/// α̃, 1/kg, of what is no link: torn or burnt through.
const NO_LINK: f32 = 1e20;

/// The links of blocks as the first pass of a substep left them: direction of the pull, factors of the elimination, multipliers.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(crate) struct Links8 {
    /// The direction a link pulls along.
    pub pull: Soa3,
    /// Off the diagonal, and 1/pivot.
    off: Vec<f32>,
    inverse: Vec<f32>,
    /// How long a link is to be along its pull, m.
    target: Vec<f32>,
    /// See [`filter`]: what of the tension per length is filtered, N/m.
    excess: Vec<f32>,
    /// Of closed lines: what of the last link's column is left below the diagonal once the others are eliminated; else empty.
    ring: Vec<f32>,
    /// Working memory.
    right: Vec<f32>,
    /// The multipliers of the substep so far, N·s².
    pub lambda: Vec<f32>,
}

impl Links8 {
    /// For `len` links, lanes counted.
    pub fn new(len: usize) -> Self {
        let numbers = || vec![0.0; len];
        Self {
            pull: Soa3::zeros(len),
            off: numbers(),
            inverse: numbers(),
            target: numbers(),
            excess: numbers(),
            ring: Vec::new(),
            right: numbers(),
            lambda: numbers(),
        }
    }

    /// The same for lines that run back into themselves.
    pub fn closed(len: usize) -> Self {
        Self { ring: vec![0.0; len], ..Self::new(len) }
    }
}

/// What the way back of [`bend`] and [`filter`] needs: eight lanes per particle.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(crate) struct Elimination {
    vector: Soa3,
    upper: Vec<f32>,
    far: Vec<f32>,
    ring: Vec<f32>,
}

impl Elimination {
    /// For runs of up to `longest` particles.
    pub fn new(longest: usize) -> Self {
        let len = longest * LANES;
        Self { vector: Soa3::zeros(len), upper: vec![0.0; len], far: vec![0.0; len], ring: vec![0.0; len] }
    }
}

/// What a pass met in the runs of a block.
#[derive(Clone, Copy)]
pub(crate) struct Met<S: Simd> {
    /// The largest T h²/(m l) of each run, m the lighter end of a link, and their sum.
    pub load: f32x8<S>,
    pub loads: f32x8<S>,
    /// The largest square of the change of a link within the substep, before this pass, in rest lengths.
    pub change: f32x8<S>,
    /// 1 if a link turned by 60° and more, else 0; found by the first pass.
    pub turned: f32x8<S>,
    /// The furthest that this pass moved a particle by a link, in rest lengths; 0 in the first pass.
    pub left: f32x8<S>,
    /// The largest change of what a link is to be long along its pull since the pass before, in rest lengths.
    pub shift: f32x8<S>,
}

impl<S: Simd> Met<S> {
    #[inline(always)]
    pub fn nothing(simd: S) -> Self {
        let zero = splat(simd, 0.0);
        Self { load: zero, loads: zero, change: zero, turned: zero, left: zero, shift: zero }
    }

    #[inline(always)]
    pub fn and(self, other: Self) -> Self {
        Self {
            load: self.load.max(other.load),
            loads: self.loads + other.loads,
            change: self.change.max(other.change),
            turned: self.turned.max(other.turned),
            left: self.left.max(other.left),
            shift: self.shift.max(other.shift),
        }
    }

    /// The mean load of so many `links`.
    #[inline(always)]
    pub fn mean_load(self, links: usize) -> f32 {
        let loads: [f32; LANES] = self.loads.into();
        loads.iter().sum::<f32>() / links as f32
    }
}

/// How long link `d`, `along` of it along its `pull`, is to be along that, so that its length is `rest`: exact if it is moved along its pull.
#[inline(always)]
pub(in crate::constraint) fn target<S: Simd>(
    simd: S,
    d: Vec3x8<S>,
    pull: Vec3x8<S>,
    along: f32x8<S>,
    rest: f32x8<S>,
) -> f32x8<S> {
    let aside = d - pull * along;
    (rest * rest - aside.dot(aside)).max(splat(simd, 0.0)).sqrt()
}

/// Solves the stretch constraints `|x_{k+1} − x_k| = spacing` of each run together: one Newton step of the XPBD
/// system (Macklin, Müller, Chentanez 2016), tridiagonal in the multipliers, by the Thomas algorithm:
/// `A_kk = (w_k + w_{k+1}) p_k·p_k + α̃`, `A_{k−1,k} = −w_k p_{k−1}·p_k`, `A δ = −(C + α̃ λ)`; p_k is the direction link k pulls along.
///
/// XPBD pulls along the direction a link is predicted to have, which is implicit for the waves across the line and damps them as
/// implicit Euler does, and which turns the whole: the pull has a moment about where the substep began. Pulled along the direction at
/// the start of the substep, as in SHAKE (Ryckaert, Ciccotti, Berendsen 1977), waves and swings keep their energy and the
/// whole its angular momentum, while the constraint still holds at the end.
///
/// The `FIRST` pass of a substep finds directions and factors; later ones, after the lines across, go on from its multipliers.
/// `compliance` is α̃ = α/(kick h), 1/kg.
///
/// A `CLOSED` line has a last link, from its last particle to its first, which is eliminated last: its column of the matrix, b, is 0 but
/// for its neighbours, and `bᵀ T⁻¹ r = (L⁻¹ b)ᵀ D⁻¹ (L⁻¹ r)` is summed up on the way forth.
#[inline(always)]
pub(crate) fn stretch<S: Simd, L: Links, const FIRST: bool, const CLOSED: bool>(
    simd: S,
    block: Block,
    position: &Soa3,
    moved: &mut Soa3,
    inverse_mass: &[f32],
    (compliance, how): (f32x8<S>, How),
    links: L,
    of: &mut Links8,
) -> Met<S> {
    let Block { count, spacing, .. } = block;
    let (zero, one, tiny) = (splat(simd, 0.0), splat(simd, 1.0), splat(simd, f32::MIN_POSITIVE));
    let rest = splat(simd, spacing);
    let per_spacing = splat(simd, 1.0 / spacing);
    let short = splat(simd, 1e-6 * spacing);
    let mut met = Met::nothing(simd);

    let (mut x, mut moves) = (Vec3x8::load(simd, position, block.at(0)), Vec3x8::load(simd, moved, block.at(0)));
    let mut w = load(simd, inverse_mass, block.at(0));
    let mut last = Vec3x8 { x: zero, y: zero, z: zero };
    let (mut last_inverse, mut last_right) = (zero, zero);
    let mut ring = Ring { pull: last, column: zero, along: zero, square: zero, last: zero };
    if CLOSED && FIRST {
        let (end, x_end, moves_end) = (block.at(count - 1), x, moves);
        let (x, moves) = (Vec3x8::load(simd, position, end), Vec3x8::load(simd, moved, end));
        ring.pull = pull_of(simd, x_end - x, moves_end - moves, short, how.turned()).0;
        ring.pull.store(&mut of.pull, block.link(count - 1));
    }
    for k in 0..if CLOSED { count } else { count - 1 } {
        let is_last = CLOSED && k == count - 1;
        let (next, link) = (block.at(if is_last { 0 } else { k + 1 }), block.link(k));
        let (x_next, moves_next) = (Vec3x8::load(simd, position, next), Vec3x8::load(simd, moved, next));
        let (before, turn) = (x_next - x, moves_next - moves);
        let d = before + turn;
        let rest = links.rest(simd, k, rest);
        let compliance = links.compliance(simd, k, compliance);
        let is_there = compliance.simd_lt(splat(simd, NO_LINK));
        let change = turn.dot(turn);
        let change = if L::VARIED { change * links.shorter(simd, k) * links.shorter(simd, k) } else { change };
        met.change = met.change.max(is_there.select(change, zero));
        let (off, inverse, mut left) = if FIRST {
            let w_next = load(simd, inverse_mass, next);
            let (pull, is_calm) = pull_of(simd, before, turn, short, how.turned());
            let has_turned = is_there & !is_calm & (w + w_next).simd_gt(zero);
            met.turned = met.turned.max(has_turned.select(one, zero));
            let off = -(w * last.dot(pull));
            let diagonal = (w + w_next) * pull.dot(pull) + compliance;
            // Only neighbours that are both pinned, of an infinitely stiff fabric, make the pivot 0; λ is of no use there.
            let inverse = if is_last {
                // Its neighbour before it is of the column, too.
                one / (diagonal - ring.square).max(tiny)
            } else {
                one / (diagonal - off * off * last_inverse).max(tiny)
            };
            if CLOSED && !is_last {
                let mut column = -(off * last_inverse * ring.column);
                if k == 0 {
                    column -= w * ring.pull.dot(pull);
                }
                if k == count - 2 {
                    column -= w_next * ring.pull.dot(pull);
                }
                ring.column = column;
                ring.square += column * column * inverse;
                store(column * inverse, &mut of.ring, link);
            }
            if !is_last {
                pull.store(&mut of.pull, link);
            }
            store(off, &mut of.off, link);
            store(inverse, &mut of.inverse, link);
            (last, w) = (pull, w_next);
            let along = d.dot(pull);
            let target = target(simd, d, pull, along, rest);
            store(target, &mut of.target, link);
            (off, inverse, target - along)
        } else {
            let pull = Vec3x8::load(simd, &of.pull, link);
            let along = d.dot(pull);
            if how.by_length {
                let target = target(simd, d, pull, along, rest);
                let shift = (target - load(simd, &of.target, link)).abs();
                let shift = if L::VARIED { shift * links.shorter(simd, k) } else { shift };
                met.shift = met.shift.max(is_there.select(shift, zero));
                store(target, &mut of.target, link);
            }
            let left = load(simd, &of.target, link) - compliance * load(simd, &of.lambda, link) - along;
            (load(simd, &of.off, link), load(simd, &of.inverse, link), left)
        };
        if is_last {
            ring.last = (left - ring.along) * inverse;
            break;
        }
        if CLOSED {
            // L⁻¹ r, before D⁻¹.
            ring.along += load(simd, &of.ring, link) * (left - off * last_right);
        }
        left = (left - off * last_right) * inverse;
        store(left, &mut of.right, link);
        (last_inverse, last_right) = (inverse, left);
        (x, moves) = (x_next, moves_next);
    }

    // Back substitution; particle k+1 is corrected once the multipliers on both its sides are known.
    let (mut lambda_above, mut newton_above, mut off_above) = (zero, zero, zero);
    let mut pull_above = Vec3x8 { x: zero, y: zero, z: zero };
    if CLOSED {
        let link = block.link(count - 1);
        let (lambda, delta) = gone_on::<S, FIRST>(simd, (ring.last, how.relaxation), &of.lambda, link);
        store(lambda, &mut of.lambda, link);
        pull_above = Vec3x8::load(simd, &of.pull, link) * delta;
        lambda_above = if L::VARIED { lambda * links.shorter(simd, count - 1) } else { lambda };
        if !FIRST {
            let left = (delta * load(simd, inverse_mass, block.at(0))).abs();
            met.left = if L::VARIED { left * links.shorter(simd, count - 1) } else { left };
        }
    }
    let (pull_around, lambda_around) = (pull_above, lambda_above);
    for k in (0..count - 1).rev() {
        let (at, link) = (block.at(k + 1), block.link(k));
        let w = load(simd, inverse_mass, at);
        let mut newton = load(simd, &of.right, link) - off_above * newton_above * load(simd, &of.inverse, link);
        if CLOSED {
            newton -= load(simd, &of.ring, link) * ring.last;
        }
        let (lambda, delta) = gone_on::<S, FIRST>(simd, (newton, how.relaxation), &of.lambda, link);
        store(lambda, &mut of.lambda, link);
        if !FIRST {
            let left = (delta * w).abs();
            met.left = met.left.max(if L::VARIED { left * links.shorter(simd, k) } else { left });
        }
        let pulls = if L::VARIED { lambda * links.shorter(simd, k) } else { lambda };
        let load_ratio = -(pulls.min(lambda_above) * w);
        met.load = met.load.max(load_ratio);
        met.loads += load_ratio.max(zero);
        let pull = Vec3x8::load(simd, &of.pull, link) * delta;
        (Vec3x8::load(simd, moved, at) + (pull - pull_above) * w).store(moved, at);
        (lambda_above, newton_above, pull_above) = (pulls, newton, pull);
        off_above = load(simd, &of.off, link);
    }
    let w = load(simd, inverse_mass, block.at(0));
    let at = block.at(0);
    if CLOSED {
        (Vec3x8::load(simd, moved, at) + (pull_around - pull_above) * w).store(moved, at);
        lambda_above = lambda_above.min(lambda_around);
    } else {
        (Vec3x8::load(simd, moved, at) - pull_above * w).store(moved, at);
    }
    met.load = met.load.max(-(lambda_above * w)) * per_spacing;
    met.loads *= per_spacing;
    met.change *= per_spacing * per_spacing;
    met.left *= per_spacing;
    met.shift *= per_spacing;
    met
}

/// What the last link of a closed line needs of the others.
struct Ring<S: Simd> {
    pull: Vec3x8<S>,
    /// L⁻¹ b at the link at hand.
    column: f32x8<S>,
    /// bᵀ T⁻¹ r and bᵀ T⁻¹ b so far.
    along: f32x8<S>,
    square: f32x8<S>,
    /// What its multiplier changes by.
    last: f32x8<S>,
}

/// The direction that a link pulls along, which was `before` and turns by `turn`, and whether that is the one it had.
///
/// A link of no length has no direction: it gets the one that it is about to have, or none. So does what turns by 60° and more: a
/// pull along where it pointed would not mend it.
#[inline(always)]
fn pull_of<S: Simd>(
    simd: S,
    before: Vec3x8<S>,
    turn: Vec3x8<S>,
    short: f32x8<S>,
    turned: f32,
) -> (Vec3x8<S>, mask32x8<S>) {
    let (one, tiny) = (splat(simd, 1.0), splat(simd, f32::MIN_POSITIVE));
    let d = before + turn;
    let (had, length) = (before.length(), d.length());
    let normal = d * (one / length.max(tiny));
    let before = before * (one / had.max(tiny));
    let is_calm = had.simd_gt(short) & normal.dot(before).simd_gt(splat(simd, turned));
    (select(is_calm, before, normal), is_calm)
}

/// The multiplier of a link and what it changes by: Newton's step, of which a later pass goes so many times as much.
#[inline(always)]
fn gone_on<S: Simd, const FIRST: bool>(
    simd: S,
    (newton, relaxation): (f32x8<S>, f32),
    lambda: &[f32],
    link: usize,
) -> (f32x8<S>, f32x8<S>) {
    if FIRST {
        return (newton, newton);
    }
    let delta = newton * splat(simd, relaxation);
    (load(simd, lambda, link) + delta, delta)
}
