//! Panels that show and change every value of a [`bevy_cloth`] world while it runs, and an outline around what is
//! selected.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_cloth::ClothPlugin;
//! use bevy_cloth_inspector::ClothInspectorPlugin;
//! use bevy_egui::EguiPlugin;
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, EguiPlugin::default(), ClothPlugin::default(), ClothInspectorPlugin))
//!     .run();
//! ```
//!
//! The panel shows the cloth that is [`Selected`], or hangs on what is, or else the first one there is. It writes
//! authored components and shared settings only, each as soon as it is changed; data that the cloth refuses is shown
//! with the reason. Frame rate and solver times appear if Bevy's `FrameTimeDiagnosticsPlugin` and
//! [`ClothDiagnosticsPlugin`](bevy_cloth::ClothDiagnosticsPlugin) are there.
//!
//! Every value has a unit, a tooltip with its range, and a button that brings its default back. The panel takes at most a third of
//! the window; its left edge can be dragged. An app adds sections of its own with
//! [`add_inspector_section`](InspectorAppExt::add_inspector_section), built from [`widgets`], and keeps the layout of the panel from
//! run to run with [`InspectorLayoutFile`].
//!
//! | module | what it shows |
//! |---|---|
//! | `panel` | the side panel and the order of its sections |
//! | `sections` | sections that an app adds |
//! | `layout` | width of the panel, which sections are open, the file that keeps both |
//! | [`widgets`] | rows, numbers, choices: what sections are made of |
//! | `world` | clock, gravity, method, substeps, colouring |
//! | `air` | wind, gusts, the selected wind zone, the selected fan |
//! | `cloth` | size, resolution, rods |
//! | `fire` | whether and how it may burn, and what the middle button does |
//! | `fabric` | preset and every value of the fabric |
//! | `look` | weave, colours, pattern, threads, sheen |
//! | `motion` | whether the cloth sleeps and when; what is a jump |
//! | `self_contact` | whether and how the cloth keeps off itself |
//! | `contact` | friction, events and force of the selected solid |
//! | `contact_view` | what of contact is drawn: candidates, contacts, crossings |
//! | `damage` | whether and how it tears, number of pieces |
//! | `object` | shape, size, place and rotation of the selected object |
//! | `material` | its colour, roughness, metal, reflectance |
//! | `camera`, `light` | the main camera, the directional lights |
//! | `advice`, `tried` | what could be left out of the cloth, and a way to try it |
//! | `statistics`, `history` | particles, strain, frame rate, time of each phase; curves of strain and energy |
//! | `outline` | lines around the selected object and the one under the pointer |
//! | `silhouette` | where a mesh ends for the eye |

mod advice;
mod air;
mod camera;
mod cloth;
mod contact;
mod contact_view;
mod damage;
mod fabric;
mod fire;
mod history;
mod layout;
mod light;
mod look;
mod material;
mod motion;
mod object;
mod outline;
mod panel;
mod sections;
mod self_contact;
mod silhouette;
mod statistics;
mod tried;
#[cfg(test)]
mod walk;
pub mod widgets;
mod world;

use bevy::prelude::*;
use bevy_egui::{EguiPlugin, EguiPrimaryContextPass};
use bevy_inspector_egui::DefaultInspectorConfigPlugin;

pub use camera::CameraTarget;
pub use contact_view::ContactGizmos;
pub use layout::{InspectorLayout, InspectorLayoutFile};
pub use outline::{HoverGizmos, NoOutline, SelectionGizmos};
pub use sections::{InspectorAppExt, InspectorSections};

/// The entity that is selected, if any. Write it from your own picking.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default)]
pub struct Selected(pub Option<Entity>);

/// The entity under the pointer that a click would select, if any: it gets a softer outline than [`Selected`]. Write it from
/// your own picking.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default)]
pub struct Hovered(pub Option<Entity>);

/// Whether the panel is shown. Default `true`.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Resource, Default)]
pub struct InspectorOpen(pub bool);

impl Default for InspectorOpen {
    fn default() -> Self {
        Self(true)
    }
}

/// The width the panel takes from the right of the screen, logical pixels; 0 while it is not shown. Read-only: for
/// those that want to leave room for it.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Resource, Default)]
pub struct PanelWidth(pub f32);

/// Adds the panel and the outline. Needs [`EguiPlugin`] and [`ClothPlugin`](bevy_cloth::ClothPlugin).
pub struct ClothInspectorPlugin;

impl Plugin for ClothInspectorPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<EguiPlugin>() {
            warn!("ClothInspectorPlugin shows nothing: add bevy_egui's EguiPlugin before it");
            return;
        }
        app.add_plugins((DefaultInspectorConfigPlugin, outline::OutlinePlugin, contact_view::ContactViewPlugin))
            .register_type::<Selected>()
            .register_type::<Hovered>()
            .register_type::<InspectorOpen>()
            .register_type::<PanelWidth>()
            .register_type::<InspectorLayout>()
            .register_type::<CameraTarget>()
            .add_systems(PreStartup, layout::load.run_if(resource_exists::<InspectorLayoutFile>))
            .add_systems(PreUpdate, forget_despawned)
            .add_systems(Update, object::note_refusals)
            .add_systems(EguiPrimaryContextPass, panel::show)
            .add_systems(Last, layout::save.run_if(resource_exists::<InspectorLayoutFile>));
        init_resources(app.world_mut());
    }
}

/// Everything that the panel keeps.
fn init_resources(world: &mut World) {
    world.init_resource::<Selected>();
    world.init_resource::<Hovered>();
    world.init_resource::<InspectorOpen>();
    world.init_resource::<PanelWidth>();
    world.init_resource::<InspectorLayout>();
    world.init_resource::<InspectorSections>();
    world.init_resource::<object::Refusals>();
    world.init_resource::<statistics::Measured>();
    world.init_resource::<advice::Adviser>();
    world.init_resource::<history::History>();
}

fn forget_despawned(mut selected: ResMut<Selected>, entities: Query<()>) {
    if selected.0.is_some_and(|entity| !entities.contains(entity)) {
        selected.0 = None;
    }
}
