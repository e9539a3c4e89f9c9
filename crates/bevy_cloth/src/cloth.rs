//! The authored component that makes an entity a cloth, and the read-only components that hold what became of it.

use std::sync::Arc;

use bevy::prelude::*;
use cloth_solver::topology::Mended;
pub use cloth_solver::topology::Resolution;
use cloth_solver::{ClothError, Fabric, Pose, Soa3, Topology};

use crate::prepare::{Authored, Follow};

/// Makes its entity a cloth.
///
/// What it is made of is told by [`Fabric`] (plain cotton unless given), what holds it by [`Pins`](crate::Pins).
/// All may be inserted, changed and removed at any time; the cloth follows at the next fixed step. Removing `Cloth`
/// takes the simulation off the entity and gives it back the [`Mesh3d`] it had.
///
/// The scale of the entity's [`Transform`] is part of the rest shape: a rectangle of 1 m × 1 m on an entity scaled by
/// 2 is a cloth of 2 m × 2 m of the same fabric. A changed scale therefore builds the cloth anew, flat and at rest;
/// a changed place or orientation moves its frame and what is pinned to it, and leaves the rest where it is. A jump
/// takes all of it along, see [`Teleport`](crate::Teleport).
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
#[require(Transform, Visibility, Fabric, Authored)]
pub struct Cloth {
    /// Where the rest shape comes from.
    pub source: ClothSource,
}

/// Where the rest shape of a [`Cloth`] comes from.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Clone, Debug, PartialEq)]
pub enum ClothSource {
    /// A rectangle in the xy plane, centred on the entity's [`Transform`] and facing +z. The warp (the direction
    /// along the roll) runs along y, the weft along x.
    Rectangle {
        /// Width along x and height along y, m, before the transform's scale.
        size: Vec2,
        /// How finely it is divided.
        resolution: Resolution,
    },
    /// The triangles of the entity's own [`Mesh3d`], which may load later; until then the entity waits. The mesh
    /// asset is read, never written: the cloth draws a mesh of its own. Where the mesh has texture coordinates the
    /// warp runs along v.
    ///
    /// A mesh that is a flat, evenly divided rectangle with the warp along one of its sides (a plane with subdivisions) is
    /// solved as a rectangle is. So is one whose quads form rows and columns along its edge loops: a sheet with four corners as a cape or a
    /// sail, or a tube as a sleeve or a skirt, of quads of any shape and size that changes smoothly, flat or bent, each cut into two
    /// triangles either way. Its rows and columns take the place of weft and warp. It takes more time than a rectangle of as many
    /// particles: 1.3 times flat, about twice as a tube, 3 to 4 times as a cape of 64 × 64. What has a hole, a pole, pockets or a texture that runs askew to its rows is none.
    ///
    /// Any other mesh, and such a one once it is cut or torn, is solved along strips of its triangles: tens of times the time of a
    /// rectangle of as many particles where these are many; hung by two corners it stretches by some per cent, where a rectangle does by one.
    ///
    /// Triangle lists and strips, with or without indices. What is wrong with a mesh and can be put right is mended: unused
    /// vertices, triangles without area or there twice, windings that disagree, edges of three or more triangles. One
    /// warning for each cloth says what, and so does [`ClothMended`]. Only a mesh in which nothing is left to simulate, a vertex
    /// is not finite, or an index names no vertex is refused.
    ///
    /// All attributes of the mesh stay with their vertices, through tears and cuts, in the mesh that is drawn: several texture
    /// coordinates, colours, those of your own. Positions, normals and tangents are the cloth's. Joints and their weights are not
    /// drawn with, since the simulation has moved the vertices already. A `ClothLook` uses the second texture coordinates itself.
    ///
    /// A mesh with joints on an entity with a [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh) starts in the pose of its joints. What
    /// they do to its size counts as the transform's scale, whose own counts no more. A joint that is sheared, or scaled after the
    /// cloth is built, takes it along without that.
    ///
    /// Needs the resource [`Assets<Mesh>`](bevy::asset::Assets) and a mesh kept in the main world.
    Mesh,
}

impl Default for ClothSource {
    fn default() -> Self {
        Self::Rectangle { size: Vec2::ONE, resolution: Resolution::Spacing(Cloth::DEFAULT_SPACING) }
    }
}

