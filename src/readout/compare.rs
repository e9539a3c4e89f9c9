//! Cloths of one scene compared: how far each is from the first, and what each costs.

use std::time::Instant;

use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, poll_once};
use bevy_cloth::{Cloth, ClothClock, ClothTopology, Particles};
use bevy_egui::{EguiContexts, egui};
use cloth_scene::{Scene, World as ScenePlay};
use egui_plot::{Legend, Line, Plot, PlotPoints};

use crate::scenes::{OfScene, Opened};

/// How long the curves are, s.
const SPAN: f64 = 12.0;
/// Ticks that are played to see what a cloth costs.
const TICKS: u32 = 60;

/// What is known of the cloths of the scene.
#[derive(Resource, Default)]
pub struct Compared {
    opened: f64,
    names: Vec<String>,
    /// For each cloth, times (s) and distances from the first (mm).
    curves: Vec<Vec<[f64; 2]>>,
    costs: Option<Task<Vec<f64>>>,
    /// Time of a tick of each, ms.
    cost: Vec<f64>,
}

/// Notes how far the cloths are apart, once a frame in which time passes.
pub fn note(
    mut compared: ResMut<Compared>,
    opened: Res<Opened>,
    clock: Res<Time<ClothClock>>,
    cloths: Query<(Entity, &Name, &ClothTopology, &Particles), (With<Cloth>, With<OfScene>)>,
) {
    if compared.opened != opened.at || compared.names.len() != opened.scene.cloths.len() {
        let names = opened.scene.cloths.iter().map(|cloth| cloth.name.clone()).collect::<Vec<_>>();
        let scene = opened.scene.clone();
        *compared = Compared {
            opened: opened.at,
            curves: vec![Vec::new(); names.len()],
            names,
            costs: Some(AsyncComputeTaskPool::get().spawn(async move { costs(&scene) })),
            cost: Vec::new(),
        };
    }
    if let Some(found) = compared.costs.as_mut().and_then(|task| block_on(poll_once(task))) {
        (compared.cost, compared.costs) = (found, None);
    }
    let time = clock.elapsed_secs_f64() - opened.at;
    let known = compared.curves.last().and_then(|curve| curve.last()).map_or(-1.0, |point| point[0]);
    let find = |name: &str| cloths.iter().find(|(_, known, ..)| known.as_str() == name);
    let Some((.., first)) = compared.names.first().and_then(|name| find(name)) else { return };
    if time <= known {
        return;
    }
    let apart: Vec<Option<f64>> = (compared.names.iter().skip(1))
        .map(|name| find(name).and_then(|(_, _, topology, other)| rms(topology, first, other)))
        .collect();
    for (curve, apart) in compared.curves.iter_mut().skip(1).zip(apart) {
        curve.extend(apart.map(|apart| [time, 1e3 * apart]));
        curve.retain(|point| point[0] > time - SPAN);
    }
}

/// Root of the mean square distance of the particles of two cloths of the same shape, each in its own frame, m.
fn rms(topology: &ClothTopology, first: &Particles, other: &Particles) -> Option<f64> {
    if first.mass.len() != other.mass.len() {
        return None;
    }
    let apart = |slot: u32| {
        let slot = slot as usize;
        f64::from(first.position.get(slot).distance_squared(other.position.get(slot)))
    };
    let (sum, count) = topology.particles().fold((0.0, 0), |(sum, count), slot| (sum + apart(slot), count + 1));
    (count > 0).then(|| (sum / f64::from(count)).sqrt())
}

/// The time of a tick of each cloth alone, ms: the mean of so many.
fn costs(scene: &Scene) -> Vec<f64> {
    let alone = |index: usize| {
        let scene = Scene { cloths: vec![scene.cloths[index].clone()], ..scene.clone() };
        let Ok(mut world) = ScenePlay::new(&scene) else { return f64::NAN };
        // From where it moves: a cloth that hangs still costs less.
        (0..TICKS).for_each(|_| world.tick());
        let begin = Instant::now();
        (0..TICKS).for_each(|_| world.tick());
        begin.elapsed().as_secs_f64() * 1e3 / f64::from(TICKS)
    };
    (0..scene.cloths.len()).map(alone).collect()
}

/// Shows curves and costs.
pub fn show(mut contexts: EguiContexts, compared: Res<Compared>) -> Result {
    let context = contexts.ctx_mut()?;
    let Some(first) = compared.names.first() else { return Ok(()) };
    egui::Window::new("Side by side")
        .anchor(egui::Align2::LEFT_TOP, [12.0, 52.0])
        .resizable(false)
        .title_bar(false)
        .show(context, |ui| {
            ui.label(format!("distance from “{first}”, mm (root mean square)"));
            let plot = Plot::new("apart").width(300.0).height(120.0).legend(Legend::default()).include_y(0.0);
            let plot = plot.allow_drag(false).allow_zoom(false).allow_scroll(false).x_axis_label("s");
            plot.show(ui, |plot| {
                for (name, curve) in compared.names.iter().zip(&compared.curves).skip(1) {
                    plot.line(Line::new(name.clone(), PlotPoints::from(curve.clone())));
                }
            });
            egui::Grid::new("costs").num_columns(2).show(ui, |ui| {
                for (index, name) in compared.names.iter().enumerate() {
                    ui.label(name);
                    match compared.cost.get(index) {
                        Some(cost) => ui.label(format!("{cost:.2} ms a tick")),
                        None => ui.weak("timing…"),
                    };
                    ui.end_row();
                }
            });
        });
    Ok(())
}
