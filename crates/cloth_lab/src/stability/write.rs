//! The maps as CSV, pictures and Markdown.

use std::fmt::Write as _;

use cloth_solver::Method;

use super::{Check, Edge, Entry, Kind, Verdict};
use crate::LabError;
use crate::plot::{Axis, Cell, Class, Figure, Look, MANY, Panel, Series, Stroke};
use crate::report::{Output, Table, header, number};

/// Everything that was found.
pub struct Found<'a> {
    /// The maps.
    pub kinds: &'a [Kind],
    /// The methods, in their order.
    pub methods: &'a [Method],
    /// All cells.
    pub entries: &'a [Entry],
    /// Theory's edges.
    pub edges: &'a [Edge],
}

/// Writes `stability.csv`, `stability.md` and a picture of each map.
///
/// # Errors
/// A file that could not be written.
pub fn write(found: &Found, checks: &[Check], quick: bool, output: &Output) -> Result<(), LabError> {
    output.write("stability.csv", &csv(found).csv())?;
    for kind in found.kinds {
        let panels = found.methods.iter().map(|method| panel(found, *kind, *method, quick)).collect();
        let columns = if found.methods.len() > 4 { 3 } else { 2 };
        let figure = Figure { size: MANY, columns, panels, classes: classes(), ..Figure::default() };
        figure.write(&output.picture(&format!("stability_{}", kind.file()))?)?;
    }
    output.write("stability.md", &markdown(found, checks))
}

fn classes() -> Vec<Class> {
    let colour = |verdict| match verdict {
        Verdict::Survived => [0x56, 0xb4, 0xe9],
        Verdict::Inaccurate => [0xf0, 0xe4, 0x42],
        Verdict::Exploded => [0xd5, 0x5e, 0x00],
    };
    let class = |verdict: Verdict| Class {
        label: verdict.name().into(),
        colour: colour(verdict),
        crossed: verdict == Verdict::Exploded,
    };
    Verdict::ALL.map(class).to_vec()
}

fn panel(found: &Found, kind: Kind, method: Method, quick: bool) -> Panel {
    let bounds = kind.values(quick).map(|values| around(&values));
    let [across, up] = kind.values(quick);
    let place = |values: &[f64], bounds: &[f64], value: f64| {
        let index = values.iter().position(|other| *other == value).unwrap_or(0);
        (bounds[index], bounds[index + 1])
    };
    let cells = (found.entries.iter())
        .filter(|entry| entry.kind == kind && entry.method == method)
        .map(|entry| Cell {
            x: place(&across, &bounds[0], entry.x),
            y: place(&up, &bounds[1], entry.y),
            class: Verdict::ALL.iter().position(|verdict| *verdict == entry.seen.verdict()).unwrap_or(0),
        })
        .collect();
    let edge = found.edges.iter().find(|edge| edge.kind == kind && edge.method == method);
    let points = edge.map(|edge| edge.points.clone()).unwrap_or_default();
    // One line in the legend, whether this method has a limit or not.
    let theory = Series { label: "theory's limit".into(), look: Look(4), stroke: Stroke::Dashed, points };
    let [x, y] = kind.axes();
    let ends = |bounds: &[f64]| (bounds[0], bounds[bounds.len() - 1]);
    let ((left, right), (low, high)) = (ends(&bounds[0]), ends(&bounds[1]));
    Panel {
        title: method.name().into(),
        x: Axis::log(x).within(left, right),
        y: Axis::log(y).within(low, high),
        cells,
        series: vec![theory],
    }
}

/// Bounds of cells around values of a logarithmic axis: half-way between them.
fn around(values: &[f64]) -> Vec<f64> {
    let (first, last) = (values[0], values[values.len() - 1]);
    let half = |a: f64, b: f64| (b / a).sqrt();
    let mut bounds = vec![first / values.get(1).map_or(1.5, |next| half(first, *next))];
    bounds.extend(values.windows(2).map(|pair| (pair[0] * pair[1]).sqrt()));
    let before = values.len().checked_sub(2).map_or(1.5, |i| half(values[i], last));
    bounds.push(last * before);
    bounds
}

fn csv(found: &Found) -> Table {
    let mut table = Table::new(["map", "method", "x", "y", "verdict", "strain_error", "energy_ratio", "steps"]);
    for entry in found.entries {
        let told = |value: f64| if value.is_finite() { number(value, 4) } else { String::new() };
        table.push([
            entry.kind.file().to_owned(),
            entry.method.name().to_owned(),
            number(entry.x, 5),
            number(entry.y, 5),
            entry.seen.verdict().name().to_owned(),
            told(entry.seen.strain_error),
            told(entry.seen.energy),
            entry.seen.steps.to_string(),
        ]);
    }
    table
}

fn markdown(found: &Found, checks: &[Check]) -> String {
    let mut text = header("Where methods fail");
    text += "Every run starts at the reference's rest. Survived: finite, bounded, largest strain at the end within 1 % (of \
             rest length) of the reference's. Inaccurate: off by more. Exploded: not finite, faster than 100 m/s, or ten \
             times the energy there was to begin with and by falling. Dashed: theory's limit, a step of 2/ω (symplectic Euler, Störmer–Verlet) or 2.83/ω \
             (RK4) for the highest frequency ω of that mesh; explicit Euler has none, its line is where rounding grows by \
             10⁷ within the run.\n\n## At the edge\n\nA run at 0.95 and one at 1.05 of the limit.\n\n";
    let mut table = Table::new(["method", "on", "limit, s", "at 0.95", "at 1.05"]);
    for check in checks {
        let [below, above] = check.verdicts.map(|verdict| verdict.name().to_owned());
        table.push([check.method.name().into(), check.subject.into(), number(check.limit, 4), below, above]);
    }
    text += &table.markdown();
    for kind in found.kinds {
        let file = kind.file();
        let _ = write!(text, "\n## {}\n\n![{file}](stability_{file}.svg)\n\n", kind.about());
        let mut table = Table::new(["method", "survived", "inaccurate", "exploded"]);
        for method in found.methods {
            let of = |verdict| {
                let mine = found.entries.iter().filter(|e| e.kind == *kind && e.method == *method);
                mine.filter(|entry| entry.seen.verdict() == verdict).count().to_string()
            };
            table.push(std::iter::once(method.name().to_owned()).chain(Verdict::ALL.map(of)));
        }
        text += &table.markdown();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::around;

    #[test]
    fn cells_meet_half_way_between_their_values() {
        let bounds = around(&[1.0, 100.0, 10_000.0]);
        let expected = [0.1, 10.0, 1e3, 1e5];
        assert!(bounds.iter().zip(expected).all(|(bound, expected)| (bound / expected - 1.0).abs() < 1e-9));
    }
}
