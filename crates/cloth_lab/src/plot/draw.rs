//! Drawing of figures.

use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::element::DashedPathElement;
use plotters::prelude::*;

use super::{Axis, Class, Figure, Look, Panel, Series, Stroke};

const FONT: &str = "sans-serif";
/// Width of the legend, pixels.
const LEGEND: u32 = 165;
/// Height of a line of the legend, pixels.
const LINE: i32 = 19;
/// Radius of a marker, pixels.
const MARKER: i32 = 4;
const INK: RGBColor = RGBColor(40, 40, 40);
const FAINT: RGBColor = RGBColor(225, 225, 225);

type Area<DB> = DrawingArea<DB, Shift>;
type Drawn = Result<(), String>;

fn told(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// Draws all panels, their title and their legend.
pub(super) fn figure<DB: DrawingBackend>(area: &Area<DB>, figure: &Figure) -> Drawn {
    area.fill(&WHITE).map_err(told)?;
    let inner =
        if figure.title.is_empty() { area.clone() } else { area.titled(&figure.title, (FONT, 18)).map_err(told)? };
    let keys = keys(figure);
    let width = inner.dim_in_pixel().0;
    let panels = if keys.is_empty() && figure.classes.is_empty() {
        inner
    } else {
        let (panels, side) = inner.split_horizontally(width.saturating_sub(LEGEND).max(1) as i32);
        legend(&side, &keys, &figure.classes)?;
        panels
    };
    let columns = figure.columns.max(1);
    let rows = figure.panels.len().div_ceil(columns).max(1);
    for (panel, area) in figure.panels.iter().zip(panels.split_evenly((rows, columns))) {
        let (x, y) = (range(panel, &panel.x, |p| p.0, |c| c.x), range(panel, &panel.y, |p| p.1, |c| c.y));
        let (over, up) = (x.0..x.1, y.0..y.1);
        match (panel.x.log, panel.y.log) {
            (true, true) => draw(&area, panel, &figure.classes, over.log_scale(), up.log_scale()),
            (true, false) => draw(&area, panel, &figure.classes, over.log_scale(), up),
            (false, true) => draw(&area, panel, &figure.classes, over, up.log_scale()),
            (false, false) => draw(&area, panel, &figure.classes, over, up),
        }?;
    }
    area.present().map_err(told)
}

/// One entry of the legend for each name.
fn keys(figure: &Figure) -> Vec<&Series> {
    let mut keys: Vec<&Series> = Vec::new();
    for series in figure.panels.iter().flat_map(|panel| &panel.series).filter(|series| !series.label.is_empty()) {
        if !keys.iter().any(|key| key.label == series.label) {
            keys.push(series);
        }
    }
    keys.sort_by_key(|key| (key.stroke == Stroke::Dashed, key.look.0));
    keys
}

/// From where to where an axis goes.
fn range(
    panel: &Panel,
    axis: &Axis,
    of_point: fn(&(f64, f64)) -> f64,
    of_cell: fn(&super::Cell) -> (f64, f64),
) -> (f64, f64) {
    if let Some(range) = axis.range {
        return range;
    }
    let points = panel.series.iter().flat_map(|series| &series.points).map(of_point);
    let cells = panel.cells.iter().map(of_cell).flat_map(|(low, high)| [low, high]);
    let (low, high) = points
        .chain(cells)
        .filter(|value| shown(axis, *value))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    match (low <= high, axis.log, panel.cells.is_empty()) {
        (false, ..) => (0.1, 1.0),
        (_, _, false) => (low, high),
        (_, true, _) => (low / 1.6, high * 1.6),
        (_, false, _) => {
            let margin = if high > low { 0.05 * (high - low) } else { 0.5 * low.abs().max(1.0) };
            (low - margin, high + margin)
        }
    }
}

fn shown(axis: &Axis, value: f64) -> bool {
    value.is_finite() && (!axis.log || value > 0.0)
}

/// A tick's label: plain where short, a power of ten otherwise.
fn tick(value: &f64) -> String {
    let size = value.abs();
    if *value == 0.0 {
        "0".into()
    } else if (1e-2..1e4).contains(&size) {
        let text = format!("{value:.4}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        let text = format!("{value:.1e}");
        text.replace(".0e", "e")
    }
}

fn draw<DB: DrawingBackend, X, Y>(area: &Area<DB>, panel: &Panel, classes: &[Class], x: X, y: Y) -> Drawn
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    let (width, height) = area.dim_in_pixel();
    let mut chart = ChartBuilder::on(area)
        .margin(6)
        .margin_right(14)
        .caption(&panel.title, (FONT, 15).into_font().color(&INK))
        .x_label_area_size(34)
        .y_label_area_size(52)
        .build_cartesian_2d(x, y)
        .map_err(told)?;
    chart
        .configure_mesh()
        .x_desc(&panel.x.title)
        .y_desc(&panel.y.title)
        .x_labels((width / 75).max(2) as usize)
        .y_labels((height / 40).max(2) as usize)
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .label_style((FONT, 12).into_font().color(&INK))
        .axis_desc_style((FONT, 13).into_font().color(&INK))
        .axis_style(INK)
        .bold_line_style(FAINT)
        .light_line_style(TRANSPARENT)
        .draw()
        .map_err(told)?;
    let pixels = chart.plotting_area();
    let (columns, rows) = pixels.get_pixel_range();
    let at = |x: f64, y: f64| {
        let (px, py) = pixels.map_coordinate(&(x, y));
        (px - columns.start, py - rows.start)
    };
    let canvas = pixels.strip_coord_spec();
    for cell in &panel.cells {
        let (a, b) = (at(cell.x.0, cell.y.0), at(cell.x.1, cell.y.1));
        if let Some(class) = classes.get(cell.class) {
            // A pixel short, so that cells stand apart.
            canvas.draw(&Rectangle::new([a, (b.0 - 1, b.1 + 1)], fill(class))).map_err(told)?;
            if class.crossed {
                let middle = ((a.0 + b.0) / 2, (a.1 + b.1) / 2);
                canvas.draw(&Cross::new(middle, 2, WHITE.stroke_width(1))).map_err(told)?;
            }
        }
    }
    let frame = (columns.end - columns.start, rows.end - rows.start);
    for series in &panel.series {
        let points: Vec<(i32, i32)> = (series.points.iter())
            .filter(|(x, y)| shown(&panel.x, *x) && shown(&panel.y, *y))
            .map(|(x, y)| at(*x, *y))
            .collect();
        for pair in points.windows(2) {
            if let (true, Some((a, b))) = (series.stroke != Stroke::Points, clip(pair[0], pair[1], frame)) {
                line(&canvas, series, a, b)?;
            }
        }
        if matches!(series.stroke, Stroke::Marked | Stroke::Points) {
            let inside = |p: &&(i32, i32)| (0..=frame.0).contains(&p.0) && (0..=frame.1).contains(&p.1);
            for point in points.iter().filter(inside) {
                marker(&canvas, series.look, *point)?;
            }
        }
    }
    Ok(())
}

fn fill(class: &Class) -> ShapeStyle {
    let [r, g, b] = class.colour;
    RGBColor(r, g, b).filled()
}

/// The part of a straight line within `0..=width`, `0..=height` (Liang & Barsky 1984).
fn clip(a: (i32, i32), b: (i32, i32), (width, height): (i32, i32)) -> Option<((i32, i32), (i32, i32))> {
    let [ax, ay, bx, by] = [a.0, a.1, b.0, b.1].map(f64::from);
    let (dx, dy) = (bx - ax, by - ay);
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for (slope, room) in [(-dx, ax), (dx, f64::from(width) - ax), (-dy, ay), (dy, f64::from(height) - ay)] {
        if slope == 0.0 && room < 0.0 {
            return None;
        }
        if slope < 0.0 {
            from = from.max(room / slope);
        } else if slope > 0.0 {
            to = to.min(room / slope);
        }
    }
    let on = |t: f64| ((ax + t * dx).round() as i32, (ay + t * dy).round() as i32);
    (from <= to).then(|| (on(from), on(to)))
}

fn line<DB: DrawingBackend>(area: &Area<DB>, series: &Series, a: (i32, i32), b: (i32, i32)) -> Drawn {
    let style = series.look.colour().stroke_width(2);
    if series.stroke == Stroke::Dashed {
        area.draw(&DashedPathElement::new([a, b], 6, 4, style)).map_err(told)
    } else {
        area.draw(&PathElement::new([a, b], style)).map_err(told)
    }
}

/// Every look has a marker of its own.
fn marker<DB: DrawingBackend>(area: &Area<DB>, look: Look, (x, y): (i32, i32)) -> Drawn {
    let (colour, r) = (look.colour(), MARKER);
    let (full, thin) = (colour.filled(), colour.stroke_width(2));
    let polygon = |points: Vec<(i32, i32)>| Polygon::new(points, full);
    match look.0 % Look::COUNT {
        0 => area.draw(&Cross::new((x, y), r, thin)),
        1 => area.draw(&polygon(vec![(x, y - r - 1), (x + r + 1, y + r), (x - r - 1, y + r)])),
        2 => area.draw(&polygon(vec![(x, y + r + 1), (x + r + 1, y - r), (x - r - 1, y - r)])),
        3 => area.draw(&polygon(vec![(x, y - r - 1), (x + r + 1, y), (x, y + r + 1), (x - r - 1, y)])),
        4 => area.draw(&Rectangle::new([(x - r, y - r), (x + r, y + r)], full)),
        5 => area
            .draw(&PathElement::new([(x - r, y), (x + r, y)], thin))
            .and_then(|()| area.draw(&PathElement::new([(x, y - r), (x, y + r)], thin))),
        6 => area.draw(&Circle::new((x, y), r, WHITE.filled())).and_then(|()| area.draw(&Circle::new((x, y), r, thin))),
        7 => area.draw(&Circle::new((x, y), r, full)),
        8 => area
            .draw(&Rectangle::new([(x - r, y - r), (x + r, y + r)], WHITE.filled()))
            .and_then(|()| area.draw(&Rectangle::new([(x - r, y - r), (x + r, y + r)], thin))),
        _ => area.draw(&polygon(vec![(x + r, y - r - 1), (x + r, y + r + 1), (x - r, y)])),
    }
    .map_err(told)
}

/// The names of all series and classes, one below the other.
fn legend<DB: DrawingBackend>(area: &Area<DB>, keys: &[&Series], classes: &[Class]) -> Drawn {
    let font = (FONT, 13).into_font().color(&INK);
    let mut y = 36;
    for class in classes {
        area.draw(&Rectangle::new([(6, y - 6), (28, y + 6)], fill(class))).map_err(told)?;
        if class.crossed {
            area.draw(&Cross::new((17, y), 2, WHITE.stroke_width(1))).map_err(told)?;
        }
        area.draw(&Text::new(class.label.clone(), (34, y - 6), font.clone())).map_err(told)?;
        y += LINE;
    }
    for key in keys {
        if key.stroke != Stroke::Points {
            line(area, key, (4, y), (30, y))?;
        }
        if matches!(key.stroke, Stroke::Marked | Stroke::Points) {
            marker(area, key.look, (17, y))?;
        }
        area.draw(&Text::new(key.label.clone(), (34, y - 6), font.clone())).map_err(told)?;
        y += LINE;
    }
    Ok(())
}
