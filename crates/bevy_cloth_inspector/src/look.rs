//! How a cloth looks: weave, colours, pattern, threads, sheen.

use bevy::prelude::*;
use bevy_cloth::{ClothLook, Pattern, Weave};
use bevy_egui::egui;

use crate::widgets::{self, Unit, Value};

const PER_METRE: Unit = Unit::new("1/m", 1.0, 5.0);

/// Shows how `cloth` looks.
pub fn show(ui: &mut egui::Ui, world: &mut World, cloth: Entity) {
    let mut on = world.entity(cloth).contains::<ClothLook>();
    let hint = "Draws it as a fabric in place of its plain material.";
    if widgets::switch(ui, "as fabric", hint, &mut on, None) {
        match on {
            true => drop(world.entity_mut(cloth).insert(ClothLook::default())),
            false => drop(world.entity_mut(cloth).remove::<ClothLook>()),
        }
    }
    widgets::edit(world, cloth, |look: &mut ClothLook| values(ui, look));
}

fn values(ui: &mut egui::Ui, look: &mut ClothLook) {
    let weaves = Weave::ALL.into_iter().map(|weave| (weave, weave_name(weave)));
    let mut weave = look.weave;
    if widgets::choice(
        ui,
        "weave",
        "How the threads cross; another weave brings its own threads and gloss.",
        &mut weave,
        None,
        weaves,
    ) {
        let ClothLook { color, second, pattern, .. } = *look;
        *look = ClothLook { second, pattern, ..ClothLook::new(weave, color) };
    }
    let default = ClothLook::new(look.weave, look.color);
    widgets::color(
        ui,
        "colour",
        "Main colour: of the warp, and of the weft unless that has its own.",
        &mut look.color,
        ClothLook::default().color,
    );
    let mut has_second = look.second.is_some();
    let hint = "Whether pattern or weft have a colour of their own.";
    if widgets::switch(ui, "second colour", hint, &mut has_second, false) {
        look.second = has_second.then_some(Color::WHITE);
    }
    if let Some(second) = &mut look.second {
        widgets::color(ui, "second", "Colour of the pattern, or without one of the weft.", second, Color::WHITE);
    }
    pattern(ui, &mut look.pattern);
    let hint = "Threads per metre as they are seen.";
    Value::new("threads", hint, PER_METRE, 50.0..=20_000.0).show(ui, &mut look.threads, default.threads);
    let hint = "How strongly fibres that stand out shine where the cloth is seen edge-on.";
    Value::new("sheen", hint, Unit::PERCENT, 0.0..=1.0).show(ui, &mut look.sheen, default.sheen);
    let hint = "Which part of the light shines through.";
    Value::new("translucency", hint, Unit::PERCENT, 0.0..=1.0).show(ui, &mut look.translucency, default.translucency);
    let hint = "How smooth the threads are: matt cotton 0 %, shining silk 100 %.";
    Value::new("gloss", hint, Unit::PERCENT, 0.0..=1.0).show(ui, &mut look.gloss, default.gloss);
}

fn weave_name(weave: Weave) -> &'static str {
    match weave {
        Weave::Plain => "plain",
        Weave::Twill => "twill",
        Weave::Satin => "satin",
        Weave::Terry => "terry",
        Weave::Knit => "knit",
        Weave::Ripstop => "ripstop",
        Weave::Velvet => "velvet",
    }
}

/// Patterns to choose from, each of a usual size.
const PATTERNS: [(Pattern, &str); 5] = [
    (Pattern::None, "none"),
    (Pattern::Stripes { width: 0.05, across: false }, "stripes"),
    (Pattern::Check { width: 0.02 }, "check"),
    (Pattern::Border { width: 0.05 }, "border"),
    (Pattern::Bands { count: 3, across: true }, "bands"),
];

fn pattern(ui: &mut egui::Ui, pattern: &mut Pattern) {
    let kind = |pattern: &Pattern| {
        let same = |(other, _): &(Pattern, _)| std::mem::discriminant(other) == std::mem::discriminant(pattern);
        PATTERNS.iter().position(same).unwrap_or(0)
    };
    let mut chosen = kind(pattern);
    let kinds = PATTERNS.iter().enumerate().map(|(index, (_, name))| (index, *name));
    if widgets::choice(ui, "pattern", "Pattern of main and second colour.", &mut chosen, 0, kinds) {
        *pattern = PATTERNS[chosen].0;
    }
    let wide = |ui: &mut egui::Ui, width: &mut f32| {
        let hint = "Width of each stripe.";
        Value::new("stripe", hint, Unit::MILLIMETRES, 1e-3..=10.0).show(ui, width, None);
    };
    let turned = |ui: &mut egui::Ui, across: &mut bool| {
        let hint = "Whether stripes run across the cloth, along the weft, or down it.";
        widgets::switch(ui, "across", hint, across, None);
    };
    match pattern {
        Pattern::None => {}
        Pattern::Stripes { width, across } => {
            wide(ui, width);
            turned(ui, across);
        }
        Pattern::Check { width } | Pattern::Border { width } => wide(ui, width),
        Pattern::Bands { count, across } => {
            Value::new("bands", "How many bands.", Unit::NONE, 1.0..=100.0).show_count(ui, count, None);
            turned(ui, across);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looking_at_any_pattern_changes_nothing() {
        for (pattern, _) in PATTERNS {
            let look = ClothLook::default().with_pattern(pattern, Color::BLACK);
            let mut world = World::new();
            let cloth = world.spawn(look).id();
            world.clear_trackers();
            let _ = egui::Context::default().run_ui(egui::RawInput::default(), |ui| show(ui, &mut world, cloth));
            assert!(!world.entity(cloth).get_ref::<ClothLook>().unwrap().is_changed(), "{pattern:?}");
        }
    }
}
