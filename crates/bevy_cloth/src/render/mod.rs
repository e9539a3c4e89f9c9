//! What is drawn: a mesh for each cloth, its bounds and its colours.

mod attach;
mod material;
mod surface;
mod write;

use bevy::asset::AssetEventSystems;
use bevy::camera::visibility::VisibilitySystems;
use bevy::pbr::StandardMaterial;
use bevy::prelude::*;

use crate::clock;
use crate::schedule::ClothSystems;
use crate::settings::Shared;

pub(crate) use attach::undraw;

/// What the colour of a cloth tells.
///
/// A component on a cloth overrides the resource [`Shared<ClothColoring>`](crate::Shared).
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub enum ClothColoring {
    /// The entity's material, and the vertex colours of the mesh it was made from if it had some.
    #[default]
    Material,
    /// Strain of the weave: blue at rest, by green and yellow to red at the fabric's
    /// [`stretch_limit`](cloth_solver::Fabric::stretch_limit). A [`StandardMaterial`] is replaced by a white one
    /// meanwhile, so that the colours are true; any other material is multiplied by them.
    Stress,
}

/// Adds the systems of this folder.
pub(crate) fn plugin(app: &mut App) {
    app.init_resource::<Shared<ClothColoring>>()
        .register_type::<ClothColoring>()
        .register_type::<Shared<ClothColoring>>()
        .configure_sets(
            PostUpdate,
            ClothSystems::Draw
                .before(AssetEventSystems)
                .before(VisibilitySystems::CalculateBounds)
                .before(VisibilitySystems::CheckVisibility),
        )
        .add_systems(
            PostUpdate,
            (
                attach::attach.run_if(resource_exists::<Assets<Mesh>>),
                material::color.run_if(resource_exists::<Assets<StandardMaterial>>),
                write::write.run_if(resource_exists::<Assets<Mesh>>),
            )
                .chain()
                .after(clock::interpolate)
                .in_set(ClothSystems::Draw),
        );
}
