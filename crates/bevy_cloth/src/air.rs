//! The wind and its gusts, and what the air does to cloth.

use bevy::prelude::*;
use cloth_solver::contact::Contacts;
use cloth_solver::forces::{Air, Gusts, GustyWind, WindField};
use cloth_solver::{ClothError, Particles, Soa3};

use crate::cloth::{ClothFrame, ClothTopology};
use crate::prepare::{Colliders, StepPlan, WindSources};
use crate::settings::Shared;
use crate::sleep::ClothAsleep;
use crate::step::ClothTick;

/// Velocity of the air, the same everywhere, in world axes, m/s; each axis −1,000,000 to 1,000,000. Default 0: calm.
///
/// A component on a cloth overrides the resource [`Shared<Wind>`]. Only a cloth with the component [`Air`] feels it, and
/// it feels calm air, too. [`Gusts`] make it uneven; each [`WindZone`](crate::WindZone) and [`Fan`](crate::Fan) comes on
/// top.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct Wind(pub Vec3);

impl Wind {
    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        let mut axes = self.0.to_array().into_iter();
        axes.try_for_each(|axis| ClothError::check("Wind", axis, -1e6..=1e6, "-1,000,000..=1,000,000 m/s on each axis"))
    }
}

/// The air around one cloth that has [`Air`].
#[derive(Component, Clone, Debug, Default)]
#[component(clone_behavior = Ignore)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Surroundings {
    /// The wind, where the cloth has one of its own.
    own: GustyWind,
    has_own: bool,
    #[cfg_attr(feature = "serialize", serde(skip))]
    field: WindField,
}

impl Surroundings {
    /// Whether the air is slower than `limit` (m/s) at every point of a cloth in `frame` that is asleep.
    pub fn is_below(
        &mut self,
        limit: f32,
        points: &Soa3,
        shared: &SharedWind,
        sources: &WindSources,
        colliders: &Colliders,
        frame: &ClothFrame,
    ) -> bool {
        let wind = if self.has_own { &self.own } else { &shared.0 };
        self.field.set_wind(wind, &frame.pose);
        self.field.set_zones(sources.zones_seen_from(frame));
        self.field.set_fans(sources.fans_seen_from(frame), &colliders.seen_by(frame, 0.0).collect::<Vec<_>>());
        self.field.is_below(limit, points)
    }

    /// How the air moves.
    pub fn field(&self) -> &WindField {
        &self.field
    }

    /// Velocity of the air at a point of the cloth's frame, m/s.
    pub fn wind_at(&self, point: Vec3) -> Vec3 {
        self.field.at(point)
    }
}

/// The wind that all cloths without one of their own share, as it goes by.
#[derive(Resource, Clone, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct SharedWind(GustyWind);

/// Gives every running cloth that has [`Air`] a place to keep it.
pub(crate) fn build(
    cloths: Query<Entity, (With<Air>, With<Particles>, Without<Surroundings>)>,
    mut commands: Commands,
) {
    for entity in &cloths {
        commands.entity(entity).try_insert(Surroundings::default());
    }
}

/// Finds how the air moves at every particle of the cloths that have [`Air`].
pub(crate) fn sample(
    mut cloths: Query<
        (
            &mut Particles,
            &mut Surroundings,
            &ClothTopology,
            &ClothFrame,
            &Contacts,
            Option<&Wind>,
            Option<&Gusts>,
            &StepPlan,
        ),
        (With<Air>, Without<ClothAsleep>),
    >,
    (wind, gusts): (Res<Shared<Wind>>, Res<Shared<Gusts>>),
    sources: Res<WindSources>,
    tick: Res<ClothTick>,
    mut shared: ResMut<SharedWind>,
) {
    if tick.still {
        return;
    }
    // What is refused must not stay in the sum of all that has blown.
    if wind.validate().and(gusts.validate()).is_ok() {
        shared.0.advance(wind.0.0, &gusts.0, tick.dt);
    }
    for (mut particles, mut around, topology, frame, contacts, own_wind, own_gusts, plan) in &mut cloths {
        if plan.substeps == 0 {
            continue;
        }
        // Velocities are those in the world, along the axes of the cloth's frame: how that moves does not matter.
        let Surroundings { own, has_own, field } = &mut *around;
        *has_own = own_wind.is_some() || own_gusts.is_some();
        if *has_own {
            own.advance(own_wind.unwrap_or(&wind).0, own_gusts.unwrap_or(&gusts), tick.dt);
            field.set_wind(own, &frame.pose);
        } else {
            field.set_wind(&shared.0, &frame.pose);
        }
        field.set_zones(sources.zones_seen_from(frame));
        field.set_fans(sources.fans_seen_from(frame), &contacts.colliders);
        field.sample(topology, &mut particles);
    }
}

/// Takes the air off a cloth that has no [`Air`] any more.
pub(crate) fn on_air_removed(removed: On<Remove, Air>, mut cloths: Query<&mut Particles>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<Surroundings>();
    if let Ok(mut particles) = cloths.get_mut(removed.entity) {
        particles.airflow = None;
    }
}
