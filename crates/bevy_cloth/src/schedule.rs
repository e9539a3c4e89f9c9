//! When things happen: the plugin, its schedules, and the sets a user can put systems between.

use bevy::ecs::message::signal_message_update_system;
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel, SingleThreadedExecutor};
use bevy::prelude::*;

use crate::air::Wind;
use crate::bones::BoneColliders;
use crate::clock::{self, RunsInFixedLoop};
use crate::cloth::Cloth;
use crate::collider::{ClothCollider, ColliderFriction};
use crate::detail::{ClothDetail, ClothViewer};
use crate::events::{
    ClothRecovered, ClothRejected, ClothReset, ClothTangled, ClothUntangled, ColliderRejected, WindRejected,
};
use crate::freedom::Freedom;
use crate::particle_pins::{self, ParticlePins};
use crate::pins::Pins;
use crate::settings::{Grabs, Gravity, Shared, Substeps};
use crate::stats::ClothStats;
use crate::step::ClothTick;
use crate::substeps::OwnSubsteps;
use crate::teleport::Teleport;
use crate::weights::Weights;
use crate::{
    Air, ClothClock, Fabric, Fan, Gusts, Method, SelfContact, WindZone, bodies, contact, contact_view, damage, fault,
    groups, prepare, self_contact, shown, sleep, stats, step, substeps,
};

/// Adds cloth to an app: everything this crate does but the diagnostics.
///
/// Works with `MinimalPlugins`. What needs assets, a renderer or pointers runs only where those are.
#[derive(Clone, Copy, Debug)]
pub struct ClothPlugin {
    schedule: InternedScheduleLabel,
}

impl ClothPlugin {
    /// Simulates in `schedule`. Ticks have the length of the fixed timestep in any case; in a schedule that runs once
    /// a frame there are as many of them as the frame is long.
    ///
    /// What is moved once a frame (colliders, entities with pins, clothes, hands) moves over all ticks of the frame; what is
    /// moved before each fixed step moves within that step.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self { schedule: schedule.intern() }
    }
}

impl Default for ClothPlugin {
    /// Simulates in [`FixedPostUpdate`].
    fn default() -> Self {
        Self::new(FixedPostUpdate)
    }
}

/// One tick of all clothes. Runs zero or more times in the schedule given to [`ClothPlugin`]; its systems one after the other, some of them on
/// several threads.
///
/// Within it [`Time`] is the cloth clock: its delta is the length of a tick.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ClothSchedule;

/// One substep of all clothes that take theirs together. Runs in [`ClothSystems::Substep`] as often as the cloth with most
/// substeps needs, on one thread.
///
/// Cloths take them together where they may touch ([`SelfContact`]); all others go through their substeps one by one, on all threads of
/// Bevy's compute task pool. Put a system into this schedule, or a condition on one of its sets, and all take them together, so that it
/// sees each substep; the motion is the same, to the bit.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ClothSubstepSchedule;

/// The phases of a tick, in order. A system put between two of them runs between them.
///
/// ```text
/// Build ─ Advance ─▶ ClothSchedule × ticks
///                    Prepare ─ Forces ─ Substep ─ Tear ─ Burn ─ Writeback
///                                       └▶ ClothSubstepSchedule × substeps
///                                          Integrate ─ Solve ─ Collide
/// ```
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClothSystems {
    /// Takes changes of authored components over into the runtime state, also while the clock is paused. In the
    /// plugin's schedule.
    Build,
    /// Advances the clock and runs [`ClothSchedule`]. In the plugin's schedule; order a physics engine before it.
    Advance,
    /// Brings frames, pins, grabs, colliders, fans and wind zones up to this tick. In [`ClothSchedule`].
    Prepare,
    /// Sets the accelerations and forces of this tick, and finds how the air moves. Systems that push cloth
    /// ([`Particles::add_force`](crate::Particles::add_force)) go here. In [`ClothSchedule`].
    Forces,
    /// The substeps, see [`ClothSubstepSchedule`]. In [`ClothSchedule`].
    Substep,
    /// Lets the air act and predicts positions. In [`ClothSubstepSchedule`].
    Integrate,
    /// Solves the constraints. In [`ClothSubstepSchedule`].
    Solve,
    /// Pushes particles out of colliders, and cloth with [`SelfContact`] off itself. In [`ClothSubstepSchedule`].
    Collide,
    /// Takes apart what is loaded beyond its strength. In [`ClothSchedule`].
    Tear,
    /// Burns what is alight. In [`ClothSchedule`].
    Burn,
    /// Lets cloth at rest fall asleep, mends faults, tells what is tangled and takes statistics. In [`ClothSchedule`].
    Writeback,
    /// Finds how far the shape drawn lies between two ticks and, with the feature `render`, writes the meshes. In
    /// [`PostUpdate`], after the transforms are propagated.
    Draw,
}

