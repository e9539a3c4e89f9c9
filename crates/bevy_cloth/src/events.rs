//! What the plugin tells, and what it can be told: events at an entity, most of them messages too.

use bevy::prelude::*;
use cloth_solver::ClothError;

use crate::sleep::WakeCause;

/// Authored data of a cloth was refused: the cloth is out of the simulation until its data changes to something
/// allowed. Told, and logged, once for each change.
///
/// An event at the entity and a message.
#[derive(EntityEvent, Message, Clone, Debug, PartialEq)]
pub struct ClothRejected {
    /// The cloth.
    pub entity: Entity,
    /// The field, the value found and the values allowed.
    pub error: ClothError,
}

/// Authored data of a collider was refused. If its shape is wrong no cloth meets it until it changes to something
/// allowed; if its transform is not finite it stays where it was last. Told, and logged, once for each change.
///
/// An event at the entity and a message.
#[derive(EntityEvent, Message, Clone, Debug, PartialEq)]
pub struct ColliderRejected {
    /// The collider.
    pub entity: Entity,
    /// The field, the value found and the values allowed.
    pub error: ClothError,
}

/// A mesh could not be bound to a cloth: it is drawn as it is until it changes. Told, and logged, once for each change.
///
/// An event at the entity and a message.
#[cfg(feature = "render")]
#[derive(EntityEvent, Message, Clone, Debug, PartialEq)]
pub struct BoundRejected {
    /// The entity with [`BoundTo`](crate::BoundTo).
    pub entity: Entity,
    /// What is wrong with its mesh, and what is allowed.
    pub error: ClothError,
}

/// Authored data of a [`Fan`](crate::Fan) or a [`WindZone`](crate::WindZone) was refused. If a value is out of range it
/// does not blow until that changes to something allowed; if its transform is not finite it blows from where it was last.
/// Told, and logged, once for each change.
///
/// An event at the entity and a message.
#[derive(EntityEvent, Message, Clone, Debug, PartialEq)]
pub struct WindRejected {
    /// The fan or the zone.
    pub entity: Entity,
    /// The field, the value found and the values allowed.
    pub error: ClothError,
}

/// A number of a running cloth had become NaN or infinite. The cloth is back in its last finite shape with zero
/// velocity and runs on; nothing else was touched.
///
/// An event at the entity and a message.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct ClothRecovered {
    /// The cloth.
    pub entity: Entity,
}

/// A cloth was put back to its rest pose, as [`ResetCloth`] asked.
///
/// An event at the entity and a message.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct ClothReset {
    /// The cloth.
    pub entity: Entity,
}

/// A cloth tore at a particle, which has parted.
///
/// An event at the entity and a message.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct ClothTorn {
    /// The cloth.
    pub entity: Entity,
    /// The particle.
    pub particle: u32,
    /// Where it stands in the world, m.
    pub position: Vec3,
    /// Its load over its strength when it parted; 0 if it was torn by [`TearCloth`](crate::TearCloth).
    pub overload: f32,
}

/// A cloth was cut.
///
/// An event at the entity and a message.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct ClothCut {
    /// The cloth.
    pub entity: Entity,
    /// A particle in the middle of the cut.
    pub particle: u32,
    /// Where it stands in the world, m.
    pub position: Vec3,
    /// How many edges long the cut is.
    pub edges: u32,
}

/// A cloth consists of more pieces than before; see [`ClothPieces`](crate::ClothPieces).
///
/// An event at the entity and a message.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct PiecesSeparated {
    /// The cloth.
    pub entity: Entity,
    /// The first particle of a piece that is new.
    pub particle: u32,
    /// Where it stands in the world, m.
    pub position: Vec3,
    /// How many pieces it consists of now.
    pub pieces: u32,
}

/// Small pieces of a cloth were taken out, their time being up; see [`Tearable`](crate::Tearable).
///
/// An event at the entity and a message.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct DebrisGone {
    /// The cloth.
    pub entity: Entity,
    /// A corner of the first of their triangles.
    pub particle: u32,
    /// Where it stood in the world, m.
    pub position: Vec3,
    /// How many triangles they had.
    pub triangles: u32,
}

/// A cloth that did not burn burst into flame.
///
/// An event at the entity and a message.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct ClothIgnited {
    /// The cloth.
    pub entity: Entity,
    /// The first particle in flames.
    pub particle: u32,
    /// Where it stands in the world, m.
    pub position: Vec3,
}

