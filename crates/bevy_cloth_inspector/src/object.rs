//! The selected object: shape, size, place, rotation; why it was refused; and all its components.

use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;
use bevy_cloth::{ClothCollider, ColliderRejected, Fan, WindRejected, WindZone};
use bevy_egui::egui;
use bevy_inspector_egui::bevy_inspector;

use crate::Selected;
use crate::widgets::{self, Unit, Value};

/// What was refused of each collider, fan and wind zone, until it changes.
#[derive(Resource, Default)]
pub struct Refusals(EntityHashMap<String>);

/// Keeps [`Refusals`].
pub fn note_refusals(
    mut refusals: ResMut<Refusals>,
    mut colliders: MessageReader<ColliderRejected>,
    mut winds: MessageReader<WindRejected>,
    changed: Query<Entity, Or<(Changed<ClothCollider>, Changed<Fan>, Changed<WindZone>, Changed<GlobalTransform>)>>,
) {
    refusals.0.retain(|entity, _| !changed.contains(*entity));
    refusals.0.extend(colliders.read().map(|message| (message.entity, message.error.to_string())));
    refusals.0.extend(winds.read().map(|message| (message.entity, message.error.to_string())));
}

/// Shows the selected object.
pub fn show(ui: &mut egui::Ui, world: &mut World) {
    let Some(entity) = world.resource::<Selected>().0.filter(|entity| world.get_entity(*entity).is_ok()) else {
        ui.label("Nothing. Click an object.");
        return;
    };
    let name = world.get::<Name>(entity).map_or_else(|| entity.to_string(), ToString::to_string);
    ui.strong(name);
    if let Some(reason) = world.resource::<Refusals>().0.get(&entity) {
        widgets::refusal(ui, reason);
    }
    widgets::edit(world, entity, |collider: &mut ClothCollider| shape(ui, collider));
    widgets::edit(world, entity, |transform: &mut Transform| place(ui, transform));
    ui.collapsing("All components", |ui| {
        // It takes what room it likes.
        egui::ScrollArea::horizontal().show(ui, |ui| bevy_inspector::ui_for_entity(world, entity, ui));
    });
}

/// The kinds of shape that can be chosen, each of about the size that `collider` has.
fn kinds(collider: &ClothCollider) -> [ClothCollider; 8] {
    let size = match *collider {
        ClothCollider::Sphere { radius } => Vec3::splat(2.0 * radius),
        ClothCollider::Capsule { radius, length } => Vec3::new(2.0 * radius, length + 2.0 * radius, 2.0 * radius),
        ClothCollider::Ellipsoid { radii } => 2.0 * radii,
        ClothCollider::Cylinder { radius, height } | ClothCollider::Cone { radius, height } => {
            Vec3::new(2.0 * radius, height, 2.0 * radius)
        }
        ClothCollider::Cuboid { size } | ClothCollider::RoundedCuboid { size, .. } => size,
        ClothCollider::Pyramid { base, height } => Vec3::new(base.x, height, base.y),
        ClothCollider::Convex { .. }
        | ClothCollider::Hull { .. }
        | ClothCollider::HeightField { .. }
        | ClothCollider::Mesh { .. }
        | ClothCollider::Triangles { .. }
        | ClothCollider::Ground => Vec3::splat(0.5),
    };
    let radius = size.x.min(size.z) / 2.0;
    [
        ClothCollider::Sphere { radius: size.min_element() / 2.0 },
        ClothCollider::Capsule { radius, length: (size.y - 2.0 * radius).max(radius) },
        ClothCollider::Cuboid { size },
        ClothCollider::Pyramid { base: size.xz(), height: size.y },
        ClothCollider::Ellipsoid { radii: size / 2.0 },
        ClothCollider::Cylinder { radius, height: size.y },
        ClothCollider::Cone { radius, height: size.y },
        ClothCollider::RoundedCuboid { size, radius: size.min_element() / 8.0 },
    ]
}

fn kind_name(collider: &ClothCollider) -> &'static str {
    match collider {
        ClothCollider::Sphere { .. } => "sphere",
        ClothCollider::Capsule { .. } => "capsule",
        ClothCollider::Cuboid { .. } => "cuboid",
        ClothCollider::Pyramid { .. } => "pyramid",
        ClothCollider::Ellipsoid { .. } => "ellipsoid",
        ClothCollider::Cylinder { .. } => "cylinder",
        ClothCollider::Cone { .. } => "cone",
        ClothCollider::RoundedCuboid { .. } => "rounded cuboid",
        ClothCollider::Convex { .. } => "convex solid",
        ClothCollider::Hull { .. } => "hull of points",
        ClothCollider::HeightField { .. } => "height field",
        ClothCollider::Mesh { .. } => "triangle mesh",
        ClothCollider::Triangles { .. } => "triangles",
        ClothCollider::Ground => "ground",
    }
}

