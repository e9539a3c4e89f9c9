//! Picking: a backend on the deformed surface, the hand that grabs, the blade that cuts, and match and water.

mod backend;
mod blade;
mod fire;
mod hand;

use bevy::asset::uuid_handle;
use bevy::picking::PickingSystems;
use bevy::picking::backend::ray::RayMap;
use bevy::picking::mesh_picking::ray_cast::SimplifiedMesh;
use bevy::picking::pointer::{PointerButton, PointerInput};
use bevy::prelude::*;

/// What a pointer brings to cloth that may burn.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Clone, Debug, PartialEq)]
pub enum FireTool {
    /// A match: sets alight what it passes.
    #[default]
    Match,
    /// Water: puts out, and wets. Within 15 cm half a litre a square metre at once, and another litre
    /// in each second while it is held.
    Water,
}

/// How pointers meet cloth.
#[derive(Resource, Reflect, Clone, Debug, PartialEq)]
#[reflect(Resource, Default, Clone, Debug, PartialEq)]
pub struct ClothPicking {
    /// Whether clothes are hit by pointers and can be grabbed and cut. Default true.
    pub enabled: bool,
    /// The button that grabs while it is held, or `None` for no grabbing. Default the primary (left) button.
    pub button: Option<PointerButton>,
    /// The button that cuts while it is held and the pointer moves, or `None` for no cutting. Default the secondary (right)
    /// button.
    pub cut_button: Option<PointerButton>,
    /// The button that uses [`ClothPicking::tool`] on cloth that is [`Flammable`](crate::Flammable), for as long as it is held,
    /// or `None`. Default the middle button.
    pub tool_button: Option<PointerButton>,
    /// What that button does. Default it ignites.
    pub tool: FireTool,
    /// Stiffness of the hand, N/m; 0.001 to 10,000,000. Default 200.
    pub stiffness: f32,
    /// The hand never pulls harder than this, N; 0 to 1,000,000. Default 20.
    pub max_force: f32,
}

impl Default for ClothPicking {
    fn default() -> Self {
        Self {
            enabled: true,
            button: Some(PointerButton::Primary),
            cut_button: Some(PointerButton::Secondary),
            tool_button: Some(PointerButton::Middle),
            tool: FireTool::Match,
            stiffness: 200.0,
            max_force: 20.0,
        }
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
