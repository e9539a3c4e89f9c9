//! Numbers to read: what the cloth has, how far it is stretched, how long everything takes.

use bevy::diagnostic::{DiagnosticPath, DiagnosticsStore, FrameTimeDiagnosticsPlugin};
use bevy::prelude::*;
use bevy_cloth::ClothStats;
use bevy_egui::egui;

use crate::widgets;

/// Diagnostics of the cloth begin with this.
const CLOTH_PATH: &str = "cloth/";

/// Shows statistics of `cloth` and of the frame. A cloth that was not measured is from now on.
pub fn show(ui: &mut egui::Ui, world: &mut World, cloth: Option<Entity>) {
    if let Some(mut cloth) = cloth.and_then(|entity| world.get_entity_mut(entity).ok())
        && !cloth.contains::<ClothStats>()
    {
        cloth.insert(ClothStats::default());
    }
    widgets::rows(ui, "statistics", |ui| {
        frame(ui, world);
        if let Some(stats) = cloth.and_then(|entity| world.get::<ClothStats>(entity)) {
            of_cloth(ui, stats);
        }
        times(ui, world);
    });
}

fn line(ui: &mut egui::Ui, label: &str, value: String) {
    widgets::row(ui, label, "", |ui| ui.monospace(value));
}

fn frame(ui: &mut egui::Ui, world: &World) {
    let Some(store) = world.get_resource::<DiagnosticsStore>() else { return };
    let smoothed = |path: DiagnosticPath| store.get(&path).and_then(|diagnostic| diagnostic.smoothed());
    if let Some(fps) = smoothed(FrameTimeDiagnosticsPlugin::FPS) {
        line(ui, "frames", format!("{fps:.0} /s"));
    }
    if let Some(time) = smoothed(FrameTimeDiagnosticsPlugin::FRAME_TIME) {
        line(ui, "frame", format!("{time:.2} ms"));
    }
}

fn of_cloth(ui: &mut egui::Ui, stats: &ClothStats) {
    line(ui, "particles", stats.particles.to_string());
    line(ui, "triangles", stats.triangles.to_string());
    line(ui, "constraints", stats.constraints.to_string());
    line(ui, "contacts", stats.contacts.to_string());
    line(ui, "substeps", if stats.asleep { "asleep".into() } else { stats.substeps.to_string() });
    line(ui, "largest strain", format!("{:.2} %", 100.0 * stats.largest_strain));
    line(ui, "speed (rms)", format!("{:.3} m/s", stats.rms_speed));
    line(ui, "kinetic energy", format!("{:.4} J", stats.kinetic_energy));
}

/// Times of the solver's phases, for all clothes together.
fn times(ui: &mut egui::Ui, world: &World) {
    let Some(store) = world.get_resource::<DiagnosticsStore>() else { return };
    let mut phases: Vec<_> = store
        .iter()
        .filter(|diagnostic| diagnostic.suffix.trim() == "ms")
        .filter_map(|diagnostic| Some((diagnostic.path().as_str().strip_prefix(CLOTH_PATH)?, diagnostic.smoothed()?)))
        .collect();
    phases.sort_unstable_by_key(|(phase, _)| *phase);
    for (phase, time) in phases {
        line(ui, phase.trim_end_matches("_ms"), format!("{time:.2} ms"));
    }
}
