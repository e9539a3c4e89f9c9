//! What is moved once a frame moves over all ticks of the frame, what is moved every tick in that tick.

use std::time::Duration;

use bevy::prelude::*;
use cloth_solver::Pose;

use super::placement::{Placement, Placements};
use super::{Anchors, ColliderState, StepPlan};
use crate::cloth::ClothFrame;
use crate::settings::Grabs;
use crate::step::ClothTick;
use crate::teleport::Teleport;

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
    /// In how many ticks it is there.
    ticks: u32,
    /// Something within [`ClothSchedule`](crate::ClothSchedule) moves it in every tick.
    each_tick: bool,
}

impl Follow {
    /// At rest.
    pub const fn new(pose: Pose) -> Self {
        Self { pose, target: pose, ticks: 1, each_tick: false }
    }

    /// Sees it before the first of several fixed steps in one frame: what moved it until now does so once a frame.
    pub fn look(&mut self, target: Pose) {
        if target != self.target {
            (self.target, self.ticks) = (target, u32::MAX);
        }
    }

    /// Sees it in a tick. [`Follow::advance`] then moves it.
    pub fn aim(&mut self, target: Pose, tick: &ClothTick) {
        let changed = target != self.target;
        if !tick.first {
            self.each_tick = changed;
        }
        if changed {
            (self.target, self.ticks) = (target, if self.each_tick { 1 } else { tick.left_in_run });
        }
        self.ticks = self.ticks.clamp(1, tick.left.max(1));
    }

    /// Whether the share of this tick in its move is a jump.
    pub fn jumps(&self, limits: &Teleport) -> bool {
        let ticks = self.ticks as f32;
        self.target != self.pose && !is_near(&self.pose, &self.target, limits.distance * ticks, limits.angle * ticks)
    }

    /// Moves it over one tick, and gives where it then stands.
    pub fn advance(&mut self) -> Pose {
        let arrives = self.ticks <= 1 || self.pose == self.target;
        self.pose = if arrives { self.target } else { self.pose.interpolate(&self.target, 1.0 / self.ticks as f32) };
        self.ticks = self.ticks.saturating_sub(1).max(1);
        self.pose
    }

    /// Puts it to `pose`, from where it reaches its target in one tick.
    pub fn carry(&mut self, pose: Pose) {
        (self.pose, self.ticks) = (pose, 1);
    }
}

/// Whether two poses are no more than `distance` (m) and `angle` (radians) apart.
pub(super) fn is_near(a: &Pose, b: &Pose, distance: f32, angle: f32) -> bool {
    a.position.distance(b.position) <= distance && a.rotation.angle_between(b.rotation) <= angle
}

/// Looks at all that moves before the first of several fixed steps in one frame.
pub(crate) fn look(
    mut cloths: Query<(Entity, &mut ClothFrame, &mut Anchors, &mut StepPlan, Option<&Grabs>)>,
    mut colliders: Query<(Entity, &mut ColliderState)>,
    placements: Placements,
    (fixed, frames): (Option<Res<Time<Fixed>>>, Option<Res<Time<Virtual>>>),
    mut frame: Local<Option<Duration>>,
) {
    let (Some(fixed), Some(frames)) = (fixed, frames) else { return };
    let is_first = frame.replace(frames.elapsed()) != Some(frames.elapsed());
    if !is_first || fixed.overstep() < fixed.timestep() {
        return;
    }
    let stands = |entity| placements.get(entity).filter(Placement::is_finite).map(|placement| placement.pose);
    for (entity, mut frame, mut anchors, mut plan, grabs) in &mut cloths {
        if let Some(pose) = stands(entity) {
            frame.follow.look(pose);
        }
        anchors.look(&placements);
        plan.look(grabs);
    }
    for (entity, mut state) in &mut colliders {
        if let (Some(follow), Some(pose)) = (&mut state.follow, stands(entity)) {
            follow.look(pose);
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
        ClothTick { left, left_in_run: 1, first: true, ..default() }
    }

    fn step(follow: &mut Follow, target: f32, tick: &ClothTick) -> f32 {
        follow.aim(at(target), tick);
        follow.advance().position.x
    }

    #[test]
    fn what_moved_before_the_ticks_of_a_frame_is_spread_over_them_and_arrives_with_the_last() {
        let mut follow = Follow::new(at(0.0));
        follow.look(at(1.0));
        let stood = [4, 3, 2, 1].map(|left| step(&mut follow, 1.0, &tick(left)));
        assert!(stood.iter().zip([0.25, 0.5, 0.75]).all(|(x, wanted)| (x - wanted).abs() < 1e-6), "{stood:?}");
        assert_eq!(stood[3], 1.0);
    }

    #[test]
    fn what_moves_before_each_tick_is_never_late() {
        let mut follow = Follow::new(at(0.0));
        for frame in 0..3 {
            follow.look(at(3.0 * frame as f32));
            for left in [3, 2, 1] {
                let target = 3.0 * frame as f32 + (4 - left) as f32;
                assert_eq!(step(&mut follow, target, &tick(left)), target);
            }
        }
    }

    #[test]
    fn a_clock_that_runs_fast_spreads_what_moves_before_each_fixed_step() {
        let mut follow = Follow::new(at(0.0));
        let ticks = [2, 1].map(|left| ClothTick { left: left + 6, left_in_run: left, first: left == 2, ..default() });
        assert_eq!(ticks.map(|tick| step(&mut follow, 1.0, &tick)), [0.5, 1.0]);
    }

    #[test]
    fn a_jump_is_judged_by_its_share_of_one_tick() {
        let limits = Teleport { distance: 0.5, ..default() };
        let jumps = |far, left| {
            let mut follow = Follow::new(at(0.0));
            follow.look(at(far));
            follow.aim(at(far), &tick(left));
            follow.jumps(&limits)
        };
        assert_eq!([jumps(0.4, 1), jumps(0.6, 1), jumps(1.9, 4), jumps(2.1, 4)], [false, true, false, true]);
    }
}
