//! The chart as CSV, pictures and Markdown.

use std::fmt::Write as _;

use cloth_solver::Method;

use super::case::Case;
use super::extras::Cost;
use super::run::{Outcome, Point};
use super::settle::Settled;
use super::truth::Truth;
use crate::LabError;
use crate::plot::{Axis, Figure, Look, MANY, Panel, SINGLE, Series, Stroke};
use crate::report::{Output, Table, header, number};

/// Cases of the main picture, in its order.
const MAIN: [&str; 6] = ["top-hung", "corner-hung", "swing", "drape", "weight", "flag"];
/// Errors below this are drawn at it: it is what rounding to f32 leaves.
const FLOOR: f64 = 1e-7;

/// What a picture shows upwards.
struct Measure {
    /// Part of the file's name.
    file: &'static str,
    /// Title of the axis.
    title: &'static str,
    /// Errors that are looked for, with their names.
    targets: [(f64, &'static str); 2],
    value: fn(&Point) -> Option<f64>,
    floor: f64,
}

const MEASURES: [Measure; 2] = [
    Measure {
        file: "strain",
        title: "error of the largest strain",
        targets: [(1e-2, "1 %"), (1e-3, "0.1 %")],
        value: |point| point.outcome.difference().map(|d| d.strain_error),
        floor: FLOOR,
    },
    Measure {
        file: "shape",
        title: "shape error (rms), mm",
        targets: [(10.0, "1 cm"), (1.0, "1 mm")],
        value: |point| point.outcome.difference().map(|d| d.shape_rms),
        floor: 1e3 * FLOOR,
    },
];

/// Everything that was found.
pub struct Found<'a> {
    /// The cases.
    pub cases: &'a [Case],
    /// The reference of each case.
    pub truths: &'a [Option<Truth>],
    /// All points.
    pub points: &'a [Point],
    /// The cost of changes at run time.
    pub costs: &'a [Cost],
    /// How the methods come to rest from flat.
    pub settled: &'a [Settled],
    /// The methods, in their order.
    pub methods: &'a [Method],
}

/// Writes `chart.csv`, `chart.md` and the pictures.
///
/// # Errors
/// A file that could not be written.
pub fn write(found: &Found, output: &Output) -> Result<(), LabError> {
    output.write("chart.csv", &csv(found).csv())?;
    for measure in &MEASURES {
        for case in found.cases {
            let stem = output.picture(&format!("chart_{}_{}", case.name.replace('-', "_"), measure.file))?;
            Figure { size: SINGLE, ..Figure::single(panel(found, case, measure)) }.write(&stem)?;
        }
        let of = |name: &&'static str| found.cases.iter().find(|case| case.name == *name);
        let panels: Vec<Panel> = MAIN.iter().filter_map(of).map(|case| panel(found, case, measure)).collect();
        if panels.len() > 1 {
            let figure = Figure { size: MANY, columns: 3, panels, ..Figure::default() };
            figure.write(&output.picture(&format!("chart_{}", measure.file))?)?;
        }
    }
    output.write("chart.md", &markdown(found))
}

fn csv(found: &Found) -> Table {
    let mut table = Table::new([
        "scene",
        "method",
        "substeps",
        "iterations",
        "outcome",
        "median_s_per_s",
        "minimum_s_per_s",
        "timed_ticks",
        "ns_per_constraint",
        "strain",
        "strain_error",
        "strain_error_relative",
        "strain_of_run",
        "shape_rms_mm",
        "shape_max_mm",
        "energy_left_ratio",
        "energy_most_ratio",
        "period_ratio",
        "amplitude_ratio",
    ]);
    let told = |value: Option<f64>| value.filter(|value| value.is_finite()).map(|v| number(v, 5)).unwrap_or_default();
    for point in found.points {
        let d = point.outcome.difference();
        table.push(
            [
                point.case.to_owned(),
                point.method.name().to_owned(),
                point.setting.substeps.to_string(),
                point.setting.iterations.to_string(),
                point.outcome.name().to_owned(),
            ]
            .into_iter()
            .chain([told(Some(point.median)), told(Some(point.minimum)), point.timed.to_string()])
            .chain([told(Some(point.per_constraint)), told(d.map(|d| d.strain)), told(d.map(|d| d.strain_error))])
            .chain([
                told(d.map(|d| d.strain_relative)),
                told(d.map(|d| d.strain_of_run)),
                told(d.map(|d| d.shape_rms)),
                told(d.map(|d| d.shape_max)),
            ])
            .chain([told(d.and_then(|d| d.energy_left)), told(d.and_then(|d| d.energy_most))])
            .chain([told(d.and_then(|d| d.period)), told(d.and_then(|d| d.amplitude))]),
        );
    }
    table
}

/// Time against error: all points, and a line through those of a method that no other of its points beats.
fn panel(found: &Found, case: &Case, measure: &Measure) -> Panel {
    let mut series = Vec::new();
    for method in found.methods {
        let mut points: Vec<(f64, f64)> = (found.points.iter())
            .filter(|point| point.case == case.name && point.method == *method)
            .filter_map(|point| Some((point.median, (measure.value)(point)?.max(measure.floor))))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut best = f64::INFINITY;
        let (front, beaten) = points.into_iter().partition::<Vec<_>, _>(|point| {
            let better = point.1 < best;
            best = best.min(point.1);
            better
        });
        let (label, look) = (method.name().to_owned(), Look::of(*method));
        series.push(Series { label: label.clone(), look, stroke: Stroke::Marked, points: front });
        series.push(Series { label, look, stroke: Stroke::Points, points: beaten });
    }
    let times = series.iter().flat_map(|series| &series.points).map(|point| point.0);
    let (low, high) = times.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), t| (low.min(t), high.max(t)));
    for (look, (error, label)) in measure.targets.iter().enumerate() {
        let points = if low < high { vec![(low, *error), (high, *error)] } else { Vec::new() };
        series.push(Series { label: (*label).to_owned(), look: Look(9 * look), stroke: Stroke::Dashed, points });
    }
    Panel {
        title: case.name.into(),
        x: Axis::log("CPU time per simulated second, s"),
        y: Axis::log(measure.title),
        series,
        ..Panel::default()
    }
}

