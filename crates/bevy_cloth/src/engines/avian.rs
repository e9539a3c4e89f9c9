//! Colliders and bodies of avian.

use avian3d::parry;
use avian3d::prelude::*;
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;

use super::shapes::{self, translate_shapes};
use super::{Engine, NoCloth, NoCounterpart, Part, WALL_THICKNESS, Walls, translate};
use crate::bodies::{ClothBody, ClothBodySystems, ClothPush};
use crate::schedule::{ClothSchedule, ClothSystems};

translate_shapes!();

/// Cloth and the bodies of [avian](avian3d) push each other: see [`engines`](crate::engines). Add avian's `PhysicsPlugins` and
/// [`ClothPlugin`](crate::ClothPlugin), too, both in the same schedule.
#[derive(Clone, Copy, Debug)]
pub struct ClothAvianPlugin {
    schedule: InternedScheduleLabel,
    /// Thickness of the walls that triangle meshes and height fields are for cloth, m; 0.001 to 10, default 0.01.
    pub wall_thickness: f32,
}

impl ClothAvianPlugin {
    /// With avian and cloth in `schedule`.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self { schedule: schedule.intern(), wall_thickness: WALL_THICKNESS }
    }
}

impl Default for ClothAvianPlugin {
    /// In [`FixedPostUpdate`], where both are by default.
    fn default() -> Self {
        Self::new(FixedPostUpdate)
    }
}

struct Avian;

impl Engine for Avian {
    type Collider = Collider;
    type Sensor = Sensor;

    fn parts(collider: &Collider, wall: f32) -> Result<Vec<Part>, NoCounterpart> {
        shapes::unscaled(parts(&**collider.shape_scaled(), wall)?, collider.scale())
    }
}

impl Plugin for ClothAvianPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<NoCloth>()
            .insert_resource(Walls::<Avian>(self.wall_thickness, std::marker::PhantomData))
            .configure_sets(self.schedule, ClothSystems::Build.after(PhysicsSystems::Last))
            .add_systems(
                self.schedule,
                (translate::<Avian>, read).after(PhysicsSystems::Last).before(ClothSystems::Build),
            )
            .add_systems(ClothSchedule, write.after(ClothBodySystems::Push).in_set(ClothSystems::Writeback));
    }
}

type Source<'a> = (
    Entity,
    &'a RigidBody,
    &'a ComputedMass,
    &'a ComputedAngularInertia,
    &'a ComputedCenterOfMass,
    Option<&'a LockedAxes>,
    Option<&'a GravityScale>,
    Has<RigidBodyDisabled>,
    Option<&'a mut ClothBody>,
);

/// Gives every dynamic body a [`ClothBody`].
fn read(mut bodies: Query<Source>, gravity: Res<Gravity>, mut commands: Commands) {
    for (entity, kind, mass, inertia, center, locked, scale, is_disabled, body) in &mut bodies {
        if !kind.is_dynamic() || is_disabled || mass.inverse() <= 0.0 {
            if body.is_some() {
                commands.entity(entity).try_remove::<(ClothBody, ClothPush)>();
            }
            continue;
        }
        let locked = locked.copied().unwrap_or_default();
        let wanted = ClothBody {
            mass: mass.value(),
            center_of_mass: center.0,
            inverse_inertia: Mat3::from(inertia.inverse()),
            acceleration: gravity.0 * scale.map_or(1.0, |scale| scale.0),
            locked_translation: BVec3::new(
                locked.is_translation_x_locked(),
                locked.is_translation_y_locked(),
                locked.is_translation_z_locked(),
            ),
            locked_rotation: BVec3::new(
                locked.is_rotation_x_locked(),
                locked.is_rotation_y_locked(),
                locked.is_rotation_z_locked(),
            ),
        };
        match body {
            Some(mut body) => _ = body.set_if_neq(wanted),
            None => _ = commands.entity(entity).try_insert(wanted),
        }
    }
}

type Pushed<'a> = (
    &'a ClothPush,
    &'a ClothBody,
    &'a mut Position,
    &'a mut Rotation,
    (&'a mut LinearVelocity, &'a mut AngularVelocity),
    Option<&'a mut SleepTimer>,
);

/// Lets avian know what cloth did to its bodies.
fn write(mut bodies: Query<Pushed>) {
    for (push, body, mut position, mut rotation, (mut velocity, mut spin), timer) in &mut bodies {
        if push.cloths == 0 {
            continue;
        }
        let center = position.0 + rotation.0 * body.center_of_mass;
        position.0 = center + push.shift + push.turn * (position.0 - center);
        rotation.0 = (push.turn * rotation.0).normalize();
        velocity.0 += push.velocity;
        spin.0 += push.spin;
        // Asleep it would not feel its weight, while cloth still pushes it up.
        if let Some(mut timer) = timer {
            timer.0 = 0.0;
        }
    }
}
