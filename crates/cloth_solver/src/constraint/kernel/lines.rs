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

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};

use crate::Soa3;
use crate::constraint::kernel::links::{Block, Links};
use crate::lanes::{LANES, Vec3x8, load, select, splat, store, transpose};

/// T h²/(m l) up to which the waves across a line are left as they are; beyond, they are slowed: see [`filter`].
pub(crate) const UNFILTERED_LOAD: f32 = 0.15;

/// What is filtered stays as it is while that leaves no more than that part of [`UNFILTERED_LOAD`] more unfiltered.
const STEADY: f32 = 0.2;

/// How strongly what is beyond is filtered: the waves of both directions together stay below the limit, `2 (4 E + 1/θ) < 4`, E the
/// largest unfiltered load, `(1 + STEADY)` of [`UNFILTERED_LOAD`].
const FILTER: f32 = 0.8;

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
        let (lambda, delta) = gone_on::<S, FIRST>(simd, ring.last, &of.lambda, link);
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
        let (lambda, delta) = gone_on::<S, FIRST>(simd, newton, &of.lambda, link);
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

/// The multiplier of a link and what it changes by, if Newton's step is `newton`.
#[inline(always)]
fn gone_on<S: Simd, const FIRST: bool>(simd: S, newton: f32x8<S>, lambda: &[f32], link: usize) -> (f32x8<S>, f32x8<S>) {
    if FIRST {
        return (newton, newton);
    }
    let delta = newton * splat(simd, OVER_RELAXATION);
    (load(simd, lambda, link) + delta, delta)
}

