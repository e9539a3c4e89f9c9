//! The clock of all clothes: pause, slow motion, single steps. A tick always has the same length.

use std::time::Duration;

use bevy::prelude::*;

/// The most ticks run between two looks at the world: what a hitch adds beyond is dropped.
const MOST_TICKS: u32 = 64;

/// Context of the clock of all clothes, [`Time<ClothClock>`](Time). Use it through [`ClothTime`].
///
/// The clock advances in ticks of the fixed timestep ([`Time<Fixed>`](Time)). Slow motion runs fewer ticks, never
/// shorter ones, so that it shows exactly the motion that full speed shows.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, Clone, Debug, PartialEq)]
pub struct ClothClock {
    paused: bool,
    relative_speed: f32,
    queued: u32,
    accumulated: Duration,
    timestep: Duration,
    shown: f32,
}

impl Default for ClothClock {
    fn default() -> Self {
        Self {
            paused: false,
            relative_speed: 1.0,
            queued: 0,
            accumulated: Duration::ZERO,
            timestep: Time::<Fixed>::default().timestep(),
            shown: 1.0,
        }
    }
}

impl ClothClock {
    /// Takes in `delta` of the surrounding clock and gives the number of ticks that are due.
    pub(crate) fn take(&mut self, delta: Duration, timestep: Duration) -> u32 {
        self.timestep = timestep;
        let stepped = self.queued.min(MOST_TICKS);
        self.queued -= stepped;
        if self.paused {
            return stepped;
        }
        // Full speed adds whole durations, so that no rounding can shift a tick.
        self.accumulated +=
            if self.relative_speed == 1.0 { delta } else { delta.mul_f64(f64::from(self.relative_speed)) };
        let mut due = 0;
        while let Some(rest) = self.accumulated.checked_sub(timestep).filter(|_| due < MOST_TICKS) {
            self.accumulated = rest;
            due += 1;
        }
        if self.accumulated >= timestep {
            self.accumulated = Duration::ZERO;
        }
        due + stepped
    }

    /// How many ticks so many further steps of the surrounding clock will make, if nobody touches either.
    pub(crate) fn ahead(&self, steps: u32, timestep: Duration) -> u32 {
        let mut clock = *self;
        (0..steps.min(MOST_TICKS)).map(|_| clock.take(timestep, timestep)).sum()
    }

    /// What was taken in and makes no whole tick yet.
    pub(crate) fn accumulated(&self) -> Duration {
        self.accumulated
    }

    /// Sets what was taken in and made no tick of yet.
    pub(crate) fn set_accumulated(&mut self, accumulated: Duration) {
        self.accumulated = accumulated;
    }

    /// Whether the clock stands until someone does something.
    pub(crate) fn stands(&self) -> bool {
        self.paused || self.relative_speed == 0.0
    }
}

/// What can be done to the clock of all clothes, [`Time<ClothClock>`](Time).
///
/// ```
/// # use bevy::prelude::*;
/// use bevy_cloth::{ClothClock, ClothTime};
///
/// fn toggle_pause(mut time: ResMut<Time<ClothClock>>) {
///     if time.is_paused() { time.unpause() } else { time.pause() }
/// }
/// # bevy::ecs::system::assert_is_system(toggle_pause);
/// ```
pub trait ClothTime {
    /// The fastest the clock may run: 8 ticks in each fixed step, a bound on the work of one frame.
    const FASTEST: f32 = 8.0;

    /// Stops the clock. A cloth that is held still follows the hand.
    fn pause(&mut self);
    /// Lets the clock run again.
    fn unpause(&mut self);
    /// Whether the clock is stopped.
    fn is_paused(&self) -> bool;
    /// How fast the clock runs: 1 is real time, 0.1 slow motion. Values outside 0..=[`FASTEST`](Self::FASTEST) are
    /// brought to the nearer end, a NaN changes nothing; both are logged.
    fn set_relative_speed(&mut self, speed: f32);
    /// How fast the clock runs when not paused, 0..=[`FASTEST`](Self::FASTEST). Default 1.
    fn relative_speed(&self) -> f32;
    /// Runs one tick at the next fixed step, paused or not. Several calls queue up.
    fn step_once(&mut self);
    /// Length of a tick.
    fn timestep(&self) -> Duration;
    /// Where the shape drawn lies between the last two ticks: 0 the one before, 1 the last. Stands while paused.
    fn interpolation(&self) -> f32;
}

