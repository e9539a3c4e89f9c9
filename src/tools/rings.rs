//! Rings: the hand slides a ring along its rod, and what hangs on it follows.

use bevy::picking::PickingSystems;
use bevy::picking::backend::ray::{RayId, RayMap};
use bevy::picking::pointer::{PointerButton, PointerId, PointerPress};
use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothPicking, ClothReset, ClothTopology, ParticlePin, ParticlePins, PinTarget};

use super::{ActiveTool, Tool};
use crate::scenes::{DROP, Ring};

/// How far from a ring, along the rod, a press takes it, m.
const REACH: f32 = 0.05;
/// The least distance of two rings, m.
const APART: f32 = 0.015;
/// How far a ring slides beyond where the curtain ends at rest, m.
const BEYOND: f32 = 0.06;

/// A ring in the hand of a pointer.
#[derive(Component, Clone, Copy, Debug)]
struct Slid {
    pointer: PointerId,
    camera: Entity,
    /// From the ring to where it was taken, along the rod, m.
    offset: f32,
}

pub fn plugin(app: &mut App) {
    app.add_observer(take)
        .add_observer(send_home)
        .add_systems(PreUpdate, slide.in_set(PickingSystems::PostHover).run_if(any_with_component::<Slid>))
        .add_systems(Update, forget);
}

/// Takes the ring nearest to a press on a rod or its rings.
fn take(
    press: On<Pointer<Press>>,
    tool: Res<ActiveTool>,
    picking: Res<ClothPicking>,
    parents: Query<&ChildOf>,
    cloths: Query<(), With<Cloth>>,
    children: Query<&Children>,
    rings: Query<&Transform, With<Ring>>,
    places: Query<&GlobalTransform>,
    mut commands: Commands,
) {
    let hit = press.original_event_target();
    let is_hand = tool.0 == Tool::Hand && press.button == PointerButton::Primary && picking.enabled;
    if press.entity != hit || !is_hand || cloths.contains(hit) {
        return;
    }
    let Some(at) = press.hit.position else { return };
    for rod in parents.iter_ancestors(hit) {
        let (Ok(parts), Ok(place)) = (children.get(rod), places.get(rod)) else { continue };
        let along = place.affine().inverse().transform_point3(at).x;
        let offsets = parts.iter().filter_map(|part| Some((part, along - rings.get(part).ok()?.translation.x)));
        if let Some((ring, offset)) = offsets.min_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) {
            if offset.abs() <= REACH {
                commands.entity(ring).insert(Slid { pointer: press.pointer_id, camera: press.hit.camera, offset });
            }
            return;
        }
    }
}

/// Moves rings that are held to where along their rod the pointer is.
fn slide(
    held: Query<(Entity, &Slid, &ChildOf)>,
    mut rings: Query<(&Ring, &mut Transform)>,
    pointers: Query<(&PointerId, &PointerPress)>,
    rays: Res<RayMap>,
    places: Query<&GlobalTransform>,
    children: Query<&Children>,
    mut cloths: Query<(&ClothTopology, Option<&mut ParticlePins>)>,
    mut commands: Commands,
) {
    for (entity, hand, parent) in &held {
        let is_down = pointers.iter().any(|(known, press)| *known == hand.pointer && press.is_primary_pressed());
        if !is_down {
            commands.entity(entity).remove::<Slid>();
            continue;
        }
        let (Ok(rod), Ok(parts)) = (places.get(parent.parent()), children.get(parent.parent())) else { continue };
        let ray = rays.map.get(&RayId::new(hand.camera, hand.pointer));
        let Some(along) = ray.and_then(|ray| nearest_to(ray, rod)) else { continue };
        let Ok((ring, place)) = rings.get(entity) else { continue };
        let (number, now) = (ring.number, place.translation.x);
        let others = || parts.iter().filter_map(|part| rings.get(part).ok());
        let at = |number: Option<u32>| {
            others().find(|(ring, _)| Some(ring.number) == number).map(|(_, at)| at.translation.x)
        };
        let end = others().map(|(ring, _)| ring.home.abs()).fold(0.0, f32::max) + BEYOND;
        let low = at(number.checked_sub(1)).map_or(-end, |left| left + APART);
        let high = at(Some(number + 1)).map_or(end, |right| right - APART);
        let wanted = (along - hand.offset).clamp(low, high.max(low));
        if wanted == now {
            continue;
        }
        if let Ok((_, mut place)) = rings.get_mut(entity) {
            place.translation.x = wanted;
        }
        let Ok((ring, _)) = rings.get(entity) else { continue };
        for part in parts.iter() {
            let Ok((topology, pins)) = cloths.get_mut(part) else { continue };
            let Some(particle) = topology.vertex_particle.get(ring.column as usize) else { continue };
            let pin = ParticlePin { particle: *particle, to: PinTarget::Entity(entity), at: Vec3::NEG_Y * DROP };
            match pins {
                // What was taken off the ring stays off.
                Some(pins) if pins.released.contains(particle) => {}
                Some(pins) if pins.held.iter().any(|held| held.particle == *particle) => {}
                Some(mut pins) => pins.held.push(pin),
                None => drop(commands.entity(part).insert(ParticlePins { held: vec![pin], ..default() })),
            }
        }
    }
}

/// The place along a rod that is nearest to a ray, m.
fn nearest_to(ray: &Ray3d, rod: &GlobalTransform) -> Option<f32> {
    let (axis, direction, apart) = (*rod.right(), *ray.direction, ray.origin - rod.translation());
    let cosine = axis.dot(direction);
    let sine = 1.0 - cosine * cosine;
    // Along the rod itself every place is as near.
    (sine > 1e-3).then(|| (apart.dot(axis) - cosine * apart.dot(direction)) / sine)
}

/// A curtain that is put back hangs on its rings where they were at first.
fn send_home(
    reset: On<ClothReset>,
    parents: Query<&ChildOf>,
    children: Query<&Children>,
    mut rings: Query<(&Ring, &mut Transform)>,
) {
    let parts = parents.get(reset.entity).ok().and_then(|parent| children.get(parent.parent()).ok());
    for part in parts.into_iter().flat_map(|parts| parts.iter()) {
        if let Ok((ring, mut place)) = rings.get_mut(part) {
            place.translation.x = ring.home;
        }
    }
}

/// Drops pins on rings that are no more: the rod was fitted anew.
fn forget(mut gone: RemovedComponents<Ring>, mut cloths: Query<&mut ParticlePins>) {
    let gone: Vec<Entity> = gone.read().collect();
    if gone.is_empty() {
        return;
    }
    let is_gone = |pin: &ParticlePin| matches!(pin.to, PinTarget::Entity(ring) if gone.contains(&ring));
    for mut pins in cloths.iter_mut().filter(|pins| pins.held.iter().any(is_gone)) {
        pins.held.retain(|pin| !is_gone(pin));
    }
}
