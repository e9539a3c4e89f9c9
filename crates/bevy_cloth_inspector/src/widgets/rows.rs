//! Rows of a section: a label on the left, a value on the right, the same widths in every section.

use bevy::prelude::*;
use bevy_egui::egui;

/// Part of a row that its label takes.
const LABEL: f32 = 0.40;
/// Width of a label, logical pixels: at least and at most.
const LABEL_WIDTHS: [f32; 2] = [84.0, 150.0];
/// Room for the reset button, logical pixels.
const RESET: f32 = 16.0;
/// Between label, value and button, logical pixels.
const GAP: f32 = 4.0;

/// What a row says of its value.
pub(super) struct Row<'a> {
    pub label: &'static str,
    pub hint: &'static str,
    /// A second line of the tooltip.
    pub more: &'a str,
    /// Of a number its unit; `None` for what is no number.
    pub unit: Option<&'static str>,
}

impl Row<'_> {
    /// Draws the row. `contents` gets the width that is left for the value; the reset button has room beside it. Where
    /// `names_unit` the unit stands at the label.
    pub fn show<R>(
        &self,
        ui: &mut egui::Ui,
        below: bool,
        names_unit: bool,
        contents: impl FnOnce(&mut egui::Ui, f32) -> R,
    ) -> R {
        #[cfg(test)]
        recorded::note(ui, self);
        let unit = self.unit.filter(|unit| names_unit && !unit.is_empty());
        if below {
            self.name(ui, ui.available_width(), unit);
            return ui.horizontal(|ui| self.value(ui, contents)).inner;
        }
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = GAP;
            let [least, most] = LABEL_WIDTHS;
            self.name(ui, (LABEL * ui.available_width()).clamp(least, most), unit);
            self.value(ui, contents)
        })
        .inner
    }

    /// The value, with room for the reset button behind it.
    fn value<R>(&self, ui: &mut egui::Ui, contents: impl FnOnce(&mut egui::Ui, f32) -> R) -> R {
        ui.spacing_mut().item_spacing.x = GAP;
        contents(ui, value_width(ui))
    }

    fn name(&self, ui: &mut egui::Ui, width: f32, unit: Option<&str>) {
        let size = egui::vec2(width, ui.spacing().interact_size.y);
        let text = match unit {
            Some(unit) => format!("{}, {unit}", self.label),
            None => self.label.to_owned(),
        };
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        ui.allocate_ui_with_layout(size, layout, |ui| {
            ui.set_min_width(width);
            ui.add(egui::Label::new(text).truncate()).on_hover_ui(|ui| {
                ui.label(self.hint);
                if !self.more.is_empty() {
                    ui.weak(self.more);
                }
            });
        });
    }
}

/// A button that brings a default back, or the room for it where there is nothing to bring back.
pub(super) fn reset(ui: &mut egui::Ui, differs: bool) -> bool {
    let size = egui::vec2(RESET, ui.spacing().interact_size.y);
    if !differs {
        return false;
    }
    let button = egui::Button::new("⟲").frame(false).min_size(size);
    ui.add(button).on_hover_text("Back to the default.").clicked()
}

/// Width of the value in the rest of a row, logical pixels: it leaves room for the reset button.
pub fn value_width(ui: &egui::Ui) -> f32 {
    (ui.available_width() - RESET - GAP).max(1.0)
}

/// A row with anything in it. `hint` is one plain sentence that says what it is.
pub fn row<R>(
    ui: &mut egui::Ui,
    label: &'static str,
    hint: &'static str,
    contents: impl FnOnce(&mut egui::Ui) -> R,
) -> R {
    Row { label, hint, more: "", unit: None }.show(ui, false, false, |ui, _| contents(ui))
}

/// Something that is on or off. Tells whether it was changed.
pub fn switch(
    ui: &mut egui::Ui,
    label: &'static str,
    hint: &'static str,
    on: &mut bool,
    default: impl Into<Option<bool>>,
) -> bool {
    let (before, default) = (*on, default.into());
    Row { label, hint, more: "", unit: None }.show(ui, false, false, |ui, width| {
        let size = egui::vec2(width, ui.spacing().interact_size.y);
        let text = if *on { "on" } else { "off" };
        ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.set_min_width(width);
            ui.checkbox(on, text).on_hover_text(hint);
        });
        if let Some(default) = default
            && reset(ui, default != *on)
        {
            *on = default;
        }
    });
    *on != before
}