impl Cloth {
    /// Distance between neighbouring particles of a rectangle unless told otherwise, m.
    pub const DEFAULT_SPACING: f32 = 0.025;

    /// A rectangle `width` × `height` (m) with a particle every [`Cloth::DEFAULT_SPACING`].
    pub const fn rectangle(width: f32, height: f32) -> Self {
        Self {
            source: ClothSource::Rectangle {
                size: Vec2::new(width, height),
                resolution: Resolution::Spacing(Self::DEFAULT_SPACING),
            },
        }
    }

    /// The triangles of the entity's own [`Mesh3d`].
    pub const fn mesh() -> Self {
        Self { source: ClothSource::Mesh }
    }

    /// The same with neighbouring particles about `metres` apart, rounded so that whole cells fill the rectangle.
    /// Does nothing to a cloth made from a mesh, which has the resolution of its triangles.
    pub const fn with_spacing(self, metres: f32) -> Self {
        self.with_resolution(Resolution::Spacing(metres))
    }

    /// The same with `across` cells over the width and `down` cells over the height.
    /// Does nothing to a cloth made from a mesh, which has the resolution of its triangles.
    pub const fn with_cells(self, across: u32, down: u32) -> Self {
        self.with_resolution(Resolution::Cells(UVec2::new(across, down)))
    }

    const fn with_resolution(mut self, to: Resolution) -> Self {
        if let ClothSource::Rectangle { resolution, .. } = &mut self.source {
            *resolution = to;
        }
        self
    }
}

/// The rest state and connectivity a running cloth was built to. Read-only; shared between threads at no cost.
///
/// Its presence says that the cloth was accepted at least once. Beside it lie the solver's
/// [`Particles`](cloth_solver::Particles), [`Constraints`](cloth_solver::cloth::Constraints) and
/// [`Contacts`](cloth_solver::contact::Contacts).
#[derive(Component, Clone, Debug, Deref)]
pub struct ClothTopology(pub(crate) Arc<Topology>);

/// What was wrong with the mesh that a cloth is made of, and was mended. Read-only; only on a cloth whose mesh had faults.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Deref)]
pub struct ClothMended(pub(crate) Mended);

/// Where a running cloth's own frame stands in the world. Read-only.
///
/// Particles are held in this frame, so that a cloth ten kilometres from the origin is as exact as one at it.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct ClothFrame {
    /// Rotation and translation of the entity at the last tick. While an entity that is moved once a frame is on its way over
    /// the ticks of the frame, how far it has come.
    pub pose: Pose,
    /// The scale that is baked into the rest shape.
    pub scale: Vec3,
    /// The pose one tick earlier; of a cloth that jumped where that was carried to.
    pub(crate) before: Pose,
    /// Where the frame is on its way to.
    pub(crate) follow: Follow,
    /// What the cloth hangs on jumped in this tick, and the cloth went along.
    pub(crate) carried: bool,
    /// Whether the entity's transform is not finite, so that the pose is the last one that was.
    pub(crate) lost: bool,
}

impl ClothFrame {
    /// Takes a point of the cloth's frame to the world, m.
    pub fn to_world(&self, point: Vec3) -> Vec3 {
        self.pose.point(point)
    }

    /// Takes a point of the world to the cloth's frame, m.
    pub fn to_local(&self, point: Vec3) -> Vec3 {
        self.pose.inverse_point(point)
    }

    /// The last tick's pose as seen from this one; exactly the identity if nothing moved.
    pub(crate) fn step(&self) -> Pose {
        crate::prepare::relative(&self.pose, &self.before)
    }
}

/// Where the particles of a running cloth were one tick ago, in the cloth's present frame. Read-only.
///
/// The shape drawn lies between it and the present one, and it is what a cloth with a non-finite number returns to.
#[derive(Component, Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct ClothHistory {
    /// Position of each slot at the start of the last tick, m.
    pub position: Soa3,
    /// Where it was when the blades of strokes last passed.
    pub(crate) strokes: crate::damage::Strokes,
}

/// Why a cloth is out of the simulation at present. Read-only; it goes when the data is mended.
///
/// A cloth that ran before stands still in its last shape.
#[derive(Component, Clone, Debug, PartialEq)]
pub struct ClothRejection(pub(crate) ClothError);

impl ClothRejection {
    /// What was refused: field, value and allowed range.
    pub fn error(&self) -> &ClothError {
        &self.0
    }
}
