//! Charts and maps, each written as SVG and as PNG.

mod draw;
mod png;

use std::path::Path;
use std::sync::Once;

use cloth_solver::Method;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

use crate::LabError;

/// Size of a picture with one panel, pixels.
pub const SINGLE: (u32, u32) = (720, 440);

/// Size of a picture with several panels, pixels.
pub const MANY: (u32, u32) = (900, 600);

/// Colour and marker of a series. There are [`Look::COUNT`], told apart by marker as well as by colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look(pub usize);

impl Look {
    /// How many there are; a larger number starts again.
    pub const COUNT: usize = PALETTE.len();

    /// The same in every picture.
    pub fn of(method: Method) -> Self {
        Self(Method::ALL.iter().position(|other| *other == method).unwrap_or(0))
    }

    fn colour(self) -> RGBColor {
        let [r, g, b] = PALETTE[self.0 % Self::COUNT];
        RGBColor(r, g, b)
    }
}

/// Told apart with any kind of colour vision (after Okabe & Ito 2008, their yellow darkened to show on white, brown and
/// grey added).
const PALETTE: [[u8; 3]; 10] = [
    [0x66, 0x66, 0x66],
    [0xe6, 0x9f, 0x00],
    [0x56, 0xb4, 0xe9],
    [0x8c, 0x51, 0x0a],
    [0x00, 0x00, 0x00],
    [0xcc, 0x79, 0xa7],
    [0xd5, 0x5e, 0x00],
    [0x00, 0x72, 0xb2],
    [0x00, 0x9e, 0x73],
    [0xa8, 0x9a, 0x00],
];

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stroke {
    /// A line through all points, with markers.
    Marked,
    /// A line without markers.
    Line,
    /// A dashed line without markers: theory, a target.
    Dashed,
    /// Markers alone.
    Points,
}

/// Points under one name.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend; the same name, look and stroke in several panels make one entry. Empty: no entry.
    pub label: String,
    /// Colour and marker.
    pub look: Look,
    /// Line, markers, or both.
    pub stroke: Stroke,
    /// The points in data units. What is not finite, or not positive on a logarithmic axis, is left out.
    pub points: Vec<(f64, f64)>,
}

/// Class of a cell of a map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Class {
    /// Name in the legend.
    pub label: String,
    /// Red, green, blue.
    pub colour: [u8; 3],
    /// Whether its cells carry a cross, to be told without colour.
    pub crossed: bool,
}

/// One cell of a map, in data units.
#[derive(Clone, Debug)]
pub struct Cell {
    /// From where to where along x.
    pub x: (f64, f64),
    /// From where to where along y.
    pub y: (f64, f64),
    /// Index into [`Figure::classes`].
    pub class: usize,
}

/// An axis.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// Title, with the unit.
    pub title: String,
    /// Whether it is logarithmic.
    pub log: bool,
    /// From where to where; found from the data if `None`.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// A linear axis.
    pub fn linear(title: &str) -> Self {
        Self { title: title.into(), log: false, range: None }
    }

    /// A logarithmic axis.
    pub fn log(title: &str) -> Self {
        Self { title: title.into(), log: true, range: None }
    }

    /// The same from `low` to `high`.
    pub fn within(self, low: f64, high: f64) -> Self {
        Self { range: Some((low, high)), ..self }
    }
}

/// One panel: a chart, a map, or a map with lines on it.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    /// Title above it.
    pub title: String,
    /// The axis across.
    pub x: Axis,
    /// The axis up.
    pub y: Axis,
    /// Cells of a map, below everything else.
    pub cells: Vec<Cell>,
    /// Lines and points.
    pub series: Vec<Series>,
}

/// A picture: panels in rows, and one legend for all of them.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    /// Title above all panels; empty for none.
    pub title: String,
    /// Width and height, pixels, both above 0.
    pub size: (u32, u32),
    /// Panels in a row, at least 1.
    pub columns: usize,
    /// The panels, row by row.
    pub panels: Vec<Panel>,
    /// The classes of the panels' cells.
    pub classes: Vec<Class>,
}

impl Figure {
    /// One panel of the usual size.
    pub fn single(panel: Panel) -> Self {
        Self { size: SINGLE, columns: 1, panels: vec![panel], ..Self::default() }
    }

    /// Writes `stem.svg` and `stem.png`.
    ///
    /// # Errors
    /// The picture and why it could not be drawn.
    pub fn write(&self, stem: &Path) -> Result<(), LabError> {
        static FONT: Once = Once::new();
        FONT.call_once(|| {
            // Refused only if the bytes are no font; then drawing says so.
            let _ = register_font("sans-serif", FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
        });
        let (svg, png) = (stem.with_extension("svg"), stem.with_extension("png"));
        draw::figure(&SVGBackend::new(&svg, self.size).into_drawing_area(), self)
            .map_err(|reason| LabError::Plot { path: svg.clone(), reason })?;
        png::write(&png, self).map_err(|reason| LabError::Plot { path: png, reason })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_has_its_own_colour() {
        for (i, a) in Method::ALL.iter().enumerate() {
            for b in &Method::ALL[..i] {
                assert_ne!(Look::of(*a).colour(), Look::of(*b).colour());
            }
        }
    }

    #[test]
    fn a_figure_is_written_twice_even_with_points_that_cannot_be_shown() {
        let points = vec![(1.0, 1e-3), (10.0, 0.0), (f64::NAN, 1.0), (1e3, 1e2)];
        let series = Series { label: "a".into(), look: Look(0), stroke: Stroke::Marked, points };
        let panel = Panel { x: Axis::log("x, s"), y: Axis::log("y, m"), series: vec![series], ..Panel::default() };
        let stem = std::env::temp_dir().join(format!("cloth_lab_plot_{}", std::process::id()));
        Figure::single(panel).write(&stem).unwrap();
        for extension in ["svg", "png"] {
            let path = stem.with_extension(extension);
            assert!(std::fs::metadata(&path).unwrap().len() > 500);
            std::fs::remove_file(path).unwrap();
        }
    }

    #[test]
    fn a_picture_that_cannot_be_written_is_an_error() {
        let stem = Path::new("/nowhere/at/all");
        assert!(matches!(Figure::single(Panel::default()).write(stem), Err(LabError::Plot { .. })));
    }
}
