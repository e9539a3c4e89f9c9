//! The palette: one row of tools at the bottom of the view, a hint above it, and the cursor over the scene.

use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_cloth::{Cloth, Flammable};
use bevy_cloth_inspector::PanelWidth;
use bevy_egui::input::EguiWantsInput;
use bevy_egui::{EguiContexts, EguiPrimaryContextPass, egui};

use super::blow::BlowSpeed;
use super::{ActiveTool, Face, Tool};
use crate::mouse::Mouse;
use crate::throw::ThrowSpeed;

/// Height of the icons, points.
const ICON: f32 = 19.0;
/// How far the row and the hint are from the lower edge, points.
const HEIGHT: [f32; 2] = [6.0, 48.0];
/// Where the icon is beside the pointer, points.
const BADGE: egui::Vec2 = egui::vec2(13.0, 12.0);
/// Colour of the names of keys.
const KEYS: egui::Color32 = egui::Color32::from_gray(190);
/// Behind row and hint.
const BACKGROUND: egui::Color32 = egui::Color32::from_black_alpha(130);

pub fn plugin(app: &mut App) {
    app.add_systems(EguiPrimaryContextPass, (show_row, show_hint, show_cursor));
}

/// An area at the bottom middle of the scene, which ends where the inspector begins.
fn area(id: &'static str, height: f32, panel: &PanelWidth) -> egui::Area {
    egui::Area::new(id.into()).anchor(egui::Align2::CENTER_BOTTOM, [-panel.0 / 2.0, -height])
}

fn frame() -> egui::Frame {
    egui::Frame::new().fill(BACKGROUND).corner_radius(6).inner_margin(egui::Margin::symmetric(6, 3))
}

fn show_row(mut contexts: EguiContexts, mut active: ResMut<ActiveTool>, panel: Res<PanelWidth>) -> Result {
    let context = contexts.ctx_mut()?;
    let mut chosen = active.0;
    area("tools", HEIGHT[0], &panel).show(context, |ui| {
        frame().show(ui, |ui| {
            ui.horizontal(|ui| {
                for tool in Tool::ALL {
                    let Face { icon, name, key_name, hint, .. } = tool.face();
                    let icon = egui::RichText::new(icon).size(ICON).color(egui::Color32::WHITE);
                    let key = egui::RichText::new(key_name).size(11.0).color(KEYS);
                    let button = egui::Button::selectable(chosen == tool, (icon, key));
                    if ui.add(button).on_hover_text(format!("{name}: {hint}")).clicked() {
                        chosen = tool;
                    }
                }
            });
        });
    });
    active.set_if_neq(ActiveTool(chosen));
    Ok(())
}

fn show_hint(
    mut contexts: EguiContexts,
    active: Res<ActiveTool>,
    panel: Res<PanelWidth>,
    (mut ball, mut blow): (ResMut<ThrowSpeed>, ResMut<BlowSpeed>),
    cloths: Query<(), With<Cloth>>,
    flammable: Query<(), (With<Cloth>, With<Flammable>)>,
) -> Result {
    let context = contexts.ctx_mut()?;
    let Face { name, hint, .. } = active.0.face();
    let burns = matches!(active.0, Tool::Match | Tool::Water);
    let hint = match burns && flammable.is_empty() && !cloths.is_empty() {
        true => "no cloth of this scene can burn; the inspector (Tab) changes that",
        false => hint,
    };
    let speed = match active.0 {
        Tool::Ball => Some((ball.0, ThrowSpeed::RANGE)),
        Tool::Blow => Some((blow.0, BlowSpeed::RANGE)),
        _ => None,
    };
    let mut changed = speed.as_ref().map(|(speed, _)| *speed);
    let area = area("hint of the tool", HEIGHT[1], &panel).interactable(speed.is_some());
    area.show(context, |ui| {
        frame().show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.strong(name);
                ui.label(egui::RichText::new(hint).color(egui::Color32::WHITE));
                if let (Some(value), Some((_, range))) = (&mut changed, speed.clone()) {
                    ui.add(egui::Slider::new(value, range).fixed_decimals(0).logarithmic(true).suffix(" m/s"));
                }
            });
        });
    });
    match (active.0, changed) {
        (Tool::Ball, Some(value)) => drop(ball.set_if_neq(ThrowSpeed(value))),
        (Tool::Blow, Some(value)) => drop(blow.set_if_neq(BlowSpeed(value))),
        _ => {}
    }
    Ok(())
}

/// Over the scene the cursor is the tool's, with its icon beside it; the hand closes while it holds something.
fn show_cursor(
    mut contexts: EguiContexts,
    active: Res<ActiveTool>,
    mouse: Mouse,
    panels: Res<EguiWantsInput>,
    windows: Query<&Window, With<PrimaryWindow>>,
) -> Result {
    let Some(at) = windows.single().ok().and_then(Window::cursor_position) else { return Ok(()) };
    if panels.wants_any_pointer_input() || !mouse.is_for_tool() {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let face = active.0.face();
    context.set_cursor_icon(match face.cursor {
        egui::CursorIcon::Grab if mouse.holds() => egui::CursorIcon::Grabbing,
        cursor => cursor,
    });
    if active.0 != Tool::Hand {
        let painter = context.layer_painter(egui::LayerId::new(egui::Order::Tooltip, "tool".into()));
        let font = egui::FontId::proportional(ICON);
        for (offset, color) in [(1.0, egui::Color32::from_white_alpha(180)), (0.0, egui::Color32::from_gray(20))] {
            let place = egui::pos2(at.x, at.y) + BADGE + egui::Vec2::splat(offset);
            painter.text(place, egui::Align2::LEFT_TOP, face.icon, font.clone(), color);
        }
    }
    Ok(())
}
