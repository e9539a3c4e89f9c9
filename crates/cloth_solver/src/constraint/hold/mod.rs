//! What holds cloth: pins, hands, tethers, a skin.

pub(in crate::constraint) mod grab;
pub(in crate::constraint) mod pin;
pub(in crate::constraint) mod skin;
pub(in crate::constraint) mod tether;
