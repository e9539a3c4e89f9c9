//! From authored components to runtime state, and the state of each tick.

mod anchors;
mod armature;
mod attributes;
mod authored;
mod build;
mod collider;
mod collider_save;
mod collider_shape;
mod follow;
mod frame;
mod placement;
mod select;
mod shared;
mod source;
mod undo;
mod wind_source;

use bevy::ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};
use bevy::prelude::*;
use cloth_solver::Pose;
use cloth_solver::forces::{Fan, WindZone};

use crate::air;
use crate::bodies;
use crate::bones;
use crate::groups;
use crate::schedule::{ClothSchedule, ClothSystems};
use crate::sleep;

pub(crate) use anchors::Anchors;
pub(crate) use armature::{Armature, TakenSkin};
#[cfg(feature = "render")]
pub(crate) use attributes::two_sided;
pub(crate) use authored::{Authored, differs_in_scale};
pub(crate) use collider::{ColliderState, Colliders};
pub(crate) use collider_save::SavedCollider;
pub(crate) use follow::Follow;
pub(crate) use frame::{MovedInPause, StepPlan};
pub(crate) use placement::{Placement, Placements};
pub(crate) use select::select;
pub(crate) use source::Skin;
#[cfg(feature = "render")]
pub(crate) use source::positions_and_indices;
pub(crate) use wind_source::WindSources;

/// `frame⁻¹ ∘ other`, exactly the identity if both are the same: what did not move must not move by a rounding.
pub(crate) fn relative(frame: &Pose, other: &Pose) -> Pose {
    if frame == other { Pose::IDENTITY } else { frame.inverse_pose(other) }
}

/// `frame ∘ inner`: what stands at `inner` as seen from `frame`, as seen from where `frame` is seen from.
pub(crate) fn placed(frame: &Pose, inner: &Pose) -> Pose {
    if *inner == Pose::IDENTITY {
        return *frame;
    }
    Pose::new(frame.point(inner.position), (frame.rotation * inner.rotation).normalize())
}

/// What [`ClothSystems::Build`] does, on one thread.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct BuildSchedule;

fn run_build(world: &mut World) {
    world.run_schedule(BuildSchedule);
}

/// Takes over what was authored until now, as at the beginning of a tick.
pub(crate) fn take_over(world: &mut World) {
    // Without the plugin there is nothing to take over.
    let _ = world.try_run_schedule(BuildSchedule);
    world.flush();
}

/// What drawing and pinning need of the mesh a running cloth was made from.
#[derive(Component, Clone, Debug)]
#[component(clone_behavior = Ignore)]
pub(crate) struct ClothSkin(pub std::sync::Arc<Skin>);

impl ClothSkin {
    /// Takes attributes of the mesh from `now`, the same cloth as it is at present, if they were not saved.
    pub fn take_attributes(&mut self, now: &Self) {
        if self.0.attributes.miss(&now.0.attributes) {
            std::sync::Arc::make_mut(&mut self.0).attributes.take(&now.0.attributes);
        }
    }

    /// The same, with what drawing needs: saved by an app that draws nothing, it lacks that. Tears then count as hems.
    #[cfg(feature = "render")]
    pub fn with_hem(mut self, topology: &cloth_solver::Topology) -> Self {
        if self.0.hem.len() != topology.slots() {
            std::sync::Arc::make_mut(&mut self.0).hem = crate::render::hem(topology);
        }
        self
    }
}

/// The mesh a cloth draws, and the one its entity had before. A clone of the entity needs it to tell them apart.
#[derive(Component, Clone, Debug)]
pub(crate) struct DrawnMesh {
    /// The user's mesh. Held so that the cloth can be built anew from it, and given back.
    pub source: Option<Handle<Mesh>>,
    /// The cloth's own.
    pub drawn: Handle<Mesh>,
}

/// Adds the systems of this folder.
pub(crate) fn plugin(app: &mut App, schedule: impl ScheduleLabel, in_fixed_loop: bool) {
    if in_fixed_loop {
        app.add_systems(FixedFirst, follow::look.before(ClothSystems::Build));
    }
    let winds = (wind_source::build::<Fan>, wind_source::build::<WindZone>);
    app.init_resource::<WindSources>()
        .init_resource::<Colliders>()
        .init_resource::<MovedInPause>()
        .init_resource::<air::SharedWind>()
        .init_schedule(BuildSchedule)
        .edit_schedule(BuildSchedule, |schedule| {
            // Handing a comparison to another thread costs many times what it takes.
            schedule.set_executor(SingleThreadedExecutor::new());
        })
        .add_systems(BuildSchedule, ((build::build, air::build).chain(), collider::build, winds, frame::look_in_pause))
        .add_systems(schedule, (bones::build, run_build).chain().in_set(ClothSystems::Build))
        .add_observer(bones::on_removed)
        .add_systems(
            ClothSchedule,
            (
                (collider::place, wind_source::place, bodies::place),
                sleep::wake,
                groups::wake_neighbors,
                frame::advance,
                collider::advance,
                bodies::advance,
                groups::form,
            )
                .chain()
                .in_set(ClothSystems::Prepare),
        )
        .add_systems(ClothSchedule, (frame::weigh, air::sample).chain().in_set(ClothSystems::Forces))
        .add_observer(wind_source::on_removed::<Fan>)
        .add_observer(wind_source::on_removed::<WindZone>)
        .add_observer(frame::on_reset)
        .add_observer(air::on_air_removed)
        .add_observer(undo::on_cloth_removed)
        .add_observer(undo::on_collider_removed);
}
