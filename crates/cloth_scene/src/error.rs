//! What can be wrong with a scene file.

use cloth_solver::ClothError;

/// Why a scene was not accepted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// The text is not the RON of a scene.
    #[error("line {line}, column {column}: {message}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What was expected or found.
        message: String,
    },
    /// A name that is no fabric.
    #[error("cloth {cloth}: there is no fabric `{name}`, allowed are: {allowed}")]
    NoSuchFabric {
        /// Which cloth of the scene, from 0.
        cloth: usize,
        /// The name found.
        name: String,
        /// The names allowed.
        allowed: String,
    },
    /// A value of a cloth is out of range.
    #[error("cloth {cloth}: {error}")]
    Cloth {
        /// Which cloth of the scene, from 0.
        cloth: usize,
        /// Field, value and range.
        error: ClothError,
    },
    /// A value of a collider is out of range.
    #[error("collider {collider}: {error}")]
    Collider {
        /// Which collider of the scene, from 0.
        collider: usize,
        /// Field, value and range.
        error: ClothError,
    },
    /// A value of a fan is out of range.
    #[error("fan {fan}: {error}")]
    Fan {
        /// Which fan of the scene, from 0.
        fan: usize,
        /// Field, value and range.
        error: ClothError,
    },
    /// A value of a wind zone is out of range.
    #[error("zone {zone}: {error}")]
    Zone {
        /// Which zone of the scene, from 0.
        zone: usize,
        /// Field, value and range.
        error: ClothError,
    },
    /// A value of a mannequin is out of range.
    #[error("figure {figure}: {error}")]
    Figure {
        /// Which mannequin of the scene, from 0.
        figure: usize,
        /// Field, value and range.
        error: ClothError,
    },
    /// A value of a prop is out of range.
    #[error("prop {prop}: {error}")]
    Prop {
        /// Which prop of the scene, from 0.
        prop: usize,
        /// Field, value and range.
        error: ClothError,
    },
    /// A value of the scene itself is out of range.
    #[error(transparent)]
    World(#[from] ClothError),
}
