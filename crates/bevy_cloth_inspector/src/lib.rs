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
//! | module | what it shows |
//! |---|---|
//! | `panel` | the side panel and the order of its sections |
//! | `world` | clock, gravity, method, substeps, colouring |
//! | `air` | wind, gusts, the selected wind zone, the selected fan |
//! | `cloth` | size, resolution, rods |
//! | `fire` | whether and how it may burn, and what the middle button does |
//! | `fabric` | preset and every value of the fabric |
//! | `motion` | whether the cloth sleeps and when; what is a jump |
//! | `self_contact` | whether and how the cloth keeps off itself |
//! | `contact_view` | what of contact is drawn: candidates, contacts, crossings |
//! | `damage` | whether and how it tears, number of pieces |
//! | `object` | shape, size, place and rotation of the selected object |
//! | `statistics` | particles, strain, frame rate, times |
//! | `outline` | lines around the selected object and the one under the pointer |
//! | `silhouette` | where a mesh ends for the eye |

mod air;
mod cloth;
mod contact_view;
mod damage;
mod fabric;
mod fire;
mod motion;
mod object;
mod outline;
mod panel;
mod self_contact;
mod silhouette;
mod statistics;
mod widgets;
mod world;

use bevy::prelude::*;
use bevy_egui::{EguiPlugin, EguiPrimaryContextPass};
use bevy_inspector_egui::DefaultInspectorConfigPlugin;

pub use contact_view::ContactGizmos;
pub use outline::{HoverGizmos, NoOutline, SelectionGizmos};

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
            .init_resource::<Selected>()
            .init_resource::<Hovered>()
            .init_resource::<InspectorOpen>()
            .init_resource::<PanelWidth>()
            .init_resource::<object::Refusals>()
            .register_type::<Selected>()
            .register_type::<Hovered>()
            .register_type::<InspectorOpen>()
            .register_type::<PanelWidth>()
            .add_systems(PreUpdate, forget_despawned)
            .add_systems(Update, object::note_refusals)
            .add_systems(EguiPrimaryContextPass, panel::show);
    }
}

fn forget_despawned(mut selected: ResMut<Selected>, entities: Query<()>) {
    if selected.0.is_some_and(|entity| !entities.contains(entity)) {
        selected.0 = None;
    }
}
