//! Arrays of any length, for serde, which knows those of up to 32 entries each by itself.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// An array of numbers.
pub(crate) mod array {
    use super::*;

    pub fn serialize<S: Serializer, const N: usize>(array: &[u32; N], serializer: S) -> Result<S::Ok, S::Error> {
        array.as_slice().serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>, const N: usize>(deserializer: D) -> Result<[u32; N], D::Error> {
        let all = Vec::<u32>::deserialize(deserializer)?;
        let length = all.len();
        all.try_into().map_err(|_| D::Error::invalid_length(length, &"as many as it has particles"))
    }
}

/// Groups of constraints.
pub(crate) mod groups {
    use super::*;
    use crate::batch::Group;
    use crate::lanes::LANES;

    pub fn serialize<S: Serializer, const N: usize>(groups: &[Group<N>], serializer: S) -> Result<S::Ok, S::Error> {
        groups.as_flattened().serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>, const N: usize>(deserializer: D) -> Result<Vec<Group<N>>, D::Error> {
        let all = Vec::<[u32; LANES]>::deserialize(deserializer)?;
        let (groups, rest) = all.as_chunks::<N>();
        match rest {
            [] => Ok(groups.to_vec()),
            _ => Err(D::Error::invalid_length(all.len(), &"a whole number of groups")),
        }
    }
}
