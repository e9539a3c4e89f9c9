//! When candidates have to be looked for, and where: the boxes that particles stay in until then.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch};
use glam::{Vec3, Vec3A};

use super::candidates::Expected;
use super::hierarchy::{Bounds, Hierarchy};
use super::state::{Solids, State};
use super::surfaces::Surfaces;
use super::tangle::Tangle;
use crate::lanes::{LANES, LEVEL, Vec3x8, load, splat};
use crate::tick::Substep;
use crate::{Particles, Soa3, Topology};

/// A crossing that nothing told of, from rounding, is looked for after so many ticks.
const TICKS_TO_CHECK: u32 = 64;

/// What someone else moves by no more than this part of the distance kept is still on the side on which it was: pairs always keep a
/// tenth of it. A frame that moves shifts its particles by a rounding.
const MOVED: f32 = 0.01;

/// Fewer pairs for each particle than this are no burden, more than that make the search look less far ahead.
const FEW: f32 = 0.25;
const MANY: f32 = 6.0;

/// The paths that particles are expected to take, and how far they may leave them.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(super) struct Watch {
    pub hierarchy: Hierarchy,
    bounds: Vec<Bounds>,
    /// Where particles will be when their paths end, m.
    later: Vec<Vec3A>,
    /// Where each particle was when candidates were looked for, less the common drift since, m.
    from: Soa3,
    /// Its velocity then, less the drift, m/s.
    velocity: Soa3,
    /// How far it may be from where it would be with that velocity, m. Below zero before the first search.
    reach: Vec<f32>,
    /// For how long paths go on, s.
    horizon: f32,
    /// That in ticks.
    ahead: f32,
    /// Time since the search, s, and how far the drift went, m.
    elapsed: f32,
    drifted: Vec3,
    /// A velocity that all particles have in common, m/s. Any will do; the mean keeps their paths short.
    pub drift: Vec3,
    /// The part of the reach that does not depend on speed, m.
    margin: f32,
    /// Substeps since the last search.
    age: u32,
    pub searches: u32,
    /// Whether the cloth may pass through itself where nobody looked: it is new, or was placed by someone else.
    pub is_suspect: bool,
    ticks: u32,
}

impl Watch {
    pub fn new(slots: usize, hierarchy: Hierarchy, surfaces: &Surfaces) -> Self {
        Self {
            hierarchy,
            bounds: vec![Bounds::EMPTY; slots],
            later: vec![Vec3A::ZERO; slots],
            from: Soa3::zeros(slots),
            velocity: Soa3::zeros(slots),
            reach: vec![-1.0; slots],
            horizon: 0.0,
            ahead: 1.0,
            elapsed: 0.0,
            drifted: Vec3::ZERO,
            drift: Vec3::ZERO,
            margin: surfaces.distance.max(surfaces.edge / 16.0),
            age: 0,
            searches: 0,
            is_suspect: true,
            ticks: 0,
        }
    }

    /// Plans the next search, after one that found `crowd` pairs for each particle: how far ahead it looks, so that it lasts for about
    /// a tick without finding too many.
    fn plan(&mut self, surfaces: &Surfaces, crowd: f32, h: f32, tick: f32) {
        let substeps = tick / h;
        let (least, most) = (0.25 * surfaces.distance, 0.25 * surfaces.edge);
        let factor = if crowd < FEW { 2.0 } else { (1.5 * substeps / self.age.max(1) as f32).clamp(0.5, 2.0) };
        self.margin = (self.margin * factor).clamp(least, most.max(least));
        self.ahead = if crowd > MANY { 0.5 * self.ahead } else { 1.5 * self.ahead }.clamp(0.5 / substeps, 1.0);
        (self.elapsed, self.age, self.horizon, self.drifted) = (0.0, 0, self.ahead * tick, Vec3::ZERO);
    }

    /// Plans a search for the substep at hand alone, because there were too many pairs.
    fn look_no_farther(&mut self, surfaces: &Surfaces) {
        (self.margin, self.ahead, self.horizon) = (0.25 * surfaces.distance, 0.0, 0.0);
    }

    pub fn advance(&mut self, h: f32) {
        self.elapsed += h;
        self.drifted += self.drift * h;
        self.age += 1;
    }

    /// Whether a particle has left its path.
    pub fn has_been_left(&self, position: &Soa3) -> bool {
        dispatch!(*LEVEL, simd => has_been_left(simd, self, position))
    }

    /// Looks for candidates again in the next substep.
    pub fn expire(&mut self) {
        self.reach.fill(-1.0);
    }
}