fn markdown(found: &Found) -> String {
    let mut text = header("Speed against accuracy");
    text += "One core; a tick is 1/60 s; times are medians over all ticks of a run but its first three, as CPU time per \
             simulated second. A setting is substeps × iterations. The largest strain error is a difference of strains \
             (1 % of rest length, not of the strain); the shape error is the root mean square distance of all particles. \
             Rest is judged from the reference's rest on, over the last half second of three; motions for as long as \
             the reference's two step lengths agree (see its table), since wrinkles make chaos of them after that; of the flag, which runs for 8 s, the strain is the one that the \
             largest strain passes in a twentieth of all ticks. What the solver does once a tick (internal friction) counts \
             as error like everything else.\n\n![time against strain error](chart_strain.svg)\n\n\
             ![time against shape error](chart_shape.svg)\n\n## Time at equal error\n\nLeast time (ms per simulated \
             second) among the settings that reach it, and that setting; – where none does.\n";
    for (heading, measure, limit) in MEASURES.iter().flat_map(|m| m.targets.map(|(limit, name)| (name, m, limit))) {
        let _ = write!(text, "\n### {heading}: {}\n\n", measure.title);
        text += &equal_error(found, measure, limit).markdown();
    }
    text += "\n## Swings\n\nThe largest strain of the whole run. Energy above rest at the end (2 s and 5 s) over the reference's, and \
             the largest within the run over that at the start. Small swing: period and amplitude over the reference's, of \
             sinusoids fitted to the middle of the lower edge, the amplitude in the last two seconds.\n\n";
    text += &swings(found).markdown();
    text += "\n## From flat to rest\n\nThe cases that are judged at rest, from a millimetre off flat: when the rms speed falls below \
             0.03 m/s for half a second, – if not within 20 s; the strain error there; and how far off the reference's rest that \
             is: folds may lie another way.\n\n";
    text += &settled(found).markdown();
    text +=
        "\n## Time of one constraint\n\nLeast median over all settings and scenes, ns per constraint and solve.\n\n";
    text += &per_constraint(found).markdown();
    text += "\n## Outcomes other than a number\n\n";
    text += &outcomes(found).markdown();
    text += "\n## What changes at run time\n\nTime of a tick over that of a quiet one, on the sheet hung by its top edge: the \
             first tick with the change, and the median of those after it.\n\n";
    text += &changes(found).markdown();
    text += "\n## The reference\n\nVelocity Verlet in f64 in steps of a quarter and an eighth of the stability limit; rest by \
             Newton's method.\n\n";
    text += &references(found).markdown();
    text
}

