//! Rings: the hand slides a ring along its rod, and what hangs on it follows.

use bevy::picking::PickingSystems;
use bevy::picking::backend::ray::{RayId, RayMap};
use bevy::picking::pointer::{PointerButton, PointerId, PointerPress};
use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothPicking, ClothReset, ClothTopology, ParticlePin, ParticlePins, PinTarget};

use super::{ActiveTool, Tool};
use crate::scenes::curtain_rod::{DROP, Ring};

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
    rays: Res<RayMap>,
    mut commands: Commands,
) {
    let hit = press.original_event_target();
    let is_hand = tool.0 == Tool::Hand && press.button == PointerButton::Primary && picking.enabled;
    if press.entity != hit || !is_hand || cloths.contains(hit) {
        return;
    }
    let ray = rays.map.get(&RayId::new(press.hit.camera, press.pointer_id));
    for rod in parents.iter_ancestors(hit) {
        let (Ok(parts), Ok(place)) = (children.get(rod), places.get(rod)) else { continue };
        let Some(along) = ray.and_then(|ray| nearest_to(ray, place)) else { return };
        let offsets = parts.iter().filter_map(|part| Some((part, along - rings.get(part).ok()?.translation.x)));
        if let Some((ring, offset)) = offsets.min_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) {
            if offset.abs() <= REACH {
                commands.entity(ring).insert(Slid { pointer: press.pointer_id, camera: press.hit.camera, offset });
            }
            return;
        }
    }
}

/// Moves rings that are held to where along their rod the pointer is, and their neighbours as far as they have to give way or
/// are drawn along.
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
        let mut row: Vec<(Entity, Ring, f32)> = parts
            .iter()
            .filter_map(|part| rings.get(part).ok().map(|(ring, place)| (part, *ring, place.translation.x)))
            .collect();
        row.sort_unstable_by_key(|(_, ring, _)| ring.number);
        let Some(index) = row.iter().position(|(ring, ..)| *ring == entity) else { continue };
        let homes: Vec<f32> = row.iter().map(|(_, ring, _)| ring.home).collect();
        let mut now: Vec<f32> = row.iter().map(|(.., x)| *x).collect();
        draw(&mut now, &homes, index, along - hand.offset);
        for ((entity, ring, before), x) in row.into_iter().zip(now) {
            let Ok((_, mut place)) = rings.get_mut(entity) else { continue };
            if x == before {
                continue;
            }
            place.translation.x = x;
            for part in parts.iter() {
                if let Ok((topology, pins)) = cloths.get_mut(part) {
                    hang(part, entity, &ring, topology, pins, &mut commands);
                }
            }
        }
    }
}

/// Moves one of the rings, which are at `row` along the rod from left to right, to `wanted`. Two neighbours are never farther
/// from each other than at first, which is how much cloth is between them.
fn draw(row: &mut [f32], homes: &[f32], index: usize, wanted: f32) {
    let end = homes.iter().map(|home| home.abs()).fold(0.0, f32::max) + BEYOND;
    let (left, right) = (index as f32, (row.len() - 1 - index) as f32);
    row[index] = wanted.min(end - right * APART).max(left * APART - end);
    for i in index + 1..row.len() {
        let most = (homes[i] - homes[i - 1]).max(APART);
        row[i] = row[i].clamp(row[i - 1] + APART, row[i - 1] + most);
    }
    for i in (0..index).rev() {
        let most = (homes[i + 1] - homes[i]).max(APART);
        row[i] = row[i].clamp(row[i + 1] - most, row[i + 1] - APART);
    }
}

/// Lets what hangs on a ring follow it from now on.
fn hang(
    cloth: Entity,
    ring_entity: Entity,
    ring: &Ring,
    topology: &ClothTopology,
    pins: Option<Mut<ParticlePins>>,
    commands: &mut Commands,
) {
    let Some(&particle) = topology.vertex_particle.get(ring.column as usize) else { return };
    let pin = ParticlePin { particle, to: PinTarget::Entity(ring_entity), at: Vec3::NEG_Y * DROP };
    match pins {
        // What was taken off the ring stays off, what hangs on it already stays there.
        Some(pins) if pins.released.contains(&particle) || pins.held.iter().any(|held| held.particle == particle) => {}
        Some(mut pins) => pins.held.push(pin),
        // Another ring may add its own in the same frame.
        None => {
            let mut entity = commands.entity(cloth);
            entity.entry::<ParticlePins>().or_default().and_modify(move |mut pins| pins.held.push(pin));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_draws_those_behind_it_along_and_pushes_those_before_it() {
        let homes = [-0.6, -0.2, 0.2, 0.6];
        let mut row = homes;
        draw(&mut row, &homes, 0, -0.1);
        assert_eq!(row, [-0.1, -0.1 + APART, 0.2, 0.6]);
        draw(&mut row, &homes, 0, -0.6);
        assert!(row.iter().zip([-0.6, -0.2, 0.2, 0.6]).all(|(x, at)| (x - at).abs() < 1e-6), "{row:?}");
        draw(&mut row, &homes, 1, 5.0);
        assert!(
            row[3] <= 0.6 + BEYOND && row[1] < row[2] && row[2] < row[3] && row[1] - row[0] <= 0.4 + 1e-6,
            "{row:?}"
        );
    }
}