impl Plugin for ClothPlugin {
    fn build(&self, app: &mut App) {
        let fixed = [
            FixedFirst.intern(),
            FixedPreUpdate.intern(),
            FixedUpdate.intern(),
            FixedPostUpdate.intern(),
            FixedLast.intern(),
        ];
        let in_fixed_loop = fixed.contains(&self.schedule);
        app.init_resource::<Time<ClothClock>>()
            .insert_resource(RunsInFixedLoop(in_fixed_loop))
            .init_resource::<ClothTick>()
            .init_resource::<groups::Groups>()
            .init_resource::<Shared<Gravity>>()
            .init_resource::<Shared<Substeps>>()
            .init_resource::<Shared<Method>>()
            .init_resource::<Shared<Wind>>()
            .init_resource::<Shared<Gusts>>()
            .init_resource::<Shared<Teleport>>()
            .add_message::<ClothRejected>()
            .add_message::<ColliderRejected>()
            .add_message::<WindRejected>()
            .add_message::<ClothRecovered>()
            .add_message::<ClothReset>()
            .add_message::<ClothTangled>()
            .add_message::<ClothUntangled>();
        register_types(app);
        add_schedules(app, self.schedule);
        prepare::plugin(app, self.schedule, in_fixed_loop);
        damage::plugin(app);
        sleep::plugin(app);
        contact::plugin(app);
        contact_view::plugin(app);
        bodies::plugin(app);
        shown::plugin(app);
        app.add_observer(particle_pins::on_pin).add_observer(particle_pins::on_unpin);
        #[cfg(feature = "render")]
        crate::render::plugin(app);
        #[cfg(feature = "picking")]
        crate::picking::plugin(app);
    }

    #[cfg(feature = "render")]
    fn finish(&self, app: &mut App) {
        crate::render::finish(app);
    }
}

fn add_schedules(app: &mut App, schedule: InternedScheduleLabel) {
    use ClothSystems::*;
    for label in [ClothSchedule.intern(), ClothSubstepSchedule.intern()] {
        // Handing a few microseconds of work to another thread costs more than the work.
        app.init_schedule(label).edit_schedule(label, |schedule| {
            schedule.set_executor(SingleThreadedExecutor::new());
        });
    }
    app.configure_sets(schedule, (Build, Advance).chain())
        .configure_sets(ClothSchedule, (Prepare, Forces, Substep, Tear, Burn, Writeback).chain())
        .configure_sets(ClothSubstepSchedule, (Integrate, Solve, Collide).chain())
        .add_systems(schedule, step::advance.in_set(Advance).before(signal_message_update_system))
        .add_systems(ClothSchedule, (step::hold_still, substeps::run).chain().in_set(Substep))
        .add_systems(
            ClothSchedule,
            (sleep::fall_asleep, fault::mend, self_contact::tell, stats::measure).chain().in_set(Writeback),
        )
        .configure_sets(PostUpdate, Draw.after(TransformSystems::Propagate))
        .add_systems(PostUpdate, clock::interpolate.in_set(Draw));
    OwnSubsteps::add(app, |app| {
        app.add_systems(
            ClothSubstepSchedule,
            (
                substeps::integrate.in_set(Integrate),
                (substeps::solve, groups::accept).chain().in_set(Solve),
                (substeps::collide, groups::collide).chain().in_set(Collide),
            ),
        );
    });
}

fn register_types(app: &mut App) {
    app.register_type::<Cloth>()
        .register_type::<Fabric>()
        .register_type_data::<Fabric, ReflectComponent>()
        .register_type_data::<Fabric, ReflectDefault>()
        .register_type::<Pins>()
        .register_type::<ParticlePins>()
        .register_type::<Freedom>()
        .register_type::<BoneColliders>()
        .register_type::<Weights>()
        .register_type::<Air>()
        .register_type_data::<Air, ReflectComponent>()
        .register_type_data::<Air, ReflectDefault>()
        .register_type::<Wind>()
        .register_type::<Shared<Wind>>()
        .register_type::<Gusts>()
        .register_type_data::<Gusts, ReflectComponent>()
        .register_type::<Shared<Gusts>>()
        .register_type::<Teleport>()
        .register_type::<ClothDetail>()
        .register_type::<ClothViewer>()
        .register_type::<Shared<Teleport>>()
        .register_type::<Fan>()
        .register_type_data::<Fan, ReflectComponent>()
        .register_type::<WindZone>()
        .register_type_data::<WindZone, ReflectComponent>()
        .register_type::<ClothCollider>()
        .register_type::<ColliderFriction>()
        .register_type::<Gravity>()
        .register_type::<Shared<Gravity>>()
        .register_type::<Substeps>()
        .register_type::<Shared<Substeps>>()
        .register_type::<Method>()
        .register_type_data::<Method, ReflectComponent>()
        .register_type::<Shared<Method>>()
        .register_type::<SelfContact>()
        .register_type_data::<SelfContact, ReflectComponent>()
        .register_type_data::<SelfContact, ReflectDefault>()
        .register_type::<Grabs>()
        .register_type::<ClothStats>()
        .register_type::<Time<ClothClock>>();
}
