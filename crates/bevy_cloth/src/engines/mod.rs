//! Physics engines: avian (feature `avian`) and rapier (feature `rapier`).
//!
//! An app adds the engine, [`ClothPlugin`](crate::ClothPlugin) and [`ClothAvianPlugin`] or [`ClothRapierPlugin`]. Then
//! - every collider of the engine keeps cloth out, but for sensors and those with [`NoCloth`]. The entity gets a
//!   [`ClothCollider`](crate::ClothCollider), or children that have one; they follow changes, and go with the collider. A
//!   `ClothCollider` of your own stays;
//! - bodies that move carry cloth along, on their way from one step to the next;
//! - cloth pushes dynamic bodies, and pulls those that it is pinned to ([`PinTarget::Entity`](crate::PinTarget::Entity)), by
//!   [`ClothBody`](crate::ClothBody), which they get.
//!
//! What a body gets is what cloth loses, to rounding. The two meet in the substeps of the cloth, with the inertia of both, so that a
//! light body is not thrown off by heavy cloth, and a heavy one swings on it without gaining anything.
//!
//! # Limits
//! - The engine has to take a step for each fixed step and before [`ClothSystems::Build`](crate::ClothSystems::Build): avian does by
//!   default; of rapier it is asked by `in_fixed_schedule`, with a `TimestepMode` of the same step.
//! - Cloth lets pass through what the engine calls a triangle mesh or a height field only by its middle: it is a wall of
//!   `wall_thickness`.
//! - While an awake body touches a cloth or holds its pins neither of them falls asleep.
//! - Pins to the cloth's own entity pull nothing, nor do those of a method that steps forces.

#[cfg(feature = "avian")]
mod avian;
#[cfg(feature = "rapier")]
mod rapier;
mod shapes;

#[cfg(feature = "avian")]
pub use avian::ClothAvianPlugin;
#[cfg(feature = "rapier")]
pub use rapier::ClothRapierPlugin;

use std::marker::PhantomData;

use bevy::prelude::*;

use crate::collider::ClothCollider;
use shapes::{NoCounterpart, Part};

/// Put this on a collider of an engine that cloth is to pass.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct NoCloth;

/// Default thickness of the walls that triangle meshes and height fields are for cloth, m.
pub const WALL_THICKNESS: f32 = 0.01;

/// What an engine knows of colliders.
trait Engine: Send + Sync + 'static {
    /// Its component for them.
    type Collider: Component;
    /// Those with this are no solids.
    type Sensor: Component;

    /// What `collider` is for cloth, under a transform with the scale that the engine has scaled it by.
    fn parts(collider: &Self::Collider, wall: f32) -> Result<Vec<Part>, NoCounterpart>;
}

/// What the collider of an engine became.
#[derive(Component)]
#[component(clone_behavior = Ignore)]
struct Translated<E: Engine> {
    /// The collider that its own entity got.
    own: Option<ClothCollider>,
    /// The children that it got.
    children: Vec<Entity>,
    engine: PhantomData<E>,
}

/// Thickness of walls, m.
#[derive(Resource)]
struct Walls<E: Engine>(f32, PhantomData<E>);

type Source<'a, E> = (
    Entity,
    Ref<'a, <E as Engine>::Collider>,
    Has<<E as Engine>::Sensor>,
    Has<NoCloth>,
    Option<&'a ClothCollider>,
    Option<&'a Translated<E>>,
);

/// Makes colliders of those of the engine that are new or changed, and takes those away that are gone.
fn translate<E: Engine>(
    colliders: Query<Source<'static, E>>,
    orphans: Query<(Entity, &Translated<E>, Option<&ClothCollider>), Without<E::Collider>>,
    walls: Res<Walls<E>>,
    mut commands: Commands,
) {
    for (entity, translated, now) in &orphans {
        translated.undo(entity, now, &mut commands);
    }
    for (entity, collider, is_sensor, is_excluded, now, translated) in &colliders {
        if is_sensor || is_excluded {
            if let Some(translated) = translated {
                translated.undo(entity, now, &mut commands);
            }
            continue;
        }
        if translated.is_some() && !collider.is_changed() {
            continue;
        }
        let known = translated.and_then(|translated| translated.own.as_ref());
        // One that is there and not from here is the user's.
        let is_users = now.is_some() && now != known;
        let parts = if is_users { Ok(Vec::new()) } else { E::parts(&collider, walls.0) };
        let parts = parts.unwrap_or_else(|error| {
            warn!("cloth passes the collider of {entity}: {error}");
            Vec::new()
        });
        if let Some(translated) = translated {
            let is_same = match &parts[..] {
                [part] if part.place == Transform::IDENTITY => known == Some(&part.collider),
                _ => false,
            };
            if is_same {
                continue;
            }
            translated.undo(entity, now, &mut commands);
        }
        let mut made = Translated::<E> { own: None, children: Vec::new(), engine: PhantomData };
        match &parts[..] {
            [part] if part.place == Transform::IDENTITY => {
                commands.entity(entity).try_insert(part.collider.clone());
                made.own = Some(part.collider.clone());
            }
            _ => {
                made.children.extend(parts.into_iter().map(|part| {
                    commands.spawn((part.collider, part.place, Visibility::default(), ChildOf(entity))).id()
                }))
            }
        }
        commands.entity(entity).try_insert(made);
    }
}

impl<E: Engine> Translated<E> {
    /// Takes away what was made, but for a collider that is another one `now`.
    fn undo(&self, entity: Entity, now: Option<&ClothCollider>, commands: &mut Commands) {
        for child in &self.children {
            commands.entity(*child).try_despawn();
        }
        if self.own.is_some() && self.own.as_ref() == now {
            commands.entity(entity).try_remove::<ClothCollider>();
        }
        commands.entity(entity).try_remove::<Self>();
    }
}
