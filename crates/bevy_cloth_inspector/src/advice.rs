//! What could be left out of the cloth that is shown: a copy of it is played in the background, with and without each part.

use std::sync::Arc;

use bevy::prelude::*;
use bevy::tasks::futures::check_ready;
use bevy::tasks::{AsyncComputeTaskPool, Task};
use bevy_cloth::{ClothSnapshot, Grabs};
use bevy_egui::egui;
use cloth_advice::{Progress, Report, Sample, Settings, advise};

use crate::tried::Tried;
use crate::widgets::{self, Unit, Value};

/// How the cloth is advised by default.
const DEFAULT: Settings = Settings { tolerance: 0.01, seconds: 2.0 };

/// A cloth has taken a change over after so long, s: a few frames.
const SETTLES: f64 = 0.3;

/// What the adviser is at.
#[derive(Resource)]
pub struct Adviser {
    settings: Settings,
    /// The cloth that is advised.
    of: Option<Entity>,
    running: Option<Running>,
    report: Option<Report>,
    /// What the user tries, the last at the end.
    tried: Vec<(Entity, Tried)>,
    /// It is not looked at before this time of egui's clock, s.
    not_before: f64,
}

struct Running {
    task: Task<Option<Report>>,
    progress: Arc<Progress>,
}

impl Drop for Running {
    /// A play that nobody waits for ends at its next tick.
    fn drop(&mut self) {
        self.progress.stop();
    }
}

impl Default for Adviser {
    fn default() -> Self {
        Self { settings: DEFAULT, of: None, running: None, report: None, tried: Vec::new(), not_before: 0.0 }
    }
}

/// Shows what could be left out of `cloth`. It is looked at when the section is opened, when another cloth is shown, and when the
/// user asks for it.
pub fn show(ui: &mut egui::Ui, world: &mut World, cloth: Entity) {
    world.resource_scope(|world, mut adviser: Mut<Adviser>| {
        let adviser = adviser.bypass_change_detection();
        adviser.tried.retain(|(entity, _)| world.get_entity(*entity).is_ok());
        if adviser.of != Some(cloth) && ui.input(|input| input.time) >= adviser.not_before {
            adviser.look(world, cloth);
        }
        adviser.listen();
        adviser.options(ui);
        adviser.state(ui, world, cloth);
        adviser.advice(ui, world, cloth);
        adviser.taken_out(ui, world);
    });
}

/// Stops what is played; it is looked at anew when the section is opened again.
pub fn stop(world: &mut World) {
    let mut adviser = world.resource_mut::<Adviser>();
    let adviser = adviser.bypass_change_detection();
    (adviser.of, adviser.running, adviser.report) = (None, None, None);
}

impl Adviser {
    /// Has a copy of `cloth` played, as it is now.
    fn look(&mut self, world: &World, cloth: Entity) {
        (self.of, self.running) = (None, None);
        if world.get::<Grabs>(cloth).is_some_and(|grabs| !grabs.0.is_empty()) {
            return;
        }
        let Some(copy) = ClothSnapshot::take(world, cloth) else { return };
        self.of = Some(cloth);
        let Some(pool) = AsyncComputeTaskPool::try_get() else { return };
        let ClothSnapshot { cloth, fabric, gravity, tick, tearing } = copy;
        let sample = Sample { cloth, fabric, gravity, tick, tearing };
        let (settings, progress) = (self.settings, Arc::new(Progress::default()));
        let told = progress.clone();
        let task = pool.spawn(async move { advise(&sample, settings, &told) });
        self.running = Some(Running { task, progress });
    }

    /// Takes the report, if there is one by now.
    fn listen(&mut self) {
        let done = self.running.as_mut().and_then(|running| check_ready(&mut running.task));
        if let Some(report) = done {
            (self.running, self.report) = (None, report);
        }
    }

    fn options(&mut self, ui: &mut egui::Ui) {
        let mut tolerance = self.settings.tolerance as f32;
        let hint = "Up to this distance of a point of the cloth two shapes count as the same.";
        if Value::new("tolerance", hint, Unit::MILLIMETRES, 1e-4..=1.0).show(
            ui,
            &mut tolerance,
            DEFAULT.tolerance as f32,
        ) {
            self.settings.tolerance = f64::from(tolerance);
        }
        let hint = "How long a copy of the cloth is played with and without each part.";
        Value::new("played for", hint, Unit::SECONDS, 0.1..=20.0).show(ui, &mut self.settings.seconds, DEFAULT.seconds);
    }

