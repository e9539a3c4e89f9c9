//! Cloth physics in SI units: fabric, topology, constraints, contact, measurement.
//!
//! The crate knows no engine, reads no clock and owns no thread. One tick of one cloth is
//! [`Cloth::step`]; an engine that wants its own systems between the phases calls them itself:
//! [`tick::Pace`], [`method::integrate`], [`method::solve`], [`method::accept`], [`contact::collide`].

pub(crate) mod batch;
pub mod body;
pub mod cloth;
pub mod constraint;
pub mod contact;
pub mod damage;
pub mod error;
pub mod fabric;
pub mod fingerprint;
pub mod forces;
pub mod group;
pub mod measure;
pub mod method;
pub mod particles;
pub mod pick;
pub mod pose;
pub mod rest;
#[cfg(feature = "save")]
mod save;
pub mod tick;
pub mod topology;

mod lanes;

pub use body::Body;
pub use cloth::Cloth;
pub use damage::fire::{Fire, Flammable};
pub use error::ClothError;
pub use fabric::Fabric;
pub use group::Group;
pub use method::Method;
pub use particles::{Particles, Soa3};
pub use pose::{Motion, Pose};
pub use tick::{Substep, Tick};
pub use topology::{Grid, Topology};
