//! What keeps the waves across lines from growing.

use fearless_simd::Simd;
use fearless_simd::prelude::*;

use super::{Elimination, Links8};
use crate::Soa3;
use crate::constraint::kernel::links::Block;
use crate::lanes::{LANES, Vec3x8, load, splat, store};

/// T h²/(m l) up to which the waves across a line are left as they are; beyond, they are slowed: see [`filter`].
pub(crate) const UNFILTERED_LOAD: f32 = 0.15;

/// What is filtered stays as it is while that leaves no more than that part of [`UNFILTERED_LOAD`] more unfiltered.
const STEADY: f32 = 0.2;

/// How strongly what is beyond is filtered: the waves of both directions together stay below the limit, `2 (4 E + 1/θ) < 4`, E the
/// largest unfiltered load, `(1 + STEADY)` of [`UNFILTERED_LOAD`].
const FILTER: f32 = 0.8;

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
