//! Numbers: what they are called, in which unit they are shown, how they are dragged.

use std::ops::RangeInclusive;

use bevy::prelude::*;
use bevy_egui::egui;

use super::rows::{Row, reset};

/// A value that is dragged logarithmically changes by this share of itself for each pixel.
const LOGARITHMIC: f64 = 0.01;
/// A value that is dragged linearly changes by this share of its range for each pixel, at most.
const LINEAR: f64 = 1.0 / 500.0;
/// A range that spans so many times its smallest value is logarithmic.
const SPANS: f64 = 100.0;
/// Three numbers side by side need so much room beside their label, logical pixels.
const ROOM_FOR_THREE: f32 = 330.0;

/// How a number is shown: its unit, and what it is multiplied by to be in that unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Written behind the number; empty for a pure number.
    pub name: &'static str,
    /// The value times this is what is shown.
    pub factor: f64,
    /// The smallest change of a drag by one pixel, in this unit.
    pub finest: f64,
}

impl Unit {
    /// Metres.
    pub const METRES: Self = Self::new("m", 1.0, 0.005);
    /// Thousandths of a metre, of a value in metres.
    pub const MILLIMETRES: Self = Self::new("mm", 1e3, 0.01);
    /// Metres per second.
    pub const METRES_PER_SECOND: Self = Self::new("m/s", 1.0, 0.005);
    /// Metres per second squared.
    pub const METRES_PER_SECOND_SQUARED: Self = Self::new("m/s²", 1.0, 0.02);
    /// A pure number.
    pub const NONE: Self = Self::new("", 1.0, 0.002);
    /// Hundredths, of a pure number.
    pub const PERCENT: Self = Self::new("%", 1e2, 0.05);
    /// Degrees, of a value in degrees.
    pub const DEGREES: Self = Self::new("°", 1.0, 0.5);
    /// Degrees, of a value in radians.
    pub const DEGREES_OF_RADIANS: Self = Self::new("°", 180.0 / std::f64::consts::PI, 0.2);
    /// Seconds.
    pub const SECONDS: Self = Self::new("s", 1.0, 0.02);
    /// A rate, per second.
    pub const PER_SECOND: Self = Self::new("1/s", 1.0, 0.01);
    /// Kelvin.
    pub const KELVIN: Self = Self::new("K", 1.0, 0.5);

    /// A unit of its own.
    pub const fn new(name: &'static str, factor: f64, finest: f64) -> Self {
        Self { name, factor, finest }
    }
}

/// A number of a section: its name, what it does, its unit and its range. It is dragged or typed, and shows a button that
/// brings the default back while it differs from it.
///
/// A drag stays within the range; what is typed may leave it. Then the number is red, and whoever uses it says why it is
/// refused. A range that spans decades is dragged logarithmically.
#[derive(Clone, Debug)]
pub struct Value {
    label: &'static str,
    hint: &'static str,
    unit: Unit,
    range: RangeInclusive<f64>,
}

impl Value {
    /// A number called `label`. `hint` is one plain sentence that says what it does. The range is in the unit of the value
    /// itself, before [`Unit::factor`].
    pub fn new(label: &'static str, hint: &'static str, unit: Unit, range: RangeInclusive<f32>) -> Self {
        // In decimal digits as they are written, so that 0.1 is shown as 0.1.
        let exact = |bound: f32| bound.to_string().parse().unwrap_or(f64::from(bound));
        Self { label, hint, unit, range: exact(*range.start())..=exact(*range.end()) }
    }

    /// Shows a number in a row of its own. `default` is what the reset button brings back; `None` for a value that has no
    /// default, such as a position.
    pub fn show(&self, ui: &mut egui::Ui, value: &mut f32, default: impl Into<Option<f32>>) -> bool {
        self.row(ui, default.into().map(|default| [default]), |ui, width| {
            self.field(ui, value, width, self.suffix());
            [*value]
        })
        .map(|[default]| *value = default)
        .is_some()
    }

