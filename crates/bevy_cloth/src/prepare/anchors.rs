//! What pins hang on, and how it moves from tick to tick.

mod make;

use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::prelude::*;
use cloth_solver::constraint::{Pin, Pins as SolverPins, Skin as SolverSkin};
use cloth_solver::{ClothError, Motion, Pose, Topology};

use super::follow::is_near;
use super::placement::Placements;
use super::{Follow, placed, relative};
use crate::cloth::ClothFrame;
use crate::particle_pins::{ParticlePin, ParticlePins};
use crate::pins::PinTarget;
use crate::step::ClothTick;
use crate::teleport::Teleport;

pub(crate) use make::{Worn, make};

/// The field named when a pin's entity has no place in the world (yet): the one fault that can mend without a change
/// of the pins.
const TARGET_ENTITY: &str = "PinTarget::Entity";

/// How far apart, in m and radians, rounding may bring what moves alike.
const ROUNDING: f32 = 1e-3;

/// What one frame of the solver's pins follows.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
enum Anchor {
    /// The cloth's own frame.
    Cloth,
    /// The cloth's frame as it stood in the world when the pins were made. Held rather than the world's origin, so
    /// that pins far from the origin are as exact as those at it.
    World(Pose),
    Entity {
        #[cfg_attr(feature = "serialize", serde(with = "crate::save::entity"))]
        entity: Entity,
        follow: Follow,
        /// The cloth's frame as seen from it when the pins were made.
        home: Pose,
    },
}

/// What the frames of a cloth's pins follow, in the order of [`SolverPins::frames`].
#[derive(Component, Clone, Debug, Default)]
#[component(clone_behavior = Ignore)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Anchors {
    all: Vec<Anchor>,
    /// How many of them are those of [`Pins`](crate::Pins); the others are those of [`ParticlePins`].
    authored: usize,
    /// The pins of [`Pins`](crate::Pins) and [`Freedom`](crate::Freedom), also those that [`ParticlePins`] releases.
    pins: Vec<Pin>,
    /// What the joints of an armature take along, and how far what is free may get from there.
    skin: Option<SolverSkin>,
}

/// Whether `error` says that a pin's entity is not there (yet).
pub(crate) fn waits_for_entity(error: &ClothError) -> bool {
    matches!(error, ClothError::OutOfRange { field: TARGET_ENTITY, .. })
}

/// The pins in `made` that [`Pins`](crate::Pins) makes, but for what `edits` release, and those that `edits` hold. Replaces the anchors of
/// earlier edits.
pub(crate) fn edit(
    made: &SolverPins,
    anchors: &mut Anchors,
    edits: Option<&ParticlePins>,
    topology: &Topology,
    mass: &[f32],
    frame: &ClothFrame,
    placements: &Placements,
) -> Result<SolverPins, ClothError> {
    edits.map_or(Ok(()), |edits| edits.validate(topology))?;
    let (held, released) = edits.map_or((&[][..], &[][..]), |edits| (&edits.held, &edits.released));
    let mut frames = made.frames[..anchors.authored].to_vec();
    let mut added: Vec<Anchor> = Vec::new();
    let mut pins: Vec<Pin> = Vec::new();
    // What is burnt has no mass and cannot be held.
    let is_there = |particle: u32| mass.get(particle as usize).is_some_and(|mass| *mass > 0.0);
    for ParticlePin { particle, to, at } in held.iter().copied().filter(|pin| is_there(pin.particle)) {
        if pins.iter().any(|pin| pin.particle == particle) {
            continue;
        }
        let mut anchor = Anchor::new(to, frame, placements)?;
        let index = added.iter().position(|known| *known == anchor).unwrap_or_else(|| {
            frames.push(anchor.advance(frame));
            added.push(anchor);
            added.len() - 1
        });
        let local = if to == PinTarget::World { frame.pose.inverse_point(at) } else { at };
        pins.push(Pin { particle, frame: (anchors.authored + index) as u32, local });
    }
    let is_free = |particle: u32| !released.contains(&particle) && pins.iter().all(|pin| pin.particle != particle);
    let authored = anchors.pins.iter().filter(|pin| is_there(pin.particle) && is_free(pin.particle));
    let pins = authored.copied().chain(pins.iter().copied()).collect();
    anchors.all.truncate(anchors.authored);
    anchors.all.extend(added);
    Ok(SolverPins { frames, pins })
}

impl Anchor {
    /// What follows `to` from now on.
    fn new(to: PinTarget, frame: &ClothFrame, placements: &Placements) -> Result<Self, ClothError> {
        Ok(match to {
            PinTarget::Cloth => Self::Cloth,
            PinTarget::World => Self::World(frame.pose),
            PinTarget::Entity(entity) => {
                let placement = placements.get(entity).filter(|placement| placement.pose.is_finite());
                let placement = placement.ok_or(ClothError::OutOfRange {
                    field: TARGET_ENTITY,
                    value: entity.index_u32() as f32,
                    allowed: "an entity with a finite `Transform`",
                })?;
                let (follow, home) = (Follow::new(placement.pose), relative(&placement.pose, &frame.pose));
                Self::Entity { entity, follow, home }
            }
        })
    }

