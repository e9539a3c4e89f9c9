//! The substeps of a tick: each cloth's own, on all threads; together where cloths meet or other systems want to see each substep.

use bevy::ecs::query::{QueryData, QueryState};
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy::tasks::{ComputeTaskPool, available_parallelism};
use cloth_solver::Particles;
use cloth_solver::cloth::Constraints;
use cloth_solver::contact::{self, Contacts, SelfContacts};
use cloth_solver::method;

use crate::Air;
use crate::cloth::ClothTopology;
use crate::prepare::StepPlan;
use crate::schedule::ClothSubstepSchedule;
use crate::sleep::ClothAsleep;
use crate::step::ClothTick;

/// A cloth that is awake, with what a substep needs.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Stepping {
    topology: &'static ClothTopology,
    particles: &'static mut Particles,
    constraints: &'static mut Constraints,
    contacts: &'static mut Contacts,
    own: Option<&'static mut SelfContacts>,
    air: Option<&'static Air>,
    plan: &'static mut StepPlan,
}

impl SteppingItem<'_, '_> {
    /// Lets the air act and predicts positions.
    fn integrate(&mut self) {
        let Some(sub) = self.plan.substep else { return };
        if let Some(air) = self.air {
            air.blow(self.topology, &mut self.particles, &sub);
        }
        method::integrate(&mut self.particles, &self.constraints, &sub);
    }

    /// Solves, and takes the substep unless it was too long. What steps together with others takes it together with them.
    fn solve(&mut self) {
        let Some(sub) = self.plan.substep else { return };
        let effort = method::solve(&mut self.particles, &mut self.constraints, &sub);
        if self.plan.group.is_some() {
            self.plan.judge(&effort);
        } else if self.plan.accepts(&effort) {
            method::accept(&mut self.particles, &mut self.constraints, &sub);
        }
    }

    /// Keeps it off colliders and, if it steps alone, off itself.
    fn collide(&mut self) {
        let Some(sub) = self.plan.substep else { return };
        let Self { topology, particles, constraints, contacts, own, plan, .. } = self;
        if !contacts.colliders.is_empty() {
            contact::collide_with(topology, particles, contacts, constraints.bodies_mut(), &sub);
        }
        if let Some(own) = own.as_mut().filter(|_| plan.group.is_none()) {
            contact::collide_self(topology, particles, contacts, own, &sub);
        }
    }

    /// Takes it to the end of the tick by itself.
    fn run(&mut self, times: &mut Times) {
        loop {
            let left = self.plan.left();
            if !self.plan.next(left) {
                return;
            }
            times.measure(INTEGRATE, || self.integrate());
            times.measure(SOLVE, || self.solve());
            times.measure(COLLIDE, || self.collide());
        }
    }

    /// About how long it takes to the end of the tick, in substeps of one particle.
    fn cost(&self) -> f32 {
        self.plan.left() * self.particles.position.len() as f32
    }
}

/// The phases of a substep, by their place in [`SubstepTimes`].
const INTEGRATE: usize = 0;
const SOLVE: usize = 1;
pub(crate) const COLLIDE: usize = 2;

/// Time spent in each of them, s.
#[derive(Clone, Copy, Debug)]
struct Times {
    seconds: [f64; 3],
    wanted: bool,
}

impl Times {
    fn measure(&mut self, phase: usize, work: impl FnOnce()) {
        if !self.wanted {
            return work();
        }
        let began = Instant::now();
        work();
        self.seconds[phase] += began.elapsed().as_secs_f64();
    }
}

/// Times of the phases of a substep, for those that ask: present with the diagnostics only.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub(crate) struct SubstepTimes(pub [f64; 3]);

/// What the plugin itself has in [`ClothSubstepSchedule`].
#[derive(Resource, Clone, Copy, Debug)]
pub(crate) struct OwnSubsteps {
    /// The number of its systems.
    systems: usize,
    /// Somebody runs them only on a condition.
    conditions: bool,
}

impl OwnSubsteps {
    /// Adds them by `add`.
    pub fn add(app: &mut App, add: impl FnOnce(&mut App)) {
        let count = |app: &App| app.get_schedule(ClothSubstepSchedule).map_or(0, systems_of);
        let before = count(app);
        add(app);
        let systems = count(app) - before;
        app.insert_resource(Self { systems, conditions: false });
    }

    /// Whether nobody but the plugin has a part in the substeps. Then nobody sees in which order cloths take them.
    fn are_all(world: &mut World) -> bool {
        let Some(schedule) = world.resource::<Schedules>().get(ClothSubstepSchedule) else { return false };
        let systems = systems_of(schedule);
        // The schedule takes them out of its graph when it first runs.
        let new = schedule.graph().system_sets.iter().any(|(_, _, conditions)| !conditions.is_empty());
        let Some(mut own) = world.get_resource_mut::<Self>() else { return false };
        own.conditions |= new;
        !own.conditions && systems == own.systems
    }
}

/// The number of systems of a schedule, those included that it has not yet made ready to run.
fn systems_of(schedule: &Schedule) -> usize {
    schedule.graph().systems.len()
}

/// Work that is shared out among threads takes at least so many substeps of a particle (about 25 ns each) a task: handing it over takes some 10 μs.
const TASK: f32 = 4000.0;