    /// The same for three numbers side by side, along x, y and z.
    pub fn show_vec3(&self, ui: &mut egui::Ui, value: &mut Vec3, default: impl Into<Option<Vec3>>) -> bool {
        let reset = self.numbers(ui, value.as_mut(), default.into().map(|default| default.to_array()));
        reset.map(|default| *value = Vec3::from(default)).is_some()
    }

    /// The same for a whole number.
    pub fn show_count(&self, ui: &mut egui::Ui, value: &mut u32, default: impl Into<Option<u32>>) -> bool {
        self.row(ui, default.into(), |ui, width| {
            let mut shown = f64::from(*value);
            let drag = self
                .drag(&mut shown, self.suffix())
                .fixed_decimals(0)
                .custom_formatter(|value, _| format!("{value:.0}"));
            let drag = drag.range(0.0..=f64::from(u32::MAX)).clamp_existing_to_range(false);
            if self.add(ui, drag, width, f64::from(*value)).changed() {
                *value = shown.round() as u32;
            }
            *value
        })
        .map(|default| *value = default)
        .is_some()
    }

    /// Several numbers side by side, below their label where there is no room beside it.
    fn numbers<const N: usize>(
        &self,
        ui: &mut egui::Ui,
        value: &mut [f32; N],
        default: Option<[f32; N]>,
    ) -> Option<[f32; N]> {
        self.row_of(ui, ui.available_width() < ROOM_FOR_THREE, default, |ui, width| {
            let gap = ui.spacing().item_spacing.x;
            let each = (width - gap * (N - 1) as f32) / N as f32;
            value.iter_mut().for_each(|value| self.field(ui, value, each, String::new()));
            *value
        })
    }

    fn row<T: PartialEq + Copy>(
        &self,
        ui: &mut egui::Ui,
        default: Option<T>,
        contents: impl FnOnce(&mut egui::Ui, f32) -> T,
    ) -> Option<T> {
        self.row_of(ui, false, default, contents)
    }

    /// A row, and what is to be put back in place of its value, if the user asks for that.
    fn row_of<T: PartialEq + Copy>(
        &self,
        ui: &mut egui::Ui,
        below: bool,
        default: Option<T>,
        contents: impl FnOnce(&mut egui::Ui, f32) -> T,
    ) -> Option<T> {
        let several = below || std::mem::size_of::<T>() > std::mem::size_of::<u32>();
        let hint = self.hint_text();
        Row { label: self.label, hint: self.hint, more: &hint, unit: Some(self.unit.name) }.show(
            ui,
            below,
            several,
            |ui, width| {
                let now = contents(ui, width);
                reset(ui, default.is_some_and(|default| default != now)).then_some(default).flatten()
            },
        )
    }

    /// One number, `width` logical pixels wide.
    pub(super) fn field(&self, ui: &mut egui::Ui, value: &mut f32, width: f32, suffix: String) {
        let before = f64::from(*value) * self.unit.factor;
        let mut shown = before;
        let response = self.add(ui, self.drag(&mut shown, suffix), width, f64::from(*value));
        if response.changed() {
            let wanted = shown / self.unit.factor;
            let inside = wanted.clamp(*self.range.start(), *self.range.end());
            *value = if response.dragged() { inside } else { wanted } as f32;
        }
    }

