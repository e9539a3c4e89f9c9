//! Forces from outside, one file each.

mod air;

pub use air::Air;