    /// What is going on, and the button to have it looked at once more.
    fn state(&mut self, ui: &mut egui::Ui, world: &World, cloth: Entity) {
        let part = self.running.as_ref().map(|running| running.progress.part());
        ui.horizontal(|ui| match part {
            Some(part) => {
                if ui.button("stop").on_hover_text("Stops playing; what was found before stays.").clicked() {
                    self.running = None;
                }
                let width = widgets::value_width(ui);
                ui.add(egui::ProgressBar::new(part).desired_height(14.0).corner_radius(2.0).desired_width(width));
                ui.ctx().request_repaint();
            }
            None => {
                let hint = "Plays a copy of the cloth as it is now, in the background.";
                if ui.button("look again").on_hover_text(hint).clicked() {
                    self.look(world, cloth);
                }
            }
        });
        if self.of.is_none() {
            widgets::note(ui, "A cloth that is held, refused or not there yet is not looked at.");
        }
    }

    fn advice(&mut self, ui: &mut egui::Ui, world: &mut World, cloth: Entity) {
        let Some(report) = &self.report else { return };
        widgets::note(ui, &report.basis());
        let mut wanted = None;
        for advice in report.advice.iter().filter(|advice| advice.can_go) {
            ui.separator();
            ui.add(egui::Label::new(advice.to_string()).wrap());
            if ui.button("try it").on_hover_text(Tried::hint(&advice.change)).clicked() {
                wanted = Some(advice.change.clone());
            }
        }
        let needed: Vec<_> = report.advice.iter().filter(|advice| !advice.can_go).collect();
        if !needed.is_empty() {
            ui.separator();
            ui.label("Needed:");
            needed.into_iter().for_each(|advice| widgets::note(ui, &advice.to_string()));
        }
        if let Some(tried) = wanted.and_then(|change| Tried::apply(world, cloth, &change)) {
            self.tried.push((cloth, tried));
            self.look_later(ui);
        }
    }

    /// What is tried, and the way back.
    fn taken_out(&mut self, ui: &mut egui::Ui, world: &mut World) {
        if self.tried.is_empty() {
            return;
        }
        ui.separator();
        ui.label("Tried:");
        let mut back = None;
        for (index, (_, tried)) in self.tried.iter().enumerate() {
            ui.horizontal_wrapped(|ui| {
                if ui.button("⟲ take back").on_hover_text("As it was before.").clicked() {
                    back = Some(index);
                }
                ui.label(&tried.name);
            });
        }
        if let Some(index) = back {
            let (entity, tried) = self.tried.remove(index);
            tried.take_back(world, entity);
            self.look_later(ui);
        }
    }

    /// Looks at the cloth anew once it has taken a change over.
    fn look_later(&mut self, ui: &egui::Ui) {
        (self.of, self.running, self.report) = (None, None, None);
        self.not_before = ui.input(|input| input.time) + SETTLES;
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use bevy::time::TimeUpdateStrategy;
    use bevy_cloth::{Air, Cloth, ClothPlugin, Pins};

    use super::*;

    #[test]
    fn a_copy_of_the_cloth_is_played_in_the_background_and_the_cloth_is_left_alone() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, ClothPlugin::default())).init_resource::<Adviser>();
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_micros(15625)));
        let curtain = (Cloth::rectangle(0.4, 0.4).with_cells(8, 8), Pins::rods(2), Air::default());
        let cloth = app.world_mut().spawn(curtain).id();
        (0..3).for_each(|_| app.update());
        app.world_mut().resource_mut::<Adviser>().settings.seconds = 0.1;
        let before = app.world().get::<Cloth>(cloth).cloned();
        let draw = |world: &mut World| {
            let _ = egui::Context::default().run_ui(egui::RawInput::default(), |ui| show(ui, world, cloth));
        };
        for _ in 0..2000 {
            draw(app.world_mut());
            if app.world().resource::<Adviser>().report.is_some() {
                break;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        let report = app.world().resource::<Adviser>().report.clone().expect("it ends");
        assert!(report.advice.iter().any(|advice| advice.change == cloth_advice::Change::NoAir), "{report:?}");
        assert_eq!(app.world().get::<Cloth>(cloth).cloned(), before);
        stop(app.world_mut());
        assert!(app.world().resource::<Adviser>().report.is_none());
    }
}
