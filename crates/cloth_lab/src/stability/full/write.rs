//! The table of everything, and its map.

use std::fmt::Write as _;

use super::{ELSEWHERE, Part, Played};
use crate::LabError;
use crate::plot::{Axis, Figure, Look, MANY, Panel, Series, Stroke};
use crate::report::{Output, Table, header, number};

/// Most trials that did not hold which are told of each row.
const TOLD: usize = 12;

/// Writes `stability_full.md` and `stability_full.svg`.
///
/// # Errors
/// A file that could not be written.
pub fn write(played: &[Played], part: Part, seconds: f64, output: &Output) -> Result<(), LabError> {
    let panels: Vec<Panel> = played.iter().flat_map(panels).collect();
    if !panels.is_empty() {
        let figure = Figure { size: MANY, columns: 4, panels, ..Figure::default() };
        figure.write(&output.picture("stability_full")?)?;
    }
    output.write("stability_full.md", &markdown(played, part, seconds))
}

/// One panel for each kind of solid: speed across, and by what it failed or held.
fn panels(row: &Played) -> Vec<Panel> {
    let mut kinds: Vec<&'static str> =
        row.trials.iter().filter_map(|(_, place, _)| place.map(|(kind, _)| kind)).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let panel = |kind: &'static str| {
        let of = |held: bool| {
            let mine = row
                .trials
                .iter()
                .filter(move |(_, place, outcome)| place.is_some_and(|(of, _)| of == kind) && outcome.held == held);
            // Side by side, so that none covers another.
            let points = mine.filter_map(|(_, place, _)| *place).enumerate();
            points.map(|(index, (_, value))| (value, (index % 40) as f64 + if held { 0.0 } else { 45.0 })).collect()
        };
        let series = |label: &str, look, held| Series {
            label: label.into(),
            look: Look(look),
            stroke: Stroke::Points,
            points: of(held),
        };
        Panel {
            title: format!("row {}: {kind}", row.number),
            x: Axis::log("speed, m/s"),
            y: Axis::linear("trial").within(-2.0, 90.0),
            series: vec![series("held", 7, true), series("not held", 6, false)],
            ..Panel::default()
        }
    };
    kinds.into_iter().map(panel).collect()
}

fn markdown(played: &[Played], part: Part, seconds: f64) -> String {
    let mut text = header("Every scene of the stability plan");
    let all: usize = played.iter().map(|row| row.trials.len()).sum();
    let failed: usize = played.iter().map(Played::failed).sum();
    let _ = write!(
        text,
        "Played by the solver alone at its default budget (10 to 80 substeps in a sixtieth of a second) where nothing else is \
         said; size {} (the part of the random trials that is played: 1 is a thousand strikes of each shape, 300 random cloths, 240 strikes of row 33), {} s on all cores, which did other work \
         besides. {} of {all} trials hold. Numbers are those of the plan; a mesh is an irregular one.\n\n",
        part.value(),
        number(seconds, 3),
        all - failed,
    );
    let mut table = Table::new(["row", "scene", "must hold", "held", "time, s"]);
    for row in played {
        table.push([
            row.number.to_string(),
            row.scene.to_owned(),
            row.must.to_owned(),
            format!("{} of {}", row.trials.len() - row.failed(), row.trials.len()),
            number(row.time, 3),
        ]);
    }
    text += &table.markdown();
    text += "\nNot here, since it takes the plugin or another command:\n\n";
    let mut elsewhere = Table::new(["row", "where"]);
    ELSEWHERE.iter().for_each(|(row, place)| elsewhere.push([(*row).to_owned(), (*place).to_owned()]));
    text += &elsewhere.markdown();
    if played.iter().any(|row| row.trials.iter().any(|(_, place, _)| place.is_some())) {
        text += "\n## Where strikes do not hold\n\n![map](stability_full.svg)\n";
    }
    if failed > 0 {
        text += &failures(played);
    }
    text + "\n## Measured\n\nThe first trials of each row that hold.\n\n" + &measured(played)
}

fn failures(played: &[Played]) -> String {
    let mut text = format!("\n## Not held\n\nThe first {TOLD} of each row.\n\n");
    let mut table = Table::new(["row", "at", "measured"]);
    for row in played {
        for (at, _, outcome) in row.trials.iter().filter(|(_, _, outcome)| !outcome.held).take(TOLD) {
            table.push([row.number.to_string(), at.clone(), outcome.measured.clone()]);
        }
    }
    text += &table.markdown();
    text
}

fn measured(played: &[Played]) -> String {
    let mut table = Table::new(["row", "at", "measured"]);
    for row in played {
        for (at, _, outcome) in row.trials.iter().filter(|(_, _, outcome)| outcome.held).take(TOLD) {
            table.push([row.number.to_string(), at.clone(), outcome.measured.clone()]);
        }
    }
    table.markdown()
}
