//! Fans and wind zones: what was accepted of them, and where each stands in this tick.

use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::prelude::*;
use cloth_solver::forces::{Fan, WindZone};
use cloth_solver::{ClothError, Pose};

use super::build::not_finite;
use super::placement::{Placement, Placements};
use super::relative;
use crate::clock::ClothClock;
use crate::cloth::ClothFrame;
use crate::events::WindRejected;
use crate::report::report;

/// What moves the air and is an entity of its own.
pub(crate) trait WindSource: Component + Copy + PartialEq {
    fn validate(&self) -> Result<(), ClothError>;
}

impl WindSource for Fan {
    fn validate(&self) -> Result<(), ClothError> {
        self.validate()
    }
}

impl WindSource for WindZone {
    fn validate(&self) -> Result<(), ClothError> {
        self.validate()
    }
}

/// What became of a [`Fan`] or a [`WindZone`].
#[derive(Component, Clone, Debug)]
#[component(clone_behavior = Ignore)]
pub(crate) struct SourceState<T: WindSource> {
    seen: Option<T>,
    /// Whether what was seen is within its ranges.
    accepted: bool,
    /// Where it stood at the last tick, once it was seen there.
    pose: Option<Pose>,
    /// Its transform was not finite when last looked at.
    lost: bool,
}

impl<T: WindSource> Default for SourceState<T> {
    fn default() -> Self {
        Self { seen: None, accepted: false, pose: None, lost: false }
    }
}

/// One that blows, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Placed<T> {
    #[cfg_attr(feature = "serialize", serde(with = "crate::save::entity"))]
    pub entity: Entity,
    pub source: T,
    pub pose: Pose,
}

/// All that blow in this tick, in the world, in the order of their entities.
#[derive(Resource, Clone, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct WindSources {
    pub fans: Vec<Placed<Fan>>,
    pub zones: Vec<Placed<WindZone>>,
    /// Whether any of it is other than it was a tick ago.
    pub changed: bool,
}

impl WindSources {
    /// The fans, as a cloth in `frame` sees them.
    pub fn fans_seen_from(&self, frame: &ClothFrame) -> impl Iterator<Item = (Fan, Pose)> {
        self.fans.iter().map(|fan| (fan.source, relative(&frame.pose, &fan.pose)))
    }

    /// The zones, as a cloth in `frame` sees them.
    pub fn zones_seen_from(&self, frame: &ClothFrame) -> impl Iterator<Item = (WindZone, Pose)> {
        self.zones.iter().map(|zone| (zone.source, relative(&frame.pose, &zone.pose)))
    }
}

impl MapEntities for WindSources {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        self.fans.iter_mut().for_each(|fan| fan.entity = mapper.get_mapped(fan.entity));
        self.fans.sort_unstable_by_key(|fan| fan.entity);
        self.zones.iter_mut().for_each(|zone| zone.entity = mapper.get_mapped(zone.entity));
        self.zones.sort_unstable_by_key(|zone| zone.entity);
    }
}

/// Checks sources that are new or changed, and gives a new one the transform it may lack.
pub(crate) fn build<T: WindSource>(
    mut sources: Query<(Entity, Ref<T>, Option<&mut SourceState<T>>)>,
    placements: Placements,
    mut commands: Commands,
) {
    for (entity, source, mut known) in &mut sources {
        let mut new = SourceState::default();
        let state = known.as_deref_mut().unwrap_or(&mut new);
        let lost = placements.get(entity).filter(|placement| !placement.is_finite());
        if lost.is_some() != state.lost {
            state.lost = lost.is_some();
            if let Some(placement) = lost {
                report(&mut commands, WindRejected { entity, error: not_finite("Transform", &placement) });
            }
        }
        // The change flag comes first, since a NaN is different from itself.
        if state.seen.is_none() || (source.is_changed() && state.seen != Some(*source)) {
            let checked = source.validate();
            (state.seen, state.accepted) = (Some(*source), checked.is_ok());
            if let Err(error) = checked {
                report(&mut commands, WindRejected { entity, error });
            }
        }
        if known.is_none() {
            commands.entity(entity).try_insert_if_new((Transform::default(), new));
        }
    }
}

/// Finds where everything that blows stands, and how far what oscillates has turned.
pub(crate) fn place(
    mut fans: Query<(Entity, &mut SourceState<Fan>)>,
    mut zones: Query<(Entity, &mut SourceState<WindZone>)>,
    placements: Placements,
    clock: Res<Time<ClothClock>>,
    mut sources: ResMut<WindSources>,
    mut before: Local<WindSources>,
) {
    std::mem::swap(&mut *sources, &mut *before);
    let WindSources { fans: placed_fans, zones: placed_zones, changed } = &mut *sources;
    gather(fans.iter_mut(), &placements, placed_fans);
    gather(zones.iter_mut(), &placements, placed_zones);
    for fan in &mut *placed_fans {
        fan.pose = fan.source.turned(fan.pose, clock.elapsed_secs_f64());
    }
    *changed = *placed_fans != before.fans || *placed_zones != before.zones;
}

fn gather<'a, T: WindSource>(
    sources: impl Iterator<Item = (Entity, Mut<'a, SourceState<T>>)>,
    placements: &Placements,
    placed: &mut Vec<Placed<T>>,
) {
    placed.clear();
    for (entity, mut state) in sources {
        let now = placements.get(entity).filter(Placement::is_finite).map(|placement| placement.pose);
        state.pose = now.or(state.pose);
        if let (Some(source), Some(pose), true) = (state.seen, state.pose, state.accepted) {
            placed.push(Placed { entity, source, pose });
        }
    }
    // The order in a query depends on what else was spawned, and the sum of velocities on it down to the last bit.
    placed.sort_unstable_by_key(|source| source.entity);
}

/// Forgets where a source was, so that one made later from the same entity starts anew.
pub(crate) fn on_removed<T: WindSource>(removed: On<Remove, T>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<SourceState<T>>();
}
