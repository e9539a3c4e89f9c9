//! The random cloths as CSV, picture and Markdown.

use crate::LabError;
use crate::plot::{Axis, Figure, Look, MANY, Panel, Series, Stroke};
use crate::report::{Output, Table, header, number};

use super::{Entry, Held, MOST_CELLS};

/// Bounds of the groups by columns: powers of two.
const COLUMNS: [u32; 7] = [1, 2, 4, 8, 16, 32, 65];
/// Names of the groups by the ratio of a cell's sides, each a factor of two.
const ASPECTS: [&str; 6] = ["1:8 – 1:4", "1:4 – 1:2", "1:2 – 1:1", "1:1 – 2:1", "2:1 – 4:1", "4:1 – 8:1"];

/// Writes `stability_random.csv`, `.md` and the picture.
///
/// # Errors
/// A file that could not be written.
pub fn write(entries: &[Entry], output: &Output) -> Result<(), LabError> {
    output.write("stability_random.csv", &table(entries.iter()).csv())?;
    figure(entries).write(&output.picture("stability_random")?)?;
    output.write("stability_random.md", &markdown(entries))
}

/// One row for each cloth.
fn table<'a>(entries: impl Iterator<Item = &'a Entry>) -> Table {
    let mut table = Table::new([
        "seed",
        "fabric",
        "kind",
        "cells",
        "size, m",
        "held by",
        "at rest",
        "rms speed, m/s",
        "without rigid motion, m/s",
        "largest strain, %",
        "substeps",
        "substeps at the end",
        "time, s",
    ]);
    for Entry { sample, seen } in entries {
        let told = |value: f64| if seen.finite { number(value, 3) } else { "not finite".into() };
        table.push([
            sample.seed.to_string(),
            sample.preset.to_owned(),
            if sample.mesh { "mesh" } else { "grid" }.to_owned(),
            format!("{} × {}", sample.cells.x, sample.cells.y),
            format!("{} × {}", number(f64::from(sample.size.x), 3), number(f64::from(sample.size.y), 3)),
            sample.held.name().to_owned(),
            if seen.rests() { "yes" } else { "no" }.to_owned(),
            told(seen.speed),
            told(seen.inner_speed),
            told(100.0 * seen.strain),
            number(seen.substeps[0], 3),
            told(seen.substeps[1]),
            number(seen.time, 2),
        ]);
    }
    table
}

/// How many of those chosen are at rest, of how many.
fn share(entries: &[Entry], chosen: impl Fn(&Entry) -> bool) -> String {
    let chosen: Vec<&Entry> = entries.iter().filter(|entry| chosen(entry)).collect();
    let rest = chosen.iter().filter(|entry| entry.seen.rests()).count();
    match chosen.len() {
        0 => "–".into(),
        all => format!("{} % ({rest} of {all})", number(100.0 * rest as f64 / all as f64, 3)),
    }
}

/// A name for each group and the shares at rest in it: of grids, of meshes, of all.
fn shares<T>(entries: &[Entry], title: &str, groups: &[(String, T)], belongs: impl Fn(&Entry, &T) -> bool) -> String {
    let mut table = Table::new([title, "grids", "meshes", "all"]);
    for (name, group) in groups {
        table.push([
            name.clone(),
            share(entries, |entry| !entry.sample.mesh && belongs(entry, group)),
            share(entries, |entry| entry.sample.mesh && belongs(entry, group)),
            share(entries, |entry| belongs(entry, group)),
        ]);
    }
    table.markdown() + "\n"
}

fn markdown(entries: &[Entry]) -> String {
    let mut text = header("Random cloths");
    text += &format!(
        "Each cloth is drawn from its seed: one of the presets; 1 to 64 columns and rows, {MOST_CELLS} cells at most; 5 cm to \
         3 m wide and high, cells between 1:8 and 8:1 (width to height); held by its top, two corners, one corner, its side, or \
         laid on a ball that stands on the ground, its radius a quarter of the larger side. Odd seeds are irregular meshes, whose \
         corners lie up to a quarter of a cell off. It starts upright (hung by one corner, with its middle below that; on the ball \
         level), a thousandth of its size out of its plane, in still air, with the damping of its fabric, and is played for 20 s at \
         60 Hz at the default tick. It is at rest if its rms speed stays below 0.03 m/s for the last half second. A swing as a whole \
         fades by the air alone: what is left without rigid motion is told beside. `--random 1 --seed S` plays cloth S alone.\n\n\
         ![map](stability_random.svg)\n\n## Shares at rest\n\n"
    );
    text += &shares(entries, "", &[("all".into(), ())], |_, ()| true);
    let mut presets: Vec<(String, &str)> = Vec::new();
    for (name, _) in cloth_solver::Fabric::PRESETS {
        presets.push(((*name).to_owned(), *name));
    }
    text += &shares(entries, "fabric", &presets, |entry, name| entry.sample.preset == *name);
    let held: Vec<_> = Held::ALL.iter().map(|held| (held.name().to_owned(), *held)).collect();
    text += &shares(entries, "held by", &held, |entry, held| entry.sample.held == *held);
    let aspects: Vec<_> = ASPECTS.iter().enumerate().map(|(i, name)| ((*name).to_owned(), i as f64)).collect();
    let group = |aspect: f64| (aspect.log2() + 3.0).floor().clamp(0.0, 5.0);
    text += &shares(entries, "cell, width : height", &aspects, |entry, i| group(entry.sample.aspect()) == *i);
    for (title, index) in [("columns", 0), ("rows", 1)] {
        let counts: Vec<_> = (COLUMNS.windows(2))
            .map(|ends| (ends[0], ends[1]))
            .map(|(low, high)| {
                (if high == low + 1 { low.to_string() } else { format!("{low} – {}", high - 1) }, low..high)
            })
            .collect();
        text += &shares(entries, title, &counts, |entry, range| range.contains(&entry.sample.cells[index]));
    }
    text += "## Not at rest\n\n";
    text + &table(entries.iter().filter(|entry| !entry.seen.rests())).markdown()
}

fn figure(entries: &[Entry]) -> Figure {
    let panel = |mesh: bool, title: &str, y: Axis, value: fn(&Entry) -> f64| {
        let points = |rests: bool| {
            (entries.iter().filter(|entry| entry.sample.mesh == mesh && entry.seen.rests() == rests))
                .map(|entry| (f64::from(entry.sample.cells.x), value(entry)))
                .collect()
        };
        let series = |label: &str, look, rests| Series {
            label: label.into(),
            look: Look(look),
            stroke: Stroke::Points,
            points: points(rests),
        };
        let series = vec![series("at rest", 7, true), series("not at rest", 6, false)];
        Panel { title: title.into(), x: Axis::log("columns").within(0.8, 80.0), y, series, ..Panel::default() }
    };
    let rows = |entry: &Entry| f64::from(entry.sample.cells.y);
    let aspect = |entry: &Entry| entry.sample.aspect();
    let panels = [(false, "grids"), (true, "irregular meshes")].into_iter().flat_map(|(mesh, title)| {
        [
            panel(mesh, title, Axis::log("rows").within(0.8, 80.0), rows),
            panel(mesh, title, Axis::log("width of a cell over height").within(0.1, 10.0), aspect),
        ]
    });
    Figure { size: MANY, columns: 2, panels: panels.collect(), ..Figure::default() }
}
