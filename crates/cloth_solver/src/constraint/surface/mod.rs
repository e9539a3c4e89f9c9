//! What owns the constraints: a grid, any other mesh, and what was taken apart.

pub(in crate::constraint) mod force;
pub(in crate::constraint) mod grid;
mod listed;
pub(in crate::constraint) mod mesh;
pub(in crate::constraint) mod nudge;
mod passes;
mod patch;

use grid::GridConstraints;
use mesh::MeshConstraints;

/// What keeps the fabric together.
#[derive(Clone, Debug, Default)]
pub(in crate::constraint) enum Surface {
    #[default]
    Empty,
    Grid(Box<GridConstraints>),
    Mesh(Box<MeshConstraints>),
}
