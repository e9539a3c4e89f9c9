//! What owns the constraints: a grid, any other mesh, and what was taken apart.

pub(in crate::constraint) mod force;
pub(in crate::constraint) mod grid;
mod listed;
pub(in crate::constraint) mod mesh;
pub(in crate::constraint) mod nudge;
mod passes;
mod patch;
mod quads;

use crate::constraint::wear::Wear;
use grid::GridConstraints;
use mesh::MeshConstraints;

/// What keeps the fabric together.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(in crate::constraint) enum Surface {
    #[default]
    Empty,
    Grid(Box<GridConstraints>),
    Mesh(Box<MeshConstraints>),
}

impl Surface {
    /// Takes over how worn the fabric is; `None` makes it as good as new.
    pub fn wear(&mut self, wear: Option<Wear<'_>>) {
        match self {
            Self::Grid(grid) => grid.wear(wear),
            Self::Mesh(mesh) => mesh.wear(wear),
            Self::Empty => {}
        }
    }
}
