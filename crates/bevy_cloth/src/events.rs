//! What the plugin tells, and what it can be told: events at an entity, most of them messages too.

use bevy::prelude::*;
use cloth_solver::ClothError;

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

/// Trigger this to put a cloth back to its rest pose, at rest. Pins stay. Works while the clock is paused.
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
