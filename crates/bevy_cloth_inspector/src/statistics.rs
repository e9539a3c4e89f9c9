//! Numbers to read: what the cloth has, how far it is stretched, how long everything takes, and how that went of late.

use bevy::diagnostic::{DiagnosticPath, DiagnosticsStore, FrameTimeDiagnosticsPlugin};
use bevy::prelude::*;
use bevy_cloth::{ClothClock, ClothDiagnosticsPlugin as Cloths, ClothStats};
use bevy_egui::egui;

use crate::history::History;
use crate::widgets;

/// The phases of a tick and of a frame in the order in which they run, and what each does.
static PHASES: [(&str, DiagnosticPath, &str); 9] = [
    ("prepare", Cloths::PREPARE, "Follows frames, pins and colliders."),
    ("forces", Cloths::FORCES, "Air and wind."),
    ("integrate", Cloths::INTEGRATE, "Moves the particles on."),
    ("solve", Cloths::SOLVE, "Threads, shear and bending."),
    ("collide", Cloths::COLLIDE, "Keeps off solids and off itself."),
    ("tear", Cloths::TEAR, "Watches loads and parts what is overloaded."),
    ("burn", Cloths::BURN, "Spreads heat and fire."),
    ("write back", Cloths::WRITEBACK, "Sleep, events and statistics."),
    ("draw", Cloths::DRAW, "Meshes, normals and flames."),
];

/// The cloth that the panel has measured.
#[derive(Resource, Default)]
pub struct Measured(Option<Entity>);

/// Shows statistics of `cloth` and of the frame. The cloth is measured while they are shown.
pub fn show(ui: &mut egui::Ui, world: &mut World, cloth: Option<Entity>) {
    measure(world, cloth);
    if let Some(stats) = cloth.and_then(|entity| world.get::<ClothStats>(entity)).copied() {
        let now = world.get_resource::<Time<ClothClock>>().map_or(0.0, |clock| clock.elapsed_secs_f64());
        world.resource_scope(|_, mut history: Mut<History>| {
            history.push(cloth, now, &stats);
            history.show(ui);
        });
        of_cloth(ui, &stats);
    }
    frame(ui, world);
    times(ui, world);
}

/// Inserts [`ClothStats`] where the cloth has none of its own.
fn measure(world: &mut World, cloth: Option<Entity>) {
    if world.resource::<Measured>().0.is_some_and(|measured| Some(measured) != cloth) {
        stop(world);
    }
    if let Some(entity) = cloth
        && !world.entity(entity).contains::<ClothStats>()
    {
        world.entity_mut(entity).insert(ClothStats::default());
        world.resource_mut::<Measured>().0 = Some(entity);
    }
}

/// Measures no more: takes off what the panel put there, and forgets the curves.
pub fn stop(world: &mut World) {
    if let Some(entity) = world.resource_mut::<Measured>().bypass_change_detection().0.take()
        && let Ok(mut entity) = world.get_entity_mut(entity)
    {
        entity.remove::<ClothStats>();
    }
    world.resource_mut::<History>().bypass_change_detection().clear();
}

fn of_cloth(ui: &mut egui::Ui, stats: &ClothStats) {
    let mut line = |label, hint, text: String| widgets::reading(ui, label, hint, text);
    line("largest strain", "Largest strain of a thread.", format!("{:.2} %", 100.0 * stats.largest_strain));
    line("strain (rms)", "Root mean square over all threads.", format!("{:.3} %", 100.0 * stats.rms_strain));
    line("speed (rms)", "Root mean square over all particles.", format!("{:.3} m/s", stats.rms_speed));
    line("kinetic energy", "Energy of its motion.", format!("{:.4} J", stats.kinetic_energy));
    line("particles", "Particles of this cloth.", stats.particles.to_string());
    line("triangles", "Triangles of this cloth.", stats.triangles.to_string());
    line("constraints", "Constraints solved in each substep.", stats.constraints.to_string());
    line("contacts", "Particles that touch a solid.", stats.contacts.to_string());
    let substeps = if stats.asleep { "asleep".into() } else { stats.substeps.to_string() };
    line("substeps", "Substeps of the last tick.", substeps);
}

fn smoothed(world: &World, path: &DiagnosticPath) -> Option<f64> {
    world.get_resource::<DiagnosticsStore>()?.get(path)?.smoothed()
}

fn frame(ui: &mut egui::Ui, world: &World) {
    if let Some(fps) = smoothed(world, &FrameTimeDiagnosticsPlugin::FPS) {
        widgets::reading(ui, "frames", "Pictures in a second.", format!("{fps:.0} /s"));
    }
    if let Some(time) = smoothed(world, &FrameTimeDiagnosticsPlugin::FRAME_TIME) {
        widgets::reading(ui, "frame", "Time of one picture.", format!("{time:.2} ms"));
    }
}

/// Times of the phases, of all cloths together.
fn times(ui: &mut egui::Ui, world: &World) {
    let phases = PHASES.iter().filter_map(|(name, path, hint)| Some((*name, *hint, smoothed(world, path)?)));
    let phases: Vec<_> = phases.collect();
    let whole: f64 = phases.iter().map(|(.., time)| time).sum();
    for (name, hint, time) in phases {
        widgets::row(ui, name, hint, |ui| {
            let bar = egui::ProgressBar::new((time / whole.max(1e-9)) as f32).text(format!("{time:.2} ms"));
            let bar = bar.desired_height(14.0).corner_radius(2.0).desired_width(widgets::value_width(ui));
            ui.add(bar).on_hover_text(hint);
        });
    }
    if whole > 0.0 {
        widgets::reading(ui, "together", "All phases, for each frame.", format!("{whole:.2} ms"));
    }
}

#[cfg(test)]
mod tests {
    use bevy_cloth::Cloth;

    use super::*;

    #[test]
    fn a_cloth_is_measured_while_statistics_are_shown_and_no_longer() {
        let mut world = World::new();
        world.init_resource::<Measured>();
        world.init_resource::<History>();
        let [first, second] = [(); 2].map(|()| world.spawn(Cloth::default()).id());
        let own = world.spawn((Cloth::default(), ClothStats::default())).id();
        let measured = |world: &World| [first, second, own].map(|cloth| world.entity(cloth).contains::<ClothStats>());
        measure(&mut world, Some(first));
        assert_eq!(measured(&world), [true, false, true]);
        measure(&mut world, Some(second));
        assert_eq!(measured(&world), [false, true, true]);
        measure(&mut world, Some(own));
        stop(&mut world);
        assert_eq!(measured(&world), [false, false, true]);
    }
}
