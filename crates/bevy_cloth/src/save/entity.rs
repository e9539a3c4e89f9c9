//! Entities for serde: what it is in the world that was saved, to be mapped to what it is in another one.

use bevy::prelude::*;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub(crate) fn serialize<S: Serializer>(entity: &Entity, serializer: S) -> Result<S::Ok, S::Error> {
    entity.to_bits().serialize(serializer)
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Entity, D::Error> {
    let bits = u64::deserialize(deserializer)?;
    Entity::try_from_bits(bits).ok_or_else(|| D::Error::custom(format_args!("{bits} is no entity")))
}

/// Several entities.
pub(crate) mod list {
    use super::*;

    pub fn serialize<S: Serializer>(entities: &[Entity], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(entities.iter().map(|entity| entity.to_bits()))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Entity>, D::Error> {
        let all = Vec::<u64>::deserialize(deserializer)?;
        let entity =
            |bits| Entity::try_from_bits(bits).ok_or_else(|| D::Error::custom(format_args!("{bits} is no entity")));
        all.into_iter().map(entity).collect()
    }
}