fn equal_error(found: &Found, measure: &Measure, limit: f64) -> Table {
    let names = found.cases.iter().map(|case| case.name);
    let mut table = Table::new(std::iter::once("method").chain(names));
    for method in found.methods {
        let entry = |case: &Case| {
            let reached = (found.points.iter())
                .filter(|point| point.case == case.name && point.method == *method)
                .filter(|point| (measure.value)(point).is_some_and(|error| error <= limit))
                .min_by(|a, b| a.median.total_cmp(&b.median));
            reached.map_or("–".into(), |p| format!("{} ({})", number(1e3 * p.median, 3), p.setting))
        };
        table.push(std::iter::once(method.name().to_owned()).chain(found.cases.iter().map(entry)));
    }
    table
}

fn swings(found: &Found) -> Table {
    let mut table = Table::new([
        "scene",
        "method",
        "setting",
        "s per s",
        "largest strain, %",
        "period",
        "amplitude",
        "energy left",
        "largest energy",
    ]);
    let told = |value: Option<f64>| value.map_or("".into(), |value| number(value, 4));
    for point in found.points {
        if let Some(d) = point.outcome.difference().filter(|d| d.energy_left.is_some()) {
            let (setting, time) = (point.setting.to_string(), number(point.median, 3));
            table.push([point.case.to_owned(), point.method.name().to_owned(), setting, time].into_iter().chain([
                number(100.0 * d.strain_of_run, 3),
                told(d.period),
                told(d.amplitude),
                told(d.energy_left),
                told(d.energy_most),
            ]));
        }
    }
    table
}

fn settled(found: &Found) -> Table {
    let mut table = Table::new(["scene", "method", "setting", "time to rest, s", "strain error, %", "shape error, mm"]);
    for settled in found.settled {
        table.push([
            settled.case.to_owned(),
            settled.method.name().to_owned(),
            settled.setting.to_string(),
            settled.time.map_or("–".into(), |time| number(time, 3)),
            number(100.0 * settled.strain_error, 3),
            number(settled.shape_rms, 3),
        ]);
    }
    table
}

fn per_constraint(found: &Found) -> Table {
    let mut table = Table::new(["method", "ns", "scene", "setting"]);
    for method in found.methods {
        let of = found.points.iter().filter(|point| point.method == *method && point.per_constraint.is_finite());
        if let Some(best) = of.min_by(|a, b| a.per_constraint.total_cmp(&b.per_constraint)) {
            let name = method.name().to_owned();
            table.push([name, number(best.per_constraint, 3), best.case.to_owned(), best.setting.to_string()]);
        }
    }
    table
}

fn outcomes(found: &Found) -> Table {
    let mut table = Table::new(["scene", "method", "diverged", "too slow", "unsupported"]);
    for case in found.cases {
        for method in found.methods {
            let of = |outcome: Outcome| {
                let mine = found.points.iter().filter(|p| p.case == case.name && p.method == *method);
                let hit = mine.filter(|p| p.outcome == outcome).map(|p| p.setting.to_string());
                hit.collect::<Vec<_>>().join(", ")
            };
            let row = [Outcome::Diverged, Outcome::TooSlow, Outcome::Unsupported].map(of);
            if row.iter().any(|entry| !entry.is_empty()) {
                table.push([case.name.to_owned(), method.name().to_owned()].into_iter().chain(row));
            }
        }
    }
    table
}

fn changes(found: &Found) -> Table {
    let mut table =
        Table::new(["method", "setting", "change", "contacts", "quiet tick, ms", "first tick", "later ticks"]);
    for cost in found.costs {
        let over =
            |time: Option<f64>| time.map_or("exploded".into(), |time| format!("{} ×", number(time / cost.quiet, 3)));
        table.push([
            cost.method.name().to_owned(),
            cost.setting.to_string(),
            cost.change.to_owned(),
            if cost.contacts > 0 { cost.contacts.to_string() } else { String::new() },
            number(1e3 * cost.quiet, 3),
            over(cost.first),
            over(cost.later),
        ]);
    }
    table
}

fn references(found: &Found) -> Table {
    let mut table = Table::new(["scene", "largest strain, %", "convergence"]);
    for (case, truth) in found.cases.iter().zip(found.truths) {
        let (strain, convergence) = truth.as_ref().map_or(("–".into(), "no reference".into()), |truth| {
            (number(100.0 * truth.record.strain_of(case, truth.until), 5), truth.convergence.clone())
        });
        table.push([case.name.to_owned(), strain, convergence]);
    }
    table
}
