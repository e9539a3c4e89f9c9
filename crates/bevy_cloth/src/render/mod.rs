//! What is drawn: a mesh for each cloth, its bounds and its colours.
use bevy::prelude::*;
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
    /// [`stretch_limit`](cloth_solver::Fabric::stretch_limit).
    Stress,
}
