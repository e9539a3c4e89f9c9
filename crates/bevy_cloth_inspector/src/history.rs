//! Curves of strain and energy over the last seconds.

use std::collections::VecDeque;

use bevy::prelude::*;
use bevy_cloth::ClothStats;
use bevy_egui::egui;
use egui_plot::{Line, Plot, PlotPoint, PlotPoints};

/// How long a curve is, s.
const SECONDS: f64 = 8.0;
/// Points of a curve at most; older ones go.
const POINTS: usize = 512;
/// Height of a graph, logical pixels.
const HEIGHT: f32 = 72.0;

const LARGEST: egui::Color32 = egui::Color32::from_rgb(235, 110, 90);
const MEAN: egui::Color32 = egui::Color32::from_rgb(105, 170, 240);
const ENERGY: egui::Color32 = egui::Color32::from_rgb(120, 200, 120);

/// Strain and energy of one cloth over the last seconds. It holds no more than a fixed number of points.
#[derive(Resource, Default)]
pub struct History {
    of: Option<Entity>,
    /// Largest and rms strain, %, and kinetic energy, J.
    curves: [VecDeque<PlotPoint>; 3],
}

impl History {
    /// Takes note of `stats` at the time `now` (s). Another cloth or a clock that was put back begins anew; while time stands nothing
    /// is noted.
    pub fn push(&mut self, of: Option<Entity>, now: f64, stats: &ClothStats) {
        let last = self.curves[0].back().map(|point| point.x);
        if self.of != of || last.is_some_and(|last| now < last) {
            self.clear();
            self.of = of;
        }
        if last == Some(now) && !self.curves[0].is_empty() {
            return;
        }
        let percent = |strain: f32| 100.0 * f64::from(strain);
        let values = [percent(stats.largest_strain), percent(stats.rms_strain), stats.kinetic_energy];
        for (curve, value) in self.curves.iter_mut().zip(values) {
            while curve.len() >= POINTS || curve.front().is_some_and(|point| point.x < now - SECONDS) {
                curve.pop_front();
            }
            curve.push_back(PlotPoint::new(now, value));
        }
    }

    /// Forgets all of it, memory included.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Draws both graphs.
    pub fn show(&mut self, ui: &mut egui::Ui) {
        let [largest, mean, energy] = &mut self.curves;
        title(ui, "strain, %", &[("largest", LARGEST), ("rms", MEAN)]);
        graph(ui, "strain", [(&*largest.make_contiguous(), LARGEST), (&*mean.make_contiguous(), MEAN)]);
        title(ui, "kinetic energy, J", &[]);
        graph(ui, "energy", [(&*energy.make_contiguous(), ENERGY)]);
    }
}

fn title(ui: &mut egui::Ui, text: &str, curves: &[(&str, egui::Color32)]) {
    ui.horizontal(|ui| {
        ui.label(text).on_hover_text(format!("The last {SECONDS:.0} s that were simulated."));
        for (name, color) in curves {
            ui.colored_label(*color, *name);
        }
    });
}

fn graph<const N: usize>(ui: &mut egui::Ui, name: &str, curves: [(&[PlotPoint], egui::Color32); N]) {
    let now = curves[0].0.last().map_or(0.0, |point| point.x);
    let plot = Plot::new(name)
        .height(HEIGHT)
        .show_axes([false, true])
        .show_grid([false, true])
        .y_axis_min_width(34.0)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_double_click_reset(false)
        .show_x(false)
        .include_x(now - SECONDS)
        .include_x(now)
        .include_y(0.0);
    plot.show(ui, |plot| {
        for (points, color) in curves {
            plot.line(Line::new("", PlotPoints::Borrowed(points)).color(color).width(1.5));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(history: &History) -> usize {
        assert!(history.curves.iter().all(|curve| curve.len() == history.curves[0].len()));
        history.curves[0].len()
    }

    #[test]
    fn a_curve_holds_the_last_seconds_and_no_more_however_fast_frames_are() {
        let (mut history, stats) = (History::default(), ClothStats::default());
        (0..6000).for_each(|frame| history.push(None, f64::from(frame) / 60.0, &stats));
        assert!((470..=490).contains(&length(&history)), "{}", length(&history));
        (0..6000).for_each(|frame| history.push(None, 100.0 + f64::from(frame) / 1000.0, &stats));
        assert_eq!(length(&history), POINTS);
    }

    #[test]
    fn while_time_stands_nothing_is_noted_and_another_cloth_begins_anew() {
        let (mut history, stats) = (History::default(), ClothStats::default());
        (0..10).for_each(|_| history.push(None, 1.0, &stats));
        assert_eq!(length(&history), 1);
        history.push(None, 2.0, &stats);
        history.push(Some(Entity::PLACEHOLDER), 3.0, &stats);
        assert_eq!(length(&history), 1);
        history.push(Some(Entity::PLACEHOLDER), 0.5, &stats);
        assert_eq!(length(&history), 1);
    }
}
