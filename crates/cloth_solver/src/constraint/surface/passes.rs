//! How many passes over the lines a substep takes.

use crate::Substep;
use crate::constraint::kernel::lines::{How, OVER_RELAXATION};

/// Passes in a substep, unless they settle before, and most passes, where the last one still moved a particle further than [`CLOSE`].
const PASSES: usize = 3;
const MOST_PASSES: usize = 8;

/// See [`PASSES`], in edges.
const CLOSE: f32 = 0.01;

/// A pass that moves no particle further than this, in edges, need not be followed by another one.
const SETTLED: f32 = 5e-4;

/// The change of a link in a substep, in rest lengths, up to which cloth that has settled needs no second pass.
const QUIET: f32 = 0.02;

/// The pass that tells whether cloth is jammed: whether it changes what a link is to be long by more than [`JAMMED`], in rest lengths,
/// and by more than [`CONTRACTION`] of what the one before did. By true lengths, passes would not converge then; they solve the linear
/// system that is left.
const TELLING: usize = 3;
const JAMMED: f32 = 0.1;
const CONTRACTION: f32 = 0.5;

/// For how long it counts as jammed, s.
const PATIENCE: f32 = 0.25;

/// Tells how a pass goes and when to stop.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::constraint) struct Passes {
    /// Whether the last pass that was not the first of its substep had next to nothing left to do.
    settled: bool,
    /// Passes in this substep so far.
    count: usize,
    /// The furthest that the last pass moved a particle, in edges.
    left: f32,
    /// The largest change of what a link is to be long in the last pass, in rest lengths.
    shift: f32,
    /// For how long still the cloth counts as jammed, s.
    jammed: f32,
}

impl Passes {
    /// How the first pass of `sub` goes.
    pub const fn first(sub: &Substep) -> How {
        How { implicit: sub.implicit, by_length: true, relaxation: 1.0 }
    }

    /// How the next pass of `sub` goes.
    pub fn how(&self, sub: &Substep) -> How {
        How { implicit: sub.implicit, by_length: self.jammed == 0.0, relaxation: OVER_RELAXATION }
    }

    /// How the pass over the rows goes that ends `sub`, before which the largest square of the change of a link was `change`; none in faster
    /// motion. With it rows and columns take turns in the same order from both ends. Otherwise what each leaves of the other, always
    /// after the same one, feeds swings within the plane of stiff sheets.
    pub fn last(&self, sub: &Substep, change: f32) -> Option<How> {
        (change < QUIET * QUIET).then(|| How { relaxation: 1.0, ..self.how(sub) })
    }

    /// Takes note of the first pass of `sub`, before which the largest square of the change of a link was `change`, in rest lengths.
    pub fn begin(&mut self, sub: &Substep, change: f32) {
        (self.count, self.left) = (1, f32::MAX);
        self.jammed = (self.jammed - sub.h).max(0.0);
        if sub.start == 0.0 || change > QUIET * QUIET {
            self.settled = false;
        }
    }

    /// Takes note of a further pass that moved a particle by at most `left` and changed what a link is to be long by `shift`, in edges.
    pub fn done(&mut self, left: f32, shift: f32) {
        self.count += 1;
        if self.count == TELLING && shift > JAMMED && shift > CONTRACTION * self.shift {
            self.jammed = PATIENCE;
        }
        (self.left, self.shift) = (left, shift);
        self.settled = left < SETTLED;
    }

    /// Whether a further pass is due.
    pub const fn is_due(&self) -> bool {
        !self.settled && self.count < MOST_PASSES && (self.count < PASSES || self.left >= CLOSE)
    }
}
