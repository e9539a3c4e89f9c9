//! The side panel: which sections it has, how wide it is, and which cloth it shows.

use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothCollider, Fan};
use bevy_egui::{EguiContext, PrimaryEguiContext, egui};

use crate::layout::InspectorLayout;
use crate::sections::InspectorSections;
use crate::{
    InspectorOpen, PanelWidth, Selected, advice, air, camera, cloth, contact, contact_view, damage, fabric, fire,
    light, look, material, motion, object, self_contact, statistics, world,
};

/// The panel takes no more than this part of the window.
const WIDEST: f32 = 1.0 / 3.0;
/// And no less than so many logical pixels, where that is no more than its part.
const NARROWEST: f32 = 200.0;
/// Width of the edge that is dragged, logical pixels.
const EDGE: f32 = 6.0;

/// Size of a section's title, points.
const TITLE: f32 = 13.5;
/// Width of the scroll bar, logical pixels.
const SCROLL_BAR: f32 = 7.0;
/// Room for the arrow of a section, logical pixels.
const INDENT: f32 = 13.0;
/// Colour of labels: brighter than egui's, to be read beside a bright scene.
const LABELS: egui::Color32 = egui::Color32::from_gray(185);
/// Colour of remarks.
const REMARKS: egui::Color32 = egui::Color32::from_gray(150);

/// Draws the panel into the primary egui context, if it is open.
pub fn show(world: &mut World) {
    let context = world.resource::<InspectorOpen>().0.then(|| primary_context(world)).flatten();
    let width = match &context {
        Some(context) => draw(context, world),
        None => {
            statistics::stop(world);
            advice::stop(world);
            0.0
        }
    };
    world.resource_mut::<PanelWidth>().set_if_neq(PanelWidth(width));
}

fn primary_context(world: &mut World) -> Option<egui::Context> {
    let mut contexts = world.query_filtered::<&mut EguiContext, With<PrimaryEguiContext>>();
    Some(contexts.single_mut(world).ok()?.get_mut().clone())
}

/// The width that the panel has in a window of `screen` logical pixels if the user wants `wanted`.
fn fitted(wanted: f32, screen: f32) -> f32 {
    let widest = (screen * WIDEST).floor();
    wanted.min(widest).max(NARROWEST.min(widest))
}

/// Draws the panel and tells its width.
pub(crate) fn draw(context: &egui::Context, world: &mut World) -> f32 {
    let screen = context.viewport_rect();
    let width = fitted(world.resource::<InspectorLayout>().width, screen.width());
    // An area of its own: a panel on egui's background would let clicks through to the scene.
    let corner = screen.right_top() - egui::vec2(width, 0.0);
    egui::Area::new("cloth inspector".into()).fixed_pos(corner).constrain(false).show(context, |ui| {
        let frame = egui::Frame::side_top_panel(ui.style());
        let size = egui::vec2(width, screen.height()) - frame.total_margin().sum();
        let whole = egui::Rect::from_min_size(corner, egui::vec2(width, screen.height()));
        frame.show(ui, |ui| {
            ui.set_min_size(size);
            ui.set_max_size(size);
            ui.spacing_mut().indent = INDENT;
            // A bar that grew under the pointer would cover the reset buttons.
            ui.spacing_mut().scroll = egui::style::ScrollStyle {
                bar_width: SCROLL_BAR,
                floating_allocated_width: SCROLL_BAR,
                ..egui::style::ScrollStyle::floating()
            };
            let visuals = ui.visuals_mut();
            visuals.indent_has_left_vline = false;
            visuals.widgets.noninteractive.fg_stroke.color = LABELS;
            visuals.weak_text_color = Some(REMARKS);
            egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| sections(ui, world));
        });
        resize(ui, whole, width, world);
    });
    width
}

/// Lets the user drag the left edge of the panel.
fn resize(ui: &egui::Ui, whole: egui::Rect, width: f32, world: &mut World) {
    let edge = whole.with_max_x(whole.left() + EDGE);
    let response = ui.interact(edge, "edge of the cloth inspector".into(), egui::Sense::drag());
    if response.hovered() || response.dragged() {
        ui.set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
        let line = ui.visuals().widgets.hovered.fg_stroke;
        ui.painter().vline(whole.left() + line.width / 2.0, whole.y_range(), line);
    }
    let by = response.drag_delta().x;
    if by != 0.0 {
        let screen = ui.ctx().viewport_rect().width();
        world.resource_mut::<InspectorLayout>().width = fitted(width - by, screen);
    }
}

