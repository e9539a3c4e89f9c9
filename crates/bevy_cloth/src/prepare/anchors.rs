//! What pins hang on, and how it moves from tick to tick.

use bevy::prelude::*;
use cloth_solver::constraint::{Pin, Pins as SolverPins};
use cloth_solver::{ClothError, Motion, Pose, Soa3, Topology};

use super::placement::Placements;
use super::relative;
use super::select::select;
use super::source::Skin;
use crate::cloth::ClothFrame;
use crate::pins::{PinTarget, Pins};

/// The field named when a pin's entity has no place in the world (yet): the one fault that can mend without a change
/// of the pins.
const TARGET_ENTITY: &str = "PinTarget::Entity";

/// What one frame of the solver's pins follows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Anchor {
    /// The cloth's own frame.
    Cloth,
    /// The cloth's frame as it stood in the world when the pins were made. Held rather than the world's origin, so
    /// that pins far from the origin are as exact as those at it.
    World(Pose),
    /// An entity, with its pose at the last tick.
    Entity(Entity, Pose),
}

/// What the frames of a cloth's pins follow, in the order of [`SolverPins::frames`].
#[derive(Component, Clone, Debug, Default)]
#[component(clone_behavior = Ignore)]
pub(crate) struct Anchors(Vec<Anchor>);

/// Whether `error` says that a pin's entity is not there (yet).
pub(crate) fn waits_for_entity(error: &ClothError) -> bool {
    matches!(error, ClothError::OutOfRange { field: TARGET_ENTITY, .. })
}

/// The solver's pins for `pins`, made at the present `position` of the particles, and what they hang on.
pub(crate) fn make(
    pins: &Pins,
    topology: &Topology,
    skin: &Skin,
    position: &Soa3,
    frame: &ClothFrame,
    placements: &Placements,
) -> Result<(SolverPins, Anchors), ClothError> {
    let mut made = SolverPins::default();
    let mut anchors = Anchors::default();
    let mut taken = vec![false; topology.slots()];
    for group in &pins.0 {
        let anchor = match group.to {
            PinTarget::Cloth => Anchor::Cloth,
            PinTarget::World => Anchor::World(frame.pose),
            PinTarget::Entity(entity) => {
                let placement = placements.get(entity).filter(|placement| placement.pose.is_finite());
                let placement = placement.ok_or(ClothError::OutOfRange {
                    field: TARGET_ENTITY,
                    value: entity.index_u32() as f32,
                    allowed: "an entity with a finite `Transform`",
                })?;
                Anchor::Entity(entity, placement.pose)
            }
        };
        let index = anchors.0.iter().position(|known| *known == anchor).unwrap_or_else(|| {
            anchors.0.push(anchor);
            made.frames.push(anchor.motion(frame, None));
            anchors.0.len() - 1
        });
        for slot in select(&group.select, topology, skin)? {
            if std::mem::replace(&mut taken[slot as usize], true) {
                continue;
            }
            let local = match anchor {
                Anchor::Cloth => topology.rest[slot as usize],
                _ => made.frames[index].to.inverse_point(position.get(slot as usize)),
            };
            made.pins.push(Pin { particle: slot, frame: index as u32, local });
        }
    }
    Ok((made, anchors))
}

impl Anchor {
    /// How the anchor moves over this tick, seen from `frame`. `now` is the pose of the entity, if it has one.
    fn motion(&self, frame: &ClothFrame, now: Option<Pose>) -> Motion {
        match self {
            Self::Cloth => Motion { from: frame.step(), to: Pose::IDENTITY },
            Self::World(pose) => Motion::at_rest(relative(&frame.pose, pose)),
            Self::Entity(_, last) => {
                let now = now.unwrap_or(*last);
                Motion { from: relative(&frame.pose, last), to: relative(&frame.pose, &now) }
            }
        }
    }
}

impl Anchors {
    /// Moves the frames of the pins over this tick. An entity that is gone or nowhere leaves its pins where they are.
    pub fn advance(&mut self, frame: &ClothFrame, placements: &Placements, frames: &mut [Motion]) {
        for (anchor, motion) in self.0.iter_mut().zip(frames) {
            let now = match anchor {
                Anchor::Entity(entity, _) => placements.get(*entity).map(|p| p.pose).filter(Pose::is_finite),
                _ => None,
            };
            *motion = anchor.motion(frame, now);
            if let (Anchor::Entity(_, last), Some(now)) = (anchor, now) {
                *last = now;
            }
        }
    }
}
