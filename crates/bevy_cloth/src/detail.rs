//! How much is computed of a cloth that is far away, or that nobody sees.

use bevy::camera::Camera;
use bevy::camera::visibility::ViewVisibility;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use cloth_solver::ClothError;

use crate::prepare::Placements;
use crate::settings::Substeps;

/// What is left out of a cloth that is far away, or that nobody sees. Without this component all is computed, always.
///
/// Far off, it takes fewer substeps; farther off it is frozen: it keeps its shape and goes along with what it hangs on, and costs next
/// to nothing. When it comes nearer it moves on from there, from rest. Where a mesh of fewer triangles should be drawn far off, give the
/// entity a `VisibilityRange` and put that mesh on another one.
///
/// Distance is that of the cloth's entity from the nearest [`ClothViewer`], or where there is none from the nearest active camera; without
/// either, all is computed. It counts a tenth less for a cloth that is computed in full than for one that is not, so that nothing
/// goes to and fro on the border. The motion depends on where the viewers are in each tick. If it has to be the same on two machines,
/// put `ClothViewer` on what is in the same place on both, and leave `freeze_unseen` off.
///
/// ```
/// # use bevy_cloth::{Cloth, ClothDetail};
/// // A flag that is frozen from 80 m on, or behind the camera.
/// let flag = (Cloth::rectangle(0.9, 0.6), ClothDetail { frozen_from: 80.0, freeze_unseen: true, ..ClothDetail::default() });
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct ClothDetail {
    /// From this distance on it takes the substeps of `reduced`, m; 0 or more. Default 20.
    pub reduced_from: f32,
    /// Substeps from there on, where the cloth's own are not fewer. Default 5, at most 20: half the cost at rest, a fourth in wind.
    pub reduced: Substeps,
    /// From this distance on it is frozen, m; 0 or more. Default 100.
    pub frozen_from: f32,
    /// Whether it is frozen while no camera and no light sees it. It is seen one frame late. Default false.
    pub freeze_unseen: bool,
}

impl ClothDetail {
    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        ClothError::check("ClothDetail::reduced_from", self.reduced_from, 0.0..=f32::INFINITY, "0 m or more")?;
        ClothError::check("ClothDetail::frozen_from", self.frozen_from, 0.0..=f32::INFINITY, "0 m or more")?;
        self.reduced.validate()
    }

    /// What is computed at `distance`, where it was `before`.
    fn level(&self, distance: f32, before: Level) -> Level {
        let from = |distance: f32, level: Level| if before < level { distance } else { BACK * distance };
        if distance >= from(self.frozen_from, Level::Frozen) {
            Level::Frozen
        } else if distance >= from(self.reduced_from, Level::Reduced) {
            Level::Reduced
        } else {
            Level::Full
        }
    }
}

/// At which share of a distance what was left out there is computed again.
const BACK: f32 = 0.9;

impl Default for ClothDetail {
    fn default() -> Self {
        let reduced = Substeps { count: 5, max: 20, ..Substeps::default() };
        Self { reduced_from: 20.0, reduced, frozen_from: 100.0, freeze_unseen: false }
    }
}

/// From here, the distances of [`ClothDetail`] are measured instead of from the cameras. There may be several.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
#[require(Transform)]
pub struct ClothViewer;

/// How much is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Level {
    #[default]
    Full,
    Reduced,
    Frozen,
}

/// From where cloth is looked at.
#[derive(SystemParam)]
pub(crate) struct Viewers<'w, 's> {
    own: Query<'w, 's, Entity, With<ClothViewer>>,
    cameras: Query<'w, 's, (Entity, &'static Camera), Without<ClothViewer>>,
    cloths: Query<'w, 's, (&'static ClothDetail, Option<&'static ViewVisibility>)>,
}

impl Viewers<'_, '_> {
    /// Where they are in this tick, in the world.
    pub fn places(&self, placements: &Placements) -> Vec<Vec3> {
        if self.cloths.is_empty() {
            return Vec::new();
        }
        let at = |entity: Entity| placements.get(entity).map(|placement| placement.pose.position);
        let own: Vec<Vec3> = self.own.iter().filter_map(at).collect();
        if !own.is_empty() {
            return own;
        }
        self.cameras.iter().filter(|(_, camera)| camera.is_active).filter_map(|(entity, _)| at(entity)).collect()
    }

    /// How much is to be computed of a cloth that stands `at`, seen from `places`, and what it is while less is.
    pub fn level(&self, cloth: Entity, at: Vec3, places: &[Vec3], before: Level) -> (Level, Option<&Substeps>) {
        let Ok((detail, seen)) = self.cloths.get(cloth) else { return (Level::Full, None) };
        if detail.freeze_unseen && seen.is_some_and(|seen| !seen.get()) {
            return (Level::Frozen, None);
        }
        let nearest = places.iter().map(|place| place.distance(at)).min_by(f32::total_cmp);
        let level = nearest.map_or(Level::Full, |distance| detail.level(distance, before));
        (level, (level == Level::Reduced).then_some(&detail.reduced))
    }
}
