//! One substep of response, and the check that nothing has passed.

use glam::Vec3A;

use super::candidates::{Pair, Pairs, Run};
use super::detect::Watch;
use super::hierarchy::Hierarchy;
use super::nearest::{Kind, gap_along, nearest};
use super::solve::{Bodies, Contact, Law, solve};
use super::state::{Solids, State};
use super::stop::Stop;
use super::sweep::first_meeting;
use super::zone::Zones;
use super::{four, tangle};
use crate::tick::Substep;
use crate::{Particles, Soa3, Topology};

/// Rounds in which what meets gets contacts, before it moves as one.
const SWEPT_ROUNDS: u32 = 3;

/// Rounds until what still meets is left to meet. Every round joins zones, so that they end; a particle that is pinned on the
/// wrong side is what they may not end for.
const MOST_ROUNDS: u32 = 200;

/// Pairs nearer than this, m, are on no side: positions of a metre are no more exact.
const NO_SIDE: f32 = 1e-7;

/// A pair that may come too near in this substep, as it was where that began.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug)]
struct Near {
    kind: Kind,
    ids: [u32; 4],
    normal: Vec3A,
    /// The distance always kept, m.
    least: f32,
    patches: [u32; 2],
}

impl Near {
    /// When the pair comes too near, if it does.
    fn meeting(&self, bodies: &Bodies) -> Option<f32> {
        let (starts, moved) = (four(&bodies.starts, &self.ids), four(&bodies.moved, &self.ids));
        let ends: [Vec3A; 4] = core::array::from_fn(|i| starts[i] + moved[i]);
        if gap_along(self.kind, &ends, self.normal) > self.least {
            return None;
        }
        first_meeting(self.kind, &starts, &moved, self.least)
    }
}

/// Working memory of the response.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(super) struct Response {
    pub bodies: Bodies,
    /// The particles of all pairs and zones.
    used: Vec<u32>,
    is_used: Vec<bool>,
    /// How far each particle has gone since candidates were looked for, less the drift, m: up to where this substep began, and
    /// at most at its end.
    path: Vec<f32>,
    assumed: Vec<f32>,
    near: Vec<Near>,
    /// By patch: how far those of its particles that went farthest in each substep since the search have gone together, less the drift,
    /// m; and with what any of them may go in this one.
    gone: Vec<f32>,
    going: Vec<f32>,
    contacts: Vec<Contact>,
    stops: Vec<Stop>,
    zones: Zones,
    /// Where each particle was when the last substep ended, m.
    ends: Vec<Vec3A>,
    pub touching: u32,
    pub rigid: u32,
}

impl Response {
    pub fn new(slots: usize) -> Self {
        Self {
            bodies: Bodies::new(slots),
            used: Vec::new(),
            is_used: vec![false; slots],
            path: vec![0.0; slots],
            assumed: vec![0.0; slots],
            near: Vec::new(),
            gone: Vec::new(),
            going: Vec::new(),
            contacts: Vec::new(),
            stops: Vec::new(),
            zones: Zones::new(slots),
            ends: vec![Vec3A::ZERO; slots],
            touching: 0,
            rigid: 0,
        }
    }

    /// Sets where particle `slot` was when the substep began, and where it is.
    pub fn place(&mut self, slot: usize, start: Vec3A, end: Vec3A) {
        self.bodies.starts[slot] = start;
        self.bodies.moved[slot] = end - start;
    }

    /// Where particles were when the substep began, m.
    pub fn starts(&self) -> &[Vec3A] {
        &self.bodies.starts
    }

    /// The particles of what pressed in the last substep.
    pub fn pressing(&self) -> impl Iterator<Item = &[u32; 4]> {
        self.contacts.iter().filter(|contact| contact.presses()).map(|contact| &contact.ids)
    }

    /// The same with the weights and the normal of each.
    pub fn pressing_contacts(&self) -> impl Iterator<Item = (&[u32; 4], &[f32; 4], Vec3A)> {
        self.contacts.iter().filter(|contact| contact.presses()).map(Contact::points)
    }

