//! Picking: a backend on the deformed surface, and the hand that grabs.
use bevy::picking::pointer::PointerButton;
use bevy::prelude::*;
/// How pointers meet cloth.
#[derive(Resource, Reflect, Clone, Debug, PartialEq)]
#[reflect(Resource, Default, Clone, Debug, PartialEq)]
pub struct ClothPicking {
    /// Whether clothes are hit by pointers and can be grabbed. Default true.
    pub enabled: bool,
    /// The button that grabs while it is held, or `None` for no grabbing. Default the primary (left) button.
    pub button: Option<PointerButton>,
    /// Stiffness of the hand, N/m, more than 0. Default 200.
    pub stiffness: f32,
    /// The hand never pulls harder than this, N, 0 or more. Default 20.
    pub max_force: f32,
}
impl Default for ClothPicking {
    fn default() -> Self {
        Self { enabled: true, button: Some(PointerButton::Primary), stiffness: 200.0, max_force: 20.0 }
    }
}
/// Where a pointer hit a cloth: the `extra` data of its [`HitData`](bevy::picking::backend::HitData).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClothHit {
    /// The particle nearest to the point hit.
    pub particle: u32,
    /// The triangle hit.
    pub triangle: u32,
    /// Barycentric weights of the point hit.
    pub weights: Vec3,
}
