//! What is moved once a frame moves over all ticks of the frame, what is moved every tick in that tick.

use std::time::Duration;

use bevy::prelude::*;
use cloth_solver::Pose;

use super::placement::{Placement, Placements};
use super::{Anchors, ColliderState, StepPlan};
use crate::bodies::BodyState;
use crate::clock::{ClothClock, ClothTime};
use crate::cloth::{ClothFrame, ClothRejection};
use crate::settings::Grabs;
use crate::step::ClothTick;
use crate::teleport::Teleport;

/// In so many ticks what is behind for longer than until the next move catches up by half, about: after a slow frame.
const CATCH_UP: f32 = 32.0;

/// Where a thing stands, and where it is on its way to.
///
/// A game moves things either once a frame, before the ticks of that frame, or in the fixed schedules, before each of
/// them. The first would stand still in all ticks but one, were it not spread over them; the second must not lag behind.
/// Which it is shows in whether the target changed since [`Follow::look`] or since the last tick of the same frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Follow {
    /// Where it stood at the end of the last tick.
    pub pose: Pose,
    /// Where it was moved to, as last seen.
    pub target: Pose,
    /// Where it was moved to when the tick before this one began.
    before: Pose,
    /// How far behind it is, in ticks: the time in which the target went what is left to go. What moves evenly from frame to frame
    /// is to move evenly from tick to tick.
    ticks: f32,
    /// In so many ticks the next move may come.
    left: f32,
    /// How many whole ticks what it was moved by last is spread over.
    spread: f32,
    /// Something within [`ClothSchedule`](crate::ClothSchedule) moves it in every tick.
    each_tick: bool,
}

impl Follow {
    /// At rest.
    pub const fn new(pose: Pose) -> Self {
        Self { pose, target: pose, before: pose, ticks: 0.0, left: 1.0, spread: 1.0, each_tick: false }
    }

    /// Sees it before the first fixed step in a frame: what moved it until now does so once a frame.
    /// The last frame was as long as so many `ticks`.
    pub fn look(&mut self, target: Pose, ticks: f32) {
        if target != self.target {
            (self.target, self.left, self.spread) = (target, f32::INFINITY, f32::INFINITY);
            self.ticks += ticks;
        }
    }

    /// Sees it in a tick. [`Follow::advance`] then moves it.
    pub fn aim(&mut self, target: Pose, tick: &ClothTick) {
        let changed = target != self.target;
        if !tick.first {
            self.each_tick = changed;
        }
        if changed {
            self.target = target;
            self.ticks = match (self.each_tick, tick.looked) {
                (true, _) => 1.0,
                (false, true) => tick.left_in_run as f32,
                (false, false) => tick.left_in_run as f32 + tick.over,
            };
            self.left = self.ticks;
            self.spread = f32::INFINITY;
        } else {
            self.left = self.left.min(tick.left.max(1) as f32 + tick.over);
        }
        self.spread = self.spread.min(self.left.floor()).max(1.0);
    }

    /// What it follows was moved to `now` as `moves` moves a pose: that is no motion.
    pub fn shift(&mut self, now: Pose, moves: impl Fn(Pose) -> Pose) {
        self.pose = if self.pose == self.target { now } else { moves(self.pose) };
        (self.target, self.before) = (now, now);
    }

    /// Whether the share of this tick in its move is a jump.
    pub fn jumps(&self, limits: &Teleport) -> bool {
        // By what it was moved in this frame, and by what is left of that: evenly spread both are the same.
        [(self.before, self.spread), (self.pose, self.ticks.max(self.left))].into_iter().any(|(from, ticks)| {
            self.target != from && !is_near(&from, &self.target, limits.distance * ticks, limits.angle * ticks)
        })
    }

    /// Moves it over one tick, and gives where it then stands.
    pub fn advance(&mut self) -> Pose {
        // Slower where it would be there before the next move, a little faster where more is left than until then.
        let part = match self.ticks > self.left {
            true => (1.0 + (self.ticks - self.left) / CATCH_UP) / self.ticks,
            false => 1.0 / self.left,
        };
        let arrives = part >= 1.0 || self.pose == self.target;
        self.pose = if arrives { self.target } else { self.pose.interpolate(&self.target, part) };
        self.ticks *= if arrives { 0.0 } else { 1.0 - part };
        self.left = (self.left - 1.0).max(1.0);
        self.before = self.target;
        self.pose
    }

    /// Puts it to `pose`, from where it reaches its target in one tick.
    pub fn carry(&mut self, pose: Pose) {
        (self.pose, self.before, self.ticks, self.left) = (pose, pose, 0.0, 1.0);
    }
}

/// Whether two poses are no more than `distance` (m) and `angle` (radians) apart.
pub(super) fn is_near(a: &Pose, b: &Pose, distance: f32, angle: f32) -> bool {
    a.position.distance(b.position) <= distance && a.rotation.angle_between(b.rotation) <= angle
}

