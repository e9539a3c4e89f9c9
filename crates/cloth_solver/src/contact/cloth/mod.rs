//! Cloth against cloth: no vertex passes through a triangle and no edge through an edge, at any speed.
//!
//! 1. **Candidates**: the pairs of features that may come within the distance kept while every particle
//!    stays near the path that its velocity predicts. Where one has left it they are looked for again, around
//!    it alone.
//! 2. **Response**, in each substep: the velocities that keep the pairs apart, by Gauss–Seidel on accumulated impulses. They act at the
//!    nearest points where the substep began and along the line between them, so that momentum and angular momentum stay; they
//!    only take energy. What is nearer than the distance kept is moved apart, and that never becomes velocity.
//! 3. **Check**: pairs that no plane parts over the whole substep are swept; those that meet get a contact where they do, and what meets
//!    even then moves nearly as one rigid body in this substep (impact zones: Provot 1997; Bridson, Fedkiw, Anderson 2002).
//!
//! So what begins free of intersections stays free of them; the sides of a cut begin a little apart: see `cut`. What begins tangled is untangled: see `tangle`.

mod candidates;
mod cut;
mod detect;
mod features;
mod flat;
mod group;
mod hierarchy;
mod nearest;
mod respond;
mod solve;
mod state;
mod stop;
mod surfaces;
mod sweep;
mod tangle;
mod view;
mod zone;

pub use group::GroupContacts;
pub(crate) use hierarchy::{Bounds, Hierarchy};

use glam::Vec3A;

use super::Contacts;
use crate::tick::Substep;
use crate::topology::Change;
use crate::{ClothError, Fabric, Particles, Topology};
use state::{Solids, State};
use surfaces::Settings;

/// How a cloth keeps off itself.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component, bevy_reflect::Reflect))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelfContact {
    /// Distance kept between the middle surfaces of two layers, m; 1e-6..=0.1. `None`, the default, is the thickness of the fabric, and
    /// at least 1/200 of the mean edge. Between neighbours in the weave never more than 0.9 of their distance at rest.
    pub distance: Option<f32>,
    /// Coulomb friction of the cloth on itself, dimensionless; 0..=10. `None`, the default, is that of the fabric.
    pub friction: Option<f32>,
    /// How fast layers that are nearer than `distance` are moved apart: the rate at which what is missing fades, 1/s; 0..=1000, default
    /// 50. Never faster than [`DEPENETRATION_SPEED`](super::DEPENETRATION_SPEED).
    pub rate: f32,
    /// Most pairs of features that are followed, for each particle; 1..=1000, default 64. A cloth crumpled so that there are more is
    /// no longer kept from passing through itself everywhere, and [`SelfContacts::is_bounded`] says so.
    pub budget: u32,
    /// Whether it also keeps off every other cloth with `SelfContact` of which this is `true`; default `true`.
    pub others: bool,
}

impl Default for SelfContact {
    fn default() -> Self {
        Self { distance: None, friction: None, rate: 50.0, budget: 64, others: true }
    }
}

impl SelfContact {
    /// `Ok` if every number is within its range.
    pub fn validate(&self) -> Result<(), ClothError> {
        if let Some(distance) = self.distance {
            ClothError::check("SelfContact::distance", distance, 1e-6..=0.1, "1e-6..=0.1 m")?;
        }
        if let Some(friction) = self.friction {
            ClothError::check("SelfContact::friction", friction, 0.0..=10.0, "0..=10")?;
        }
        ClothError::check("SelfContact::rate", self.rate, 0.0..=1000.0, "0..=1000 1/s")?;
        ClothError::check("SelfContact::budget", self.budget as f32, 1.0..=1000.0, "1..=1000")
    }
}

/// What contact of a cloth with itself needs to know of it, and what it found.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component))]
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub struct SelfContacts {
    settings: Settings,
    others: bool,
    state: State,
    found: Found,
}

/// What was found of one cloth.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    touching: u32,
    candidates: usize,
    tangled: usize,
    is_bounded: bool,
}

impl SelfContacts {
    /// Of a cloth of `fabric` over `topology`.
    ///
    /// # Errors
    /// A setting out of its range.
    pub fn new(topology: &Topology, fabric: &Fabric, settings: &SelfContact) -> Result<Self, ClothError> {
        settings.validate()?;
        let others = settings.others;
        let settings = Settings::new(topology, fabric, settings);
        Ok(Self { settings, others, state: State::new(topology, settings), found: Found::default() })
    }

    /// Begins anew with the cloth of `topology`: it was placed by someone else, or is another one.
    pub fn reset(&mut self, topology: &Topology) {
        self.state = State::new(topology, self.settings);
        self.found = Found::default();
    }

    /// Updates it after `change` of the topology, which is `now`, of particles that have followed already. What was parted stands at one
    /// place and is on no side of itself: its sides are drawn apart, each into its own cloth, by a fraction of the distance kept.
    pub fn follow(&mut self, now: &Topology, change: &Change, particles: &mut Particles) {
        self.reset(now);
        cut::draw_apart(now, change, particles, self.settings.distance);
    }

    /// Distance kept between two layers, m.
    pub fn distance(&self) -> f32 {
        self.settings.distance
    }

    /// Whether it keeps off other cloths, too: [`SelfContact::others`].
    pub fn meets_others(&self) -> bool {
        self.others
    }

    /// Pairs of features that press on each other, in the last substep.
    pub fn touching(&self) -> u32 {
        self.found.touching
    }

    /// Pairs of features that may come near each other before they are looked for again.
    pub fn candidates(&self) -> usize {
        self.found.candidates
    }

    /// Edges that pass through a triangle, when they were last looked for: of a cloth that began tangled. 0 once it is free.
    pub fn tangled(&self) -> usize {
        self.found.tangled
    }

    /// Whether there were more pairs than [`SelfContact::budget`] allows when they were last looked for.
    pub fn is_bounded(&self) -> bool {
        self.found.is_bounded
    }

    /// How often candidates have been looked for so far, everywhere or around some particles.
    pub fn searches(&self) -> u32 {
        self.state.watch.searches
    }

    /// Substeps so far in which some particles had to move as a rigid body.
    pub fn rigid_substeps(&self) -> u32 {
        self.state.response.rigid
    }
}

/// One substep's worth of contact of a cloth with itself; after [`super::collide`].
pub fn collide_self(
    topology: &Topology,
    particles: &mut Particles,
    contacts: &Contacts,
    own: &mut SelfContacts,
    sub: &Substep,
) {
    let solids = [Solids { slots: 0..topology.slots() as u32, contacts }];
    own.state.collide(topology, particles, &solids, sub);
    let State { response, pairs, tangle, .. } = &own.state;
    own.found = Found {
        touching: response.touching,
        candidates: pairs.len(),
        tangled: tangle.passages.len(),
        is_bounded: pairs.is_bounded,
    };
}

/// The four entries that belong to a pair.
#[inline(always)]
fn four(all: &[Vec3A], ids: &[u32; 4]) -> [Vec3A; 4] {
    ids.map(|id| all[id as usize])
}
