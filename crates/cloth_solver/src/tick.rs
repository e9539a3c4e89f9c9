//! Time: a tick, and the substeps it is divided into.

/// One tick: how long, and into how many substeps it may be divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Length of the tick, s.
    pub dt: f32,
    /// Least number of substeps, at least 1: what a quiet tick takes.
    pub substeps: u32,
    /// Largest number of substeps: as many are taken as load and motion ask for. Not below `substeps`; equal to it, the number
    /// is fixed. Methods that step forces, and PBD, always take `substeps`.
    pub most: u32,
    /// Iterations in a substep, at least 1; of no effect on methods that do not iterate.
    pub iterations: u32,
}

/// Default least and largest number of substeps in a tick; see the chart in `docs/lab`.
pub const DEFAULT_SUBSTEPS: [u32; 2] = [10, 80];

impl Tick {
    /// A tick of `dt` seconds at the default budget.
    pub const fn new(dt: f32) -> Self {
        let [substeps, most] = DEFAULT_SUBSTEPS;
        Self { dt, substeps, most, iterations: 1 }
    }

    /// A tick of `dt` seconds in exactly `substeps` substeps.
    pub const fn fixed(dt: f32, substeps: u32) -> Self {
        Self { dt, substeps, most: substeps, iterations: 1 }
    }

    /// A tick of `dt` seconds in at least `substeps` substeps and, where more are asked for, as many as by default.
    pub const fn at_least(dt: f32, substeps: u32) -> Self {
        let most = if substeps > DEFAULT_SUBSTEPS[1] { substeps } else { DEFAULT_SUBSTEPS[1] };
        Self { dt, substeps, most, iterations: 1 }
    }

    /// Its first substep, for cloth that moved before, if it is a quiet tick.
    pub fn first(&self) -> Substep {
        let [count, most] = self.range();
        let (h, shortest) = (self.dt / count, self.dt / most);
        let iterations = self.iterations.max(1);
        Substep { h, kick: h, longest: h, shortest, start: 0.0, end: 1.0 / count, implicit: false, iterations }
    }

    /// The least and the largest number of substeps.
    fn range(&self) -> [f32; 2] {
        let least = self.substeps.max(1);
        [least, self.most.max(least)].map(|count| count as f32)
    }
}

/// One substep of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Substep {
    /// Length, s: how long the particles drift at one velocity.
    pub h: f32,
    /// How long the forces act that give them that velocity, s: from the middle of the last substep to the middle of this one, so
    /// that a change of length neither adds energy nor takes any. Half of `h` in the first substep of all.
    pub kick: f32,
    /// The longest that a substep of this tick may be, s. Forces are smoothed for this length, whatever that of the substep is,
    /// so that the fabric does not become stiffer and softer again with the number of substeps.
    pub longest: f32,
    /// The shortest that a substep of this tick may be, s.
    pub shortest: f32,
    /// Where in the tick it starts, 0..1.
    pub start: f32,
    /// Where in the tick it ends, 0..=1; exactly 1 in the last.
    pub end: f32,
    /// Whether the cloth moves more than even the most substeps resolve. Then links pull along the directions that they are about to
    /// have, which is stable whatever the motion and takes energy from it.
    pub implicit: bool,
    /// Iterations, at least 1.
    pub iterations: u32,
}

impl Substep {
    /// Whether it is the last of its tick.
    pub fn is_last(&self) -> bool {
        self.end >= 1.0
    }

    /// What a force becomes a move by, divided by mass, s²: `kick` times `h`.
    pub fn square(&self) -> f32 {
        self.kick * self.h
    }

    /// [`Self::square`] over that of the longest substep: the part of a smoothed force that acts in this one.
    pub(crate) fn share(&self) -> f32 {
        self.square() / (self.longest * self.longest)
    }
}

/// What a substep was like for the cloth: what decides how long the next one may be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effort {
    /// The largest T h²/(m l) of the links, T tension, m mass of the lighter end, l rest length, over what is stable.
    pub load: f32,
    /// The mean T h²/(m l) of the links.
    pub mean_load: f32,
    /// The largest change of a link (stretch and turn) in rest lengths.
    pub motion: f32,
    /// Whether a link turned by 60° and more: pulls along such links are the only ones that have a moment.
    pub turned: bool,
}

/// Divides the ticks of one cloth into substeps: as many as its load and its motion ask for.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pace {
    /// Substeps to a tick that are asked for.
    asked: f32,
    /// Where in the tick the next substep starts.
    at: f32,
    /// Substeps taken in this tick, those that were repeated included.
    taken: u32,
    /// How many times shorter than by the least number of substeps the substep is that forces are smoothed for, a power of [`STEP`];
    /// below 1 before the first substep.
    shorter: f32,
    /// For how long it should have been shorter than that, s; below 0 longer.
    due: f32,
    /// Length of the last substep that was accepted, s; 0 before the first.
    last: f32,
    /// See [`Substep::implicit`].
    implicit: bool,
}

/// [`Effort::mean_load`] up to which waves across taut cloth are right within 2 %.
const MEAN_LOAD: f32 = 0.4;

