//! One substep of response, and the check that nothing has passed.

use glam::Vec3A;

use super::candidates::{Pair, Pairs};
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
    /// The particles of all pairs.
    used: Vec<u32>,
    /// How far each particle has gone since candidates were looked for, less the drift, m: up to where this substep began, and
    /// at most at its end.
    path: Vec<f32>,
    assumed: Vec<f32>,
    near: Vec<Near>,
    is_near: Vec<bool>,
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
            path: vec![0.0; slots],
            assumed: vec![0.0; slots],
            near: Vec::new(),
            is_near: Vec::new(),
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

    /// Begins with new pairs.
    pub fn begin(&mut self, pairs: &Pairs, particles: &Particles, solids: &[Solids], sub: &Substep) {
        let mut is_used = vec![false; self.path.len()];
        pairs.all.iter().flat_map(|pair| pair.ids).for_each(|id| is_used[id as usize] = true);
        self.used.clear();
        self.used.extend((0..is_used.len() as u32).filter(|slot| is_used[*slot as usize]));
        self.path.fill(0.0);
        self.assumed.fill(0.0);
        self.is_near.clear();
        self.is_near.resize(pairs.len(), false);
        self.near.clear();
        self.contacts.clear();
        self.stops.iter().for_each(|stop| self.bodies.held[stop.particle as usize] = Vec3A::ZERO);
        Stop::find(&mut self.stops, &self.used, particles, solids, sub);
        self.gather(particles);
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
    fn find_near(&mut self, pairs: &mut Pairs, law: &Law) -> bool {
        let mut has_no_side = false;
        for (index, pair) in pairs.all.iter_mut().enumerate() {
            if self.is_near[index] {
                continue;
            }
            if ways(&self.assumed, pair) < pair.limit {
                continue;
            }
            let Pair { kind, ids, keep, .. } = *pair;
            let starts = four(&self.bodies.starts, &ids);
            let found = nearest(kind, &starts);
            let distance = found.between.length();
            pair.limit = distance - pair.limit_at(distance, &found.weights);
            pair.path = ids.map(|id| self.path[id as usize]);
            if ways(&self.assumed, pair) < pair.limit {
                continue;
            }
            if distance < NO_SIDE {
                has_no_side = true;
                continue;
            }
            self.is_near[index] = true;
            let normal = found.between / distance;
            self.near.push(Near { kind, ids, normal, least: pair.least(distance) });
            let moved = four(&self.bodies.moved, &ids);
            let ends: [Vec3A; 4] = core::array::from_fn(|i| starts[i] + moved[i]);
            if pair.speaks(&found.weights) && gap_along(kind, &ends, normal) < keep {
                self.contacts.extend(Contact::new(kind, ids, &found, keep, 0.0, &self.bodies, law));
            }
        }
        has_no_side
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
                    self.contacts.extend(Contact::new(near.kind, near.ids, &found, near.least, t, &self.bodies, law));
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
        self.response.reset(particles, h, slack);
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
                self.watch.is_suspect |= self.response.find_near(&mut self.pairs, &law);
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
                self.detect(topology, particles, solids, sub, true);
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
        self.response.finish(Vec3A::from(self.watch.drift * h), particles);
    }
}

impl Response {
    /// Begins a substep.
    fn reset(&mut self, particles: &Particles, h: f32, slack: f32) {
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
        self.is_near.fill(false);
        self.near.clear();
        self.contacts.clear();
        self.zones.clear();
    }

    /// Ends a substep.
    fn finish(&mut self, drift: Vec3A, particles: &Particles) {
        self.touching = self.pressing().count() as u32;
        self.rigid += u32::from(!self.zones.is_empty());
        for slot in self.used.iter().map(|slot| *slot as usize) {
            self.path[slot] += (self.bodies.moved[slot] - drift).length();
            self.ends[slot] = Vec3A::from(particles.position.get(slot));
        }
    }
}