/// Slows the waves across runs under a high load: of the tension of each link beyond [`UNFILTERED_LOAD`], e per length, what
/// acts is φ with `(1 + θ e (w + w')) φ_k − θ e w φ_{k−1} − θ e w' φ_{k+1} = e d_k`, d_k the link when the substep began.
///
/// Pulled along such d, an exact line steps its waves explicitly: with g = h² ω² that is stable for g < 4, and the highest wave
/// has g = 4 T h²/(m l). So filtered, no load makes it unstable, and what is even along the line is left as it is. φ follows from d by
/// a symmetric matrix without directions: the whole gets no angular momentum. Where tension ends at once, as beside a weight, the
/// links carry less along themselves, too: what is taken off their multipliers, and later passes find it anew.
///
/// e stays as it is while the tension changes little: a stiffness that follows every tension takes part in the motion, and adds to it.
/// `square` is [`crate::Substep::square`].
#[inline(always)]
pub(crate) fn filter<S: Simd, const CLOSED: bool>(
    simd: S,
    block: Block,
    position: &Soa3,
    moved: &mut Soa3,
    inverse_mass: &[f32],
    of: &mut Links8,
    work: &mut Elimination,
    square: f32,
) {
    let (zero, one, tiny) = (splat(simd, 0.0), splat(simd, 1.0), splat(simd, f32::MIN_POSITIVE));
    let (theta, unfiltered) = (splat(simd, FILTER), splat(simd, UNFILTERED_LOAD));
    let (steady, square) = (splat(simd, STEADY), splat(simd, square));
    let none = Vec3x8 { x: zero, y: zero, z: zero };
    let (mut x, mut w) = (Vec3x8::load(simd, position, block.at(0)), load(simd, inverse_mass, block.at(0)));
    let (mut last, mut last_upper) = (none, zero);
    // Of a closed line, whose last link is eliminated last: its column below the diagonal, its row over its own stiffness right of the
    // diagonal, and what they make of the right-hand side and of one another.
    let (first, mut column, mut row, mut around, mut both) = (w, zero, zero, none, zero);
    let mut last_link = none;
    for k in 0..if CLOSED { block.count } else { block.count - 1 } {
        let is_last = CLOSED && k == block.count - 1;
        let next = block.at(if is_last { 0 } else { k + 1 });
        let (x_next, w_next) = (Vec3x8::load(simd, position, next), load(simd, inverse_mass, next));
        let length = (x_next - x).length();
        let d = Vec3x8::load(simd, &of.pull, block.link(k)) * length;
        let tension = -load(simd, &of.lambda, block.link(k)) / length.max(tiny);
        let stays = unfiltered / w.max(w_next).max(tiny);
        let most = (tension - stays).max(zero);
        let link = block.link(k);
        let (was, least) = (load(simd, &of.excess, link) * square, (most - stays * steady).max(zero));
        // What is not a number is passed over.
        let excess = was.simd_gt(least).select(was, least).min(most);
        store(excess / square, &mut of.excess, link);
        let stiff = theta * excess;
        if is_last {
            let pivot = one + stiff * (w + w_next) - stiff * both;
            last_link = (d * excess - around * stiff) * (one / pivot);
            store(excess, &mut work.far, k * LANES);
            break;
        }
        let inverse = one / (one + stiff * (w + w_next) - stiff * w * last_upper);
        if CLOSED {
            (column, row) = (stiff * w * column, last_upper * row);
            if k == 0 {
                (column, row) = (column - stiff * first, row - first);
            }
            if k == block.count - 2 {
                (column, row) = (column - stiff * w_next, row - w_next);
            }
            column *= inverse;
            both += row * column;
            store(column, &mut work.ring, k * LANES);
        }
        last = (d * excess + last * (stiff * w)) * inverse;
        if CLOSED {
            around = around + last * row;
        }
        last_upper = stiff * w_next * inverse;
        last.store(&mut work.vector, k * LANES);
        store(last_upper, &mut work.upper, k * LANES);
        store(excess, &mut work.far, k * LANES);
        (x, w) = (x_next, w_next);
    }
    // Back: φ_k, and what it is less than e d.
    let (mut phi, mut less_above) = (none, none);
    let mut x_next = Vec3x8::load(simd, position, block.at(block.count - 1));
    if CLOSED {
        let (k, link) = (block.count - 1, block.link(block.count - 1));
        let (pull, length) =
            (Vec3x8::load(simd, &of.pull, link), (Vec3x8::load(simd, position, block.at(0)) - x_next).length());
        less_above = pull * (length * load(simd, &work.far, k * LANES)) - last_link;
        store(load(simd, &of.lambda, link) + less_above.dot(pull), &mut of.lambda, link);
    }
    let less_around = less_above;
    for k in (0..block.count - 1).rev() {
        let (at, next) = (block.at(k), block.at(k + 1));
        let x = Vec3x8::load(simd, position, at);
        phi = Vec3x8::load(simd, &work.vector, k * LANES) + phi * load(simd, &work.upper, k * LANES);
        if CLOSED {
            phi = phi - last_link * load(simd, &work.ring, k * LANES);
        }
        let (link, length) = (block.link(k), (x_next - x).length());
        let pull = Vec3x8::load(simd, &of.pull, link);
        let less = pull * (length * load(simd, &work.far, k * LANES)) - phi;
        store(load(simd, &of.lambda, link) + less.dot(pull), &mut of.lambda, link);
        (Vec3x8::load(simd, moved, next) + (less - less_above) * load(simd, inverse_mass, next)).store(moved, next);
        (x_next, less_above) = (x, less);
    }
    let at = block.at(0);
    if CLOSED {
        less_above = less_above - less_around;
    }
    (Vec3x8::load(simd, moved, at) - less_above * load(simd, inverse_mass, at)).store(moved, at);
}

/// How eight runs resist bending in a substep.
#[derive(Clone, Copy)]
pub(crate) struct Bend<S: Simd> {
    /// l³/(D width H²), 1/kg, H the longest substep.
    pub compliance: f32x8<S>,
    /// How strongly the force is filtered, so that no wave of it is too fast for H; 0 where none is anyway.
    pub filter: f32,
    /// What part of the force in the longest substep acts in this one: see [`crate::Substep::share`].
    pub share: f32,
}

