//! What is drawn: a mesh for each cloth, its bounds and its colours, and flames where it burns.

mod attach;
mod bound;
mod color;
mod flames;
mod look;
mod look_material;
mod material;
mod subdivide;
mod surface;
mod value_noise;
mod wear;
mod weave;
mod write;

use bevy::asset::AssetEventSystems;
use bevy::camera::visibility::VisibilitySystems;
use bevy::pbr::{MaterialPlugin, PbrPlugin, StandardMaterial};
use bevy::prelude::*;
use bevy::shader::load_shader_library;

use crate::events::BoundRejected;
use crate::schedule::ClothSystems;
use crate::settings::Shared;
use crate::shown;

pub(crate) use attach::undraw;
pub use bound::{BoundMeshes, BoundTo};
pub use flames::ClothFlames;
pub use look::{ClothLook, Pattern, Weave};
pub use look_material::{ClothMaterial, FabricExtension};
pub use subdivide::ClothSubdivision;
pub(crate) use subdivide::Subdivision;
pub(crate) use wear::hem;

/// What the colour of a cloth tells.
///
/// A component on a cloth overrides the resource [`Shared<ClothColoring>`](crate::Shared).
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub enum ClothColoring {
    /// The entity's material, and the vertex colours of the mesh it was made from if it had some.
    #[default]
    Material,
    /// Stress: blue at rest, by green and yellow to red at the limit. The larger of fire damage and of the load over the
    /// strength of a cloth that is [`Tearable`](crate::Tearable), or of the strain over the fabric's
    /// [`stretch_limit`](cloth_solver::Fabric::stretch_limit) of one that is not. Here and below a [`StandardMaterial`] is
    /// replaced by a white one meanwhile, so that the colours are true; any other material is multiplied by them.
    Stress,
    /// Strain along warp or weft, stretched or compressed: red at the fabric's stretch limit.
    Strain,
    /// Temperature: blue in a room, red in a flame.
    Temperature,
    /// Speed: blue at rest, red from 5 m/s on.
    Speed,
    /// Contact: red where the cloth touches a collider.
    Contact,
}

impl ClothColoring {
    /// All colourings.
    pub const ALL: [Self; 6] =
        [Self::Material, Self::Stress, Self::Strain, Self::Temperature, Self::Speed, Self::Contact];
}

/// Adds the systems of this folder.
pub(crate) fn plugin(app: &mut App) {
    if app.is_plugin_added::<PbrPlugin>() {
        add_look_material(app);
    }
    app.init_resource::<Shared<ClothColoring>>()
        .register_type::<ClothColoring>()
        .register_type::<Shared<ClothColoring>>()
        .init_resource::<Shared<ClothFlames>>()
        .register_type::<ClothFlames>()
        .register_type::<Shared<ClothFlames>>()
        .init_resource::<Shared<ClothSubdivision>>()
        .register_type::<ClothSubdivision>()
        .register_type::<Shared<ClothSubdivision>>()
        .register_type::<ClothLook>()
        .register_type::<BoundTo>()
        .register_type::<BoundMeshes>()
        .add_message::<BoundRejected>()
        .add_observer(bound::on_unbound)
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
                (look_material::undress, look_material::dress)
                    .chain()
                    .run_if(resource_exists::<Assets<ClothMaterial>>.and_then(resource_exists::<Assets<Image>>)),
                material::color.run_if(resource_exists::<Assets<StandardMaterial>>),
                (write::write, bound::bind, bound::write).chain().run_if(resource_exists::<Assets<Mesh>>),
                (flames::quench, flames::draw).chain().run_if(
                    resource_exists::<Assets<Mesh>>
                        .and_then(resource_exists::<Assets<StandardMaterial>>)
                        .and_then(resource_exists::<Assets<Image>>),
                ),
            )
                .chain()
                .after(shown::show)
                .in_set(ClothSystems::Draw),
        );
}

/// Adds what a renderer needs to draw a [`ClothLook`].
fn add_look_material(app: &mut App) {
    load_shader_library!(app, "fabric_types.wgsl");
    bevy::asset::embedded_asset!(app, "fabric.wgsl");
    bevy::asset::embedded_asset!(app, "fabric_prepass.wgsl");
    app.add_plugins(MaterialPlugin::<ClothMaterial>::default());
}

/// Warns if the renderer came too late to draw a [`ClothLook`].
pub(crate) fn finish(app: &mut App) {
    if app.is_plugin_added::<PbrPlugin>() && !app.world().contains_resource::<Assets<ClothMaterial>>() {
        warn!("`ClothLook` has no effect: add `ClothPlugin` after `DefaultPlugins`");
    }
}
