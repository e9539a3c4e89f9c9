//! Colliders and bodies of rapier.

use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;
use bevy_rapier3d::parry;
use bevy_rapier3d::prelude::*;

use super::shapes::{self, translate_shapes};
use super::{Engine, NoCloth, NoCounterpart, Part, WALL_THICKNESS, Walls, translate};
use crate::bodies::{ClothBody, ClothBodySystems, ClothPush};
use crate::schedule::{ClothSchedule, ClothSystems};

translate_shapes!();

/// Cloth and the bodies of [rapier](bevy_rapier3d) push each other: see [`engines`](crate::engines). Add rapier's
/// `RapierPhysicsPlugin`, told to run `in_fixed_schedule`, and [`ClothPlugin`](crate::ClothPlugin), too. The resource `TimestepMode` has
/// to be `Fixed` with the fixed timestep of Bevy, or `Variable` with a `max_dt` no shorter than that.
#[derive(Clone, Copy, Debug)]
pub struct ClothRapierPlugin {
    schedule: InternedScheduleLabel,
    /// Thickness of the walls that triangle meshes and height fields are for cloth, m; 0.001 to 10, default 0.01.
    pub wall_thickness: f32,
}

impl ClothRapierPlugin {
    /// With cloth in `schedule`.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self { schedule: schedule.intern(), wall_thickness: WALL_THICKNESS }
    }
}

impl Default for ClothRapierPlugin {
    /// With cloth in [`FixedPostUpdate`], where it is by default.
    fn default() -> Self {
        Self::new(FixedPostUpdate)
    }
}

struct Rapier;

impl Engine for Rapier {
    type Collider = Collider;
    type Sensor = Sensor;

    fn parts(collider: &Collider, wall: f32) -> Result<Vec<Part>, NoCounterpart> {
        shapes::unscaled(parts(&*collider.raw, wall)?, collider.scale())
    }
}

impl Plugin for ClothRapierPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<NoCloth>()
            .insert_resource(Walls::<Rapier>(self.wall_thickness, std::marker::PhantomData))
            .configure_sets(self.schedule, ClothSystems::Build.after(PhysicsSet::Writeback))
            .add_systems(
                self.schedule,
                (translate::<Rapier>, read).after(PhysicsSet::Writeback).before(ClothSystems::Build),
            )
            .add_systems(ClothSchedule, write.after(ClothBodySystems::Push).in_set(ClothSystems::Writeback));
    }
}

type Source<'a> = (
    Entity,
    &'a RigidBody,
    Option<(&'a RapierRigidBodyHandle, &'a RapierContextEntityLink)>,
    Has<Velocity>,
    Option<&'a LockedAxes>,
    Option<&'a GravityScale>,
    Has<RigidBodyDisabled>,
    Option<&'a mut ClothBody>,
);

/// Gives every dynamic body a [`ClothBody`], and a `Velocity` to be changed by.
fn read(mut bodies: Query<Source>, sets: Query<(&RapierRigidBodySet, &RapierConfiguration)>, mut commands: Commands) {
    for (entity, kind, known, has_velocity, locked, scale, is_disabled, body) in &mut bodies {
        let known = known.filter(|_| *kind == RigidBody::Dynamic && !is_disabled);
        let set = known.and_then(|(_, set)| sets.get(set.0).ok());
        let gravity = set.map_or(Vec3::ZERO, |(_, all)| all.gravity);
        let known = known.zip(set).and_then(|((handle, _), (set, _))| set.bodies.get(handle.0));
        let mass = known.map(|known| &known.mass_properties().local_mprops).filter(|mass| mass.inv_mass > 0.0);
        let Some(mass) = mass else {
            if body.is_some() {
                commands.entity(entity).try_remove::<(ClothBody, ClothPush)>();
            }
            continue;
        };
        if !has_velocity {
            commands.entity(entity).try_insert(Velocity::default());
        }
        let own = Mat3::from_quat(mass.principal_inertia_local_frame);
        let locked = locked.copied().unwrap_or(LockedAxes::empty());
        let wanted = ClothBody {
            mass: 1.0 / mass.inv_mass,
            center_of_mass: mass.local_com,
            inverse_inertia: own * Mat3::from_diagonal(mass.inv_principal_inertia) * own.transpose(),
            acceleration: gravity * scale.map_or(1.0, |scale| scale.0),
            locked_translation: BVec3::new(
                locked.contains(LockedAxes::TRANSLATION_LOCKED_X),
                locked.contains(LockedAxes::TRANSLATION_LOCKED_Y),
                locked.contains(LockedAxes::TRANSLATION_LOCKED_Z),
            ),
            locked_rotation: BVec3::new(
                locked.contains(LockedAxes::ROTATION_LOCKED_X),
                locked.contains(LockedAxes::ROTATION_LOCKED_Y),
                locked.contains(LockedAxes::ROTATION_LOCKED_Z),
            ),
        };
        match body {
            Some(mut body) => _ = body.set_if_neq(wanted),
            None => _ = commands.entity(entity).try_insert(wanted),
        }
    }
}

/// Lets rapier know what cloth did to its bodies. It takes their places over from the transforms.
fn write(mut bodies: Query<(&ClothPush, &mut Velocity)>) {
    for (push, mut velocity) in &mut bodies {
        if push.cloths > 0 {
            velocity.linear += push.velocity;
            velocity.angular += push.spin;
        }
    }
}