/// Bending of each run: at every inner particle the vector `c_k = x_{k−1} − 2 x_k + x_{k+1}`, whose energy
/// `½ D (width/l) |t₂ − t₁|²` is that of a hinge of angle θ, `|t₂ − t₁| = 2 sin(θ/2)` (isometric bending, Bergou et al.
/// 2006, along a line). It is linear in the positions, so it needs no normals and has no degenerate configuration.
///
/// Its force is that where the substep begins, which neither turns nor damps the whole; where that would be too stiff for the substep
/// it is filtered, `(α̃ + θ B W Bᵀ) λ = −c`, by the LDLᵀ factors of the pentadiagonal system: `(B W Bᵀ)_kk = w_{k−1} + 4 w_k + w_{k+1}`,
/// `_{k,k+1} = −2 (w_k + w_{k+1})`, `_{k,k+2} = w_{k+1}`. A symmetric matrix without directions again: no angular momentum.
#[inline(always)]
pub(crate) fn bend<S: Simd>(
    simd: S,
    block: Block,
    position: &Soa3,
    moved: &mut Soa3,
    inverse_mass: &[f32],
    stiffness: Bend<S>,
    links: impl Links,
    work: &mut Elimination,
) {
    if block.count < 3 {
        return;
    }
    if stiffness.filter > 0.0 {
        bend_filtered(simd, block, position, moved, inverse_mass, stiffness, links, work);
        return;
    }
    let (zero, two, share) = (splat(simd, 0.0), splat(simd, 2.0), splat(simd, stiffness.share));
    let none = Vec3x8 { x: zero, y: zero, z: zero };
    let mut x = Vec3x8::load(simd, position, block.at(1));
    let mut edge = x - Vec3x8::load(simd, position, block.at(0));
    let (mut lambda1, mut lambda2) = (none, none);
    for k in 1..block.count - 1 {
        let x_next = Vec3x8::load(simd, position, block.at(k + 1));
        let edge_next = x_next - x;
        let lambda = (edge - edge_next) * (share / links.bend(simd, k, stiffness.compliance));
        push(simd, lambda2 - lambda1 * two + lambda, moved, inverse_mass, block.at(k - 1));
        (x, edge, lambda2, lambda1) = (x_next, edge_next, lambda1, lambda);
    }
    push(simd, lambda2 - lambda1 * two, moved, inverse_mass, block.at(block.count - 2));
    push(simd, lambda1, moved, inverse_mass, block.at(block.count - 1));
}

#[inline(always)]
fn push<S: Simd>(simd: S, by: Vec3x8<S>, moved: &mut Soa3, inverse_mass: &[f32], at: usize) {
    (Vec3x8::load(simd, moved, at) + by * load(simd, inverse_mass, at)).store(moved, at);
}

