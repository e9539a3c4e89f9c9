//! How many passes over the lines a substep takes.

use crate::Substep;

/// Passes in a substep, unless they settle before, and most passes, where the last one still moved a particle further than [`CLOSE`].
const PASSES: usize = 3;
const MOST_PASSES: usize = 8;

/// See [`PASSES`], in edges.
const CLOSE: f32 = 0.02;

/// A pass that moves no particle further than this, in edges, need not be followed by another one.
const SETTLED: f32 = 5e-4;

/// The change of a link in a substep, in rest lengths, up to which cloth that has settled needs no second pass.
const QUIET: f32 = 0.02;

/// Tells when to stop.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::constraint) struct Passes {
    /// Whether the last pass that was not the first of its substep had next to nothing left to do.
    settled: bool,
}

impl Passes {
    /// Takes note of the first pass of `sub`, before which the largest square of the change of a link was `change`, in rest lengths.
    pub fn begin(&mut self, sub: &Substep, change: f32) {
        if sub.start == 0.0 || change > QUIET * QUIET {
            self.settled = false;
        }
    }

    /// Whether a further pass is due after `done` of them, the last of which moved a particle by at most `left` edges.
    pub fn is_due(&mut self, done: usize, left: f32) -> bool {
        if done > 1 {
            self.settled = left < SETTLED;
        }
        !self.settled && done < MOST_PASSES && (done < PASSES || left >= CLOSE)
    }
}