fn shape(ui: &mut egui::Ui, collider: &mut ClothCollider) {
    widgets::row(ui, "shape", "Form of the solid.", |ui| {
        let combo = egui::ComboBox::from_id_salt("shape").selected_text(kind_name(collider));
        combo.width(widgets::value_width(ui)).truncate().show_ui(ui, |ui| {
            for kind in kinds(collider) {
                let same = std::mem::discriminant(&kind) == std::mem::discriminant(collider);
                if ui.selectable_label(same, kind_name(&kind)).clicked() && !same {
                    *collider = kind;
                }
            }
        });
    });
    let length = |ui: &mut egui::Ui, label, hint, value: &mut f32| {
        Value::new(label, hint, Unit::METRES, 1e-4..=1e4).show(ui, value, None);
    };
    let size_of = |ui: &mut egui::Ui, label, value: &mut Vec3| {
        Value::new(label, "Along x, y and z.", Unit::METRES, 1e-4..=1e4).show_vec3(ui, value, None);
    };
    match collider {
        ClothCollider::Sphere { radius } => length(ui, "radius", "Radius of the ball.", radius),
        ClothCollider::Capsule { radius, length: between } => {
            length(ui, "radius", "Radius of the capsule.", radius);
            let row = Value::new("length", "Between the centres of the half-balls.", Unit::METRES, 0.0..=1e4);
            row.show(ui, between, None);
        }
        ClothCollider::Cuboid { size } => size_of(ui, "size", size),
        ClothCollider::Pyramid { base, height } => {
            length(ui, "base, x", "Edge of the base along x.", &mut base.x);
            length(ui, "base, z", "Edge of the base along z.", &mut base.y);
            length(ui, "height", "From the base to the apex.", height);
        }
        ClothCollider::Convex { planes } => {
            widgets::reading(ui, "planes", "How many planes bound it.", planes.len().to_string());
        }
        ClothCollider::Ellipsoid { radii } => size_of(ui, "radii", radii),
        ClothCollider::Cylinder { radius, height } | ClothCollider::Cone { radius, height } => {
            length(ui, "radius", "Radius of the base.", radius);
            length(ui, "height", "From the base to the top.", height);
        }
        ClothCollider::RoundedCuboid { size, radius } => {
            length(ui, "edge radius", "Radius of the rounded edges.", radius);
            size_of(ui, "size", size);
        }
        ClothCollider::Hull { points } => {
            widgets::reading(ui, "points", "How many points it is the hull of.", points.len().to_string());
        }
        ClothCollider::HeightField { cells, thickness, .. } => {
            thick(ui, thickness);
            let text = format!("{} × {}", cells.x, cells.y);
            widgets::reading(ui, "cells", "Cells along x and z.", text);
        }
        ClothCollider::Mesh { thickness } | ClothCollider::Triangles { thickness, .. } => thick(ui, thickness),
        ClothCollider::Ground => {}
    }
}

fn thick(ui: &mut egui::Ui, thickness: &mut f32) {
    let row = Value::new("thickness", "Thickness of the wall along the surface.", Unit::METRES, 1e-3..=10.0);
    row.show(ui, thickness, None);
}

fn place(ui: &mut egui::Ui, transform: &mut Transform) {
    let row = Value::new("place", "Along x, y and z.", Unit::METRES, -1e6..=1e6);
    row.show_vec3(ui, &mut transform.translation, None);
    let (x, y, z) = transform.rotation.to_euler(EulerRot::XYZ);
    let before = Vec3::new(x, y, z).map(f32::to_degrees);
    let mut after = before;
    let row = Value::new("rotation", "Around x, y and z, in this order.", Unit::DEGREES, -360.0..=360.0);
    // A turn by a rounding error is none.
    let default = if before.abs().max_element() < 1e-3 { before } else { Vec3::ZERO };
    row.show_vec3(ui, &mut after, default);
    if after != before {
        let [x, y, z] = after.to_array().map(f32::to_radians);
        transform.rotation = Quat::from_euler(EulerRot::XYZ, x, y, z);
    }
    let row = Value::new("scale", "Along x, y and z; of a cloth it is part of the rest shape.", Unit::NONE, 1e-3..=1e3);
    row.show_vec3(ui, &mut transform.scale, Vec3::ONE);
}
