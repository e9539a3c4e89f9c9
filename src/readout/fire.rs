//! How fire spreads over each cloth: since when it burns, how far it is charred, how fast that grows.

use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothClock, ClothFire, ClothTopology};
use bevy_egui::{EguiContexts, egui};
use cloth_scene::SceneCloth;

use crate::scenes::{OfScene, Opened};

/// What is charred this far counts as burnt.
const CHARRED: f32 = 0.5;
/// The length that 16 CFR 1610 takes the time of, m.
const GAUGE: f32 = 0.127;
/// The speed is a mean over this time, s.
const OVER: f64 = 1.0;

/// What is known of the fire on each cloth.
#[derive(Resource, Default)]
pub struct Burnt {
    opened: f64,
    cloths: HashMap<Entity, Course>,
}

/// The course of one fire.
#[derive(Default)]
struct Course {
    name: String,
    /// When the first flame was seen, s of the scene.
    since: Option<f64>,
    out: Option<f64>,
    /// Times, s, and how far it was charred then, m.
    reached: Vec<(f64, f32)>,
    gauge: Option<f64>,
}

/// Notes how far each fire has come.
pub fn note(
    mut burnt: ResMut<Burnt>,
    opened: Res<Opened>,
    clock: Res<Time<ClothClock>>,
    cloths: Query<(Entity, &Name, &ClothTopology, &ClothFire), (With<Cloth>, With<OfScene>)>,
) {
    if burnt.opened != opened.at {
        *burnt = Burnt { opened: opened.at, ..default() };
    }
    let time = clock.elapsed_secs_f64() - opened.at;
    burnt.cloths.retain(|entity, _| cloths.contains(*entity));
    for (entity, name, topology, fire) in &cloths {
        let course = burnt.cloths.entry(entity).or_default();
        if course.name.is_empty() {
            course.name = name.as_str().to_owned();
        }
        if course.reached.last().is_some_and(|(known, _)| *known >= time) {
            continue;
        }
        if fire.flaming() > 0 {
            course.since.get_or_insert(time);
            course.out = None;
        } else if course.since.is_some() {
            course.out.get_or_insert(time);
        }
        let spec = opened.scene.cloths.iter().find(|spec| spec.name == name.as_str());
        let far =
            course.reached.last().map_or(0.0, |(_, far)| *far).max(spec.map_or(0.0, |spec| far(spec, topology, fire)));
        if let Some(since) = course.since.filter(|_| far >= GAUGE) {
            course.gauge.get_or_insert(time - since);
        }
        course.reached.push((time, far));
    }
}

/// How far from where it was lit a cloth is charred, m.
fn far(spec: &SceneCloth, topology: &ClothTopology, fire: &ClothFire) -> f32 {
    let lit = spec.fire.iter().flat_map(|fire| &fire.lit);
    let lit: Vec<Vec2> = lit.map(|part| (*part - 0.5) * spec.size * Vec2::new(1.0, -1.0)).collect();
    let from = |slot: usize| {
        let at = topology.rest.get(slot).map_or(Vec2::ZERO, |rest| rest.truncate());
        // Along the strip: how far it crept aside is no matter.
        lit.iter().map(|lit| (at - lit).y.abs()).fold(f32::INFINITY, f32::min)
    };
    let charred = fire.char().iter().enumerate().filter(|(_, char)| **char > CHARRED);
    charred.map(|(slot, _)| from(slot)).filter(|far| far.is_finite()).fold(0.0, f32::max)
}

/// Shows the courses as a table.
pub fn show(mut contexts: EguiContexts, burnt: Res<Burnt>) -> Result {
    let context = contexts.ctx_mut()?;
    let mut courses: Vec<&Course> = burnt.cloths.values().collect();
    courses.sort_unstable_by(|a, b| a.name.cmp(&b.name));
    egui::Window::new("Fire").anchor(egui::Align2::LEFT_TOP, [12.0, 52.0]).resizable(false).title_bar(false).show(
        context,
        |ui| {
            egui::Grid::new("fires").num_columns(5).striped(true).spacing([14.0, 4.0]).show(ui, |ui| {
                for head in ["", "burns for", "charred", "speed", "5 in (127 mm)"] {
                    ui.weak(head);
                }
                ui.end_row();
                for course in courses {
                    let now = course.reached.last().copied().unwrap_or_default();
                    ui.label(&course.name);
                    let end = course.out.unwrap_or(now.0);
                    ui.monospace(course.since.map_or("–".into(), |since| format!("{:5.1} s", end - since)));
                    ui.monospace(format!("{:4.0} mm", 1e3 * now.1));
                    let before = course.reached.iter().rev().find(|(time, _)| *time <= now.0 - OVER);
                    let speed = before.map(|(time, far)| f64::from(now.1 - far) / (now.0 - time));
                    ui.monospace(speed.map_or("–".into(), |speed| format!("{:4.0} mm/s", 1e3 * speed)));
                    ui.monospace(course.gauge.map_or("–".into(), |after| format!("{after:5.1} s")));
                    ui.end_row();
                }
            });
        },
    );
    Ok(())
}
