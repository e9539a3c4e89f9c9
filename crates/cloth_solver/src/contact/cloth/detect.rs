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

/// The part of the patches that may be marked before all are looked at.
const MOST_MARKED: f32 = 0.5;

/// Fewer pairs for each particle than this are no burden, more than that make searches look less far ahead.
const FEW: f32 = 0.25;
const MANY: f32 = 12.0;

/// For how many ticks the path of a particle should hold. A longer one has more pairs along it, a shorter one is looked for more often.
const PATIENCE: f32 = 3.0;

/// When paths are found anew, those of which a particle is farther off than this part of what it may be are found anew as well: one
/// search serves all that are about to leave.
const NEARLY: f32 = 0.5;

/// The paths that particles are expected to take, and how far they may leave them.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(super) struct Watch {
    pub hierarchy: Hierarchy,
    bounds: Vec<Bounds>,
    /// Where particles will be when their paths end, m.
    later: Vec<Vec3A>,
    /// Where particles are when the last of all paths ends, m, and how far they may be off that.
    last: Vec<Vec3A>,
    room: Vec<f32>,
    /// Where each particle was when candidates were looked for, less the common drift since, m.
    from: Soa3,
    /// Its velocity then, less the drift, m/s.
    velocity: Soa3,
    /// How far it may be from where it would be with that velocity, m. Below zero before the first search.
    reach: Vec<f32>,
    /// When its path ends, s.
    until: Vec<f32>,
    /// Whether it has left it.
    pub has_left: Vec<bool>,
    /// The part of the reach that does not depend on speed, m.
    margin: Vec<f32>,
    /// When its path was found, s.
    since: Vec<f32>,
    /// For how long paths are to hold, in ticks.
    patience: f32,
    /// Time since all were looked for, s, and how far the drift went, m.
    elapsed: f32,
    drifted: Vec3,
    /// A velocity that all particles have in common, m/s. Any will do; the mean keeps their paths short.
    pub drift: Vec3,
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
            last: vec![Vec3A::ZERO; slots],
            room: vec![0.0; slots],
            from: Soa3::zeros(slots),
            velocity: Soa3::zeros(slots),
            reach: vec![-1.0; slots],
            until: vec![0.0; slots],
            has_left: vec![true; slots],
            margin: vec![surfaces.distance.max(surfaces.edge / 16.0); slots],
            since: vec![0.0; slots],
            patience: PATIENCE,
            elapsed: 0.0,
            drifted: Vec3::ZERO,
            drift: Vec3::ZERO,
            searches: 0,
            is_suspect: true,
            ticks: 0,
        }
    }

    /// Plans for how long the paths found in this tick are to hold, with `crowd` pairs for each particle now.
    fn plan(&mut self, crowd: f32, substeps: f32) {
        let times = if crowd > MANY { 0.5 } else { 1.5 };
        self.patience = (times * self.patience).clamp(1.0 / substeps, PATIENCE);
    }

    /// Plans the path of a particle anew: the room around it grows until the path holds for long enough, and as far as it may where
    /// there are few pairs.
    fn plan_path(&mut self, slot: usize, surfaces: &Surfaces, tick: f32, is_crowded: bool) {
        let (least, most) = (0.25 * surfaces.distance, 0.25 * surfaces.edge);
        let held = (self.elapsed - self.since[slot]).max(f32::MIN_POSITIVE);
        let factor = if is_crowded { (self.patience * tick / held).clamp(0.5, 2.0) } else { 2.0 };
        self.margin[slot] = (self.margin[slot] * factor).clamp(least, most.max(least));
    }

    /// Plans a search for the substep at hand alone, because there were too many pairs.
    fn look_no_farther(&mut self, surfaces: &Surfaces) {
        self.margin.fill(0.25 * surfaces.distance);
        self.patience = 0.0;
    }

    /// Where a particle is expected to be now, less the drift, m.
    fn path(&self, slot: usize) -> Vec3 {
        self.from.get(slot) + self.velocity.get(slot) * self.elapsed.min(self.until[slot])
    }

    /// Finds where particles, now at `starts` less the drift, would be if they all went on until the last path ends, and how far they may
    /// be off the straight way there if each stops where its own path ends. Only places at one time say how triangles lie. `h` is the
    /// length of the substep at hand.
    fn straighten(&mut self, starts: &[Vec3A], shift: Vec3A, h: f32) {
        let latest = self.until.iter().copied().fold(self.elapsed, f32::max);
        let part = h / (latest - self.elapsed + h);
        for slot in 0..self.until.len() {
            let way = self.velocity.get(slot) * (latest - self.until[slot]);
            let path = self.path(slot);
            self.last[slot] = self.later[slot] + Vec3A::from(way);
            let between = (starts[slot] + shift).lerp(self.last[slot], part);
            self.room[slot] = self.reach[slot] + way.length() + between.distance(path.into());
        }
    }

    /// Begins time anew.
    fn begin(&mut self) {
        let Self { since, until, elapsed, .. } = self;
        since.iter_mut().chain(until).for_each(|time| *time -= *elapsed);
        (self.elapsed, self.drifted) = (0.0, Vec3::ZERO);
    }

    pub fn advance(&mut self, h: f32) {
        self.elapsed += h;
        self.drifted += self.drift * h;
    }

    /// Whether a particle has left its path.
    pub fn has_been_left(&self, position: &Soa3) -> bool {
        dispatch!(*LEVEL, simd => has_been_left(simd, self, position))
    }

    /// Finds which particles have left their paths. `false` if so many patches have lost particles that one better looks at all.
    fn find_left(&mut self, position: &Soa3) -> bool {
        for slot in 0..self.reach.len() {
            let off = position.get(slot) - self.drifted - self.path(slot);
            let reach = NEARLY * self.reach[slot];
            // Negated, so that what is not a number has left.
            self.has_left[slot] = !(off.length_squared() <= reach * reach && reach >= 0.0);
        }
        self.hierarchy.mark(&self.has_left) as f32 <= MOST_MARKED * self.hierarchy.patches() as f32
    }

    /// Looks for candidates again in the next substep.
    pub fn expire(&mut self) {
        self.reach.fill(-1.0);
    }
}