    fn drag<'a>(&self, shown: &'a mut f64, suffix: String) -> egui::DragValue<'a> {
        let speed = self.speed(*shown);
        egui::DragValue::new(shown).speed(speed).suffix(suffix).custom_formatter(|value, _| digits(value))
    }

    fn add(&self, ui: &mut egui::Ui, drag: egui::DragValue, width: f32, value: f64) -> egui::Response {
        let size = egui::vec2(width.max(1.0), ui.spacing().interact_size.y);
        let is_refused = !self.allows(value);
        #[cfg(test)]
        super::rows::recorded::note_field(ui);
        let error = ui.visuals().error_fg_color;
        let response = ui
            .scope(|ui| {
                if is_refused {
                    ui.visuals_mut().override_text_color = Some(error);
                }
                ui.add_sized(size, drag)
            })
            .inner;
        response.on_hover_ui(|ui| {
            ui.label(self.hint);
            ui.weak(self.hint_text());
        })
    }

    /// Whether a value lies within the range, but for rounding.
    fn allows(&self, value: f64) -> bool {
        let (start, end) = (*self.range.start(), *self.range.end());
        let rounding = 1e-6 * value.abs();
        value >= start - rounding && value <= end + rounding
    }

    /// Change for each pixel of a drag, in the unit shown.
    fn speed(&self, shown: f64) -> f64 {
        let [start, end] = [*self.range.start(), *self.range.end()].map(|bound| bound * self.unit.factor);
        if self.is_logarithmic() {
            (shown.abs() * LOGARITHMIC).max(self.unit.finest)
        } else {
            ((end - start) * LINEAR).min(10.0 * self.unit.finest)
        }
    }

    /// Whether the range spans decades.
    fn is_logarithmic(&self) -> bool {
        let (start, end) = (*self.range.start(), *self.range.end());
        let smallest = if start > 0.0 { start } else { self.unit.finest / self.unit.factor };
        start >= 0.0 && end > SPANS * smallest
    }

    fn suffix(&self) -> String {
        if self.unit.name.is_empty() { String::new() } else { format!(" {}", self.unit.name) }
    }

    /// The range in words.
    fn hint_text(&self) -> String {
        let [start, end] = [*self.range.start(), *self.range.end()].map(|bound| bound * self.unit.factor);
        let above = if *self.range.start() > 0.0 && *self.range.start() < 1e-30 { "above 0" } else { "" };
        let start = if above.is_empty() { digits(start) } else { above.into() };
        format!("{start} to {}{}", digits(end), self.suffix())
    }
}

/// A number with four digits that count, and no more zeros than it needs.
fn digits(value: f64) -> String {
    let size = value.abs();
    if !value.is_finite() {
        return value.to_string();
    }
    if size < 1e-9 {
        return "0".into();
    }
    if !(1e-3..1e6).contains(&size) {
        let text = format!("{value:.2e}");
        let (number, power) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{power}", trimmed(number));
    }
    let decimals = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
    trimmed(&format!("{value:.decimals$}")).into()
}

/// Without zeros at the end behind the point.
fn trimmed(number: &str) -> &str {
    if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_keep_four_digits() {
        let texts = [
            (0.0, "0"),
            (1.0, "1"),
            (-12.3456, "-12.35"),
            (5500.0, "5500"),
            (123_456.0, "123456"),
            (1e9, "1e9"),
            (2.5e-5, "2.5e-5"),
            (0.0123, "0.0123"),
        ];
        for (value, text) in texts {
            assert_eq!(digits(value), text);
        }
    }

    #[test]
    fn a_range_that_spans_decades_is_dragged_by_shares_and_a_narrow_one_is_not() {
        let wide = Value::new("a", "A.", Unit::NONE, 0.01..=1e9);
        assert!((wide.speed(5000.0) - 50.0).abs() < 1e-9 && (wide.speed(0.5) - 0.005).abs() < 1e-9);
        let narrow = Value::new("a", "A.", Unit::NONE, -1.0..=1.0);
        assert_eq!(narrow.speed(0.1), narrow.speed(0.9));
    }

    #[test]
    fn the_tooltip_tells_the_range_in_the_unit_that_is_shown() {
        let text = |unit, range| Value::new("a", "A.", unit, range).hint_text();
        assert_eq!(text(Unit::MILLIMETRES, 1e-6..=0.1), "0.001 to 100 mm");
        assert_eq!(text(Unit::NONE, f32::MIN_POSITIVE..=1e3), "above 0 to 1000");
    }
}
