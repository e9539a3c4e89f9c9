//! What cloth can suffer: cuts, tears, holes, fire.
//!
//! Cuts and tears change the topology and tell by a [`Change`] what became of particles and triangles; [`follow`] brings the rest
//! of the cloth up to it.

mod cut;
pub mod fire;
mod line;
mod tear;

pub use cut::{Blade, Cut, Stroke, cut};
pub use tear::{Direction, Split, Tear, Tearing, Torn, tear_at};

use std::sync::Arc;

use crate::constraint::Constraints;
use crate::topology::{Change, Surgery};
use crate::{Particles, Topology};

/// Takes `triangles` out of `topology`; `None` if there is none of them.
pub fn remove(topology: &mut Arc<Topology>, triangles: &[u32]) -> Option<Change> {
    let mut surgery = Surgery::new(topology);
    surgery.remove(triangles);
    surgery.finish()
}

/// Brings particles and constraints of a cloth up to what became of its topology: it was `before`, and is `now` by `change`.
pub fn follow(
    before: &Topology,
    now: &Topology,
    change: &Change,
    particles: &mut Particles,
    constraints: &mut Constraints,
) {
    particles.follow(before, now, change);
    constraints.follow(now, change);
}