/// Looks at all that moves before the first fixed step in a frame.
pub(crate) fn look(
    mut cloths: Query<(Entity, &mut ClothFrame, &mut Anchors, &mut StepPlan, Option<&Grabs>), Without<ClothRejection>>,
    mut colliders: Query<(Entity, &mut ColliderState)>,
    mut bodies: Query<(Entity, &mut BodyState)>,
    placements: Placements,
    frames: Option<Res<Time<Virtual>>>,
    clock: Res<Time<ClothClock>>,
    mut frame: Local<Option<(Duration, f32)>>,
) {
    let Some(frames) = frames else { return };
    if frame.is_some_and(|(last, _)| last == frames.elapsed()) {
        return;
    }
    // What was moved since the last look went its way in the time until the frame at hand.
    let speed = if clock.context().stands() { 1.0 } else { clock.relative_speed() };
    let passed =
        frame.map_or(0.0, |(last, length)| (frames.elapsed() - last).as_secs_f32() - frames.delta_secs() + length);
    *frame = Some((frames.elapsed(), frames.delta_secs()));
    let ticks = passed * speed / clock.timestep().as_secs_f32();
    let stands = |entity| placements.get(entity).filter(Placement::is_finite).map(|placement| placement.pose);
    for (entity, mut frame, mut anchors, mut plan, grabs) in &mut cloths {
        if let Some(pose) = stands(entity) {
            frame.follow.look(pose, ticks);
        }
        anchors.look(&placements, ticks);
        plan.look(grabs, ticks);
    }
    for (entity, mut state) in &mut bodies {
        if let Some(pose) = stands(entity) {
            state.look(pose, ticks);
        }
    }
    for (entity, mut state) in &mut colliders {
        if let (Some(follow), Some(pose)) = (&mut state.follow, stands(entity)) {
            follow.look(pose, ticks);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f32) -> Pose {
        Pose::new(Vec3::X * x, Quat::IDENTITY)
    }

    fn tick(left: u32) -> ClothTick {
        ClothTick { left, left_in_run: 1, first: true, looked: true, ..default() }
    }

    fn step(follow: &mut Follow, target: f32, tick: &ClothTick) -> f32 {
        follow.aim(at(target), tick);
        follow.advance().position.x
    }

    #[test]
    fn what_moved_before_the_ticks_of_a_frame_is_spread_over_them_and_arrives_with_the_last() {
        let mut follow = Follow::new(at(0.0));
        follow.look(at(1.0), 1.0);
        let stood = [4, 3, 2, 1].map(|left| step(&mut follow, 1.0, &tick(left)));
        assert!(stood.iter().zip([0.25, 0.5, 0.75]).all(|(x, wanted)| (x - wanted).abs() < 1e-6), "{stood:?}");
        assert_eq!(stood[3], 1.0);
    }

    #[test]
    fn what_moves_before_each_tick_is_never_late() {
        let mut follow = Follow::new(at(0.0));
        for frame in 0..3 {
            follow.look(at(3.0 * frame as f32), 3.0);
            for left in [3, 2, 1] {
                let target = 3.0 * frame as f32 + (4 - left) as f32;
                assert_eq!(step(&mut follow, target, &tick(left)), target);
            }
        }
    }

    #[test]
    fn a_clock_that_runs_fast_spreads_what_moves_before_each_fixed_step() {
        let mut follow = Follow::new(at(0.0));
        let ticks = [2, 1].map(|left| ClothTick {
            left: left + 6,
            left_in_run: left,
            first: left == 2,
            looked: true,
            ..default()
        });
        assert_eq!(ticks.map(|tick| step(&mut follow, 1.0, &tick)), [0.5, 1.0]);
    }

    /// By how much it is moved in each tick of so many, while what it follows goes 1 m a second from frame to frame.
    fn played(frame: f32, tick_length: f32, ticks: usize) -> Vec<f32> {
        let (mut follow, mut moves, mut time, mut shown) = (Follow::new(at(0.0)), vec![], 0.0, 0.0);
        while moves.len() < ticks {
            let seen = shown;
            follow.look(at(seen), frame / tick_length);
            shown += frame;
            time += frame;
            let due = (time / tick_length).floor();
            time -= due * tick_length;
            for left in (1..=due as u32).rev() {
                let before = follow.pose.position.x;
                let tick = ClothTick { over: time / tick_length, ..tick(left) };
                moves.push(step(&mut follow, seen, &tick) - before);
            }
        }
        moves
    }

    #[test]
    fn what_moves_evenly_from_frame_to_frame_moves_evenly_from_tick_to_tick() {
        for hertz in [24.0, 30.0, 59.9, 60.0, 75.0, 144.0, 240.0, 1000.0] {
            let moves = played(1.0 / hertz, 1.0 / 64.0, 80);
            for moved in &moves[20..] {
                assert!((moved * 64.0 - 1.0).abs() < 1e-3, "{hertz} Hz: {moved}");
            }
        }
    }

    #[test]
    fn a_jump_is_judged_by_its_share_of_one_tick() {
        let limits = Teleport { distance: 0.5, ..default() };
        let jumps = |far, left| {
            let mut follow = Follow::new(at(0.0));
            follow.look(at(far), 1.0);
            follow.aim(at(far), &tick(left));
            follow.jumps(&limits)
        };
        assert_eq!([jumps(0.4, 1), jumps(0.6, 1), jumps(1.9, 4), jumps(2.1, 4)], [false, true, false, true]);
    }
}
