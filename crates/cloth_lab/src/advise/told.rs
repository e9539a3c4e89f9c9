//! The advice in words and tables.

use std::path::Path;

use cloth_scene::Scene;
use cloth_solver::Method;

use super::laws::Prediction;
use super::model::{Change, Lever, highest_frequency};
use super::play::{By, End};
use super::search::{Cheapest, Full, Measured, Settings};
use crate::report::{Table, header, number};

/// Everything that was found.
pub struct Found<'a> {
    /// The scene's file.
    pub file: &'a Path,
    /// The scene as it is in the file.
    pub scene: &'a Scene,
    /// How the search went about.
    pub settings: Settings,
    /// The full model.
    pub full: &'a Full,
    /// Every cheaper model.
    pub ladder: &'a [Measured],
    /// The cheapest.
    pub cheapest: &'a Cheapest,
    /// What the dimensionless numbers say.
    pub predictions: &'a [Prediction],
}

impl Found<'_> {
    /// All of it, as Markdown.
    pub fn markdown(&self) -> String {
        let mut text = header(&format!("Advice on {}", self.file.display()));
        if !self.scene.about.is_empty() {
            text += &format!("{}\n\n", self.scene.about);
        }
        text += &self.basis();
        text += "\n## What the numbers of the scene say, and what was measured\n\n";
        text += &self.expected().markdown();
        text += "\n## Parts of the model\n\n";
        text += &self.rows(|lever| matches!(lever, Lever::Part(_))).markdown();
        text += "\n## Mesh and budget\n\n";
        text += &self.rows(|lever| !matches!(lever, Lever::Part(_))).markdown();
        text += &self.left_out();
        text += "\n## The cheapest model within it\n\n";
        text += &self.recommendation();
        text
    }

    fn basis(&self) -> String {
        let (full, scene) = (self.full, &self.full.scene);
        let by = match full.by {
            By::Path => "Compared is the shape at ten moments over the last half of the scene.".to_owned(),
            By::End => format!(
                "The motion is not determined to the tolerance: with twice the substeps the full model is {} away from \
                 itself on the way. Compared is therefore the end, at rest after {} s.",
                mm(full.path.most),
                scene.seconds
            ),
            By::Mean => format!(
                "The motion is chaotic: with twice the substeps the full model is {} away from itself. Compared is \
                 therefore the mean shape over the last half of the scene.",
                mm(full.path.most)
            ),
        };
        let bar = if full.bar > self.settings.tolerance {
            format!(
                " Even so it is {} away from itself: a change up to that cannot be told from none and counts as none.",
                mm(full.own.most)
            )
        } else {
            format!(" With twice the substeps the full model is {} away from itself.", mm(full.own.most))
        };
        format!(
            "Full model: {}, {} ms a tick of 1/{} s (median; fastest {}), largest strain {} %. Tolerance {}: no material \
             point may be farther than that from where the full model has it. {by}{bar}\n",
            Change::Budget { method: scene.method, substeps: scene.substeps, iterations: scene.iterations }.name(),
            number(full.recording.median, 3),
            scene.rate,
            number(full.recording.least, 3),
            number(f64::from(100.0 * full.recording.largest_strain), 2),
            mm(self.settings.tolerance),
        )
    }

    fn expected(&self) -> Table {
        let mut table = Table::new(["model", "number", "rule", "predicted", "measured"]);
        let word = |needed: bool| if needed { "needed" } else { "can go" }.to_owned();
        for prediction in self.predictions {
            let measured = self.ladder.iter().find(|measured| Some(&measured.change) == prediction.change.as_ref());
            let measured = match (measured, &prediction.change) {
                (Some(measured), _) => word(!self.full.within(measured.difference)),
                (None, Some(_)) => "not tried".into(),
                (None, None) => prediction.instead.into(),
            };
            let entries = [prediction.about.into(), prediction.value.clone(), prediction.rule.into()];
            table.push(entries.into_iter().chain([word(prediction.needed), measured]));
        }
        table
    }

    fn rows(&self, wanted: impl Fn(Lever) -> bool) -> Table {
        let mut table = Table::new(["without, or with", "farthest point", "rms", "ms with", "ms without", "verdict"]);
        for measured in self.ladder.iter().filter(|measured| wanted(measured.change.lever())) {
            let within = self.full.within(measured.difference);
            let is_part = matches!(measured.change.lever(), Lever::Part(_));
            let verdict = match (measured.end, within, is_part) {
                (End::Exploded, ..) => "explodes",
                (End::TooSlow, ..) => "too slow",
                (End::Finished, true, true) if measured.change == Change::Inextensible => {
                    "can go: they pass for inextensible"
                }
                (End::Finished, true, true) => "can go",
                (End::Finished, true, false) => "enough",
                (End::Finished, false, true) => "needed",
                (End::Finished, false, false) => "not enough",
            };
            let doubt = if within && measured.difference.most > self.settings.tolerance {
                ", as far as can be told"
            } else {
                ""
            };
            table.push([
                if is_part { format!("no {}", measured.change.name()) } else { measured.change.name() },
                mm(measured.difference.most),
                mm(measured.difference.rms),
                number(self.full.recording.median, 3),
                number(measured.median, 3),
                format!("{verdict}{doubt}"),
            ]);
        }
        table
    }

    /// The methods that were not tried, and why.
    fn left_out(&self) -> String {
        let is_tried = |method: &Method| {
            *method == self.full.scene.method
                || self
                    .ladder
                    .iter()
                    .any(|m| matches!(m.change, Change::Budget { method: tried, .. } if tried == *method))
        };
        let names: Vec<&str> =
            Method::ALL.iter().filter(|method| !is_tried(method)).map(|method| method.name()).collect();
        if names.is_empty() {
            return String::new();
        }
        let substeps = highest_frequency(&self.full.scene) / (2.0 * self.full.scene.rate);
        format!(
            "\nNot tried: {}. Explicit Euler gains energy at every step length; for the others this mesh and fabric take \
             some {} substeps a tick to be stable.\n",
            names.join(", "),
            number(f64::from(substeps), 2)
        )
    }

    fn recommendation(&self) -> String {
        let cheapest = self.cheapest;
        if cheapest.changes.is_empty() {
            return "The full model: nothing can go.\n".into();
        }
        let mut text = String::new();
        for change in &cheapest.changes {
            text += &match change.lever() {
                Lever::Part(_) => format!("- no {}\n", change.name()),
                _ => format!("- {}\n", change.name()),
            };
        }
        text + &format!(
            "\nPlayed together: {} ms a tick in place of {} ({} times faster), farthest point {} away, rms {}.\n",
            number(cheapest.recording.median, 3),
            number(self.full.recording.median, 3),
            number(self.full.recording.median / cheapest.recording.median.max(1e-9), 3),
            mm(cheapest.difference.most),
            mm(cheapest.difference.rms),
        )
    }
}

fn mm(metres: f64) -> String {
    if metres.is_finite() { format!("{} mm", number(1e3 * metres, 2)) } else { "–".into() }
}
