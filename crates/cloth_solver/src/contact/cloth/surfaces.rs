//! What the surfaces of cloths are like that touch.

use super::SelfContact;
use crate::{Fabric, Topology};

/// The numbers of [`SelfContact`] as they are for one cloth.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Settings {
    /// Distance kept, m.
    pub distance: f32,
    pub friction: f32,
    /// Rate at which what is missing to the distance fades, 1/s.
    rate: f32,
    /// Most pairs.
    most: usize,
    /// Mean edge at rest, m.
    edge: f32,
    /// The part of what is missing that is made up in the substep at hand.
    made_up: f32,
}

impl Settings {
    pub fn new(topology: &Topology, fabric: &Fabric, settings: &SelfContact) -> Self {
        let edge = crate::contact::mean_edge(topology);
        Self {
            distance: settings.distance.unwrap_or(fabric.thickness.max(edge / 200.0)),
            friction: settings.friction.unwrap_or(fabric.friction),
            rate: settings.rate,
            most: settings.budget as usize * topology.particle_count(),
            edge,
            made_up: 0.0,
        }
    }
}

/// The surfaces of all cloths that keep off one another.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(super) struct Surfaces {
    all: Vec<Settings>,
    /// The cloth of each slot.
    of_slot: Vec<u32>,
    /// The smallest distance kept and the smallest mean edge, m.
    pub distance: f32,
    pub edge: f32,
    /// Most pairs.
    pub most: usize,
}

/// What holds where two points touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Between {
    /// Distance kept, m.
    pub distance: f32,
    pub friction: f32,
    pub made_up: f32,
    /// Both belong to one cloth.
    pub is_own: bool,
}

impl Surfaces {
    /// Those of cloths with so many slots each.
    pub fn new(cloths: impl IntoIterator<Item = (Settings, usize)>) -> Self {
        let mut surfaces = Self { all: vec![], of_slot: vec![], distance: f32::MAX, edge: f32::MAX, most: 0 };
        for (settings, slots) in cloths {
            surfaces.of_slot.extend(std::iter::repeat_n(surfaces.all.len() as u32, slots));
            surfaces.all.push(settings);
            surfaces.distance = surfaces.distance.min(settings.distance);
            surfaces.edge = surfaces.edge.min(settings.edge);
            surfaces.most += settings.most;
        }
        surfaces
    }

    /// Begins a substep of `h` s.
    pub fn begin(&mut self, h: f32) {
        for settings in &mut self.all {
            settings.made_up = 1.0 - (-settings.rate * h).exp();
        }
    }

    /// The distance from the middle of the cloth at `slot` to its surface, m.
    #[inline(always)]
    pub fn half_distance(&self, slot: usize) -> f32 {
        0.5 * self.all[self.of_slot[slot] as usize].distance
    }

    /// What holds between two slots: of two cloths the mean.
    #[inline(always)]
    pub fn between(&self, a: u32, b: u32) -> Between {
        let [a, b] = [a, b].map(|slot| self.of_slot[slot as usize]);
        let [first, second] = [a, b].map(|cloth| &self.all[cloth as usize]);
        let mean = |of: fn(&Settings) -> f32| 0.5 * (of(first) + of(second));
        Between {
            distance: mean(|settings| settings.distance),
            friction: mean(|settings| settings.friction),
            made_up: mean(|settings| settings.made_up),
            is_own: a == b,
        }
    }
}
