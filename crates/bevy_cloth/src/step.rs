//! The tick: the clock, and what is done before its substeps.

use std::time::Duration;

use bevy::ecs::query::QueryState;
use bevy::prelude::*;
use cloth_solver::Particles;

use crate::clock::{ClothClock, ClothTime, RunsInFixedLoop};
use crate::prepare::{MovedInPause, StepPlan};
use crate::schedule::ClothSchedule;
use crate::settings::Grabs;
use crate::sleep::ClothAsleep;

/// The tick at hand.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub(crate) struct ClothTick {
    /// Its length, s.
    pub dt: f32,
    /// Time stands and only what is held by a hand, or hangs on something that is moved, moves: no force acts, no speed is kept, the clock does not
    /// advance.
    pub still: bool,
    /// How many ticks are still to come in this frame, this one included.
    pub left: u32,
    /// How many of them before any other system runs: in this run of the plugin's schedule, this one included.
    pub left_in_run: u32,
    /// It is the first of its run.
    pub first: bool,
    /// What is left of the frame after its last tick, in ticks, 0..1.
    pub over: f32,
    /// What moves was looked at before the first of them: the plugin runs in the fixed loop.
    pub looked: bool,
}

/// Advances the clock and runs [`ClothSchedule`] once for each tick that is due.
pub(crate) fn advance(world: &mut World, grabs: &mut QueryState<&Grabs>) {
    let delta = world.get_resource::<Time>().map_or(Duration::ZERO, Time::delta);
    let timestep = world.get_resource::<Time<Fixed>>().copied().unwrap_or_default().timestep();
    let Some(mut clock) = world.get_resource_mut::<Time<ClothClock>>() else { return };
    let due = clock.context_mut().take(delta, timestep);
    let stands = clock.context().stands();
    let held = grabs.iter(world).any(|grabs| !grabs.0.is_empty());
    let moved = world.get_resource::<MovedInPause>().is_some_and(|moved| moved.0);
    let still = stands && due == 0 && (held || moved);
    if due == 0 && !still {
        return;
    }
    let looked = world.get_resource::<RunsInFixedLoop>().is_some_and(|runs| runs.0);
    let (ahead, over) = ticks_ahead(world, timestep, still);
    let due = due.max(1);
    let outside = world.get_resource::<Time>().copied();
    let _ = world.try_schedule_scope(ClothSchedule, |world, schedule| {
        for done in 0..due {
            let clock = world.get_resource_mut::<Time<ClothClock>>().map(|mut clock| {
                if !still {
                    clock.advance_by(timestep);
                }
                clock.as_generic()
            });
            set_time(world, clock);
            let left_in_run = due - done;
            *world.resource_mut::<ClothTick>() = ClothTick {
                dt: timestep.as_secs_f32(),
                still,
                left: left_in_run + ahead,
                left_in_run,
                first: done == 0,
                over,
                looked,
            };
            schedule.run(world);
        }
    });
    set_time(world, outside);
}

/// How many ticks follow in this frame after this run of the plugin's schedule, and what part of a tick is left after them.
fn ticks_ahead(world: &World, timestep: Duration, still: bool) -> (u32, f32) {
    let in_fixed_loop = world.get_resource::<RunsInFixedLoop>().is_some_and(|runs| runs.0);
    let fixed = world.get_resource::<Time<Fixed>>().filter(|_| in_fixed_loop);
    // The fixed loop has taken the step at hand off the overstep, and goes on while a whole one is left.
    let overstep = fixed.map_or(Duration::ZERO, Time::<Fixed>::overstep);
    let steps = overstep.as_nanos() / timestep.as_nanos().max(1);
    let steps = u32::try_from(steps).unwrap_or(u32::MAX);
    let clock = world.get_resource::<Time<ClothClock>>().filter(|_| !still);
    let ahead = clock.map_or(steps, |clock| clock.context().ahead(steps, timestep));
    let of_clock = clock.map_or(Duration::ZERO, |clock| clock.context().accumulated());
    let speed = clock.map_or(1.0, |clock| clock.relative_speed());
    let parts = of_clock.as_secs_f32() + overstep.as_secs_f32() * speed;
    (ahead, (parts / timestep.as_secs_f32().max(f32::MIN_POSITIVE) - ahead as f32).clamp(0.0, 1.0))
}

fn set_time(world: &mut World, to: Option<Time>) {
    if let (Some(mut time), Some(to)) = (world.get_resource_mut::<Time>(), to) {
        *time = to;
    }
}

/// In a tick in which time stands, takes all speed and force off what is about to move.
pub(crate) fn hold_still(mut cloths: Query<(&mut Particles, &StepPlan), Without<ClothAsleep>>, tick: Res<ClothTick>) {
    for (mut particles, plan) in &mut cloths {
        if tick.still && plan.substeps > 0 {
            particles.velocity.fill(Vec3::ZERO);
            particles.airflow = None;
            clear_forces(&mut particles);
        }
    }
}

/// Forces act for one tick.
pub(crate) fn clear_forces(particles: &mut Particles) {
    if let Some(force) = &mut particles.force {
        force.fill(Vec3::ZERO);
    }
}