    /// Where the particles of all pairs were when the last substep ended, m.
    pub fn ends(&self) -> &[Vec3A] {
        &self.ends
    }

    /// Whether someone else has moved a particle that is at `position` by more than `least` (m) since the last substep ended.
    pub fn was_moved(&self, position: &Soa3, least: f32) -> bool {
        let end = |slot: u32| self.ends[slot as usize];
        let is_moved = |slot: u32| end(slot).distance_squared(position.get(slot as usize).into()) > least * least;
        self.used.iter().any(|slot| is_moved(*slot))
    }

    /// Begins with new pairs, all of them or those `of_marked` patches.
    pub fn begin(
        &mut self,
        pairs: &mut Pairs,
        watch: &Watch,
        particles: &Particles,
        solids: &[Solids],
        sub: &Substep,
        of_marked: bool,
    ) {
        let hierarchy = &watch.hierarchy;
        if of_marked {
            self.near.retain(|near| !hierarchy.is_marked(near.patches));
            self.contacts.retain(|contact| !hierarchy.is_marked(contact.patches));
        } else {
            self.near.clear();
            self.contacts.clear();
            self.is_used.fill(false);
            self.zones.slots().for_each(|slot| self.is_used[slot as usize] = true);
            self.path.fill(0.0);
            self.assumed.fill(0.0);
            for all in [&mut self.gone, &mut self.going] {
                all.clear();
                all.resize(hierarchy.patches(), 0.0);
            }
        }
        let is_new = |run: &&mut Run| run.others == f32::NEG_INFINITY;
        let mut news = Vec::new();
        for run in pairs.runs.iter_mut().filter(is_new) {
            for pair in &mut pairs.all[run.range()] {
                pair.path = pair.ids.map(|id| self.path[id as usize]);
                let new = pair.ids.into_iter().filter(|id| !std::mem::replace(&mut self.is_used[*id as usize], true));
                news.extend(new);
            }
        }
        self.used.clear();
        self.used.extend((0..self.is_used.len() as u32).filter(|slot| self.is_used[*slot as usize]));
        if of_marked {
            news.extend((0..).zip(&watch.has_left).filter(|(_, has_left)| **has_left).map(|(slot, _)| slot));
            news.sort_unstable();
            news.dedup();
            news.retain(|slot| self.is_used[*slot as usize]);
            let Self { stops, bodies, .. } = self;
            stops.retain(|stop| {
                let is_old = news.binary_search(&stop.particle).is_err();
                if !is_old {
                    bodies.held[stop.particle as usize] = Vec3A::ZERO;
                }
                is_old
            });
            Stop::find(stops, &news, particles, solids, sub);
        } else {
            self.find_stops(particles, solids, sub);
        }
        self.gather(particles);
    }

    /// Finds where colliders stop the particles of all pairs.
    pub fn find_stops(&mut self, particles: &Particles, solids: &[Solids], sub: &Substep) {
        self.stops.drain(..).for_each(|stop| self.bodies.held[stop.particle as usize] = Vec3A::ZERO);
        Stop::find(&mut self.stops, &self.used, particles, solids, sub);
    }

    fn gather(&mut self, particles: &Particles) {
        let Bodies { starts, moved, velocity, inverse_mass, .. } = &mut self.bodies;
        for slot in self.used.iter().map(|slot| *slot as usize) {
            let start = Vec3A::from(particles.previous.get(slot));
            starts[slot] = start;
            moved[slot] = Vec3A::from(particles.position.get(slot)) - start;
            velocity[slot] = Vec3A::from(particles.velocity.get(slot));
            inverse_mass[slot] = particles.inverse_mass[slot];
        }
    }

    fn scatter(&mut self, particles: &mut Particles) {
        let Bodies { starts, moved, velocity, inverse_mass, .. } = &self.bodies;
        for slot in self.used.iter().map(|slot| *slot as usize) {
            if inverse_mass[slot] > 0.0 {
                particles.position.set(slot, (starts[slot] + moved[slot]).into());
                particles.velocity.set(slot, velocity[slot].into());
            }
        }
    }

