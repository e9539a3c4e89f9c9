//! The same constraints along straight runs, swept one after the other in colours instead of solved together: what plain
//! XPBD and PBD do.

use fearless_simd::{Simd, f32x8};

use crate::Soa3;
use crate::constraint::kernel::links::{Block, Links, New, Worn};
use crate::lanes::{Vec3x8, load, splat};
use fearless_simd::prelude::*;

/// α̃ of links taken as rigid, 1/kg: as good as none, but for links that are not there.
const RIGID: f32 = 1e-10;

/// α̃ of eight runs; no bending if the fabric does not resist it.
#[derive(Clone, Copy)]
pub(in crate::constraint) struct Compliance<S: Simd> {
    pub stretch: f32x8<S>,
    pub bend: Option<f32x8<S>>,
}

/// Sweeps eight runs, rigidly without compliance: then distances to the neighbours but one stand against bending.
#[inline(always)]
pub(in crate::constraint) fn block<S: Simd>(
    simd: S,
    block: Block,
    position: &Soa3,
    moved: &mut Soa3,
    inverse_mass: &[f32],
    compliance: Option<Compliance<S>>,
    worn: Option<Worn<'_>>,
) {
    match worn {
        None => block_of(simd, block, position, moved, inverse_mass, compliance, New),
        Some(worn) => block_of(simd, block, position, moved, inverse_mass, compliance, worn),
    }
}

#[inline(always)]
fn block_of<S: Simd>(
    simd: S,
    block: Block,
    position: &Soa3,
    moved: &mut Soa3,
    inverse_mass: &[f32],
    compliance: Option<Compliance<S>>,
    links: impl Links,
) {
    match compliance {
        Some(Compliance { stretch: along, bend: across }) => {
            if let Some(across) = across {
                bend(simd, block, position, moved, inverse_mass, across, links);
            }
            stretch(simd, block, position, moved, inverse_mass, along, links);
        }
        None => {
            let rigid = splat(simd, RIGID);
            for from in 0..2 {
                let (block, links) = (block.every_second(from), links.every_second(from));
                if block.count > 1 {
                    stretch(simd, block, position, moved, inverse_mass, rigid, links);
                }
            }
            stretch(simd, block, position, moved, inverse_mass, rigid, links);
        }
    }
}

/// One sweep over the stretch constraints of each run, every second link and then the others. `compliance` is α̃, 1/kg.
#[inline(always)]
fn stretch<S: Simd>(
    simd: S,
    block: Block,
    position: &Soa3,
    moved: &mut Soa3,
    inverse_mass: &[f32],
    compliance: f32x8<S>,
    links: impl Links,
) {
    let (one, tiny, rest) = (splat(simd, 1.0), splat(simd, f32::MIN_POSITIVE), splat(simd, block.spacing));
    for colour in 0..2 {
        for k in (colour..block.count - 1).step_by(2) {
            let (a, b) = (block.at(k), block.at(k + 1));
            let (from, to) = (Vec3x8::load(simd, moved, a), Vec3x8::load(simd, moved, b));
            let edge = Vec3x8::load(simd, position, b) - Vec3x8::load(simd, position, a) + (to - from);
            let (wa, wb) = (load(simd, inverse_mass, a), load(simd, inverse_mass, b));
            let length = edge.length();
            let pull = edge
                * ((length - links.rest(simd, k, rest))
                    / ((wa + wb + links.compliance(simd, k, compliance)).max(tiny) * length.max(tiny))
                    * one);
            (from + pull * wa).store(moved, a);
            (to - pull * wb).store(moved, b);
        }
    }
}

/// One sweep over the bending constraints of each run, in three colours. `compliance` is l³/(D width h²), 1/kg.
#[inline(always)]
fn bend<S: Simd>(
    simd: S,
    block: Block,
    position: &Soa3,
    moved: &mut Soa3,
    inverse_mass: &[f32],
    compliance: f32x8<S>,
    links: impl Links,
) {
    let two = splat(simd, 2.0);
    for colour in 1..4 {
        for k in (colour..block.count.saturating_sub(1)).step_by(3) {
            // No `map` over arrays here: its closure would be compiled without the instruction set this is dispatched to.
            let (a, b, c) = (block.at(k - 1), block.at(k), block.at(k + 1));
            let (d0, d1, d2) =
                (Vec3x8::load(simd, moved, a), Vec3x8::load(simd, moved, b), Vec3x8::load(simd, moved, c));
            let (x0, x1) = (Vec3x8::load(simd, position, a), Vec3x8::load(simd, position, b));
            let x2 = Vec3x8::load(simd, position, c);
            let (w0, w1) = (load(simd, inverse_mass, a), load(simd, inverse_mass, b));
            let w2 = load(simd, inverse_mass, c);
            let curl = (x1 - x0) - (x2 - x1) + ((d1 - d0) - (d2 - d1));
            let push = curl * (splat(simd, 1.0) / (w0 + two * two * w1 + w2 + links.bend(simd, k, compliance)));
            (d0 + push * w0).store(moved, a);
            (d1 - push * (two * w1)).store(moved, b);
            (d2 + push * w2).store(moved, c);
        }
    }
}