#[inline(always)]
fn bend_filtered<S: Simd>(
    simd: S,
    block: Block,
    position: &Soa3,
    moved: &mut Soa3,
    inverse_mass: &[f32],
    stiffness: Bend<S>,
    links: impl Links,
    work: &mut Elimination,
) {
    let (zero, one, two) = (splat(simd, 0.0), splat(simd, 1.0), splat(simd, 2.0));
    let (theta, share) = (splat(simd, stiffness.filter), splat(simd, stiffness.share));
    let none = Vec3x8 { x: zero, y: zero, z: zero };
    let (count, at) = (block.count, |k: usize| block.at(k));
    let mut x = Vec3x8::load(simd, position, at(1));
    let mut edge = x - Vec3x8::load(simd, position, at(0));
    let (mut w0, mut w1) = (load(simd, inverse_mass, at(0)) * theta, load(simd, inverse_mass, at(1)) * theta);
    // Of the rows k−1 and k−2: the pivot's inverse, the factor next to the diagonal, the right-hand side.
    let (mut inverse1, mut inverse2, mut near1, mut y1, mut y2) = (zero, zero, zero, none, none);
    for k in 1..count - 1 {
        let x_next = Vec3x8::load(simd, position, at(k + 1));
        let edge_next = x_next - x;
        let w2 = load(simd, inverse_mass, at(k + 1)) * theta;
        let inner = if k > 1 { one } else { zero };
        let far = if k > 2 { w0 } else { zero };
        // The factors below the diagonal times their pivots; the nearer one, which is negative, with its sign turned.
        let near = two * (w0 + w1) * inner - far * near1;
        let (near_factor, far_factor) = (near * inverse1, far * inverse2);
        let compliance = links.bend(simd, k, stiffness.compliance);
        let pivot = w0 + two * two * w1 + w2 + compliance - near_factor * near - far_factor * far;
        let inverse = one / pivot;
        let y = (edge - edge_next) * share + y1 * near_factor - y2 * far_factor;
        (y * inverse).store(&mut work.vector, k * LANES);
        store(near_factor, &mut work.upper, k * LANES);
        store(far_factor, &mut work.far, k * LANES);
        (inverse2, inverse1, near1, y2, y1) = (inverse1, inverse, near_factor, y1, y);
        (x, edge, w0, w1) = (x_next, edge_next, w1, w2);
    }
    // Back: λ_k = z_k + near_{k+1} λ_{k+1} − far_{k+2} λ_{k+2}; a particle moves once its three multipliers are known.
    let (mut lambda1, mut lambda2) = (none, none);
    let (mut near1, mut far1, mut far2) = (zero, zero, zero);
    for k in (1..count - 1).rev() {
        let lambda = Vec3x8::load(simd, &work.vector, k * LANES) + lambda1 * near1 - lambda2 * far2;
        push(simd, lambda - lambda1 * two + lambda2, moved, inverse_mass, at(k + 1));
        far2 = far1;
        near1 = load(simd, &work.upper, k * LANES);
        far1 = load(simd, &work.far, k * LANES);
        (lambda2, lambda1) = (lambda1, lambda);
    }
    push(simd, lambda2 - lambda1 * two, moved, inverse_mass, at(1));
    push(simd, lambda1, moved, inverse_mass, at(0));
}

/// Copies rows `first..first + 8` of a grid into lanes: particle `c` of row `first + lane` goes to lane `lane` of
/// vector `c`, from `base` on. Rows past the last repeat it.
#[inline(always)]
pub(crate) fn gather_rows<S: Simd>(simd: S, from: &[f32], to: &mut [f32], base: usize, grid: Rows, first: usize) {
    // No closures here either: see `shear::smooth`.
    for c in (0..grid.stride).step_by(LANES) {
        let mut block = [splat(simd, 0.0); LANES];
        for (lane, row) in block.iter_mut().enumerate() {
            *row = load(simd, from, (first + lane).min(grid.rows - 1) * grid.stride + c);
        }
        let block = transpose(block);
        for (i, column) in block.iter().enumerate() {
            store(*column, to, base + (c + i) * LANES);
        }
    }
}

/// The way back of [`gather_rows`].
#[inline(always)]
pub(crate) fn scatter_rows<S: Simd>(simd: S, from: &[f32], base: usize, to: &mut [f32], grid: Rows, first: usize) {
    for c in (0..grid.stride).step_by(LANES) {
        let mut block = [splat(simd, 0.0); LANES];
        for (i, column) in block.iter_mut().enumerate() {
            *column = load(simd, from, base + (c + i) * LANES);
        }
        let block = transpose(block);
        for (lane, row) in block.iter().enumerate().take(grid.rows - first) {
            store(*row, to, (first + lane) * grid.stride + c);
        }
    }
}

/// Rows of a grid as they lie in memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows {
    /// Number of rows.
    pub rows: usize,
    /// Slots from one row to the next.
    pub stride: usize,
}
