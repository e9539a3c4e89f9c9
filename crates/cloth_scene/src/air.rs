//! What moves the air of a scene besides its wind.

use cloth_solver::forces::{Fan, WindZone};
use serde::{Deserialize, Serialize};

use crate::ScenePlace;

/// A fan.
#[derive(Serialize, Deserialize, Clone, Debug, Default, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct SceneFan {
    /// What it is called.
    pub name: String,
    /// How it blows. Default [`Fan::default`]: 0.4 m across, 5 m/s.
    pub fan: Fan,
    /// Where the middle of its outlet is and how it is turned; unturned it blows along −z.
    pub place: ScenePlace,
}

/// A region with a wind of its own.
#[derive(Serialize, Deserialize, Clone, Debug, Default, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct SceneZone {
    /// What it is called.
    pub name: String,
    /// How large it is and how it blows. Default [`WindZone::default`]: a ball of 1 m, 3 m/s along −z.
    pub zone: WindZone,
    /// Where its middle is and how it is turned.
    pub place: ScenePlace,
}