    /// Where it stands, and where it is moved to.
    fn ends(&self, frame: &ClothFrame) -> [Pose; 2] {
        match self {
            Self::Cloth => [frame.pose, frame.follow.target],
            Self::World(pose) => [*pose; 2],
            Self::Entity { follow, .. } => [follow.pose, follow.target],
        }
    }

    fn jumps(&self, frame: &ClothFrame, limits: &Teleport) -> bool {
        match self {
            Self::Cloth => frame.follow.jumps(limits),
            Self::World(_) => false,
            Self::Entity { follow, .. } => follow.jumps(limits),
        }
    }

    /// Where the cloth's frame gets to if it goes along with this alone.
    fn carried(&self, frame: &ClothFrame) -> Pose {
        let [from, to] = self.ends(frame);
        placed(&to, &relative(&from, &frame.pose))
    }

    /// Where this wants the rest shape, seen from the cloth's frame.
    fn home(&self, frame: &ClothFrame) -> Pose {
        match self {
            Self::Cloth => Pose::IDENTITY,
            Self::World(pose) => relative(&frame.pose, pose),
            Self::Entity { follow, home, .. } => relative(&frame.pose, &placed(&follow.pose, home)),
        }
    }

    /// Moves over this tick, and tells how, seen from `frame`.
    fn advance(&mut self, frame: &ClothFrame) -> Motion {
        match self {
            Self::Cloth => Motion { from: frame.step(), to: Pose::IDENTITY },
            Self::World(pose) => Motion::at_rest(relative(&frame.pose, pose)),
            Self::Entity { follow, .. } => {
                let from = relative(&frame.pose, &follow.pose);
                Motion { from, to: relative(&frame.pose, &follow.advance()) }
            }
        }
    }
}

impl MapEntities for Anchors {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        for anchor in &mut self.all {
            if let Anchor::Entity { entity, .. } = anchor {
                *entity = mapper.get_mapped(*entity);
            }
        }
    }
}

impl Anchors {
    /// Sees the entities that pins hang on before the first fixed step in a frame.
    pub fn look(&mut self, placements: &Placements, ticks: f32) {
        self.see(placements, |follow, target| follow.look(target, ticks));
    }

    /// Sees where they are in this tick. One that is gone or nowhere leaves its pins where they are.
    pub fn aim(&mut self, placements: &Placements, tick: &ClothTick) {
        self.see(placements, |follow, target| follow.aim(target, tick));
    }

    /// The index of what follows `to`, which is added if there is none yet.
    fn index(
        &mut self,
        to: PinTarget,
        made: &mut SolverPins,
        frame: &ClothFrame,
        placements: &Placements,
    ) -> Result<u32, ClothError> {
        let mut anchor = Anchor::new(to, frame, placements)?;
        if let Some(known) = self.all.iter().position(|known| *known == anchor) {
            return Ok(known as u32);
        }
        made.frames.push(anchor.advance(frame));
        self.all.push(anchor);
        Ok(self.all.len() as u32 - 1)
    }

    /// What the joints of an armature take along, but for what `edits` hold elsewhere.
    pub fn skin(&self, edits: Option<&ParticlePins>) -> Option<SolverSkin> {
        let mut skin = self.skin.clone()?;
        let held = edits.map_or(&[][..], |edits| &edits.held);
        skin.pins.retain(|(particle, _)| held.iter().all(|pin| pin.particle != *particle));
        Some(skin)
    }

    /// The entity that each frame of the pins follows, if it is one.
    pub fn entities(&self) -> impl Iterator<Item = Option<Entity>> {
        self.all.iter().map(|anchor| match anchor {
            Anchor::Entity { entity, .. } => Some(*entity),
            Anchor::Cloth | Anchor::World(_) => None,
        })
    }

    /// Lets `shift` change how each entity is followed.
    pub fn shift(&mut self, shift: impl Fn(Entity, &mut Follow)) {
        for anchor in &mut self.all {
            if let Anchor::Entity { entity, follow, .. } = anchor {
                shift(*entity, follow);
            }
        }
    }

    /// Whether any of it is another entity.
    pub fn follow_entities(&self) -> bool {
        self.all.iter().any(|anchor| matches!(anchor, Anchor::Entity { .. }))
    }

    /// Whether an entity that pins hang on is elsewhere than at the end of the last tick.
    pub fn have_moved(&self, placements: &Placements) -> bool {
        self.all.iter().any(|anchor| {
            let Anchor::Entity { entity, follow, .. } = anchor else { return false };
            placements.get(*entity).is_some_and(|placement| placement.pose.is_finite() && placement.pose != follow.pose)
        })
    }

    fn see(&mut self, placements: &Placements, see: impl Fn(&mut Follow, Pose)) {
        for anchor in &mut self.all {
            if let Anchor::Entity { entity, follow, .. } = anchor {
                let now = placements.get(*entity).map(|placement| placement.pose).filter(Pose::is_finite);
                see(follow, now.unwrap_or(follow.target));
            }
        }
    }

