//! What all clothes share: the clock, gravity, method, substeps, colouring.

use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothClock, ClothColoring, ClothTime, Gravity, Method, ResetCloth, Substeps};
use bevy_egui::egui;

use crate::widgets::{self, Unit, Value, edit_own_or_shared};

/// Slowest and fastest motion that can be chosen.
const SPEEDS: std::ops::RangeInclusive<f32> = 0.02..=1.0;

/// Shows the clock: pause, step, slow motion, reset.
pub fn clock(ui: &mut egui::Ui, world: &mut World) {
    let Some(mut clock) = world.get_resource_mut::<Time<ClothClock>>() else { return };
    let mut reset = false;
    ui.horizontal_wrapped(|ui| {
        let paused = clock.is_paused();
        let button = ui.button(if paused { "▶ go on" } else { "⏸ pause" });
        if button.on_hover_text("Stops and starts the simulation.").clicked() {
            if paused { clock.unpause() } else { clock.pause() }
        }
        if ui.button("⏭ step").on_hover_text("One tick, then pause.").clicked() {
            clock.pause();
            clock.step_once();
        }
        reset = ui.button("⟲ reset").on_hover_text("All cloth back to its rest pose.").clicked();
        ui.label(format!("{:.2} s", clock.elapsed_secs())).on_hover_text("Time simulated.");
    });
    let mut speed = clock.relative_speed();
    let hint = "Slow motion: it runs fewer ticks, never shorter ones.";
    if Value::new("speed", hint, Unit::PERCENT, SPEEDS).show(ui, &mut speed, 1.0) {
        clock.set_relative_speed(speed);
    }
    if reset {
        let clothes: Vec<Entity> = world.query_filtered::<Entity, With<Cloth>>().iter(world).collect();
        for entity in clothes {
            world.trigger(ResetCloth { entity });
        }
    }
}

/// Shows the shared settings, or those that `cloth` has of its own.
pub fn settings(ui: &mut egui::Ui, world: &mut World, cloth: Option<Entity>) {
    edit_own_or_shared(world, cloth, |gravity: &mut Gravity| {
        let row = Value::new("gravity", "Along x, y and z.", Unit::METRES_PER_SECOND_SQUARED, -1e4..=1e4);
        row.show_vec3(ui, &mut gravity.0, Gravity::default().0);
    });
    let mut iterates = false;
    edit_own_or_shared(world, cloth, |method: &mut Method| {
        let hint = "How the cloth is advanced in time.";
        let methods = Method::ALL.into_iter().map(|method| (method, label(method)));
        widgets::choice(ui, "method", hint, method, Method::default(), methods);
        iterates = method.iterates();
    });
    edit_own_or_shared(world, cloth, |substeps: &mut Substeps| {
        let default = Substeps::default();
        let hint = "Substeps of a quiet tick: more of them resolve faster motion.";
        Value::new("substeps", hint, Unit::NONE, 1.0..=200.0).show_count(ui, &mut substeps.count, default.count);
        let hint = "Most substeps of a tick; load and fast motion ask for more than a quiet tick takes.";
        Value::new("at most", hint, Unit::NONE, 1.0..=200.0).show_count(ui, &mut substeps.max, default.max);
        if iterates {
            let row = Value::new("iterations", "Iterations in each substep.", Unit::NONE, 1.0..=100.0);
            row.show_count(ui, &mut substeps.iterations, default.iterations);
        }
    });
    edit_own_or_shared(world, cloth, |coloring: &mut ClothColoring| {
        let hint = "What the colour of the cloth shows.";
        let colorings = ClothColoring::ALL.into_iter().map(|coloring| (coloring, coloring_label(coloring)));
        widgets::choice(ui, "colours", hint, coloring, ClothColoring::default(), colorings);
    });
}

fn coloring_label(coloring: ClothColoring) -> &'static str {
    match coloring {
        ClothColoring::Material => "material",
        ClothColoring::Stress => "stress",
        ClothColoring::Strain => "strain",
        ClothColoring::Temperature => "temperature",
        ClothColoring::Speed => "speed",
        ClothColoring::Contact => "contact",
    }
}

/// A method's name in print.
fn label(method: Method) -> &'static str {
    match method {
        Method::ExplicitEuler => "explicit Euler",
        Method::SymplecticEuler => "symplectic Euler",
        Method::StormerVerlet => "Störmer–Verlet",
        Method::RungeKutta4 => "Runge–Kutta 4",
        Method::Pbd => "PBD",
        Method::XpbdSweeps => "XPBD, sweeps",
        Method::XpbdLines => "XPBD, lines",
    }
}