/// Triangles of a cloth burnt through and are gone.
///
/// An event at the entity and a message, in each tick in which it happens.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct ClothBurntThrough {
    /// The cloth.
    pub entity: Entity,
    /// A corner of the first of them.
    pub particle: u32,
    /// Where it stood in the world, m.
    pub position: Vec3,
    /// How many.
    pub triangles: u32,
}

/// The last flame of a cloth went out before all of it was burnt: water put it out, or it reached nothing more that would
/// light. What is dry can be lit again.
///
/// An event at the entity and a message. Whenever a cloth stops burning it is either this or [`ClothBurntOut`].
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct ClothExtinguished {
    /// The cloth.
    pub entity: Entity,
    /// The particle, or one of those, on which the last flame stood.
    pub particle: u32,
    /// Where it stands in the world, m.
    pub position: Vec3,
}

/// The last flame of a cloth went out, and nothing is left of it that could light. Its char may still glow.
///
/// An event at the entity and a message. Whenever a cloth stops burning it is either this or [`ClothExtinguished`].
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct ClothBurntOut {
    /// The cloth.
    pub entity: Entity,
    /// The particle, or one of those, on which the last flame stood.
    pub particle: u32,
    /// Where it stands in the world, or stood when its cloth burnt through, m.
    pub position: Vec3,
}

/// Trigger this to put a cloth back to its rest pose where its entity is now, at rest, and whole if it was torn, cut or burnt.
/// [`Pins`](crate::Pins) stay, [`ParticlePins`](crate::ParticlePins) are removed. Works while the clock is paused.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_cloth::{Cloth, ResetCloth};
/// fn reset_all(cloths: Query<Entity, With<Cloth>>, mut commands: Commands) {
///     for entity in &cloths {
///         commands.trigger(ResetCloth { entity });
///     }
/// }
/// ```
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq)]
pub struct ResetCloth {
    /// The cloth. An entity that is no running cloth is left alone.
    pub entity: Entity,
}

/// A cloth came to rest and is not advanced any more; see [`ClothSleep`](crate::ClothSleep).
///
/// An event at the entity and a message.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct ClothFellAsleep {
    /// The cloth.
    pub entity: Entity,
}

/// A cloth that was asleep is advanced again; see [`ClothSleep`](crate::ClothSleep).
///
/// An event at the entity and a message.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct ClothWoke {
    /// The cloth.
    pub entity: Entity,
    /// What woke it.
    pub cause: WakeCause,
}

/// Trigger this to wake a cloth. If nothing moves it, it falls asleep again after [`ClothSleep::time`](crate::ClothSleep::time).
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq)]
pub struct WakeCloth {
    /// The cloth. One that is awake is left alone.
    pub entity: Entity,
}

/// A cloth touches a collider that has [`ContactEvents`](crate::ContactEvents), and did not before.
///
/// An event at the collider and a message; at most one for each cloth in a tenth of a second.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct ContactBegan {
    /// The collider.
    pub entity: Entity,
    /// The cloth.
    pub cloth: Entity,
    /// How fast the fastest of its particles came against it, along the normal, m/s.
    pub speed: f32,
    /// What the cloth gave to the collider in this tick, N·s.
    pub impulse: f32,
}

/// A cloth has not touched a collider that has [`ContactEvents`](crate::ContactEvents) for a tenth of a second, or one of the two is
/// gone. Each [`ContactBegan`] is followed by exactly one of these.
///
/// An event at the collider and a message.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct ContactEnded {
    /// The collider.
    pub entity: Entity,
    /// The cloth.
    pub cloth: Entity,
    /// The strongest impulse of the cloth on the collider in one tick, N·s.
    pub impulse: f32,
    /// From the first touch to the last, s.
    pub duration: f32,
}

/// A cloth that has [`SelfContact`](crate::SelfContact) passes through itself: it was given the component, or put into its place, while
/// it did. It is being untangled, and does not fall asleep in the meantime.
///
/// An event at the entity and a message. Each is followed by a [`ClothUntangled`], unless the cloth is no more.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct ClothTangled {
    /// The cloth.
    pub entity: Entity,
    /// Edges that pass through a triangle.
    pub crossings: u32,
}

/// A cloth that was tangled passes through itself nowhere any more, or has no [`SelfContact`](crate::SelfContact) any more.
///
/// An event at the entity and a message.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq)]
pub struct ClothUntangled {
    /// The cloth.
    pub entity: Entity,
}
