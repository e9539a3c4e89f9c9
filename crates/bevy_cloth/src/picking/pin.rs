//! Pins a pointer puts into cloth and takes out.

use bevy::picking::events::{Pointer, Press};
use bevy::prelude::*;
use cloth_solver::Particles;
use cloth_solver::cloth::Constraints;

use super::{ClothHit, ClothPicking, ClothTool};
use crate::cloth::ClothFrame;
use crate::particle_pins::{PinParticle, UnpinParticle};
use crate::pins::PinTarget;
use crate::shown::ShownShape;

/// A press within this distance of a pinned particle takes its pin out, m.
const REACH: f32 = 0.03;

/// Pins the particle under a pointer to the world, or releases one that is pinned nearby.
pub(crate) fn pin(
    press: On<Pointer<Press>>,
    settings: Res<ClothPicking>,
    cloths: Query<(&ClothFrame, &Particles, &ShownShape, &Constraints)>,
    mut commands: Commands,
) {
    let entity = press.entity;
    // The event climbs up to the parents of what was hit.
    let hit = press.hit.extra_as::<ClothHit>().filter(|_| entity == press.original_event_target());
    let (Some(hit), Some(at), Ok((frame, particles, shape, constraints))) =
        (hit, press.hit.position, cloths.get(entity))
    else {
        return;
    };
    if settings.tool(press.button) != Some(ClothTool::Pin) {
        return;
    }
    let at = frame.to_local(at);
    let pinned = constraints.pins().pins.iter().map(|pin| pin.particle);
    let place = |particle: u32| match shape.positions().get(particle as usize) {
        Some(drawn) => *drawn,
        None => particles.position.get(particle as usize),
    };
    let near = pinned.map(|particle| (particle, place(particle).distance(at)));
    let nearest = near.filter(|(_, distance)| *distance <= REACH).min_by(|a, b| a.1.total_cmp(&b.1));
    // Of a coarse cloth the nearest particle may be farther away than that.
    let particle = nearest.map_or(hit.particle, |(particle, _)| particle);
    if nearest.is_some() || constraints.pins().pins.iter().any(|pin| pin.particle == particle) {
        commands.trigger(UnpinParticle { entity, particle });
    } else {
        commands.trigger(PinParticle { entity, particle, to: PinTarget::World });
    }
}
