//! The lab: speed against accuracy charted, stability mapped, known answers checked, engines compared, scenes advised.
//!
//! Every command is a module with its arguments and a `run`.

pub mod advise;
pub mod chart;
pub mod compare;
mod error;
pub mod plot;
pub mod progress;
pub mod reference;
pub mod report;
pub mod stability;
pub mod validate;

pub use error::LabError;
