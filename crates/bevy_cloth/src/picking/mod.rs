//! Picking: a backend on the deformed surface, the hand that grabs, the blade that cuts, match and water, and pins.

mod backend;
mod blade;
mod fire;
mod hand;
mod pin;

use bevy::asset::uuid_handle;
use bevy::picking::PickingSystems;
use bevy::picking::backend::ray::RayMap;
use bevy::picking::mesh_picking::ray_cast::SimplifiedMesh;
use bevy::picking::pointer::{PointerButton, PointerInput};
use bevy::prelude::*;

/// What a button of a pointer does to cloth while it is held.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Clone, Debug, PartialEq)]
pub enum ClothTool {
    /// A hand: grabs the cloth and pulls it. What is [`Tearable`](crate::Tearable) may rip.
    #[default]
    Grab,
    /// A blade: cuts every cloth that the pointer sweeps over.
    Cut,
    /// A match: lights cloth that is [`Flammable`](crate::Flammable).
    Match,
    /// Water, for cloth that is [`Flammable`](crate::Flammable): puts out, and wets. Within 15 cm half a litre a square metre
    /// at once, and another litre in each second while it is held.
    Water,
    /// Pins: a press pins the particle hit to the world where it is, see [`PinParticle`](crate::PinParticle). A press on a
    /// pinned particle, or within 3 cm of one, releases it, also if [`Pins`](crate::Pins) holds it.
    Pin,
}

/// How pointers meet cloth: which tool each button is.
#[derive(Resource, Reflect, Clone, Debug, PartialEq)]
#[reflect(Resource, Default, Clone, Debug, PartialEq)]
pub struct ClothPicking {
    /// Whether clothes are hit by pointers and the tools work. Default true.
    pub enabled: bool,
    /// The tool of the primary (left) button, or `None`. Default [`ClothTool::Grab`].
    pub primary: Option<ClothTool>,
    /// The tool of the secondary (right) button, or `None`. Default [`ClothTool::Cut`].
    pub secondary: Option<ClothTool>,
    /// The tool of the middle button, or `None`. Default [`ClothTool::Match`].
    pub middle: Option<ClothTool>,
    /// Stiffness of the hand, N/m; 0.001 to 10,000,000. Default 200.
    pub stiffness: f32,
    /// The hand never pulls harder than this, N; 0 to 1,000,000. Default 20.
    pub max_force: f32,
}

impl Default for ClothPicking {
    fn default() -> Self {
        Self {
            enabled: true,
            primary: Some(ClothTool::Grab),
            secondary: Some(ClothTool::Cut),
            middle: Some(ClothTool::Match),
            stiffness: 200.0,
            max_force: 20.0,
        }
    }
}

impl ClothPicking {
    /// The tool of a button; `None` if it has none, or while picking is not enabled.
    pub fn tool(&self, button: PointerButton) -> Option<ClothTool> {
        let tool = match button {
            PointerButton::Primary => self.primary,
            PointerButton::Secondary => self.secondary,
            PointerButton::Middle => self.middle,
        };
        tool.filter(|_| self.enabled)
    }
}

/// Where a pointer hit a cloth: the `extra` data of its [`HitData`](bevy::picking::backend::HitData), whose position
/// and normal are those of the surface in the world.
///
/// ```
/// # use bevy::prelude::*;
/// use bevy_cloth::ClothHit;
///
/// fn name_the_triangle(press: On<Pointer<Press>>) {
///     if let Some(hit) = press.hit.extra_as::<ClothHit>() {
///         info!("triangle {} of {}", hit.triangle, press.entity);
///     }
/// }
/// # App::new().add_observer(name_the_triangle);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClothHit {
    /// The corner of the triangle nearest to the point hit: slot of a particle.
    pub particle: u32,
    /// The triangle hit: index into the triangles of the cloth's [`ClothTopology`](crate::ClothTopology).
    pub triangle: u32,
    /// Barycentric weights of the point hit; they sum to 1.
    pub weights: Vec3,
}

/// A handle to no mesh.
const NO_MESH: Handle<Mesh> = uuid_handle!("6f0f9c0b-3c1e-4a5f-9d0a-5a8ecb5f2c11");

/// Keeps Bevy's own mesh picking off the mesh a cloth draws, which it would read whole for every ray: it takes the
/// simplified mesh of an entity for the real one, and this one does not exist.
#[cfg(feature = "render")]
pub(crate) fn hidden_from_mesh_picking() -> impl Bundle {
    SimplifiedMesh(NO_MESH)
}

/// Lets every pointer look through what bears it.
#[cfg(feature = "render")]
pub(crate) fn unseen() -> impl Bundle {
    (Pickable::IGNORE, hidden_from_mesh_picking())
}

/// Takes off an entity what picking put on it.
pub(crate) fn forget(entity: &mut EntityWorldMut) {
    entity.remove::<backend::ClothSurface>();
    if entity.get::<SimplifiedMesh>().is_some_and(|mesh| mesh.0 == NO_MESH) {
        entity.remove::<SimplifiedMesh>();
    }
}

/// Adds the systems of this folder. They run where Bevy's picking plugins are.
pub(crate) fn plugin(app: &mut App) {
    app.init_resource::<ClothPicking>()
        .register_type::<ClothPicking>()
        .init_resource::<hand::Hands>()
        .init_resource::<blade::Strokes>()
        .add_observer(hand::grab)
        .add_observer(pin::pin)
        .init_resource::<fire::ToolsInUse>()
        .add_observer(fire::take_up)
        .add_systems(
            PreUpdate,
            (
                backend::cast.in_set(PickingSystems::Backend),
                (
                    hand::release.run_if(resource_exists::<Messages<PointerInput>>),
                    hand::pull,
                    fire::go_on,
                    blade::cut.run_if(resource_exists::<Messages<PointerInput>>),
                )
                    .chain()
                    .in_set(PickingSystems::PostHover),
            )
                .run_if(resource_exists::<RayMap>),
        );
}