/// One of several: a list that opens. Tells whether it was changed.
pub fn choice<T: PartialEq + Clone>(
    ui: &mut egui::Ui,
    label: &'static str,
    hint: &'static str,
    value: &mut T,
    default: impl Into<Option<T>>,
    choices: impl IntoIterator<Item = (T, &'static str)>,
) -> bool {
    let (before, default) = (value.clone(), default.into());
    let choices: Vec<(T, &str)> = choices.into_iter().collect();
    let shown = choices.iter().find(|(choice, _)| choice == value).map_or("own", |(_, name)| name);
    Row { label, hint, more: "", unit: None }.show(ui, false, false, |ui, width| {
        let combo = egui::ComboBox::from_id_salt(label).selected_text(shown).width(width).truncate();
        let response = combo.show_ui(ui, |ui| {
            for (choice, name) in &choices {
                ui.selectable_value(value, choice.clone(), *name);
            }
        });
        response.response.on_hover_text(hint);
        if let Some(default) = default
            && reset(ui, default != *value)
        {
            *value = default;
        }
    });
    *value != before
}

/// A colour. Tells whether it was changed.
pub fn color(
    ui: &mut egui::Ui,
    label: &'static str,
    hint: &'static str,
    value: &mut Color,
    default: impl Into<Option<Color>>,
) -> bool {
    let (before, default) = (*value, default.into());
    Row { label, hint, more: "", unit: None }.show(ui, false, false, |ui, width| {
        let Srgba { red, green, blue, alpha } = value.to_srgba();
        let mut rgb = [red, green, blue];
        ui.spacing_mut().interact_size.x = width;
        if ui.color_edit_button_rgb(&mut rgb).on_hover_text(hint).changed() {
            *value = Color::srgba(rgb[0], rgb[1], rgb[2], alpha);
        }
        if let Some(default) = default
            && reset(ui, default.to_srgba() != value.to_srgba())
        {
            *value = default;
        }
    });
    *value != before
}

/// A number or a word to read.
pub fn reading(ui: &mut egui::Ui, label: &'static str, hint: &'static str, text: impl Into<String>) {
    row(ui, label, hint, |ui| {
        ui.add(egui::Label::new(egui::RichText::new(text.into()).monospace()).truncate()).on_hover_text(hint);
    });
}

/// A remark, in weak letters.
pub fn note(ui: &mut egui::Ui, text: &str) {
    ui.add(egui::Label::new(egui::RichText::new(text).weak()).wrap());
}

/// A line that tells what was refused and why.
pub fn refusal(ui: &mut egui::Ui, reason: &str) {
    let text = egui::RichText::new(format!("⚠ {reason}")).color(ui.visuals().error_fg_color);
    ui.add(egui::Label::new(text).wrap());
}

/// What the rows said that were drawn, for tests.
#[cfg(test)]
pub(crate) mod recorded {
    use bevy_egui::egui;

    /// One row.
    #[derive(Clone, Debug, PartialEq)]
    pub struct Shown {
        pub label: &'static str,
        pub hint: &'static str,
        pub unit: Option<&'static str>,
    }

    fn id() -> egui::Id {
        egui::Id::new("rows of a test")
    }

    pub(super) fn note(ui: &egui::Ui, row: &super::Row) {
        let super::Row { label, hint, unit, .. } = *row;
        let shown = Shown { label, hint, unit };
        ui.data_mut(|data| data.get_temp_mut_or_default::<Vec<Shown>>(id()).push(shown));
    }

    fn fields_id() -> egui::Id {
        egui::Id::new("number fields of a test")
    }

    /// A number that can be dragged was drawn.
    pub(in crate::widgets) fn note_field(ui: &egui::Ui) {
        ui.data_mut(|data| *data.get_temp_mut_or_default::<usize>(fields_id()) += 1);
    }

    /// Number of fields since the last call.
    pub fn take_fields(context: &egui::Context) -> usize {
        context.data_mut(|data| std::mem::take(data.get_temp_mut_or_default::<usize>(fields_id())))
    }

    /// Opens every section from now on that was not shown before.
    pub fn open_all(context: &egui::Context) {
        context.data_mut(|data| data.insert_temp(egui::Id::new("all open"), true));
    }

    pub fn all_open(ui: &egui::Ui) -> bool {
        ui.data_mut(|data| data.get_temp(egui::Id::new("all open")).unwrap_or(false))
    }

    /// All rows since the last call.
    pub fn take(context: &egui::Context) -> Vec<Shown> {
        context.data_mut(|data| std::mem::take(data.get_temp_mut_or_default::<Vec<Shown>>(id())))
    }
}
