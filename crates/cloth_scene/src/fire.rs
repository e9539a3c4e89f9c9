//! How a cloth of a scene burns, and where it is lit.

use cloth_solver::damage::fire::Flammable;
use glam::Vec2;
use serde::{Deserialize, Serialize};

/// A cloth that may burn.
#[derive(Serialize, Deserialize, Clone, Debug, Default, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct SceneFire {
    /// How it burns. Default by heat, as cotton.
    pub burns: Flammable,
    /// Where a match is held to it at the start, as parts of width (from the left) and height (from the top), 0..=1: (0.5, 1)
    /// is the middle of the lower edge. Default nowhere.
    pub lit: Vec<Vec2>,
}
