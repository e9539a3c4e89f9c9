//! Waves across the strips of a mesh under a load that the most substeps do not resolve: what
//! [`lines::filter`](crate::constraint::kernel::lines::filter) is to the lines of a grid.
//!
//! A strip pulls along the directions that it had when the substep began: it steps the waves across itself explicitly, which is
//! stable for ω² h² < 4. Of the tension of each link beyond what is surely stable, e per length, what acts is φ with
//! `(E⁻¹ + θ C W Cᵀ) φ = f`, f the columns of the deformation gradient when the substep began and C their coefficients. No wave of φ is
//! faster than ω² h² = 1/θ, whatever the tension and however light a particle. φ follows from f by a symmetric matrix without
//! directions: the whole is neither moved nor turned.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use crate::Soa3;
use crate::batch::{Packed, gather4, scatter4};
use crate::constraint::kernel::strips::{Link, REACH};
use crate::lanes::{LANES, Vec3x8, load, splat, store};

/// Tension times Σ w c² up to which a link is left as it is: half of what is stable.
const UNFILTERED: f32 = 0.15;

/// θ: the waves of both directions together stay below the limit, with what is left as it is.
const FILTER: f32 = 1.25;

/// Working memory for the longest strip, eight lanes each.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Waves {
    vector: Soa3,
    /// √e.
    root: Vec<f32>,
    /// [`REACH`] to a link: factors below the diagonal.
    factor: Vec<f32>,
    /// 1/pivot.
    inverse: Vec<f32>,
}

impl Waves {
    /// For strips of up to `longest` links.
    pub fn new(longest: usize) -> Self {
        let numbers = || vec![0.0; longest * LANES];
        let factor = vec![0.0; longest * REACH * LANES];
        Self { vector: Soa3::zeros(longest * LANES), root: numbers(), factor, inverse: numbers() }
    }

    /// Takes off the moves and multipliers of eight strips what is too fast; `pull` is the direction of each link, [`REACH`] further
    /// on. `packs` are positions and moves.
    #[inline(always)]
    pub fn slow<S: Simd>(
        &mut self,
        simd: S,
        links: &[Link],
        pull: &Soa3,
        lambda: &mut [f32],
        [position, moved]: [&mut [Packed]; 2],
    ) {
        let (zero, one, tiny) = (splat(simd, 0.0), splat(simd, 1.0), splat(simd, f32::MIN_POSITIVE));
        let (theta, unfiltered) = (splat(simd, FILTER), splat(simd, UNFILTERED));
        // LDLᵀ of `1 + θ √E C W Cᵀ √E`.
        for (k, link) in links.iter().enumerate() {
            let [a, b, c] = &link.corners;
            let ((_, w_a), (_, w_b), (_, w_c)) =
                (gather4(simd, position, a), gather4(simd, position, b), gather4(simd, position, c));
            let w = [w_a, w_b, w_c];
            let own = link.mobility(simd, w);
            let size = length(simd, link, position);
            let tension = -load(simd, lambda, k * LANES) / size.max(tiny);
            let excess = (tension - unfiltered / own.max(tiny)).max(zero);
            let f = Vec3x8::load(simd, pull, (k + REACH) * LANES) * size;
            let root = excess.sqrt();
            let mut pivot = one + theta * excess * own;
            let mut right = f * root;
            let reach = REACH.min(k);
            let mut u = [zero; REACH];
            for j in (1..=reach).rev() {
                let shared = link.shared_mobility(simd, j, w);
                u[j - 1] = theta * root * load(simd, &self.root, (k - j) * LANES) * shared;
                for i in j + 1..=reach {
                    u[j - 1] -= u[i - 1] * load(simd, &self.factor, ((k - j) * REACH + i - j - 1) * LANES);
                }
            }
            for j in 1..=reach {
                let factor = u[j - 1] * load(simd, &self.inverse, (k - j) * LANES);
                pivot -= u[j - 1] * factor;
                right = right - Vec3x8::load(simd, &self.vector, (k - j) * LANES) * factor;
                store(factor, &mut self.factor, (k * REACH + j - 1) * LANES);
            }
            right.store(&mut self.vector, k * LANES);
            store(root, &mut self.root, k * LANES);
            // At least 1 but for rounding.
            store(one / pivot.max(one), &mut self.inverse, k * LANES);
        }
        for (k, link) in links.iter().enumerate().rev() {
            let mut found = Vec3x8::load(simd, &self.vector, k * LANES) * load(simd, &self.inverse, k * LANES);
            for j in 1..=REACH.min(links.len() - 1 - k) {
                let factor = load(simd, &self.factor, ((k + j) * REACH + j - 1) * LANES);
                found = found - Vec3x8::load(simd, &self.vector, (k + j) * LANES) * factor;
            }
            found.store(&mut self.vector, k * LANES);
            let root = load(simd, &self.root, k * LANES);
            let pull = Vec3x8::load(simd, pull, (k + REACH) * LANES);
            let f = pull * length(simd, link, position);
            let less = f * (root * root) - found * root;
            store(load(simd, lambda, k * LANES) + less.dot(pull), lambda, k * LANES);
            for (corner, coefficient) in link.corners.iter().zip(link.coefficients(simd)) {
                let (by, w) = gather4(simd, moved, corner);
                scatter4(by + less * (w * coefficient), w, moved, corner);
            }
        }
    }
}

/// |f| when the substep began.
#[inline(always)]
fn length<S: Simd>(simd: S, link: &Link, position: &[Packed]) -> f32x8<S> {
    let [a, b, c] = &link.corners;
    let [_, to_b, to_c] = link.coefficients(simd);
    let ((a, _), (b, _), (c, _)) = (gather4(simd, position, a), gather4(simd, position, b), gather4(simd, position, c));
    ((b - a) * to_b + (c - a) * to_c).length()
}
