//! What cloth suffers: tears where it may, cuts where a blade goes, fire; and the pieces that come of it.

mod apply;
mod cut;
mod fire;
mod pieces;
mod tear;

use bevy::mesh::{MeshVertexAttribute, VertexFormat};
use bevy::prelude::*;

use crate::schedule::{ClothSchedule, ClothSystems};

#[cfg(feature = "picking")]
pub(crate) use apply::Whole;
pub use cloth_solver::damage::fire::{Contagion, Flammability, Flammable, Stage};
pub use cut::CutCloth;
pub(crate) use cut::Strokes;
pub use fire::{ClothFire, IgniteCloth, WetCloth};
pub use pieces::{ClothPiece, ClothPieces};
pub(crate) use tear::TearState;
pub use tear::{TearCloth, Tearable};

/// A factor on the strength of a cloth that is [`Tearable`] at each vertex of the mesh it is made from, 0 to 1: paint the
/// seams that shall give first.
pub const ATTRIBUTE_STRENGTH: MeshVertexAttribute =
    MeshVertexAttribute::new("ClothStrength", 0x636c_6f74_6874, VertexFormat::Float32);

/// Adds the systems of this folder.
pub(crate) fn plugin(app: &mut App) {
    use crate::events::{
        ClothBurntOut, ClothBurntThrough, ClothCut, ClothExtinguished, ClothIgnited, ClothTorn, DebrisGone,
        PiecesSeparated,
    };
    app.add_message::<ClothTorn>()
        .add_message::<ClothCut>()
        .add_message::<PiecesSeparated>()
        .add_message::<DebrisGone>()
        .add_message::<ClothIgnited>()
        .add_message::<ClothBurntThrough>()
        .add_message::<ClothExtinguished>()
        .add_message::<ClothBurntOut>()
        .register_type::<Flammable>()
        .register_type_data::<Flammable, ReflectComponent>()
        .register_type_data::<Flammable, ReflectDefault>()
        .register_type::<Tearable>()
        .add_systems(ClothSchedule, (tear::tear, pieces::clear_debris).chain().in_set(ClothSystems::Tear))
        .add_systems(ClothSchedule, fire::burn.in_set(ClothSystems::Burn))
        .add_observer(fire::on_ignite)
        .add_observer(fire::on_wet)
        .add_observer(fire::on_removed)
        .add_observer(cut::on_cut)
        .add_observer(tear::on_tear)
        .add_observer(tear::on_removed);
}
