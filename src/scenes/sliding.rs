//! Rings that slide along their rod: drawn together when the scene opens, and by whatever pulls at the curtain.
//!
//! A ring slides where the cloth below pulls it more along the rod than friction holds: by more than μ times the force across
//! (Coulomb). The direction of the cloth a hand's breadth below the ring stands for that of its pull.

use bevy::prelude::*;
use bevy_cloth::{
    ClothClock, ClothFrame, ClothReset, ClothSchedule, ClothSystems, ClothTopology, ParticlePin, ParticlePins,
    Particles, PinTarget,
};

use super::curtain_rod::{CurtainRod, DROP, Ring};

/// Friction of a ring on its rod, dimensionless: brass on brass.
const FRICTION: f32 = 0.35;
/// How fast rings are drawn together, and how fast they slide at most, m/s.
const DRAWN: f32 = 0.5;
const FASTEST: f32 = 1.5;
/// How long a ring takes to slip to where friction holds it, s: the cloth below follows it no faster.
const SLIP: f32 = 0.2;
/// The least distance of two rings, m.
const APART: f32 = 0.02;
/// How far below its edge the cloth tells where it pulls, m.
const BELOW: f32 = 0.12;

/// A ring that is still to be drawn to where it belongs at first.
#[derive(Component, Clone, Copy, Debug)]
struct Drawn;

/// Lets rings slide.
pub struct SlidingPlugin;

impl Plugin for SlidingPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(ClothSchedule, slide.before(ClothSystems::Prepare))
            .add_systems(Update, begin)
            .add_observer(again);
    }
}

/// New rings of a rod that gathers its curtain are drawn together.
fn begin(new: Query<(Entity, &ChildOf), Added<Ring>>, rods: Query<&CurtainRod>, mut commands: Commands) {
    for (ring, parent) in &new {
        if rods.get(parent.parent()).is_ok_and(|rod| rod.gather < 1.0) {
            commands.entity(ring).insert(Drawn);
        }
    }
}

/// So are those of a curtain that was reset.
fn again(
    reset: On<ClothReset>,
    parents: Query<&ChildOf>,
    rods: Query<(&CurtainRod, &Children)>,
    rings: Query<(), With<Ring>>,
    mut commands: Commands,
) {
    let Ok((rod, parts)) = parents.get(reset.entity).and_then(|parent| rods.get(parent.parent())) else { return };
    for ring in parts.iter().filter(|part| rod.gather < 1.0 && rings.contains(*part)) {
        commands.entity(ring).insert(Drawn);
    }
}

fn slide(
    rods: Query<(&CurtainRod, &GlobalTransform, &Children)>,
    mut rings: Query<(&Ring, &mut Transform, Has<Drawn>)>,
    mut cloths: Query<(&ClothTopology, &Particles, &ClothFrame, Option<&mut ParticlePins>)>,
    time: Res<Time<ClothClock>>,
    mut commands: Commands,
) {
    let dt = time.delta_secs();
    for (rod, place, parts) in &rods {
        if rod.gather >= 1.0 && !rod.slides {
            continue;
        }
        let mut on_rod: Vec<(Entity, Ring, f32, bool)> = parts
            .iter()
            .filter_map(|part| rings.get(part).ok().map(|(ring, at, drawn)| (part, *ring, at.translation.x, drawn)))
            .collect();
        on_rod.sort_unstable_by_key(|(_, ring, ..)| ring.number);
        let Some(cloth) = parts.iter().find(|part| cloths.contains(*part)) else { continue };
        let Ok((topology, particles, frame, mut pins)) = cloths.get_mut(cloth) else { continue };
        let end = on_rod.iter().map(|(_, ring, ..)| ring.home.abs()).fold(0.0, f32::max);
        let mut new_pins = ParticlePins::default();
        for index in 0..on_rod.len() {
            let (entity, ring, now, drawn) = on_rod[index];
            let Some(particle) = topology.vertex_particle.get(ring.column as usize).copied() else { continue };
            let wanted = if drawn {
                let aim = ring.home * rod.gather;
                if (aim - now).abs() < 1e-4 {
                    commands.entity(entity).remove::<Drawn>();
                }
                now + (aim - now).clamp(-DRAWN * dt, DRAWN * dt)
            } else if rod.slides {
                let below = topology.vertex_particle.get((ring.column + rod.row_below(BELOW)) as usize);
                let pulled = below.map(|slot| frame.to_world(particles.position.get(*slot as usize)));
                let from = place.transform_point(Vec3::new(now, -DROP, 0.0));
                pulled.map_or(now, |at| now + (slipped(at - from, *place.right()) / SLIP).clamp(-FASTEST, FASTEST) * dt)
            } else {
                now
            };
            let low = index.checked_sub(1).map_or(-end, |left| on_rod[left].2 + APART);
            let high = on_rod.get(index + 1).map_or(end, |right| right.2 - APART);
            let wanted = wanted.clamp(low, high.max(low));
            if wanted == now {
                continue;
            }
            on_rod[index].2 = wanted;
            if let Ok((_, mut at, _)) = rings.get_mut(entity) {
                at.translation.x = wanted;
            }
            let pin = ParticlePin { particle, to: PinTarget::Entity(entity), at: Vec3::NEG_Y * DROP };
            let held = pins.as_deref().unwrap_or(&new_pins);
            if held.released.contains(&particle) || held.held.iter().any(|held| held.particle == particle) {
                continue;
            }
            pins.as_deref_mut().unwrap_or(&mut new_pins).held.push(pin);
        }
        if pins.is_none() && !new_pins.held.is_empty() {
            commands.entity(cloth).insert(new_pins);
        }
    }
}

/// How far a ring slips along the rod until the pull of what hangs from it (the way down to it, m) is held by friction, m.
fn slipped(pull: Vec3, axis: Vec3) -> f32 {
    let along = pull.dot(axis);
    let held = FRICTION * (pull - along * axis).length();
    along.signum() * (along.abs() - held).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_slips_until_friction_holds_the_pull() {
        assert_eq!(slipped(Vec3::new(0.03, -0.1, 0.0), Vec3::X), 0.0);
        let slip = slipped(Vec3::new(-0.2, -0.1, 0.0), Vec3::X);
        assert!((slip + 0.165).abs() < 1e-6, "{slip}");
        assert!(slipped(Vec3::new(-0.2 - slip, -0.1, 0.0), Vec3::X).abs() < 1e-6);
    }
}