    /// Where the cloth's frame gets to if the cloth is carried along in this tick: if all that it hangs on jumps, and all
    /// alike. That is what its pins follow, or without pins its own entity.
    pub fn carried(&self, frame: &ClothFrame, pins: &[Pin], limits: &Teleport) -> Option<Pose> {
        let own = frame.follow.jumps(limits);
        if pins.is_empty() {
            return own.then_some(frame.follow.target);
        }
        if !self.all.iter().any(|anchor| anchor.jumps(frame, limits))
            || self.holding(pins).any(|(anchor, _)| !anchor.jumps(frame, limits))
        {
            return None;
        }
        let mean = mean(self.holding(pins).map(|(anchor, count)| (anchor.carried(frame), count)))?;
        // What is left between each and the mean is motion, and must be no jump again.
        let alike = |(anchor, _): (&Anchor, f32)| {
            let [from, to] = anchor.ends(frame);
            let there = placed(&mean, &relative(&frame.pose, &from));
            is_near(&there, &to, limits.distance.max(ROUNDING), limits.angle.max(ROUNDING))
        };
        self.holding(pins).all(alike).then_some(mean)
    }

    /// Takes what jumps along with the cloth, whose frame goes from `from` to `to`.
    pub fn carry(&mut self, from: &Pose, to: &Pose, limits: &Teleport) {
        for anchor in &mut self.all {
            if let Anchor::Entity { follow, .. } = anchor
                && follow.jumps(limits)
            {
                follow.carry(placed(to, &relative(from, &follow.pose)));
            }
        }
    }

    /// Puts everything that pins follow to where it stands now, at rest.
    pub fn stand_still(&mut self, frame: &ClothFrame, frames: &mut [Motion], placements: &Placements) {
        for (anchor, motion) in self.all.iter_mut().zip(frames) {
            if let Anchor::Entity { entity, follow, .. } = anchor {
                let now = placements.get(*entity).map(|placement| placement.pose).filter(Pose::is_finite);
                *follow = Follow::new(now.unwrap_or(follow.target));
            }
            *motion = Motion::at_rest(anchor.advance(frame).to);
        }
    }

    /// Moves the frames of the pins over this tick.
    pub fn advance(&mut self, frame: &ClothFrame, frames: &mut [Motion]) {
        for (anchor, motion) in self.all.iter_mut().zip(frames) {
            *motion = anchor.advance(frame);
        }
    }

    /// Where each frame of the pins of the cloth `entity` is at this moment, seen from `frame`: what they follow moves on between
    /// ticks.
    pub fn now(&self, entity: Entity, frame: &ClothFrame, placements: &Placements) -> impl Iterator<Item = Pose> {
        let stands = |entity| placements.get(entity).map(|placement| placement.pose).filter(Pose::is_finite);
        self.all.iter().map(move |anchor| {
            let now = match anchor {
                Anchor::Cloth => stands(entity).unwrap_or(frame.follow.target),
                Anchor::World(pose) => *pose,
                Anchor::Entity { entity, follow, .. } => stands(*entity).unwrap_or(follow.target),
            };
            relative(&frame.pose, &now)
        })
    }

    /// The pins of [`Pins`](crate::Pins), also those that [`ParticlePins`] releases.
    pub fn authored(&self) -> &[Pin] {
        &self.pins
    }

    /// Where the rest shape belongs, seen from the cloth's frame: at rest in it, or where the pins of [`Pins`](crate::Pins) on other things
    /// hold it.
    pub fn home(&self, frame: &ClothFrame) -> Pose {
        if self.holding(&self.pins).any(|(anchor, _)| *anchor == Anchor::Cloth) {
            return Pose::IDENTITY;
        }
        mean(self.holding(&self.pins).map(|(anchor, count)| (anchor.home(frame), count))).unwrap_or(Pose::IDENTITY)
    }

    /// Each that has pins, and how many.
    fn holding(&self, pins: &[Pin]) -> impl Iterator<Item = (&Anchor, f32)> + Clone {
        let count = |index| pins.iter().filter(|pin| pin.frame as usize == index).count() as f32;
        self.all.iter().enumerate().map(move |(index, anchor)| (anchor, count(index))).filter(|(_, count)| *count > 0.0)
    }
}

/// The mean of poses, each with its weight; exactly the one if all are the same.
fn mean(poses: impl Iterator<Item = (Pose, f32)> + Clone) -> Option<Pose> {
    let (first, _) = poses.clone().next()?;
    if poses.clone().all(|(pose, _)| pose == first) {
        return Some(first);
    }
    let (mut position, mut rotation, mut total) = (Vec3::ZERO, Quat::from_array([0.0; 4]), 0.0);
    for (pose, weight) in poses {
        // A rotation and its negative are the same.
        let sign = if pose.rotation.dot(first.rotation) < 0.0 { -1.0 } else { 1.0 };
        position += (pose.position - first.position) * weight;
        rotation += pose.rotation * (sign * weight);
        total += weight;
    }
    Some(Pose::new(first.position + position / total, rotation.normalize()))
}
