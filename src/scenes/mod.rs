//! The scenes of the demo and how one is opened.

mod curtain_rod;
mod sandbox;

use bevy::prelude::*;
use bevy_cloth::{ClothClock, ClothColoring, ClothTime, Shared};
use bevy_cloth_inspector::InspectorOpen;
use clap::ValueEnum;

use crate::cli::{Coloring, Options};

/// What can be opened with `--scene`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scene {
    /// A curtain on a rod, with a sphere, a pyramid and a capsule to push through it.
    Sandbox,
}

/// Opens the scene that was asked for.
pub struct ScenesPlugin {
    /// What the command line says.
    pub options: Options,
}

impl Plugin for ScenesPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(curtain_rod::CurtainRodPlugin);
        match self.options.scene {
            Scene::Sandbox => app.add_systems(Startup, sandbox::spawn),
        };
        let coloring = match self.options.coloring {
            Coloring::Material => ClothColoring::Material,
            Coloring::Stress => ClothColoring::Stress,
        };
        app.insert_resource(Shared(coloring))
            .insert_resource(InspectorOpen(self.options.screenshot.is_none() || self.options.ui));
        if self.options.paused {
            app.world_mut().resource_mut::<Time<ClothClock>>().pause();
        }
    }
}