#[inline(always)]
fn has_been_left<S: Simd>(simd: S, watch: &Watch, position: &Soa3) -> bool {
    let time = splat(simd, watch.elapsed.min(watch.horizon));
    let drifted = Vec3x8::splat(simd, watch.drifted);
    let zero = splat(simd, 0.0);
    let mut is_left = zero.simd_lt(zero);
    for i in (0..watch.reach.len() / LANES).map(|group| group * LANES) {
        let path = Vec3x8::load(simd, &watch.from, i) + Vec3x8::load(simd, &watch.velocity, i) * time;
        let off = Vec3x8::load(simd, position, i) - drifted - path;
        let reach = load(simd, &watch.reach, i);
        // Negated, so that what is not a number has left.
        is_left |= !(off.dot(off).simd_le(reach * reach) & reach.simd_ge(zero));
    }
    is_left.any_true()
}

impl State {
    pub(super) fn begin_tick(&mut self, topology: &Topology, particles: &Particles) {
        let watch = &mut self.watch;
        let (mut mass, mut momentum) = (0.0_f32, Vec3::ZERO);
        // Of every seventh: any common velocity will do.
        for slot in (0..topology.slots()).step_by(7) {
            let m = particles.mass[slot];
            mass += m;
            momentum += particles.velocity.get(slot) * m;
        }
        watch.drift = if mass > 0.0 { momentum / mass } else { Vec3::ZERO };
        watch.ticks += 1;
        watch.is_suspect |= watch.ticks.is_multiple_of(TICKS_TO_CHECK);
        if !self.tangle.passages.is_empty()
            || self.response.was_moved(&particles.previous, MOVED * self.surfaces.distance)
        {
            watch.is_suspect = true;
            watch.expire();
        }
    }

    /// Looks for all pairs of features that may meet in this substep or, if particles go on as they do, in the next tick. `is_again` if
    /// the response of this substep has moved particles off their paths: it may still stop or move any as far as they went.
    pub(super) fn detect(
        &mut self,
        topology: &Topology,
        particles: &Particles,
        solids: &[Solids],
        sub: &Substep,
        is_again: bool,
    ) {
        let tick = sub.h / (sub.end - sub.start);
        let crowd = self.pairs.len() as f32 / topology.slots() as f32;
        self.watch.plan(&self.surfaces, crowd, sub.h, tick);
        self.search(topology, particles, sub, is_again);
        if self.pairs.is_bounded {
            self.watch.look_no_farther(&self.surfaces);
            self.search(topology, particles, sub, is_again);
        }
        self.response.begin(&self.pairs, particles, solids, sub);
    }

    /// One search, as it is planned.
    fn search(&mut self, topology: &Topology, particles: &Particles, sub: &Substep, is_again: bool) {
        let Self { surfaces, watch, pairs, response, tangle } = self;
        watch.searches += 1;
        let shift = Vec3A::from(watch.drift * sub.h);
        for slot in 0..topology.slots() {
            let [from, to] = [&particles.previous, &particles.position].map(|all| Vec3A::from(all.get(slot)));
            let velocity = particles.velocity.get(slot) - watch.drift;
            let way = velocity * watch.horizon;
            watch.from.set(slot, to.into());
            watch.velocity.set(slot, velocity);
            response.place(slot, from, to);
            let (from, on) = (from + shift, to + Vec3A::from(way));
            watch.reach[slot] = watch.margin + 0.1 * way.length() + if is_again { from.distance(to) } else { 0.0 };
            watch.later[slot] = on;
            let around = Vec3A::splat(watch.reach[slot] + surfaces.half_distance(slot));
            watch.bounds[slot] = Bounds { min: from.min(to).min(on) - around, max: from.max(to).max(on) + around };
            pairs.expect(slot, Expected { now: to - from, later: on - from, reach: watch.reach[slot] });
        }
        watch.hierarchy.refit(&watch.bounds);
        watch.hierarchy.find_cones(topology, response.starts(), &watch.later, &watch.reach);
        let was_empty = pairs.is_empty();
        let look = |tangle: &mut Tangle, watch: &mut Watch, starts: &[Vec3A]| {
            tangle.find(topology, &mut watch.hierarchy, starts);
            watch.is_suspect = !tangle.passages.is_empty();
        };
        if watch.is_suspect && !was_empty {
            look(tangle, watch, response.starts());
        }
        pairs.find(topology, surfaces, &mut watch.hierarchy, &watch.bounds, response.starts(), tangle);
        if was_empty && !pairs.is_empty() {
            // Nobody looked while there was nothing near.
            look(tangle, watch, response.starts());
            if !tangle.passages.is_empty() {
                pairs.find(topology, surfaces, &mut watch.hierarchy, &watch.bounds, response.starts(), tangle);
            }
        }
    }
}
