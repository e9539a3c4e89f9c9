//! Bending of eight runs side by side.

use fearless_simd::{Simd, f32x8};

use super::Elimination;
use crate::Soa3;
use crate::constraint::kernel::links::{Block, Links};
use crate::lanes::{LANES, Vec3x8, load, splat, store};

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
