//! The main camera: where it is, what it looks at, field of view, exposure, light of the surroundings.

use bevy::camera::Exposure;
use bevy::light::EnvironmentMapLight;
use bevy::prelude::*;
use bevy_egui::egui;

use crate::widgets::{Unit, Value};

/// Brightness in steps of a factor of two.
const EV100: Unit = Unit::new("EV100", 1.0, 0.05);
const CANDELA: Unit = Unit::new("cd/m²", 1.0, 1.0);

/// The point that the camera on this entity looks at, m. The panel shows it, and when the user changes it or the camera's
/// position writes it together with the [`Transform`].
///
/// Optional: without it the point of the line of sight nearest to the origin is shown. An app whose camera has a controller of its own
/// keeps both equal: it writes this when the controller moves, and moves the controller when this is changed.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default)]
pub struct CameraTarget(pub Vec3);

/// The active [`Camera3d`] that draws first.
pub fn main_camera(world: &mut World) -> Option<Entity> {
    let mut cameras = world.query_filtered::<(Entity, &Camera), With<Camera3d>>();
    let active = cameras.iter(world).filter(|(_, camera)| camera.is_active);
    active.min_by_key(|(_, camera)| camera.order).map(|(entity, _)| entity)
}

/// Shows the camera `entity`.
pub fn show(ui: &mut egui::Ui, world: &mut World, entity: Entity) {
    place(ui, world, entity);
    if let Some(Projection::Perspective(lens)) = world.get::<Projection>(entity) {
        let before = lens.fov;
        let mut fov = before;
        let hint = "Vertical field of view.";
        let row = Value::new("field of view", hint, Unit::DEGREES_OF_RADIANS, 0.02..=3.0);
        row.show(ui, &mut fov, PerspectiveProjection::default().fov);
        if fov != before
            && let Some(mut projection) = world.get_mut::<Projection>(entity)
            && let Projection::Perspective(lens) = &mut *projection
        {
            lens.fov = fov.clamp(0.02, 3.0);
        }
    }
    let default = Exposure::default().ev100;
    let before = world.get::<Exposure>(entity).map_or(default, |exposure| exposure.ev100);
    let mut ev100 = before;
    let hint = "Brightness the camera is set for: one more makes the picture half as bright.";
    Value::new("exposure", hint, EV100, -10.0..=25.0).show(ui, &mut ev100, default);
    if ev100 != before {
        world.entity_mut(entity).insert(Exposure { ev100 });
    }
    if let Some(light) = world.get::<EnvironmentMapLight>(entity) {
        let before = light.intensity;
        let mut intensity = before;
        let hint = "Brightness of the light that the surroundings throw from all sides.";
        Value::new("image light", hint, CANDELA, 0.0..=1e5).show(ui, &mut intensity, None);
        if intensity != before
            && let Some(mut light) = world.get_mut::<EnvironmentMapLight>(entity)
        {
            light.intensity = intensity;
        }
    }
}

fn place(ui: &mut egui::Ui, world: &mut World, entity: Entity) {
    let Some(transform) = world.get::<Transform>(entity).copied() else { return };
    let known = world.get::<CameraTarget>(entity).map(|target| target.0);
    let target = known.unwrap_or_else(|| nearest_to_origin(&transform));
    let (mut from, mut to) = (transform.translation, target);
    let row = Value::new("position", "Where the camera is, along x, y and z.", Unit::METRES, -1e6..=1e6);
    row.show_vec3(ui, &mut from, None);
    let row =
        Value::new("target", "The point in the middle of the picture, along x, y and z.", Unit::METRES, -1e6..=1e6);
    row.show_vec3(ui, &mut to, None);
    if (from, to) == (transform.translation, target) || from.distance_squared(to) < 1e-6 {
        return;
    }
    let mut camera = world.entity_mut(entity);
    camera.insert(Transform { translation: from, ..transform }.looking_at(to, Vec3::Y));
    if known.is_some() {
        camera.insert(CameraTarget(to));
    }
}

/// The point of the line of sight that is nearest to the origin, at least a metre ahead.
fn nearest_to_origin(camera: &Transform) -> Vec3 {
    let ahead = camera.forward();
    camera.translation + ahead * (-camera.translation).dot(*ahead).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_without_a_target_looks_at_what_is_nearest_to_the_origin() {
        let camera = Transform::from_xyz(0.0, 0.5, 3.0).looking_at(Vec3::new(0.0, 0.5, 0.0), Vec3::Y);
        assert!(nearest_to_origin(&camera).distance(Vec3::new(0.0, 0.5, 0.0)) < 1e-5);
    }

    #[test]
    fn looking_at_the_camera_does_not_move_it() {
        let mut world = World::new();
        let place = Transform::from_xyz(0.3, 1.5, 3.0).looking_at(Vec3::Y, Vec3::Y);
        let camera = world.spawn((Camera3d::default(), place)).id();
        assert_eq!(main_camera(&mut world), Some(camera));
        world.clear_trackers();
        let _ = egui::Context::default().run_ui(egui::RawInput::default(), |ui| show(ui, &mut world, camera));
        assert!(!world.entity(camera).get_ref::<Transform>().unwrap().is_changed());
        assert!(!world.entity(camera).contains::<Exposure>());
    }
}
