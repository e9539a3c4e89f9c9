//! Fire by chance, from edge to edge.

use fearless_simd::dispatch;
use rand::RngExt;

use super::chance::Chance;
use super::rings::Rings;
use super::state::State;
use super::{Contagion, FLAME_TEMPERATURE};
use crate::Topology;
use crate::lanes::{LANES, LEVEL};
use crate::topology::Change;

/// No triangle.
const NONE: u32 = u32::MAX;

/// What fire by chance keeps beside [`State`]: an entry per edge where not said otherwise.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(super) struct Spread {
    pub rule: Contagion,
    chance: Chance,
    /// The edges this was made for.
    edges: Vec<[u32; 2]>,
    /// 0, sound, to 1, broken.
    damage: Vec<f32>,
    is_burning: Vec<bool>,
    /// The triangles at each edge.
    triangles: Vec<[u32; 2]>,
    /// The edges that burn, in the order in which they took fire.
    burning: Vec<u32>,
    /// Number of burning edges around each slot.
    flames: Vec<u32>,
    /// Particles that have taken fire since the last tick began.
    lit: Vec<u32>,
}

impl Spread {
    pub fn new(topology: &Topology, rings: &Rings, rule: &Contagion) -> Self {
        let edges = topology.edges.len();
        let mut triangles = vec![[NONE; 2]; edges];
        for (triangle, &[a, b, c]) in topology.triangles.iter().enumerate() {
            for (p, q) in [(a, b), (b, c), (c, a)] {
                if let Some(edge) = rings.edge(p, q) {
                    let second = usize::from(triangles[edge][0] != NONE);
                    triangles[edge][second] = triangle as u32;
                }
            }
        }
        Self {
            rule: *rule,
            chance: Chance::new(rule.seed),
            edges: topology.edges.clone(),
            damage: vec![0.0; edges],
            is_burning: vec![false; edges],
            triangles,
            burning: Vec::with_capacity(edges),
            flames: vec![0; topology.slots()],
            lit: Vec::with_capacity(topology.slots()),
        }
    }

    /// Whether anything burns.
    pub fn is_burning(&self) -> bool {
        !self.burning.is_empty()
    }

    /// Lights every sound and dry edge at `slot`; `true` if it did not burn before and does now.
    pub fn ignite(&mut self, slot: usize, state: &mut State, rings: &Rings) -> bool {
        let before = self.flames[slot];
        for spoke in rings.around(slot) {
            self.light(spoke.edge as usize, state);
        }
        before == 0 && self.flames[slot] > 0
    }

    /// Pours `water`, kg/m², on `slot`: every edge there goes out.
    pub fn wet(&mut self, slot: usize, water: f32, state: &mut State, rings: &Rings) {
        state.moisture[slot] += water;
        for spoke in rings.around(slot) {
            if self.is_burning[spoke.edge as usize] {
                self.put_out(spoke.edge as usize, state);
            }
        }
        self.burning.retain(|edge| self.is_burning[*edge as usize]);
        self.count(state);
    }

    /// Tells what is in flames.
    fn count(&self, state: &mut State) {
        let flames = |slot: &usize| self.flames[*slot] > 0;
        (state.flaming, state.burning) = ((0..self.flames.len()).filter(flames).count(), self.is_burning());
        state.flame = (0..self.flames.len()).find(flames).map(|slot| slot as u32).or(state.flame);
    }