/// [`Effort::motion`] up to which links keep pulling along the direction that they had when the substep began.
const MOTION: f32 = 0.35;

/// How far beyond what it may be a substep is accepted.
const TOLERANCE: f32 = 1.3;

/// What is left of the number of substeps asked for after a substep in which fewer would have done.
const FADE: f32 = 0.98;

/// Forces are smoothed for a substep so many times shorter where more than so many times as many substeps are asked for.
const STEP: f32 = 1.6;

/// And for the longer one again where no more than this part of them is.
const CALM: f32 = 0.8;

/// How long it has to be so, s.
const PATIENCE: f32 = 0.25;

impl Pace {
    /// Begins a tick. `at_least` is what anything else than load and motion asks for (moving colliders).
    pub fn begin(&mut self, tick: &Tick, at_least: f32) {
        let [least, most] = tick.range();
        (self.at, self.taken) = (0.0, 0);
        self.asked = self.asked.max(at_least).clamp(least, most);
    }

    /// The substep at hand; `None` if the tick is over.
    pub fn substep(&mut self, tick: &Tick) -> Option<Substep> {
        self.substep_of(tick, self.left(tick))
    }

    /// How many substeps are asked for until the tick is over. Cloths that step together take the most that any of them asks for.
    pub fn left(&self, tick: &Tick) -> f32 {
        let most = tick.range()[1];
        // A thousandth: what is left but for rounding needs no substep of its own.
        ((1.0 - self.at) * self.asked.clamp(self.floor(tick), most) - 1e-3).ceil().max(1.0)
    }

    /// The number of substeps that forces are smoothed for.
    fn floor(&self, tick: &Tick) -> f32 {
        let [least, most] = tick.range();
        (least * self.shorter).clamp(least, most)
    }

    /// The substep at hand if so many are `left` in the tick, at least 1; `None` if the tick is over.
    pub fn substep_of(&self, tick: &Tick, left: f32) -> Option<Substep> {
        if self.at >= 1.0 {
            return None;
        }
        let floor = self.floor(tick);
        let end = if left == 1.0 { 1.0 } else { self.at + (1.0 - self.at) / left };
        let h = tick.dt * (1.0 - self.at) / left;
        // Not the shortest that this tick takes: a change of stiffness adds energy or takes some.
        let longest = (tick.dt / floor).max(h);
        let kick = 0.5 * (h + self.last);
        let (longest, shortest, iterations) = (longest.max(h), tick.dt / tick.range()[1], tick.iterations.max(1));
        Some(Substep { h, kick, longest, shortest, start: self.at, end, implicit: self.implicit, iterations })
    }

    /// Takes note of what `sub` was like. `false` if it has to be repeated, being too long.
    pub fn accept(&mut self, tick: &Tick, sub: &Substep, effort: &Effort) -> bool {
        let [least, most] = tick.range();
        self.taken += 1;
        let by_load = effort.load.max(effort.mean_load / MEAN_LOAD).sqrt();
        // `max` and `min` pass over what is not a number.
        let asked = (by_load.max(effort.motion / MOTION) * tick.dt / sub.h).max(least).min(most);
        if asked * sub.h > TOLERANCE * tick.dt {
            self.asked = 1.1 * asked;
            return false;
        }
        if !sub.implicit && effort.motion > TOLERANCE * MOTION {
            self.implicit = true;
            return false;
        }
        self.implicit &= effort.motion > CALM * MOTION;
        self.asked = asked.max(FADE * self.asked);
        (self.at, self.last) = (sub.end, sub.h);
        self.shorter = self.shorter.max(1.0);
        let floor = least * self.shorter;
        if self.asked > STEP * floor {
            self.due += sub.h;
        } else if self.asked < CALM * floor && self.shorter > 1.0 {
            self.due -= sub.h;
        }
        if self.due.abs() > PATIENCE {
            self.shorter = (self.shorter * if self.due > 0.0 { STEP } else { 1.0 / STEP }).max(1.0);
            self.due = 0.0;
        }
        true
    }

    /// Takes back what a substep was judged to be like, because this cloth or one that steps together with it has to repeat it; `before`
    /// is what it was before. What is asked for that substep stays.
    pub fn repeat(&mut self, before: Self) {
        let Self { asked, taken, implicit, .. } = *self;
        *self = Self { asked, taken, implicit: implicit || before.implicit, ..before };
    }

    /// Substeps taken in this tick so far, those that were repeated included.
    pub fn taken(&self) -> u32 {
        self.taken
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cloth_that_moves_too_fast_for_the_shortest_substep_does_not_repeat_it_for_ever_beside_another() {
        let (tick, wild) = (Tick::new(1.0 / 60.0), Effort { motion: 10.0, ..Effort::default() });
        let mut pace = Pace::default();
        pace.begin(&tick, 0.0);
        while let Some(sub) = pace.substep(&tick) {
            // The other cloth takes each substep as it is.
            let before = pace;
            if !pace.accept(&tick, &sub, &wild) {
                pace.repeat(before);
            }
            assert!(pace.taken() < 200, "it repeats {sub:?}");
        }
        assert!(pace.taken() >= tick.most);
    }
}
