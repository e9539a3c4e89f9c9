//! The side panel: which sections it has, and which cloth it shows.

use bevy::prelude::*;
use bevy_cloth::{Cloth, Fan};
use bevy_egui::{EguiContext, PrimaryEguiContext, egui};

use crate::{
    InspectorOpen, PanelWidth, Selected, air, cloth, contact_view, damage, fabric, fire, motion, object, self_contact,
    statistics, world,
};

/// Width of the panel, logical pixels.
const WIDTH: f32 = 310.0;

/// Draws the panel into the primary egui context, if it is open.
pub fn show(world: &mut World) {
    let width = if world.resource::<InspectorOpen>().0 { draw(world) } else { None };
    world.resource_mut::<PanelWidth>().set_if_neq(PanelWidth(width.unwrap_or(0.0)));
}

/// Draws the panel and tells its width; `None` if there is no egui context.
fn draw(world: &mut World) -> Option<f32> {
    let mut contexts = world.query_filtered::<&mut EguiContext, With<PrimaryEguiContext>>();
    let context = contexts.single_mut(world).ok()?.get_mut().clone();
    // An area of its own: a panel on egui's background would let clicks through to the scene.
    let screen = context.viewport_rect();
    let corner = screen.right_top() - egui::vec2(WIDTH, 0.0);
    egui::Area::new("cloth inspector".into()).fixed_pos(corner).constrain(false).show(&context, |ui| {
        let frame = egui::Frame::side_top_panel(ui.style());
        let size = egui::vec2(WIDTH, screen.height()) - frame.total_margin().sum();
        frame.show(ui, |ui| {
            ui.set_min_size(size);
            ui.set_max_size(size);
            egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| sections(ui, world));
        });
    });
    Some(WIDTH)
}

fn sections(ui: &mut egui::Ui, world: &mut World) {
    let cloth = shown_cloth(world);
    section(ui, "Time", true, |ui| world::clock(ui, world));
    section(ui, "Selected object", true, |ui| object::show(ui, world));
    if let Some(entity) = cloth {
        section(ui, "Cloth", true, |ui| cloth::show(ui, world, entity));
        section(ui, "Fabric", true, |ui| fabric::show(ui, world, entity));
        section(ui, "Self-contact", true, |ui| self_contact::show(ui, world, entity));
        section(ui, "Contact view", false, |ui| contact_view::show(ui, world, entity));
        section(ui, "Tearing", true, |ui| damage::tearing(ui, world, entity));
        section(ui, "Fire", true, |ui| fire::show(ui, world, entity));
        section(ui, "Sleep", true, |ui| motion::sleep(ui, world, entity));
        section(ui, "Teleport", false, |ui| motion::teleport(ui, world, entity));
    }
    if let Some(fan) = air::selected_with::<Fan>(world) {
        section(ui, "Fan", true, |ui| air::fan(ui, world, fan));
    }
    section(ui, "Wind", true, |ui| air::wind(ui, world, cloth));
    section(ui, "World", true, |ui| world::settings(ui, world, cloth));
    section(ui, "Statistics", true, |ui| statistics::show(ui, world, cloth));
}

fn section(ui: &mut egui::Ui, title: &str, open: bool, contents: impl FnOnce(&mut egui::Ui)) {
    egui::CollapsingHeader::new(egui::RichText::new(title).strong()).default_open(open).show(ui, contents);
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
}