    /// Bounds how far particles go in this substep. Whether any goes farther than it was assumed to.
    fn assume(&mut self, drift: Vec3A, slack: f32) -> bool {
        let mut is_more = false;
        for slot in self.used.iter().map(|slot| *slot as usize) {
            let way = (self.bodies.moved[slot] - drift).length();
            if self.path[slot] + way > self.assumed[slot] {
                self.assumed[slot] = self.path[slot] + 1.3 * way + slack;
                is_more = true;
            }
        }
        is_more
    }

    /// Finds the pairs that may come too near in this substep, and their contacts.
    fn find_near(&mut self, pairs: &mut Pairs, hierarchy: &Hierarchy, law: &Law) -> bool {
        let mut has_no_side = false;
        for patch in 0..self.going.len() {
            let ways = hierarchy.particles_of(patch).iter().map(|slot| {
                let slot = *slot as usize;
                self.assumed[slot] - self.path[slot]
            });
            // More than rounding makes it less.
            self.going[patch] = (1.0 + 1e-5) * (self.gone[patch] + ways.fold(0.0, f32::max));
        }
        for run in &mut pairs.runs {
            let together = |of: &[f32]| run.patches.iter().map(|patch| of[*patch as usize]).sum::<f32>();
            let (gone, going) = (together(&self.gone), together(&self.going));
            if run.others > going {
                continue;
            }
            run.others = f32::INFINITY;
            for pair in pairs.all[run.range()].iter_mut().filter(|pair| !pair.is_near) {
                if pair.due <= going {
                    has_no_side |= !self.look(pair, run.patches, law);
                    pair.due = gone + pair.limit - ways(&self.path, pair);
                }
                let least = if pair.is_near { &mut run.near } else { &mut run.others };
                *least = least.min(pair.due);
            }
        }
        has_no_side
    }

    /// Whether a pair may come too near in this substep; then makes its contact. `false` if it has no side.
    fn look(&mut self, pair: &mut Pair, patches: [u32; 2], law: &Law) -> bool {
        if ways(&self.assumed, pair) < pair.limit {
            return true;
        }
        let Pair { kind, ids, keep, .. } = *pair;
        let starts = four(&self.bodies.starts, &ids);
        let found = nearest(kind, &starts);
        let distance = found.between.length();
        pair.limit = distance - pair.limit_at(distance, &found.weights);
        pair.path = ids.map(|id| self.path[id as usize]);
        if ways(&self.assumed, pair) < pair.limit {
            return true;
        }
        if distance < NO_SIDE {
            return false;
        }
        pair.is_near = true;
        let normal = found.between / distance;
        self.near.push(Near { kind, ids, normal, least: pair.least(distance), patches });
        let moved = four(&self.bodies.moved, &ids);
        let ends: [Vec3A; 4] = core::array::from_fn(|i| starts[i] + moved[i]);
        if pair.speaks(&found.weights) && gap_along(kind, &ends, normal) < keep {
            self.contacts.extend(Contact::new(kind, ids, patches, &found, keep, 0.0, &self.bodies, law));
        }
        true
    }

    /// Of the pairs that meet in spite of their contacts makes further ones, or zones. Whether there were any.
    fn check(&mut self, round: u32, law: &Law) -> bool {
        let mut has_met = false;
        for near in &self.near {
            if self.zones.holds(&near.ids) {
                continue;
            }
            if let Some(t) = near.meeting(&self.bodies) {
                has_met = true;
                if round < SWEPT_ROUNDS {
                    let (starts, moved) = (four(&self.bodies.starts, &near.ids), four(&self.bodies.moved, &near.ids));
                    let found = nearest(near.kind, &core::array::from_fn(|i| starts[i] + moved[i] * t));
                    let contact =
                        Contact::new(near.kind, near.ids, near.patches, &found, near.least, t, &self.bodies, law);
                    self.contacts.extend(contact);
                } else {
                    self.zones.join(&near.ids, t, &self.bodies);
                }
            }
        }
        has_met
    }
}

