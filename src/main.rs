//! The demo game: scenes, camera, mouse and keys around `bevy_cloth`. No physics in here but the flight of a thrown ball.

mod camera;
mod cli;
mod fans;
mod help;
mod keys;
mod look;
mod menu;
mod mouse;
mod processor;
mod readout;
mod record;
mod save;
mod scenes;
mod screenshot;
mod select;
mod shapes;
#[cfg(test)]
mod test_game;
mod throw;
mod tools;
mod window;

use bevy::diagnostic::FrameTimeDiagnosticsPlugin;
use bevy::prelude::*;
use bevy_cloth::{ClothDiagnosticsPlugin, ClothPlugin};
use bevy_cloth_inspector::ClothInspectorPlugin;
use bevy_egui::EguiPlugin;
use clap::Parser;

fn main() -> AppExit {
    let options = cli::Options::parse();
    let mut app = App::new();
    let record = record::RecordPlugin {
        folder: options.record.clone(),
        rate: f64::from(options.rate),
        seconds: options.seconds,
    };
    let processor = processor::ProcessorPlugin { sized: options.size.is_some() };
    match &options.screenshot {
        Some(file) => {
            app.add_plugins(screenshot::ScreenshotPlugin { file: file.clone(), at: options.at, size: options.pixels() })
        }
        None => app.add_plugins((window::WindowedPlugin { size: options.pixels() }, record, processor)),
    };
    app.add_plugins((
        EguiPlugin::default(),
        FrameTimeDiagnosticsPlugin::default(),
        ClothPlugin::default(),
        ClothDiagnosticsPlugin,
        ClothInspectorPlugin,
        camera::CameraPlugin,
        look::LookPlugin,
        shapes::ShapesPlugin,
        fans::FansPlugin,
        throw::FlightPlugin,
        readout::ReadoutPlugin,
        scenes::ScenesPlugin { options },
    ));
    app.run()
}