#[inline(always)]
fn has_been_left<S: Simd>(simd: S, watch: &Watch, position: &Soa3) -> bool {
    let elapsed = splat(simd, watch.elapsed);
    let drifted = Vec3x8::splat(simd, watch.drifted);
    let zero = splat(simd, 0.0);
    let mut is_left = zero.simd_lt(zero);
    for i in (0..watch.reach.len() / LANES).map(|group| group * LANES) {
        let time = elapsed.min(load(simd, &watch.until, i));
        let path = Vec3x8::load(simd, &watch.from, i) + Vec3x8::load(simd, &watch.velocity, i) * time;
        let off = Vec3x8::load(simd, position, i) - drifted - path;
        let reach = load(simd, &watch.reach, i);
        // Negated, so that what is not a number has left.
        is_left |= !(off.dot(off).simd_le(reach * reach) & reach.simd_ge(zero));
    }
    is_left.any_true()
}

impl State {
    pub(super) fn begin_tick(&mut self, topology: &Topology, particles: &Particles, sub: &Substep) {
        let watch = &mut self.watch;
        watch.plan(self.pairs.len() as f32 / topology.slots() as f32, 1.0 / (sub.end - sub.start));
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

    /// Looks for the pairs of features that may meet in this substep or while particles stay near their paths: for all, or where
    /// particles have left theirs.
    pub(super) fn detect(&mut self, topology: &Topology, particles: &Particles, solids: &[Solids], sub: &Substep) {
        let watch = &mut self.watch;
        let of_marked = watch.find_left(&particles.position) && !self.pairs.is_bounded && !watch.is_suspect;
        if !of_marked {
            watch.begin();
        }
        self.search(topology, particles, sub, of_marked);
        let is_bounded = self.pairs.is_bounded;
        if is_bounded {
            self.watch.look_no_farther(&self.surfaces);
            self.search(topology, particles, sub, false);
        }
        let of_marked = of_marked && !is_bounded;
        self.response.begin(&mut self.pairs, &self.watch, particles, solids, sub, of_marked);
    }

    /// One search, as it is planned: for all pairs, or those `of_marked` patches, of which particles have left their paths.
    fn search(&mut self, topology: &Topology, particles: &Particles, sub: &Substep, of_marked: bool) {
        let Self { surfaces, watch, pairs, response, tangle } = self;
        watch.searches += 1;
        let shift = Vec3A::from(watch.drift * sub.h);
        let drifted = Vec3A::from(watch.drifted);
        let tick = sub.h / (sub.end - sub.start);
        let horizon = watch.patience.min(1.0) * tick;
        let is_crowded = pairs.len() as f32 > FEW * topology.slots() as f32;
        for slot in 0..topology.slots() {
            let [from, to] = [&particles.previous, &particles.position].map(|all| Vec3A::from(all.get(slot)));
            response.place(slot, from, to);
            let from = from + shift;
            if !of_marked || watch.has_left[slot] {
                watch.plan_path(slot, surfaces, tick, is_crowded);
                let velocity = particles.velocity.get(slot) - watch.drift;
                let way = Vec3A::from(velocity * horizon);
                watch.velocity.set(slot, velocity);
                watch.from.set(slot, Vec3::from(to - drifted) - velocity * watch.elapsed);
                (watch.since[slot], watch.until[slot]) = (watch.elapsed, watch.elapsed + horizon);
                watch.reach[slot] = watch.margin[slot] + 0.1 * way.length();
                let [from, to] = [from, to].map(|x| x - drifted);
                let on = to + way;
                watch.later[slot] = on;
                let around = Vec3A::splat(watch.reach[slot] + surfaces.half_distance(slot));
                watch.bounds[slot] = Bounds { min: from.min(to).min(on) - around, max: from.max(to).max(on) + around };
            }
            let path = watch.path(slot);
            pairs.expect(
                slot,
                Expected {
                    now: Vec3A::from(path) + drifted - from,
                    later: watch.later[slot] + drifted - from,
                    velocity: watch.velocity.get(slot).into(),
                    until: watch.until[slot],
                    reach: watch.reach[slot],
                },
            );
        }
        watch.hierarchy.refit(topology, &watch.bounds, of_marked);
        watch.straighten(response.starts(), shift - drifted, sub.h);
        watch.hierarchy.find_flat(topology, response.starts(), &watch.last, &watch.room, of_marked);
        let was_empty = pairs.is_empty();
        let look = |tangle: &mut Tangle, watch: &mut Watch, starts: &[Vec3A]| {
            tangle.find(topology, &mut watch.hierarchy, starts);
            watch.is_suspect = !tangle.passages.is_empty();
        };
        if watch.is_suspect && !was_empty {
            look(tangle, watch, response.starts());
        }
        pairs.find(topology, surfaces, &mut watch.hierarchy, &watch.bounds, response.starts(), tangle, of_marked);
        if was_empty && !pairs.is_empty() {
            // Nobody looked while there was nothing near.
            look(tangle, watch, response.starts());
            if !tangle.passages.is_empty() {
                pairs.find(topology, surfaces, &mut watch.hierarchy, &watch.bounds, response.starts(), tangle, false);
            }
        }
    }
}
