//! What holds cloth: pins, hands, tethers.

pub(in crate::constraint) mod grab;
pub(in crate::constraint) mod pin;
pub(in crate::constraint) mod tether;