fn sections(ui: &mut egui::Ui, world: &mut World) {
    let cloth = shown_cloth(world);
    section(ui, world, "Time", true, world::clock);
    let of_app = world.resource::<InspectorSections>().clone();
    for own in &of_app.0 {
        section(ui, world, &own.title, own.open, |ui, world| own.show(ui, world));
    }
    section(ui, world, "Selected object", true, object::show);
    if let Some(collider) = air::selected_with::<ClothCollider>(world) {
        section(ui, world, "Contact", false, |ui, world| contact::show(ui, world, collider));
    }
    if let Some(fan) = air::selected_with::<Fan>(world) {
        section(ui, world, "Fan", true, |ui, world| air::fan(ui, world, fan));
    }
    if let Some(entity) = material::of_selected(world) {
        section(ui, world, "Material", false, |ui, world| material::show(ui, world, entity));
    }
    if let Some(entity) = cloth {
        section(ui, world, "Cloth", false, |ui, world| cloth::show(ui, world, entity));
        section(ui, world, "Fabric", true, |ui, world| fabric::show(ui, world, entity));
        section(ui, world, "Look", false, |ui, world| look::show(ui, world, entity));
        section(ui, world, "Self-contact", false, |ui, world| self_contact::show(ui, world, entity));
        section(ui, world, "Contact view", false, |ui, world| contact_view::show(ui, world, entity));
        section(ui, world, "Tearing", false, |ui, world| damage::tearing(ui, world, entity));
        section(ui, world, "Fire", false, |ui, world| fire::show(ui, world, entity));
        section(ui, world, "Sleep", false, |ui, world| motion::sleep(ui, world, entity));
        section(ui, world, "Teleport", false, |ui, world| motion::teleport(ui, world, entity));
    }
    section(ui, world, "Wind", false, |ui, world| air::wind(ui, world, cloth));
    section(ui, world, "World", false, |ui, world| world::settings(ui, world, cloth));
    if let Some(entity) = camera::main_camera(world) {
        section(ui, world, "Camera", false, |ui, world| camera::show(ui, world, entity));
    }
    section(ui, world, "Light", false, light::show);
    let advised = cloth.is_some_and(|entity| {
        section(ui, world, "What could be left out", false, |ui, world| advice::show(ui, world, entity))
    });
    if !advised {
        advice::stop(world);
    }
    if !section(ui, world, "Statistics", false, |ui, world| statistics::show(ui, world, cloth)) {
        statistics::stop(world);
    }
}

/// A section that folds. Tells whether it is open.
fn section(
    ui: &mut egui::Ui,
    world: &mut World,
    title: &str,
    open: bool,
    contents: impl FnOnce(&mut egui::Ui, &mut World),
) -> bool {
    let layout = world.resource::<InspectorLayout>();
    let remembered = layout.open.get(title).copied();
    #[cfg(test)]
    let remembered = remembered.or(crate::widgets::recorded::all_open(ui).then_some(true));
    let mut is_open = false;
    let header = egui::CollapsingHeader::new(egui::RichText::new(title).strong().size(TITLE))
        .id_salt(title)
        .default_open(remembered.unwrap_or(open));
    let response = header.show(ui, |ui| {
        is_open = true;
        ui.spacing_mut().item_spacing.y = 4.0;
        contents(ui, world);
        ui.add_space(4.0);
    });
    if response.header_response.clicked() {
        let id = ui.make_persistent_id(title);
        let now = egui::collapsing_header::CollapsingState::load(ui.ctx(), id).is_some_and(|state| state.is_open());
        world.resource_mut::<InspectorLayout>().open.insert(title.to_owned(), now);
    }
    is_open
}

/// The selected cloth, or the one that hangs below what is selected, or the first one in the world.
fn shown_cloth(world: &mut World) -> Option<Entity> {
    let selected = world.resource::<Selected>().0;
    let mut clothes: Vec<Entity> = world.query_filtered::<Entity, With<Cloth>>().iter(world).collect();
    clothes.sort_unstable_by_key(|entity| entity.index_u32());
    let hangs_on = |cloth: Entity, on: Entity| {
        let parent = |entity| world.get::<ChildOf>(entity).map(ChildOf::parent);
        std::iter::successors(Some(cloth), |entity| parent(*entity)).any(|entity| entity == on)
    };
    selected
        .and_then(|on| clothes.iter().copied().find(|cloth| hangs_on(*cloth, on)))
        .or_else(|| clothes.first().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cloth_that_hangs_on_the_selected_rod_is_shown_else_the_first() {
        let mut world = World::new();
        let first = world.spawn(Cloth::default()).id();
        let rod = world.spawn_empty().id();
        let second = world.spawn((Cloth::default(), ChildOf(rod))).id();
        for (selected, shown) in [(None, first), (Some(rod), second), (Some(second), second), (Some(first), first)] {
            world.insert_resource(Selected(selected));
            assert_eq!(shown_cloth(&mut world), Some(shown));
        }
    }

    #[test]
    fn a_world_without_cloth_shows_none() {
        let mut world = World::new();
        world.init_resource::<Selected>();
        assert_eq!(shown_cloth(&mut world), None);
    }

    #[test]
    fn the_panel_takes_no_more_than_a_third_of_any_window() {
        for screen in [320.0, 800.0, 1280.0, 3840.0] {
            for wanted in [0.0, 310.0, 1e6] {
                assert!(fitted(wanted, screen) <= screen / 3.0, "{wanted} in {screen}");
            }
        }
        assert_eq!(fitted(310.0, 1280.0), 310.0);
        assert_eq!(fitted(0.0, 1280.0), NARROWEST);
    }
}
