//! Saved cloths as bytes: a magic word, the version, a fingerprint, and the state.

use core::fmt;

use cloth_solver::fingerprint::Fingerprint;
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{RestoreError, SavedCloths, State};

/// What the bytes begin with.
const MAGIC: [u8; 8] = *b"BevCloth";

/// What wrote the bytes: the version of the crate, and which form of its state. The number goes up with every change of what is saved.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "/1");

/// Saved cloths, written.
#[derive(Clone, Debug)]
pub(crate) struct Bytes(Vec<u8>);

impl SavedCloths {
    /// As bytes: some hundreds for each particle.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        bytes.extend_from_slice(&MAGIC);
        bytes.push(VERSION.len() as u8);
        bytes.extend_from_slice(VERSION.as_bytes());
        let fingerprint_at = bytes.len();
        bytes.extend_from_slice(&[0; 8]);
        // Into memory, and of types that each write what they hold: there is nothing that can fail.
        let mut bytes = postcard::to_extend(&self.0, bytes).expect("state can be written to memory");
        let fingerprint = fingerprint(&bytes[fingerprint_at + 8..]);
        bytes[fingerprint_at..fingerprint_at + 8].copy_from_slice(&fingerprint);
        bytes
    }

    /// What [`to_bytes`](Self::to_bytes) made bytes of.
    ///
    /// # Errors
    /// Bytes that are something else, were written by another version of this crate, or are damaged.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, RestoreError> {
        let damaged = RestoreError::Damaged;
        let rest = bytes.strip_prefix(&MAGIC).ok_or(RestoreError::NotSaved)?;
        let too_short = damaged("the beginning is incomplete");
        let (length, rest) = rest.split_first().ok_or(too_short.clone())?;
        let (version, rest) = rest.split_at_checked(usize::from(*length)).ok_or(too_short.clone())?;
        if version != VERSION.as_bytes() {
            let found = String::from_utf8_lossy(version).into_owned();
            return Err(RestoreError::Version { found, expected: VERSION });
        }
        let (known, state) = rest.split_first_chunk::<8>().ok_or(too_short)?;
        if *known != fingerprint(state) {
            return Err(damaged("bytes are missing, or are others than were written"));
        }
        match postcard::take_from_bytes::<State>(state) {
            Ok((state, [])) => Ok(Self(state)),
            Ok(_) => Err(damaged("there is more than the state")),
            Err(_) => Err(damaged("the state cannot be read")),
        }
    }
}

fn fingerprint(state: &[u8]) -> [u8; 8] {
    let mut all = Fingerprint::default();
    all.bytes(state);
    all.finish().to_le_bytes()
}

impl From<SavedCloths> for Bytes {
    fn from(saved: SavedCloths) -> Self {
        Self(saved.to_bytes())
    }
}

impl TryFrom<Bytes> for SavedCloths {
    type Error = RestoreError;

    fn try_from(bytes: Bytes) -> Result<Self, RestoreError> {
        Self::from_bytes(&bytes.0)
    }
}

impl Serialize for Bytes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bytes(&self.0)
    }
}

impl<'de> Deserialize<'de> for Bytes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_byte_buf(BytesVisitor)
    }
}

struct BytesVisitor;

impl<'de> Visitor<'de> for BytesVisitor {
    type Value = Bytes;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("the bytes of saved cloths")
    }

    fn visit_bytes<E>(self, bytes: &[u8]) -> Result<Bytes, E> {
        Ok(Bytes(bytes.to_vec()))
    }

    fn visit_byte_buf<E>(self, bytes: Vec<u8>) -> Result<Bytes, E> {
        Ok(Bytes(bytes))
    }

    /// For formats that know no bytes, as JSON.
    fn visit_seq<A: SeqAccess<'de>>(self, mut all: A) -> Result<Bytes, A::Error> {
        let mut bytes = Vec::new();
        while let Some(byte) = all.next_element()? {
            bytes.push(byte);
        }
        Ok(Bytes(bytes))
    }
}
