//! Casts the rays of all pointers against the shape that is drawn of each cloth.

use std::sync::Arc;

use bevy::camera::Camera;
use bevy::camera::visibility::RenderLayers;
use bevy::ecs::change_detection::Tick;
use bevy::ecs::system::SystemParam;
use bevy::picking::Pickable;
use bevy::picking::backend::ray::RayMap;
use bevy::picking::backend::{HitData, PointerHits};
use bevy::prelude::*;
use cloth_solver::pick::Surface;
use cloth_solver::{Particles, Soa3, Topology, measure};

use super::{ClothHit, ClothPicking};
use crate::cloth::{ClothFrame, ClothTopology};
use crate::shown::ShownShape;

/// What rays are cast against: bounds of a cloth, and a hierarchy of its triangles made when the bounds are first met.
#[derive(Component)]
#[component(clone_behavior = Ignore)]
pub(crate) struct ClothSurface {
    topology: Arc<Topology>,
    /// What is drawn, or where nothing is drawn the particles.
    positions: Soa3,
    positions_of: [Tick; 2],
    bounds: (Vec3, Vec3),
    /// Made when the bounds are first met, and fitted to the positions unless it `is_stale`.
    surface: Option<Surface>,
    is_stale: bool,
}

/// The backend.
pub(crate) fn cast(
    settings: Res<ClothPicking>,
    rays: Res<RayMap>,
    cameras: Query<(&Camera, Option<&RenderLayers>)>,
    mut cloths: Query<(
        Entity,
        &ClothTopology,
        &ClothFrame,
        (Ref<Particles>, Ref<ShownShape>),
        Option<&RenderLayers>,
        Option<&Pickable>,
        Option<&mut ClothSurface>,
    )>,
    shown: Shown,
    mut output: MessageWriter<PointerHits>,
    mut commands: Commands,
) {
    if !settings.enabled {
        return;
    }
    for (id, ray) in rays.iter() {
        let Ok((camera, camera_layers)) = cameras.get(id.camera) else { continue };
        let mut picks = Vec::new();
        for (entity, topology, frame, (particles, shape), layers, pickable, surface) in &mut cloths {
            let same_layer = camera_layers.unwrap_or_default().intersects(layers.unwrap_or_default());
            if pickable.is_some_and(|p| !p.is_hoverable && !p.should_block_lower) || !same_layer || !shown.get(entity) {
                continue;
            }
            let Some(mut surface) = surface else {
                commands.entity(entity).try_insert(ClothSurface::new(topology, &particles, &shape));
                continue;
            };
            let local = Ray3d {
                origin: frame.to_local(ray.origin),
                direction: Dir3::new_unchecked((frame.pose.rotation.conjugate() * *ray.direction).normalize()),
            };
            let Some(hit) = surface.cast(topology, &particles, &shape, local) else { continue };
            let extra = ClothHit { particle: hit.particle, triangle: hit.triangle, weights: hit.weights.into() };
            let position = Some(ray.get_point(hit.distance));
            let normal = Some(frame.pose.rotation * hit.normal);
            picks.push((entity, HitData::new_with_extra(id.camera, hit.distance, position, normal, extra)));
        }
        if !picks.is_empty() {
            output.write(PointerHits::new(id.pointer, picks, camera.order as f32));
        }
    }
}

/// Tells what a user has hidden. Read from [`Visibility`] itself, which is there without a renderer as well.
#[derive(SystemParam)]
pub(crate) struct Shown<'w, 's> {
    entities: Query<'w, 's, (Option<&'static Visibility>, Option<&'static ChildOf>)>,
}

impl Shown<'_, '_> {
    pub fn get(&self, mut entity: Entity) -> bool {
        while let Ok((visibility, parent)) = self.entities.get(entity) {
            match (visibility, parent) {
                (Some(Visibility::Hidden), _) => return false,
                (Some(Visibility::Visible), _) | (_, None) => return true,
                (_, Some(parent)) => entity = parent.parent(),
            }
        }
        true
    }
}

impl ClothSurface {
    fn new(topology: &ClothTopology, particles: &Ref<Particles>, shape: &Ref<ShownShape>) -> Self {
        let positions = seen(topology, particles, shape);
        Self {
            topology: topology.0.clone(),
            bounds: measure::bounds(topology, &positions),
            positions,
            positions_of: [particles.last_changed(), shape.last_changed()],
            surface: None,
            is_stale: true,
        }
    }

    fn cast(
        &mut self,
        topology: &ClothTopology,
        particles: &Ref<Particles>,
        shape: &Ref<ShownShape>,
        ray: Ray3d,
    ) -> Option<cloth_solver::pick::SurfaceHit> {
        let now = [particles.last_changed(), shape.last_changed()];
        if self.positions_of != now || !Arc::ptr_eq(&self.topology, &topology.0) {
            self.positions = seen(topology, particles, shape);
            self.bounds = measure::bounds(topology, &self.positions);
            (self.positions_of, self.is_stale) = (now, true);
        }
        if !Arc::ptr_eq(&self.topology, &topology.0) {
            (self.topology, self.surface) = (topology.0.clone(), None);
        }
        if !meets(ray, self.bounds) {
            return None;
        }
        let surface = self.surface.get_or_insert_with(|| Surface::new(topology));
        if std::mem::take(&mut self.is_stale) {
            surface.refit(topology, &self.positions);
        }
        surface.cast(topology, &self.positions, ray.origin, *ray.direction)
    }
}

/// The positions that a pointer meets.
fn seen(topology: &Topology, particles: &Particles, shape: &ShownShape) -> Soa3 {
    match shape.positions() {
        drawn if drawn.len() == topology.slots() => Soa3::from_slice(drawn),
        _ => particles.position.clone(),
    }
}

/// Whether a ray meets a box, by slabs.
fn meets(ray: Ray3d, (low, high): (Vec3, Vec3)) -> bool {
    let per_metre = ray.direction.recip();
    let (a, b) = ((low - ray.origin) * per_metre, (high - ray.origin) * per_metre);
    let enter = a.min(b).max_element().max(0.0);
    let leave = a.max(b).min_element();
    // A ray in the very plane of a side gives a NaN, and gets the benefit of the doubt.
    enter <= leave || enter.is_nan() || leave.is_nan()
}
