//! The shape for which something about a collider was found.

use super::Shape;

/// The shape for which something about a collider was found: as soon as the collider has another one it holds no more.
#[derive(Clone, Debug, Default)]
pub enum KnownShape {
    /// Nothing was found yet.
    #[default]
    Unknown,
    /// For this one.
    Shape(Shape),
    /// For that with this [`Shape::fingerprint`]: saved state names a shape, and does not hold it.
    #[cfg(feature = "save")]
    Saved(u64),
}

impl From<Shape> for KnownShape {
    fn from(shape: Shape) -> Self {
        Self::Shape(shape)
    }
}

impl KnownShape {
    /// Whether it is `shape`; from now on it is.
    pub fn meet(&mut self, shape: &Shape) -> bool {
        let is_same = match self {
            Self::Unknown => false,
            Self::Shape(known) if known.is_same(shape) => return true,
            Self::Shape(_) => false,
            #[cfg(feature = "save")]
            Self::Saved(fingerprint) => *fingerprint == shape.fingerprint(),
        };
        *self = Self::Shape(shape.clone());
        is_same
    }
}

#[cfg(feature = "save")]
impl serde::Serialize for KnownShape {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let fingerprint = match self {
            Self::Unknown => None,
            Self::Shape(shape) => Some(shape.fingerprint()),
            Self::Saved(fingerprint) => Some(*fingerprint),
        };
        serde::Serialize::serialize(&fingerprint, serializer)
    }
}

#[cfg(feature = "save")]
impl<'de> serde::Deserialize<'de> for KnownShape {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let fingerprint: Option<u64> = serde::Deserialize::deserialize(deserializer)?;
        Ok(fingerprint.map_or(Self::Unknown, Self::Saved))
    }
}
