//! The state of contact among the particles of one cloth, or of several that step together.

use std::ops::Range;

use super::candidates::Pairs;
use super::detect::Watch;
use super::features::Features;
use super::hierarchy::Hierarchy;
use super::respond::Response;
use super::surfaces::{Settings, Surfaces};
use super::tangle::Tangle;
use crate::contact::Contacts;
use crate::tick::Substep;
use crate::{Particles, Topology};

/// The solids that stop the particles of one cloth.
#[derive(Clone, Debug)]
pub(super) struct Solids<'a> {
    /// Its slots.
    pub slots: Range<u32>,
    pub contacts: &'a Contacts,
}

#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(super) struct State {
    pub surfaces: Surfaces,
    pub watch: Watch,
    pub pairs: Pairs,
    pub response: Response,
    pub tangle: Tangle,
}

impl State {
    /// Of one cloth.
    pub fn new(topology: &Topology, settings: Settings) -> Self {
        let surfaces = Surfaces::new([(settings, topology.slots())]);
        Self::of(surfaces, Hierarchy::new(topology), Features::new(topology))
    }

    /// Of the cloths with these surfaces.
    pub fn of(surfaces: Surfaces, hierarchy: Hierarchy, features: Features) -> Self {
        let slots = features.slots();
        Self {
            watch: Watch::new(slots, hierarchy, &surfaces),
            pairs: Pairs::new(features),
            response: Response::new(slots),
            tangle: Tangle::default(),
            surfaces,
        }
    }

    /// One substep's worth of contact.
    pub fn collide(&mut self, topology: &Topology, particles: &mut Particles, solids: &[Solids], sub: &Substep) {
        if sub.start <= 0.0 {
            self.begin_tick(topology, particles, sub);
            self.response.find_stops(particles, solids, sub);
        }
        self.response.touching = 0;
        self.watch.advance(sub.h);
        if self.watch.has_been_left(&particles.position) {
            self.detect(topology, particles, solids, sub);
        }
        if !self.pairs.is_empty() || !self.tangle.passages.is_empty() {
            self.respond(topology, particles, solids, sub);
        }
    }
}
