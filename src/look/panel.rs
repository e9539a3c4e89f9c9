//! The inspector's section of the scene: time of day, sky, exposure.

use bevy::prelude::*;
use bevy_cloth_inspector::widgets::{self, Unit, Value};
use bevy_egui::egui;

use super::View;
use crate::scenes::Opened;

const HOURS: Unit = Unit::new("h", 1.0, 0.02);
const STOPS: Unit = Unit::new("stops", 1.0, 0.02);

/// Shows how the scene is shown. What its file says is the default.
pub fn show(InMut(ui): InMut<egui::Ui>, mut view: ResMut<View>, opened: Res<Opened>) {
    let (mut now, file) = (view.0.clone(), &opened.scene.view);
    widgets::reading(ui, "scene", "The scene that is open; M shows all.", &opened.scene.title);
    let hint = "Time of day: the sun rises at 6, stands highest at 12 and sets at 18.";
    Value::new("time of day", hint, HOURS, 0.0..=24.0).show(ui, &mut now.hour, file.hour);
    let hint = "From where the sun shines at noon, about the vertical, from the first view.";
    Value::new("sun at noon", hint, Unit::DEGREES, -180.0..=180.0).show(ui, &mut now.noon, file.noon);
    let hint = "How much of the sky is clouded; all of it hides the sun.";
    Value::new("clouds", hint, Unit::PERCENT, 0.0..=1.0).show(ui, &mut now.clouds, file.clouds);
    let hint = "How much brighter the picture is than at normal exposure.";
    Value::new("exposure", hint, STOPS, -8.0..=8.0).show(ui, &mut now.exposure, file.exposure);
    if now != view.0
        && now.hour.is_finite()
        && now.noon.is_finite()
        && now.clouds.is_finite()
        && now.exposure.is_finite()
    {
        view.0 = now;
    }
}
