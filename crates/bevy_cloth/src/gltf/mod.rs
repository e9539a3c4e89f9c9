//! Models from Blender, or any other program that writes glTF: custom properties say what is cloth.
//!
//! Blender writes the custom properties of objects, meshes and materials into the file when *Include → Custom Properties* is
//! ticked in the exporter. No add-on is needed. The same names work in the `extras` of any glTF file:
//!
//! | property | value | what it does |
//! |---|---|---|
//! | `cloth` | `true`, or the name of a fabric of [`Fabric::PRESETS`], such as `"Canvas"` | makes it a [`Cloth`] of that [`Fabric`]; needed |
//! | `cloth_pins` | `"top"`, `"corners"`, a number of rods, `"color"`, `"attribute"`, `"none"` | [`Pins`]; without it there are none |
//! | `cloth_strength` | a number above 0, up to 1000 | [`Tearable`] with that [`scale`](Tearable::scale): 1 is the real strength of the fabric |
//! | `cloth_burns` | `true`, `false` | [`Flammable`] |
//! | `cloth_air` | `true` (default), `false` | [`Air`]: it feels air and wind |
//! | `cloth_self_contact` | `true`, `false` | [`SelfContact`]: it does not pass through itself |
//!
//! Properties of an object count before those of its mesh, and these before those of its material: so one garment can be of
//! several fabrics. `"color"` pins where the active colour attribute has at least half of red. `"attribute"` pins where the
//! attribute `_CLOTH_PIN` is at least 0.5; `_CLOTH_STRENGTH` paints the strength ([`ATTRIBUTE_STRENGTH`]). In Blender both are float
//! attributes of vertices, written when *Data → Mesh → Attributes* is ticked; they are read by the plugin that [`gltf_plugin`] makes.
//!
//! What is above is read for each primitive of a mesh, which is an entity of its own and a cloth of its own: primitives of one
//! garment are not sewn to each other.
//!
//! The scale of the object and of all above it is part of the rest shape, see [`Cloth`]. What is wrong is told by a line in the log
//! and by the message [`GltfClothProblem`], with node, key, value and what is allowed; the rest of the entries counts.
//!
//! ```no_run
//! # use bevy::prelude::*;
//! # use bevy_cloth::gltf::{GltfClothPlugin, gltf_plugin};
//! # use bevy_cloth::ClothPlugin;
//! # fn with(default_plugins: bevy::app::PluginGroupBuilder) {
//! App::new().add_plugins((default_plugins.set(gltf_plugin()), ClothPlugin::default(), GltfClothPlugin)).run();
//! # }
//! ```

#[cfg(feature = "render")]
mod material;
mod names;

use bevy::gltf::{GltfExtras, GltfMaterialExtras, GltfMeshExtras, GltfPlugin};
use bevy::mesh::{MeshVertexAttribute, VertexAttributeValues, VertexFormat};
use bevy::prelude::*;

pub use names::Problem;
use names::{PinsWanted, Wanted};

#[cfg(doc)]
use crate::Fabric;
use crate::{ATTRIBUTE_STRENGTH, Air, Cloth, Flammable, Pins, SelfContact, Tearable};

/// Where a mesh from a glTF file is pinned: at vertices where this is at least 0.5; `_CLOTH_PIN` in the file.
pub const ATTRIBUTE_PIN: MeshVertexAttribute =
    MeshVertexAttribute::new("ClothPin", 0x636c_6f74_6870, VertexFormat::Float32);

/// Smallest value of [`ATTRIBUTE_PIN`] that pins.
const PINNED: f32 = 0.5;

/// Bevy's [`GltfPlugin`], with the vertex attributes that cloth knows.
pub fn gltf_plugin() -> GltfPlugin {
    // The loader of Bevy 0.19 looks them up without the underscore that they have in the file.
    GltfPlugin::default()
        .add_custom_vertex_attribute("CLOTH_PIN", ATTRIBUTE_PIN)
        .add_custom_vertex_attribute("CLOTH_STRENGTH", ATTRIBUTE_STRENGTH)
}

/// Makes cloth of what glTF files say is cloth, see [the module](self).
#[derive(Clone, Copy, Debug, Default)]
pub struct GltfClothPlugin;

