//! Why a command of the lab stopped.

use std::path::PathBuf;

/// Why a command of the lab stopped.
#[derive(Debug, thiserror::Error)]
pub enum LabError {
    /// Checks that the default method claims failed.
    #[error("the default method fails {failed} of the checks it claims")]
    Failed {
        /// How many.
        failed: usize,
    },
    /// Trials of the stability plan did not hold.
    #[error("{failed} trials do not hold")]
    Unstable {
        /// How many.
        failed: usize,
    },
    /// A file could not be read or written.
    #[error("{path}: {error}", path = path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// A scene was refused.
    #[error("{path}: {error}", path = path.display())]
    Scene {
        /// Its file.
        path: PathBuf,
        /// Why.
        error: cloth_scene::SceneError,
    },
    /// A plot could not be drawn.
    #[error("{path}: cannot draw: {reason}", path = path.display())]
    Plot {
        /// The picture.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}
