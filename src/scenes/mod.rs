//! The scenes of the demo and how one is opened.

mod catalog;
pub mod curtain_rod;
mod file;
mod sandbox;
mod stage;

use crate::cli::{Coloring, Options};
use bevy::prelude::*;
use bevy_cloth::{ClothClock, ClothColoring, ClothTime, Shared};
use bevy_cloth_inspector::InspectorOpen;
pub use catalog::{SANDBOX, Scene, names, open};
pub use stage::glossy;

/// Opens the scene that was asked for.
pub struct ScenesPlugin {
    /// What the command line says.
    pub options: Options,
}

impl Plugin for ScenesPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(curtain_rod::CurtainRodPlugin);
        match &self.options.scene {
            Scene::Sandbox => {
                app.add_systems(Startup, sandbox::spawn);
            }
            Scene::File(scene) => {
                file::configure(app, scene);
                app.add_systems(Startup, file::spawn).add_systems(Update, file::light);
            }
        }
        let coloring = match self.options.coloring {
            Coloring::Material => ClothColoring::Material,
            Coloring::Stress => ClothColoring::Stress,
            Coloring::Strain => ClothColoring::Strain,
            Coloring::Temperature => ClothColoring::Temperature,
            Coloring::Speed => ClothColoring::Speed,
            Coloring::Contact => ClothColoring::Contact,
        };
        app.insert_resource(Shared(coloring))
            .insert_resource(InspectorOpen(self.options.screenshot.is_none() || self.options.ui));
        if self.options.paused {
            app.world_mut().resource_mut::<Time<ClothClock>>().pause();
        }
    }
}