    /// Advances by a tick of `dt` s.
    pub fn burn(&mut self, topology: &Topology, rings: &Rings, state: &mut State, dt: f32) {
        if self.burning.is_empty() {
            self.lit.clear();
            return;
        }
        let rule = self.rule;
        // What takes fire in this tick burns from the next one on.
        for k in 0..self.burning.len() {
            let edge = self.burning[k] as usize;
            let more = (rule.rate * dt).min(1.0 - self.damage[edge]);
            self.damage[edge] += more;
            for slot in self.edges[edge].map(|slot| slot as usize) {
                let around = rings.around(slot).len() as f32;
                state.fuel[slot] = (state.fuel[slot] - more / around).max(0.0);
                state.scorch[slot] = 1.0 - state.fuel[slot];
            }
            let expected = rule.spread * self.damage[edge] * dt;
            let drawn = self.chance.random::<f32>();
            // The chance of at least one leap is 1 − e^−expected, which is never above `expected`.
            if drawn < expected && drawn < 1.0 - libm::expf(-expected) {
                self.leap(edge, state, rings);
            }
            if self.damage[edge] >= 1.0 {
                self.put_out(edge, state);
                for triangle in self.triangles[edge].into_iter().filter(|triangle| *triangle != NONE) {
                    state.burn_through(topology, triangle as usize);
                }
            }
        }
        self.burning.retain(|edge| self.is_burning[*edge as usize]);
        state.burnt_through.sort_unstable();
        core::mem::swap(&mut state.ignited, &mut self.lit);
        self.lit.clear();
        self.count(state);
        dispatch!(*LEVEL, simd => for i in (0..state.fuel.len() / LANES * LANES).step_by(LANES) {
            state.tell(simd, i, 0.0, 0.0);
        });
    }

    /// Lights one neighbour of `edge`, each with the same chance.
    fn leap(&mut self, edge: usize, state: &mut State, rings: &Rings) {
        let [a, b] = self.edges[edge].map(|slot| rings.around(slot as usize));
        let chosen = self.chance.random_range(0..(a.len() + b.len()) as u32) as usize;
        let spoke = if chosen < a.len() { a[chosen] } else { b[chosen - a.len()] };
        self.light(spoke.edge as usize, state);
    }

    fn light(&mut self, edge: usize, state: &mut State) {
        let ends = self.edges[edge].map(|slot| slot as usize);
        let wet = ends.iter().any(|slot| state.moisture[*slot] > 0.0);
        if wet || self.is_burning[edge] || self.damage[edge] >= 1.0 {
            return;
        }
        self.is_burning[edge] = true;
        self.burning.push(edge as u32);
        for slot in ends {
            if self.flames[slot] == 0 {
                state.temperature[slot] = FLAME_TEMPERATURE;
                self.lit.push(slot as u32);
            }
            self.flames[slot] += 1;
        }
    }

    fn put_out(&mut self, edge: usize, state: &mut State) {
        self.is_burning[edge] = false;
        for slot in self.edges[edge].map(|slot| slot as usize) {
            self.flames[slot] -= 1;
            if self.flames[slot] == 0 {
                state.temperature[slot] = state.air;
            }
        }
    }

    /// Follows a change of topology, from the edges `old` to `rings`: an edge has what the edge had that it is, is a
    /// part or a copy of.
    pub fn follow(&mut self, topology: &Topology, old: &Rings, rings: &Rings, change: &Change) {
        let before = core::mem::replace(self, Self::new(topology, rings, &self.rule));
        (self.chance, self.lit) = (before.chance, before.lit);
        for (edge, ends) in topology.edges.iter().enumerate() {
            let [a, b] = ends.map(|slot| ancestors(change, slot));
            let pairs = a.into_iter().flat_map(|a| b.map(|b| (a, b)));
            let Some(was) = pairs.filter_map(|(a, b)| old.edge(a, b)).next() else { continue };
            self.damage[edge] = before.damage[was];
            self.is_burning[edge] = before.is_burning[was];
            if self.is_burning[edge] {
                self.burning.push(edge as u32);
                ends.iter().for_each(|slot| self.flames[*slot as usize] += 1);
            }
        }
    }
}

/// The particles before `change` that the particle `slot` is, is a copy of, or lies between; a copy of what is born itself
/// counts for what that lies between.
fn ancestors(change: &Change, slot: u32) -> [u32; 2] {
    let parents =
        |slot: u32| change.born.binary_search_by_key(&slot, |born| born.slot).map(|born| change.born[born].parents);
    let mut now = [slot; 2];
    // Parents are in smaller slots.
    loop {
        let next = match now {
            [a, b] if a == b => parents(a).unwrap_or(now),
            [a, b] => [parents(a).map_or(a, |p| p[0]), parents(b).map_or(b, |p| p[1])],
        };
        if next == now {
            return now;
        }
        now = next;
    }
}
