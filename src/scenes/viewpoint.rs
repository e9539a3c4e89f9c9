//! From where a scene is looked at that does not say it.

use bevy::prelude::*;
use bevy_cloth::Method;
use bevy_cloth::cloth_solver::measure;
use cloth_scene::{Scene, SceneFan, SceneShape, World};

use crate::camera::Viewpoint;

/// From where a scene is looked at, from its middle.
const DIRECTION: Vec3 = Vec3::new(0.42, 0.32, 1.0);
/// Distance of the camera, in radii of the scene.
const DISTANCE: f32 = 2.2;
/// The least height of the camera above the ground, m.
const LOWEST: f32 = 0.3;
/// How long the scene is played beforehand to see where its cloths will be, s, and how coarsely; by the default method,
/// which so few substeps suffice.
const FORESEEN: (f32, u32, u32) = (3.0, 4, 5);

/// The box around all that the scene shows in its first seconds, ground apart, m: found by playing it coarsely.
pub fn bounds(scene: &Scene) -> (Vec3, Vec3) {
    let (seconds, fewer, substeps) = FORESEEN;
    let mut coarse = scene.clone();
    (coarse.rate, coarse.substeps, coarse.method) = (60.0, substeps, Method::default());
    for cloth in &mut coarse.cloths {
        cloth.cells = (cloth.cells / fewer).max(UVec2::ONE);
    }
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for collider in &scene.colliders {
        let (at, half) = (collider.place.at, half_extent(&collider.shape));
        if let Some(half) = half {
            (low, high) = (low.min(at - half), high.max(at + half));
        }
    }
    for SceneFan { fan, place, .. } in &scene.fans {
        (low, high) = (low.min(place.at - fan.diameter / 2.0), high.max(place.at + fan.diameter / 2.0));
    }
    if let Ok(mut play) = World::new(&coarse) {
        for _ in 0..=(seconds.min(scene.seconds) * coarse.rate) as u32 {
            for (cloth, frame) in play.cloths.iter().zip(&play.frames) {
                let (from, to) = measure::bounds(&cloth.topology, &cloth.particles.position);
                for corner in 0..8 {
                    let pick = |axis: usize| if corner >> axis & 1 == 0 { from[axis] } else { to[axis] };
                    let corner = frame.point(Vec3::new(pick(0), pick(1), pick(2)));
                    if corner.is_finite() {
                        (low, high) = (low.min(corner), high.max(corner));
                    }
                }
            }
            play.tick();
        }
    }
    if low.cmple(high).all() { (low, high) } else { (Vec3::NEG_ONE, Vec3::ONE) }
}

/// Half the edges of a box around a shape however it is turned, m; `None` of what has no end.
fn half_extent(shape: &SceneShape) -> Option<Vec3> {
    match *shape {
        SceneShape::Sphere { radius } => Some(Vec3::splat(radius)),
        SceneShape::Capsule { radius, length } => Some(Vec3::new(radius, radius + length / 2.0, radius)),
        SceneShape::Cuboid { size } => Some(size / 2.0),
        SceneShape::Pyramid { base, height } => Some(Vec3::new(base.x, height, base.y) / 2.0),
        SceneShape::Ellipsoid { radii } => Some(radii),
        SceneShape::Cylinder { radius, height } | SceneShape::Cone { radius, height } => {
            Some(Vec3::new(radius, height / 2.0, radius))
        }
        SceneShape::RoundedCuboid { size, .. } => Some(size / 2.0),
        SceneShape::Ground => None,
    }
}

/// A place from where the whole box is seen.
pub fn of(low: Vec3, high: Vec3) -> Viewpoint {
    let middle = (low + high) / 2.0;
    let radius = ((high - low).length() / 2.0).clamp(0.1, 20.0);
    let mut from = middle + DIRECTION.normalize() * (DISTANCE * radius);
    from.y = from.y.max(LOWEST);
    Viewpoint { from, to: middle, ..Viewpoint::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_camera_has_in_view_what_a_swing_falls_to() {
        let (low, high) = bounds(&crate::scenes::open("swing").expect("there"));
        assert!(low.y < 0.6 && high.y >= 1.5 && high.z > 0.4, "{low} {high}");
        let Viewpoint { from, to, .. } = of(low, high);
        assert!((to - (low + high) / 2.0).length() < 1e-6 && from.z > high.z);
    }
}
