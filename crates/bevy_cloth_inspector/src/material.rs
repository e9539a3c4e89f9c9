//! The material of the selected object: colour, roughness, metal, reflectance.

use bevy::prelude::*;
use bevy_egui::egui;

use crate::Selected;
use crate::widgets::{self, Unit, Value};

/// The selected entity, or else the first one below it, that has a [`StandardMaterial`].
pub fn of_selected(world: &World) -> Option<Entity> {
    let root = world.resource::<Selected>().0?;
    let has = |entity: &Entity| world.get::<MeshMaterial3d<StandardMaterial>>(*entity).is_some();
    let children = world.get::<Children>(root).map_or(&[][..], |children| children);
    std::iter::once(root).chain(children.iter().copied()).find(has)
}

/// Shows the material of `entity`. All that shares it changes along with it.
pub fn show(ui: &mut egui::Ui, world: &mut World, entity: Entity) {
    let Some(handle) = world.get::<MeshMaterial3d<StandardMaterial>>(entity).map(|material| material.0.clone()) else {
        return;
    };
    let Some(mut materials) = world.get_resource_mut::<Assets<StandardMaterial>>() else { return };
    let Some(material) = materials.get(&handle) else { return };
    let mut look = Look::of(material);
    if look.show(ui)
        && let Some(mut material) = materials.get_mut(&handle)
    {
        look.write(&mut material);
    }
}

/// What of a material is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Look {
    color: Color,
    roughness: f32,
    metallic: f32,
    reflectance: f32,
}

impl Look {
    fn of(material: &StandardMaterial) -> Self {
        let StandardMaterial { base_color: color, perceptual_roughness: roughness, metallic, reflectance, .. } =
            *material;
        Self { color, roughness, metallic, reflectance }
    }

    fn write(self, material: &mut StandardMaterial) {
        material.base_color = self.color;
        material.perceptual_roughness = self.roughness;
        material.metallic = self.metallic;
        material.reflectance = self.reflectance;
    }

    /// Tells whether it was changed.
    fn show(&mut self, ui: &mut egui::Ui) -> bool {
        let (before, default) = (*self, Self::of(&StandardMaterial::default()));
        widgets::color(ui, "colour", "Colour of the surface.", &mut self.color, default.color);
        let hint = "From a mirror (9 %) to chalk (100 %).";
        Value::new("roughness", hint, Unit::PERCENT, 0.089..=1.0).show(ui, &mut self.roughness, default.roughness);
        let hint = "Whether it is metal; in between is neither.";
        Value::new("metallic", hint, Unit::PERCENT, 0.0..=1.0).show(ui, &mut self.metallic, default.metallic);
        let hint = "How much light it reflects where it is looked at straight; 50 % for most things.";
        let row = Value::new("reflectance", hint, Unit::PERCENT, 0.0..=1.0);
        row.show(ui, &mut self.reflectance, default.reflectance);
        *self != before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_material_of_a_child_is_shown_if_the_selected_object_has_none() {
        let mut world = World::new();
        let root = world.spawn_empty().id();
        let child = world.spawn((MeshMaterial3d::<StandardMaterial>::default(), ChildOf(root))).id();
        for (selected, expected) in [(None, None), (Some(root), Some(child)), (Some(child), Some(child))] {
            world.insert_resource(Selected(selected));
            assert_eq!(of_selected(&world), expected);
        }
    }
}