/// How far both sides of a pair may have gone together since its limit was set, by the way of each particle since the search.
#[inline(always)]
fn ways(of: &[f32], pair: &Pair) -> f32 {
    let [a, b, c, d]: [f32; 4] = core::array::from_fn(|i| of[pair.ids[i] as usize] - pair.path[i]);
    match pair.kind {
        Kind::VertexTriangle => a + b.max(c).max(d),
        Kind::EdgeEdge => a.max(b) + c.max(d),
    }
}

impl State {
    /// Keeps the pairs apart in one substep.
    pub(super) fn respond(&mut self, topology: &Topology, particles: &mut Particles, solids: &[Solids], sub: &Substep) {
        let h = sub.h;
        self.surfaces.begin(h);
        let slack = 0.02 * self.surfaces.distance;
        self.response.reset(&mut self.pairs, particles, h, slack);
        if !self.tangle.passages.is_empty() {
            tangle::untangle(&self.tangle, topology, particles, h);
            self.response.gather(particles);
        }
        let mut may_find_more = true;
        for round in 0..MOST_ROUNDS {
            let law = Law { surfaces: &self.surfaces, h };
            let drift = Vec3A::from(self.watch.drift * h);
            may_find_more |= self.response.assume(drift, slack);
            if may_find_more {
                self.watch.is_suspect |= self.response.find_near(&mut self.pairs, &self.watch.hierarchy, &law);
                may_find_more = false;
            }
            if round <= SWEPT_ROUNDS {
                if self.response.contacts.is_empty() && round == 0 && self.response.near.is_empty() {
                    break;
                }
                let Response { bodies, contacts, stops, .. } = &mut self.response;
                solve(bodies, contacts, stops, &law);
            } else {
                let Response { bodies, zones, .. } = &mut self.response;
                zones.stiffen(bodies);
            }
            self.response.scatter(particles);
            if self.watch.has_been_left(&particles.position) {
                self.detect(topology, particles, solids, sub);
                may_find_more = true;
                continue;
            }
            if self.response.assume(drift, slack) {
                may_find_more = true;
                continue;
            }
            let law = Law { surfaces: &self.surfaces, h };
            if !self.response.check(round, &law) {
                break;
            }
        }
        self.response.finish(Vec3A::from(self.watch.drift * h), particles, &self.watch.hierarchy);
    }
}

impl Response {
    /// Begins a substep.
    fn reset(&mut self, pairs: &mut Pairs, particles: &Particles, h: f32, slack: f32) {
        self.gather(particles);
        for stop in &mut self.stops {
            stop.advance(h);
            let id = stop.particle as usize;
            let is_held = stop.height(self.bodies.starts[id], h) < 5.0 * slack;
            self.bodies.held[id] = if is_held { stop.normal } else { Vec3A::ZERO };
        }
        for slot in self.used.iter().map(|slot| *slot as usize) {
            self.assumed[slot] = 0.0;
        }
        for run in pairs.runs.iter_mut().filter(|run| run.near < f32::INFINITY) {
            pairs.all[run.range()].iter_mut().for_each(|pair| pair.is_near = false);
            (run.others, run.near) = (run.others.min(run.near), f32::INFINITY);
        }
        self.near.clear();
        self.contacts.clear();
        self.zones.clear();
    }

    /// Ends a substep.
    fn finish(&mut self, drift: Vec3A, particles: &Particles, hierarchy: &Hierarchy) {
        self.touching = self.pressing().count() as u32;
        self.rigid += u32::from(!self.zones.is_empty());
        for slot in self.used.iter().map(|slot| *slot as usize) {
            // From here on the way of this substep.
            self.assumed[slot] = (self.bodies.moved[slot] - drift).length();
            self.path[slot] += self.assumed[slot];
            self.ends[slot] = Vec3A::from(particles.position.get(slot));
        }
        for (patch, gone) in self.gone.iter_mut().enumerate() {
            let ways = hierarchy.particles_of(patch).iter().map(|slot| self.assumed[*slot as usize]);
            *gone += ways.fold(0.0, f32::max);
        }
    }
}
