//! Time-stepping methods, one file each.

pub mod xpbd;
