//! What a cloth could do without, and what that saves.
//!
//! [`advise`] plays a copy of a cloth as it is now, and again with one part less: without bending, without air, with fewer cells or
//! substeps. What moves no point by more than a tolerance could be left out. Nothing is guessed: each [`Advice`] says how far a
//! point moved and what part of the time was saved.
//!
//! ```
//! use std::sync::Arc;
//!
//! use cloth_advice::{Progress, Sample, Settings, advise};
//! use cloth_solver::topology::Resolution;
//! use cloth_solver::{Cloth, Fabric, Tick, Topology};
//! use glam::{UVec2, Vec2, Vec3};
//!
//! let fabric = Fabric::COTTON_POPLIN;
//! let topology = Topology::rectangle(Vec2::ONE, Resolution::Cells(UVec2::splat(10)))?;
//! let cloth = Cloth::new(Arc::new(topology), &fabric)?;
//! let sample = Sample { cloth, fabric, gravity: Vec3::NEG_Y * 9.81, tick: Tick::new(1.0 / 60.0), tearing: None };
//! let settings = Settings { tolerance: 0.01, seconds: 0.1 };
//! let report = advise(&sample, settings, &Progress::default()).expect("nobody stopped it");
//! assert!(report.advice.iter().any(|advice| advice.can_go));
//! # Ok::<(), cloth_solver::ClothError>(())
//! ```
//!
//! | module | what is in it |
//! |---|---|
//! | `change` | [`Change`]: what could be left out |
//! | `shape` | [`Shape`], [`Difference`]: how far two shapes are apart |
//! | `sample` | [`Sample`]: a cloth that is played apart from its world |
//! | `advise` | [`advise`]: plays and compares |
//! | `sentence` | an [`Advice`] in a sentence |
//!
//! Scenes as a whole are advised by the lab, which plays them at greater length.

mod advise;
mod change;
mod sample;
mod sentence;
mod shape;

pub use advise::{Advice, Progress, Report, Settings, advise};
pub use change::{Change, Lever};
pub use sample::Sample;
pub use shape::{Difference, Shape, Sheet};
