//! What all clothes share: the clock, gravity, method, substeps, colouring.

use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothClock, ClothColoring, ClothTime, Gravity, Method, ResetCloth, Shared, Substeps};
use bevy_egui::egui;

use crate::widgets::{self, Unit};

/// Slowest motion the slider offers.
const SLOWEST: f32 = 0.02;
const METRE_PER_SECOND_SQUARED: Unit = Unit::new("m/s²", 1.0, 0.02);

/// Shows the clock: pause, step, slow motion, reset.
pub fn clock(ui: &mut egui::Ui, world: &mut World) {
    let Some(mut clock) = world.get_resource_mut::<Time<ClothClock>>() else { return };
    let mut reset = false;
    ui.horizontal(|ui| {
        let paused = clock.is_paused();
        if ui.button(if paused { "▶ go on" } else { "⏸ pause" }).clicked() {
            if paused { clock.unpause() } else { clock.pause() }
        }
        if ui.button("⏭ step").on_hover_text("One tick, then pause.").clicked() {
            clock.pause();
            clock.step_once();
        }
        reset = ui.button("⟲ reset").on_hover_text("All cloth back to its rest pose.").clicked();
        ui.label(format!("{:.2} s", clock.elapsed_secs()));
    });
    let mut speed = clock.relative_speed();
    let slider = egui::Slider::new(&mut speed, SLOWEST..=1.0)
        .logarithmic(true)
        .clamping(egui::SliderClamping::Edits)
        .text("speed");
    if ui.add(slider).on_hover_text("Slow motion runs fewer ticks, never shorter ones.").changed() {
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
    widgets::rows(ui, "world", |ui| {
        edit_own_or_shared(world, cloth, |gravity: &mut Gravity| {
            widgets::row(ui, "gravity", "m/s², along x, y and z.", |ui| {
                widgets::numbers(ui, gravity.0.as_mut(), Unit { name: "", ..METRE_PER_SECOND_SQUARED });
            });
        });
        let mut iterates = false;
        edit_own_or_shared(world, cloth, |method: &mut Method| {
            widgets::row(ui, "method", "How the cloth is advanced in time.", |ui| choose(ui, method));
            iterates = method.iterates();
        });
        edit_own_or_shared(world, cloth, |substeps: &mut Substeps| {
            widgets::row(ui, "substeps", "In a quiet tick: the budget that buys stiffness.", |ui| {
                ui.add(egui::DragValue::new(&mut substeps.count).speed(0.1));
            });
            widgets::row(ui, "at most", "The solver may take more under load, up to this.", |ui| {
                ui.add(egui::DragValue::new(&mut substeps.max).speed(0.1));
            });
            if iterates {
                widgets::row(ui, "iterations", "In each substep.", |ui| {
                    ui.add(egui::DragValue::new(&mut substeps.iterations).speed(0.05));
                });
            }
        });
        edit_own_or_shared(world, cloth, |coloring: &mut ClothColoring| {
            widgets::row(ui, "colours", "", |ui| {
                let name = |coloring: ClothColoring| format!("{coloring:?}").to_lowercase();
                egui::ComboBox::from_id_salt("colours").selected_text(name(*coloring)).width(150.0).show_ui(ui, |ui| {
                    for choice in ClothColoring::ALL {
                        ui.selectable_value(coloring, choice, name(choice));
                    }
                });
            });
        });
    });
}

fn choose(ui: &mut egui::Ui, method: &mut Method) {
    egui::ComboBox::from_id_salt("method").selected_text(label(*method)).width(150.0).show_ui(ui, |ui| {
        for choice in Method::ALL {
            ui.selectable_value(method, choice, label(choice));
        }
    });
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

/// Edits the component of `cloth` if it has one, else the resource shared by all.
pub fn edit_own_or_shared<C>(world: &mut World, cloth: Option<Entity>, change: impl FnOnce(&mut C))
where
    C: Component<Mutability = bevy::ecs::component::Mutable> + Clone + PartialEq + Default + std::fmt::Debug,
    Shared<C>: Resource<Mutability = bevy::ecs::component::Mutable>,
{
    match cloth.filter(|entity| world.entity(*entity).contains::<C>()) {
        Some(entity) => widgets::edit(world, entity, change),
        None => widgets::edit_resource(world, |shared: &mut Shared<C>| change(&mut shared.0)),
    }
}
