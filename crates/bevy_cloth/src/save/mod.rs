//! The state of all running cloths: taken, put back, and with the feature `serialize` written and read.

mod around;
#[cfg(feature = "serialize")]
mod bytes;
mod cloth;
#[cfg(feature = "serialize")]
pub(crate) mod entity;
mod error;

use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::prelude::*;

use crate::cloth::{ClothRejection, ClothTopology};
use crate::prepare::take_over;
use around::Around;
use cloth::SavedCloth;

pub use error::RestoreError;

/// The state of all running cloths of a world, for rollback and for saved games: everything that the next tick goes on from, so that
/// what follows is the same to the last bit as if nothing had been saved.
///
/// It holds shape, motion, tears, cuts, fire, contact, sleep, what pins and colliders were on their way to, [`ParticlePins`], gusts and the
/// cloth clock. It does not hold what is authored ([`Cloth`](crate::Cloth), [`Fabric`](crate::Fabric), [`Pins`](crate::Pins), colliders,
/// transforms, settings) nor [`Grabs`](crate::Grabs), which are input: those have to be as they were when it is put back. In another
/// world the entities are others: map them with [`MapEntities`]. They should be spawned in the same order, since contacts are solved in the
/// order of their entities.
///
/// Taking it copies some 500 bytes a particle; the topology and the colliders are shared.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_cloth::{RestoreError, SavedCloths};
/// // Goes back to an earlier tick, for it to be played again with other input.
/// fn roll_back(world: &mut World, earlier: &SavedCloths) -> Result<(), RestoreError> {
///     earlier.restore(world)
/// }
/// # fn now(world: &World) -> SavedCloths { SavedCloths::take(world) }
/// ```
///
/// With the feature `serialize` it becomes bytes by `to_bytes`, and is `Serialize` and `Deserialize`. The bytes are for the same version of
/// this crate. They are protected against damage, not against forgery: read none that a stranger made on purpose.
///
/// [`ParticlePins`]: crate::ParticlePins
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(try_from = "bytes::Bytes", into = "bytes::Bytes"))]
pub struct SavedCloths(State);

#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct State {
    /// What is around all cloths.
    around: Around,
    /// In the order of their entities.
    cloths: Vec<SavedCloth>,
}

impl SavedCloths {
    /// The state of all cloths that run at this moment: not of those that wait for a mesh, and not of those that were refused.
    pub fn take(world: &World) -> Self {
        let running = world.try_query_filtered::<Entity, (With<ClothTopology>, Without<ClothRejection>)>();
        let mut entities: Vec<Entity> = running.map_or_else(Vec::new, |mut running| running.iter(world).collect());
        entities.sort_unstable();
        let cloths = entities.into_iter().filter_map(|entity| SavedCloth::take(world.entity(entity))).collect();
        Self(State { around: Around::take(world), cloths })
    }

    /// The entities of the cloths it holds.
    pub fn entities(&self) -> impl Iterator<Item = Entity> {
        self.0.cloths.iter().map(|cloth| cloth.entity)
    }

    /// Puts all cloths it holds back into this state. Cloths that it does not hold are left as they are. What was authored until now is
    /// taken over first, so that entities may be spawned immediately before.
    ///
    /// # Errors
    /// A cloth that is not there, is none, waits for its mesh or was refused, or is another one than was saved; then nothing changes.
    pub fn restore(&self, world: &mut World) -> Result<(), RestoreError> {
        take_over(world);
        for cloth in &self.0.cloths {
            cloth.check(world)?;
        }
        self.0.around.restore(world);
        for cloth in &self.0.cloths {
            cloth.restore(world);
        }
        self.0.around.restore_groups(world);
        Ok(())
    }
}

impl MapEntities for SavedCloths {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        self.0.around.map_entities(mapper);
        self.0.cloths.iter_mut().for_each(|cloth| cloth.map_entities(mapper));
        self.0.cloths.sort_unstable_by_key(|cloth| cloth.entity);
    }
}
