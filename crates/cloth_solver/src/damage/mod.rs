//! What destroys cloth, one file or folder each.

pub mod fire;