impl ClothTime for Time<ClothClock> {
    fn pause(&mut self) {
        self.context_mut().paused = true;
    }

    fn unpause(&mut self) {
        self.context_mut().paused = false;
    }

    fn is_paused(&self) -> bool {
        self.context().paused
    }

    fn set_relative_speed(&mut self, speed: f32) {
        let allowed = speed.clamp(0.0, Self::FASTEST);
        if allowed != speed {
            warn!("`Time<ClothClock>::relative_speed` was set to {speed}, allowed is 0..={}", Self::FASTEST);
        }
        if !allowed.is_nan() {
            self.context_mut().relative_speed = allowed;
        }
    }

    fn relative_speed(&self) -> f32 {
        self.context().relative_speed
    }

    fn step_once(&mut self) {
        let clock = self.context_mut();
        clock.queued = clock.queued.saturating_add(1);
    }

    fn timestep(&self) -> Duration {
        self.context().timestep
    }

    fn interpolation(&self) -> f32 {
        self.context().shown
    }
}

/// Whether the plugin runs in a schedule of the fixed loop, whose overstep then counts towards the next tick.
#[derive(Resource, Clone, Copy, Debug)]
pub(crate) struct RunsInFixedLoop(pub bool);

/// Finds where the shape drawn lies between the last two ticks.
pub(crate) fn interpolate(
    mut time: ResMut<Time<ClothClock>>,
    fixed: Option<Res<Time<Fixed>>>,
    in_fixed_loop: Res<RunsInFixedLoop>,
) {
    let clock = time.context();
    if clock.stands() {
        return;
    }
    let overstep = fixed.filter(|_| in_fixed_loop.0).map_or(Duration::ZERO, |fixed| fixed.overstep());
    let ahead = clock.accumulated.as_secs_f32() + overstep.as_secs_f32() * clock.relative_speed;
    let shown = (ahead / clock.timestep.as_secs_f32()).clamp(0.0, 1.0);
    time.context_mut().shown = shown;
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: Duration = Duration::from_millis(10);

    #[test]
    fn slow_motion_runs_fewer_ticks_and_loses_none() {
        let mut clock = ClothClock { relative_speed: 0.25, ..default() };
        let ticks: u32 = (0..100).map(|_| clock.take(STEP, STEP)).sum();
        assert_eq!(ticks, 25);
    }

    #[test]
    fn what_lies_ahead_is_what_comes() {
        let mut clock = ClothClock { relative_speed: 0.4, ..default() };
        clock.take(STEP, STEP);
        let ahead = clock.ahead(9, STEP);
        assert_eq!(ahead, 4);
        assert_eq!((0..9).map(|_| clock.take(STEP, STEP)).sum::<u32>(), ahead);
    }

    #[test]
    fn a_hitch_runs_a_bounded_number_of_ticks_and_owes_none_later() {
        let mut clock = ClothClock::default();
        assert_eq!(clock.take(STEP * 100_000, STEP), MOST_TICKS);
        assert_eq!(clock.take(Duration::ZERO, STEP), 0);
    }

    #[test]
    fn steps_asked_for_while_paused_run_once_each() {
        let mut time = Time::<ClothClock>::default();
        time.pause();
        time.step_once();
        time.step_once();
        assert_eq!(time.context_mut().take(STEP * 7, STEP), 2);
        assert_eq!(time.context_mut().take(STEP * 7, STEP), 0);
    }

    #[test]
    fn a_speed_that_is_no_number_changes_nothing() {
        let mut time = Time::<ClothClock>::default();
        time.set_relative_speed(0.5);
        time.set_relative_speed(f32::NAN);
        assert_eq!(time.relative_speed(), 0.5);
        time.set_relative_speed(-3.0);
        assert_eq!(time.relative_speed(), 0.0);
        time.set_relative_speed(f32::INFINITY);
        assert_eq!(time.relative_speed(), <Time<ClothClock> as ClothTime>::FASTEST);
    }
}
