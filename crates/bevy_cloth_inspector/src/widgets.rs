//! Small pieces that the sections share: rows of numbers with units, and editing a component in place.

use bevy::ecs::component::Mutable;
use bevy::prelude::*;
use bevy_egui::egui;

/// A value dragged by one pixel changes by this share of itself.
const DRAG_SHARE: f64 = 0.005;

/// What rounds to zero is shown without a sign.
const NOTHING: f64 = 5e-4;

/// How a number is shown: its unit, and what it is multiplied by to be in that unit.
#[derive(Clone, Copy, Debug)]
pub struct Unit {
    /// Written behind the number.
    pub name: &'static str,
    /// SI times this is what is shown.
    pub factor: f64,
    /// The smallest change of a drag by one pixel, in this unit.
    pub finest: f64,
}

impl Unit {
    /// Metres.
    pub const METRES: Self = Self::new("m", 1.0, 0.005);
    /// Thousandths of a metre.
    pub const MILLIMETRES: Self = Self::new("mm", 1e3, 0.01);
    /// A pure number.
    pub const NONE: Self = Self::new("", 1.0, 0.005);
    /// Hundredths.
    pub const PERCENT: Self = Self::new("%", 1e2, 0.05);
    /// Degrees, for values in degrees.
    pub const DEGREES: Self = Self::new("°", 1.0, 0.5);

    /// A unit of its own.
    pub const fn new(name: &'static str, factor: f64, finest: f64) -> Self {
        Self { name, factor, finest }
    }
}

/// A grid of rows, a label and a value each.
pub fn rows(ui: &mut egui::Ui, name: &str, contents: impl FnOnce(&mut egui::Ui)) {
    egui::Grid::new(name).num_columns(2).min_col_width(96.0).spacing([8.0, 4.0]).show(ui, contents);
}

/// One row of a grid.
pub fn row<R>(ui: &mut egui::Ui, label: &str, hint: &str, contents: impl FnOnce(&mut egui::Ui) -> R) -> R {
    let response = ui.label(label);
    if !hint.is_empty() {
        response.on_hover_text(hint);
    }
    let answer = contents(ui);
    ui.end_row();
    answer
}

/// A number that can be dragged or typed. It takes any value: what is not allowed is refused, with the reason, by the
/// one who uses it.
pub fn number(ui: &mut egui::Ui, value: &mut f32, unit: Unit) {
    let mut shown = f64::from(*value) * unit.factor;
    if shown.abs() < NOTHING {
        shown = 0.0;
    }
    let suffix = if unit.name.is_empty() { String::new() } else { format!(" {}", unit.name) };
    let speed = (shown.abs() * DRAG_SHARE).max(unit.finest);
    if ui.add(egui::DragValue::new(&mut shown).speed(speed).max_decimals(3).suffix(suffix)).changed() {
        *value = (shown / unit.factor) as f32;
    }
}

/// Numbers side by side.
pub fn numbers<'a>(ui: &mut egui::Ui, values: impl IntoIterator<Item = &'a mut f32>, unit: Unit) {
    ui.horizontal(|ui| values.into_iter().for_each(|value| number(ui, value, unit)));
}

/// A labelled number in a row of its own.
pub fn number_row(ui: &mut egui::Ui, label: &str, hint: &str, value: &mut f32, unit: Unit) {
    row(ui, label, hint, |ui| number(ui, value, unit));
}

/// Lets `change` work on a copy of the component, and writes it back only if it differs, so that nothing counts as
/// changed because it was looked at.
pub fn edit<C>(world: &mut World, entity: Entity, change: impl FnOnce(&mut C))
where
    C: Component<Mutability = Mutable> + Clone + PartialEq,
{
    let Some(before) = world.get::<C>(entity).cloned() else { return };
    let mut after = before.clone();
    change(&mut after);
    if after != before
        && let Some(mut component) = world.get_mut::<C>(entity)
    {
        *component = after;
    }
}

/// As [`edit`], for a resource.
pub fn edit_resource<R>(world: &mut World, change: impl FnOnce(&mut R))
where
    R: Resource<Mutability = Mutable> + Clone + PartialEq,
{
    let Some(before) = world.get_resource::<R>().cloned() else { return };
    let mut after = before.clone();
    change(&mut after);
    if after != before {
        *world.resource_mut::<R>() = after;
    }
}

/// A line that tells what was refused and why.
pub fn refusal(ui: &mut egui::Ui, reason: &str) {
    ui.label(egui::RichText::new(format!("⚠ {reason}")).color(ui.visuals().error_fg_color));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Component, Clone, PartialEq, Debug)]
    struct Value(f32);

    #[test]
    fn looking_at_a_component_is_no_change_and_editing_it_is_one() {
        let mut world = World::new();
        let entity = world.spawn(Value(1.0)).id();
        world.clear_trackers();
        edit(&mut world, entity, |value: &mut Value| value.0 = 1.0);
        assert!(!world.entity(entity).get_ref::<Value>().expect("there").is_changed());
        edit(&mut world, entity, |value: &mut Value| value.0 = 2.0);
        let value = world.entity(entity).get_ref::<Value>().expect("there");
        assert!(value.is_changed());
        assert_eq!(*value, Value(2.0));
    }

    #[test]
    fn what_is_not_there_is_not_edited() {
        let mut world = World::new();
        let entity = world.spawn_empty().id();
        edit(&mut world, entity, |_: &mut Value| panic!("there is no component"));
    }
}
