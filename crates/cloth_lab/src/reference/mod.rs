//! An independent reference for rectangles, in f64.
//!
//! It shares no code with the solver: the energies that `cloth_solver::measure::elastic_energy` documents are written
//! down a second time, on purpose, and advanced by another method. Motion is velocity Verlet with steps far below the
//! stability limit and nothing implicit ([`Motion`]); rest is a minimum of the potential energy found by Newton's method
//! ([`rest()`]).

mod eigen;
mod elements;
mod motion;
mod rest;
mod sheet;

pub use eigen::highest_frequency;
pub use motion::Motion;
pub use rest::{Rest, rest};
pub use sheet::{Ball, Sheet, Wind};

#[cfg(test)]
mod tests;
