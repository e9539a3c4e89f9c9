//! Sleep: cloth at rest is not advanced until something could move it.

mod disturbance;
mod fall;
mod wake;

use bevy::ecs::change_detection::Tick;
use bevy::prelude::*;
use cloth_solver::cloth::Constraints;
use cloth_solver::{ClothError, Particles, measure};

use crate::cloth::ClothTopology;
use crate::events::{ClothFellAsleep, ClothWoke};
use crate::prepare::Anchors;
use crate::schedule::{ClothSchedule, ClothSystems};
use crate::settings::Shared;
use crate::step;

pub(crate) use disturbance::Disturbances;
pub(crate) use wake::wake_up;

/// When a cloth that has come to rest falls asleep: it then stands still and costs next to nothing until something could move
/// it.
///
/// It wakes when a component of its own or a shared setting changes, when its entity or what its pins follow moves, when a
/// collider near it moves, comes or goes, when wind reaches it, when it is grabbed, torn, cut, lit or reset, when a system
/// writes to its [`Particles`], when a cloth near it wakes or comes near that both keep off (see
/// [`SelfContact`](crate::SelfContact); such cloths fall asleep together), and when [`WakeCloth`](crate::WakeCloth) asks for it. Each change of
/// [`ClothAsleep`] is an event: [`ClothFellAsleep`], [`ClothWoke`].
///
/// A component on a cloth overrides the resource [`Shared<ClothSleep>`](crate::Shared).
///
/// ```
/// # use bevy_cloth::{Cloth, ClothSleep};
/// // A cloth that is advanced in every tick, whatever it does.
/// let cloth = (Cloth::rectangle(1.0, 1.0), ClothSleep::NEVER);
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct ClothSleep {
    /// Whether the cloth may fall asleep. Default `true`.
    pub enabled: bool,
    /// It does so only while every particle moves slower than this from tick to tick, m/s; 0 to 10. Default 0.03. At 0 it never does.
    pub speed: f32,
    /// For how long that must have been so, s; 0 to 1,000. In the meantime its kinetic energy must have fallen, too: what begins
    /// to topple is slow as well. Default 0.5.
    pub time: f32,
    /// Air that is slower than this at every particle does not move it, m/s; 0 to 100. Default 0.05: in it a light curtain a metre
    /// long hangs askew by a few millimetres. Only cloth with the component [`Air`](crate::Air) feels any; at 0 such cloth never
    /// sleeps.
    pub wind: f32,
}

impl ClothAsleep {
    /// Of a cloth that is to sleep as it is now.
    pub(crate) fn of(cloth: &EntityWorldMut) -> Option<Self> {
        let (topology, particles) = (cloth.get::<ClothTopology>()?, cloth.get_ref::<Particles>()?);
        Some(Self {
            bounds: measure::bounds(topology, &particles.position),
            has_anchors: cloth.get::<Anchors>()?.follow_entities(),
            written: [particles.last_changed(), cloth.get_ref::<Constraints>()?.last_changed()],
        })
    }

    /// The corners of the box around its particles, cloth frame, m.
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        self.bounds
    }
}

impl ClothSleep {
    /// The cloth never falls asleep.
    pub const NEVER: Self = Self { enabled: false, ..Self::DEFAULT };

    const DEFAULT: Self = Self { enabled: true, speed: 0.03, time: 0.5, wind: 0.05 };

    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        ClothError::check("ClothSleep::speed", self.speed, 0.0..=10.0, "0..=10 m/s")?;
        ClothError::check("ClothSleep::time", self.time, 0.0..=1e3, "0..=1,000 s")?;
        ClothError::check("ClothSleep::wind", self.wind, 0.0..=100.0, "0..=100 m/s")
    }
}

impl Default for ClothSleep {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// The cloth is asleep, see [`ClothSleep`]. Read-only: trigger [`WakeCloth`](crate::WakeCloth) to wake it.
#[derive(Component, Clone, Copy, Debug)]
#[component(clone_behavior = Ignore)]
pub struct ClothAsleep {
    /// The corners of the box around its particles, cloth frame, m.
    bounds: (Vec3, Vec3),
    /// Whether pins hang on another entity.
    has_anchors: bool,
    /// When its particles and its constraints were last written to. Whoever does so again wants it awake.
    written: [Tick; 2],
}

/// Why a cloth woke, see [`ClothWoke`].
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Clone, Debug, PartialEq)]
pub enum WakeCause {
    /// One of its components or a shared setting changed.
    Change,
    /// Its own entity moved, or what its pins follow.
    Frame,
    /// A collider near it moved, changed, came or went.
    Collider,
    /// Wind reached it.
    Wind,
    /// A hand took hold of it.
    Hand,
    /// It was torn, cut, lit, wetted or reset, or a system wrote to its particles.
    Particles,
    /// Another cloth that it keeps off came near it, or one near it woke.
    Cloth,
    /// [`WakeCloth`](crate::WakeCloth) asked for it.
    Request,
}

/// Adds the systems of this folder.
pub(crate) fn plugin(app: &mut App) {
    app.init_resource::<Shared<ClothSleep>>()
        .init_resource::<Disturbances>()
        .register_type::<ClothSleep>()
        .register_type::<Shared<ClothSleep>>()
        .add_message::<ClothFellAsleep>()
        .add_message::<ClothWoke>()
        .add_systems(ClothSchedule, wake::wake_pushed.before(step::hold_still).in_set(ClothSystems::Substep))
        .add_observer(wake::on_removed)
        .add_observer(wake::on_asked);
}

pub(crate) use fall::fall_asleep;
pub(crate) use wake::wake;
