//! Why saved cloths cannot be put back.

use bevy::prelude::*;

/// Why [`SavedCloths`](crate::SavedCloths) were not read or not put back.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RestoreError {
    /// The bytes are something else.
    #[error("these are no saved cloths: they do not begin as such do")]
    NotSaved,
    /// The bytes were written by another version of this crate.
    #[error("saved by version {found} of bevy_cloth, this is {expected}")]
    Version {
        /// That version.
        found: String,
        /// This one.
        expected: &'static str,
    },
    /// Bytes are missing, or are others than were written.
    #[error("the saved cloths are damaged: {0}")]
    Damaged(&'static str),
    /// An entity is no cloth that runs: it is gone, has no [`Cloth`](crate::Cloth), waits for its mesh, or was refused.
    #[error("{0} was saved as a cloth, and is none that runs")]
    NoCloth(Entity),
    /// A cloth has another rest shape than the one that was saved: another size, resolution, mesh or scale.
    #[error("cloth {0} has another rest shape than it was saved with")]
    OtherShape(Entity),
    /// An authored component of a cloth is another one than when it was saved.
    #[error("cloth {entity} has another `{component}` than it was saved with")]
    OtherComponent {
        /// The cloth.
        entity: Entity,
        /// The component.
        component: &'static str,
    },
}