impl Plugin for GltfClothPlugin {
    fn build(&self, app: &mut App) {
        // Before the ticks of the frame in which a scene is first seen.
        app.add_message::<GltfClothProblem>().add_systems(First, make_cloth);
        #[cfg(feature = "render")]
        app.add_systems(First, material::turn.after(make_cloth));
    }
}

/// An entry of a glTF file that says nothing about cloth that could be followed.
#[derive(Message, Clone, Debug, PartialEq)]
pub struct GltfClothProblem {
    /// The entity of the mesh.
    pub entity: Entity,
    /// The name of its node.
    pub node: String,
    /// What is wrong.
    pub problem: Problem,
}

/// A mesh of a glTF file, and what is said about it.
type Primitive = (
    Entity,
    &'static Mesh3d,
    Option<&'static ChildOf>,
    Option<&'static GltfMeshExtras>,
    Option<&'static GltfMaterialExtras>,
    Has<Cloth>,
);

/// Looks at every mesh that is new.
fn make_cloth(
    new: Query<Entity, Added<Mesh3d>>,
    primitives: Query<Primitive>,
    nodes: Query<(Option<&Name>, Option<&GltfExtras>)>,
    meshes: Option<Res<Assets<Mesh>>>,
    mut waiting: Local<Vec<Entity>>,
    mut problems: MessageWriter<GltfClothProblem>,
    mut commands: Commands,
) {
    waiting.extend(&new);
    waiting.retain(|entity| {
        let Ok((entity, mesh, parent, of_mesh, of_material, is_cloth)) = primitives.get(*entity) else { return false };
        let node = parent.and_then(|parent| nodes.get(parent.parent()).ok());
        let of_node = node.and_then(|(_, extras)| extras);
        if is_cloth || (of_node.is_none() && of_mesh.is_none() && of_material.is_none()) {
            return false;
        }
        let texts = [of_node.map(|e| &e.value), of_mesh.map(|e| &e.value), of_material.map(|e| &e.value)];
        let (wanted, wrong) = Wanted::read(texts.into_iter().flatten().map(String::as_str));
        let loaded = meshes.as_ref().and_then(|meshes| meshes.get(&mesh.0));
        if wanted.pins == Some(PinsWanted::Attribute) && loaded.is_none() {
            return true;
        }
        let name = node.and_then(|(name, _)| name).map_or_else(|| entity.to_string(), Name::to_string);
        let mut tell = |problem: Problem| {
            warn!("node `{name}`: {problem}");
            problems.write(GltfClothProblem { entity, node: name.clone(), problem });
        };
        wrong.into_iter().for_each(&mut tell);
        if wanted.cloth == Some(true) {
            let pins = match &wanted.pins {
                Some(PinsWanted::Pins(pins)) => pins.clone(),
                Some(PinsWanted::Attribute) => painted(loaded).unwrap_or_else(|problem| {
                    tell(problem);
                    Pins::default()
                }),
                None => Pins::default(),
            };
            dress(&mut commands.entity(entity), &wanted, pins);
        }
        false
    });
}

/// Pins at the vertices that are painted.
fn painted(mesh: Option<&Mesh>) -> Result<Pins, Problem> {
    match mesh.and_then(|mesh| mesh.try_attribute_option(ATTRIBUTE_PIN).ok().flatten()) {
        Some(VertexAttributeValues::Float32(values)) => {
            Ok(Pins::vertices((0..).zip(values).filter(|(_, value)| **value >= PINNED).map(|(vertex, _)| vertex)))
        }
        _ => Err(Problem {
            key: "cloth_pins".into(),
            value: "\"attribute\"".into(),
            allowed: "that on a mesh with the attribute `_CLOTH_PIN`, a float for each vertex, read by `gltf_plugin`"
                .into(),
        }),
    }
}

/// A cloth that was made of a glTF file.
#[derive(Component, Clone, Copy, Debug)]
struct FromGltf;

/// Gives an entity the components of the cloth that is wanted.
fn dress(entity: &mut EntityCommands, wanted: &Wanted, pins: Pins) {
    entity.insert((Cloth::mesh(), wanted.fabric.unwrap_or_default(), pins, FromGltf));
    if wanted.air != Some(false) {
        entity.insert(Air::default());
    }
    if let Some(scale) = wanted.strength {
        entity.insert(Tearable { scale, ..default() });
    }
    if wanted.burns {
        entity.insert(Flammable::default());
    }
    if wanted.self_contact {
        entity.insert(SelfContact::default());
    }
}