/// Takes every cloth to the end of the tick: what steps with others, or with systems in between, by
/// [`ClothSubstepSchedule`].
pub(crate) fn run(
    world: &mut World,
    cloths: &mut QueryState<Stepping, Without<ClothAsleep>>,
    mut threads: Local<Option<usize>>,
) {
    let dt = world.resource::<ClothTick>().dt;
    let may_be_alone = OwnSubsteps::are_all(world);
    let wanted = world.contains_resource::<SubstepTimes>();
    let mut alone = Vec::new();
    let mut some_together = false;
    for mut cloth in cloths.iter_mut(world) {
        let SteppingItem { plan, particles, constraints, contacts, .. } = &mut cloth;
        plan.begin(dt, particles, constraints, contacts);
        if plan.substeps == 0 {
            continue;
        }
        if may_be_alone && plan.group.is_none() {
            alone.push(cloth);
        } else {
            some_together = true;
        }
    }
    let began = Instant::now();
    let threads = *threads.get_or_insert_with(threads_at_work);
    let times = run_alone(&mut alone, threads, wanted);
    drop(alone);
    if let Some(mut of_phases) = world.get_resource_mut::<SubstepTimes>() {
        let all: f64 = times.iter().sum();
        // On several threads at once.
        let share = (began.elapsed().as_secs_f64() / all.max(f64::MIN_POSITIVE)).min(1.0);
        of_phases.0.iter_mut().zip(times).for_each(|(sum, time)| *sum += time * share);
    }
    if some_together {
        run_together(world, cloths);
    }
}

/// How many threads can work at once: those of the pool, and the one that waits for them.
fn threads_at_work() -> usize {
    ComputeTaskPool::try_get().map_or(1, |pool| (pool.thread_num() + 1).min(available_parallelism()))
}

/// Takes each of `cloths` to the end of the tick. Returns the time spent in each phase, s, all threads together.
fn run_alone(cloths: &mut [SteppingItem], threads: usize, wanted: bool) -> [f64; 3] {
    let run = move |cloths: &mut [SteppingItem]| {
        let mut times = Times { seconds: [0.0; 3], wanted };
        cloths.iter_mut().for_each(|cloth| cloth.run(&mut times));
        times.seconds
    };
    let cost: f32 = cloths.iter().map(SteppingItem::cost).sum();
    if threads < 2 || cloths.len() < 2 || cost < 2.0 * TASK {
        return run(cloths);
    }
    // Some more tasks than threads, for those that turn out to take longer.
    let of_task = (cost / (4 * threads) as f32).max(TASK);
    let times = ComputeTaskPool::get().scope(|scope| {
        let mut left = cloths;
        while !left.is_empty() {
            let mut sum = 0.0;
            let enough = left.iter().position(|cloth| {
                sum += cloth.cost();
                sum >= of_task
            });
            let (task, others) = left.split_at_mut(enough.map_or(left.len(), |last| last + 1));
            left = others;
            scope.spawn(async move { run(task) });
        }
    });
    times.into_iter().fold([0.0; 3], |sum, times| std::array::from_fn(|phase| sum[phase] + times[phase]))
}

/// Runs [`ClothSubstepSchedule`] until every cloth has come to the end of the tick.
fn run_together(world: &mut World, cloths: &mut QueryState<Stepping, Without<ClothAsleep>>) {
    // By group the most substeps that one of its cloths asks for.
    let mut lefts: Vec<f32> = Vec::new();
    let _ = world.try_schedule_scope(ClothSubstepSchedule, |world, schedule| {
        loop {
            let mut some_left = false;
            lefts.clear();
            for SteppingItem { plan, .. } in cloths.iter_mut(world) {
                let Some(group) = plan.group else { continue };
                lefts.resize(lefts.len().max(group + 1), 1.0);
                lefts[group] = plan.left().max(lefts[group]);
            }
            for SteppingItem { mut plan, .. } in cloths.iter_mut(world) {
                let left = plan.group.map_or_else(|| plan.left(), |group| lefts[group]);
                some_left |= plan.next(left);
            }
            if !some_left {
                break;
            }
            schedule.run(world);
        }
    });
}

type Cloths<'w, 's> = Query<'w, 's, Stepping, Without<ClothAsleep>>;
type Watch<'w> = Option<ResMut<'w, SubstepTimes>>;

/// Does `work`, which is part of `phase`.
pub(crate) fn measured(watch: Watch, phase: usize, work: impl FnOnce()) {
    let mut times = Times { seconds: [0.0; 3], wanted: watch.is_some() };
    times.measure(phase, work);
    if let Some(mut watch) = watch {
        watch.0[phase] += times.seconds[phase];
    }
}

pub(crate) fn integrate(mut cloths: Cloths, watch: Watch) {
    measured(watch, INTEGRATE, || cloths.iter_mut().for_each(|mut cloth| cloth.integrate()));
}

pub(crate) fn solve(mut cloths: Cloths, watch: Watch) {
    measured(watch, SOLVE, || cloths.iter_mut().for_each(|mut cloth| cloth.solve()));
}

pub(crate) fn collide(mut cloths: Cloths, watch: Watch) {
    measured(watch, COLLIDE, || cloths.iter_mut().for_each(|mut cloth| cloth.collide()));
}
