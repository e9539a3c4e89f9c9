//! The selected object: shape, size, place, rotation; why it was refused; and all its components.

use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;
use bevy_cloth::{ClothCollider, ColliderFriction, ColliderRejected, Fan, WindRejected, WindZone};
use bevy_egui::egui;
use bevy_inspector_egui::bevy_inspector;

use crate::Selected;
use crate::widgets::{self, Unit};

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
    widgets::rows(ui, "object", |ui| {
        widgets::edit(world, entity, |collider: &mut ClothCollider| shape(ui, collider));
        widgets::edit(world, entity, |friction: &mut ColliderFriction| {
            widgets::number_row(ui, "friction", "Coulomb friction coefficient.", &mut friction.0, Unit::NONE);
        });
        widgets::edit(world, entity, |transform: &mut Transform| place(ui, transform));
    });
    ui.collapsing("All components", |ui| bevy_inspector::ui_for_entity(world, entity, ui));
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
        ClothCollider::Ground => "ground",
    }
}

fn shape(ui: &mut egui::Ui, collider: &mut ClothCollider) {
    widgets::row(ui, "shape", "", |ui| {
        egui::ComboBox::from_id_salt("shape").selected_text(kind_name(collider)).show_ui(ui, |ui| {
            for kind in kinds(collider) {
                let same = std::mem::discriminant(&kind) == std::mem::discriminant(collider);
                if ui.selectable_label(same, kind_name(&kind)).clicked() && !same {
                    *collider = kind;
                }
            }
        });
    });
    let mut length = |label, hint, value: &mut f32| widgets::number_row(ui, label, hint, value, Unit::METRES);
    match collider {
        ClothCollider::Sphere { radius } => length("radius", "", radius),
        ClothCollider::Capsule { radius, length: between } => {
            length("radius", "", radius);
            length("length", "Between the centres of the half-balls.", between);
        }
        ClothCollider::Cuboid { size } => {
            widgets::row(ui, "size", "Along x, y and z, m.", |ui| {
                widgets::numbers(ui, size.as_mut(), Unit { name: "", ..Unit::METRES });
            });
        }
        ClothCollider::Pyramid { base, height } => {
            length("base, x", "", &mut base.x);
            length("base, z", "", &mut base.y);
            length("height", "", height);
        }
        ClothCollider::Convex { planes } => {
            let planes = planes.len();
            widgets::row(ui, "planes", "", |ui| ui.label(planes.to_string()));
        }
        ClothCollider::Ellipsoid { radii } => {
            widgets::row(ui, "radii", "Along x, y and z, m.", |ui| {
                widgets::numbers(ui, radii.as_mut(), Unit { name: "", ..Unit::METRES });
            });
        }
        ClothCollider::Cylinder { radius, height } | ClothCollider::Cone { radius, height } => {
            length("radius", "", radius);
            length("height", "", height);
        }
        ClothCollider::RoundedCuboid { size, radius } => {
            length("edge radius", "", radius);
            widgets::row(ui, "size", "Along x, y and z, m.", |ui| {
                widgets::numbers(ui, size.as_mut(), Unit { name: "", ..Unit::METRES });
            });
        }
        ClothCollider::Hull { points } => {
            let points = points.len();
            widgets::row(ui, "points", "", |ui| ui.label(points.to_string()));
        }
        ClothCollider::HeightField { cells, thickness, .. } => {
            length("thickness", "Of the wall along the surface.", thickness);
            let cells = *cells;
            widgets::row(ui, "cells", "", |ui| ui.label(format!("{} × {}", cells.x, cells.y)));
        }
        ClothCollider::Mesh { thickness } => length("thickness", "Of the wall along the triangles.", thickness),
        ClothCollider::Ground => {}
    }
}

fn place(ui: &mut egui::Ui, transform: &mut Transform) {
    widgets::row(ui, "place", "Along x, y and z, m.", |ui| {
        widgets::numbers(ui, transform.translation.as_mut(), Unit { name: "", ..Unit::METRES });
    });
    let (x, y, z) = transform.rotation.to_euler(EulerRot::XYZ);
    let before = [x, y, z].map(f32::to_degrees);
    let mut after = before;
    widgets::row(ui, "rotation", "Around x, y and z, in this order.", |ui| {
        widgets::numbers(ui, &mut after, Unit::DEGREES)
    });
    if after != before {
        let [x, y, z] = after.map(f32::to_radians);
        transform.rotation = Quat::from_euler(EulerRot::XYZ, x, y, z);
    }
    widgets::row(ui, "scale", "", |ui| {
        widgets::numbers(ui, transform.scale.as_mut(), Unit { name: "", ..Unit::NONE });
    });
}
