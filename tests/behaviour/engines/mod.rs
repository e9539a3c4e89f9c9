//! Cloth and the bodies of physics engines push and pull each other. Every test runs with each of the engines.

mod colliders;
mod pull;
mod push;

use std::time::Duration;

use crate::common::*;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_cloth::*;

/// A form that both engines know.
#[derive(Clone, Copy, Debug)]
pub enum Form {
    Ball(f32),
    Cuboid(Vec3),
}

/// An engine under test.
pub trait Engine {
    /// An app with it, whose updates after the first are one tick of that length each.
    fn app_of(tick: Duration) -> App;
    /// A dynamic body that rubs on nothing, or without mass what does not move.
    fn spawn(app: &mut App, form: Form, mass: Option<f32>, place: Transform) -> Entity;
    fn velocity(app: &App, body: Entity) -> Vec3;
    fn set_velocity(app: &mut App, body: Entity, velocity: Vec3);
    fn set_gravity(app: &mut App, gravity: Vec3);
    /// Lets its motion fade, moving and turning, at that rate, 1/s.
    fn damp(app: &mut App, body: Entity, rate: f32);
    /// Lets it move along y only, and not turn.
    fn lock(app: &mut App, body: Entity);

    fn app() -> App {
        Self::app_of(TICK)
    }
}

fn headless_with(tick: Duration, engine: impl FnOnce(&mut App)) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, ClothPlugin::default()));
    engine(&mut app);
    app.insert_resource(Time::<Fixed>::from_duration(tick));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(tick));
    app.finish();
    app.cleanup();
    app.update();
    app
}

pub struct Avian;

impl Engine for Avian {
    fn app_of(tick: Duration) -> App {
        headless_with(tick, |app| {
            app.add_plugins((avian3d::PhysicsPlugins::default(), ClothAvianPlugin::default()));
        })
    }

    fn spawn(app: &mut App, form: Form, mass: Option<f32>, place: Transform) -> Entity {
        use avian3d::prelude::*;
        let collider = match form {
            Form::Ball(radius) => Collider::sphere(radius),
            Form::Cuboid(size) => Collider::cuboid(size.x, size.y, size.z),
        };
        let body = if mass.is_some() { RigidBody::Dynamic } else { RigidBody::Static };
        let density = ColliderDensity(mass.unwrap_or(1.0) / collider.mass(1.0));
        app.world_mut().spawn((body, collider, density, Friction::new(0.0), place)).id()
    }

    fn velocity(app: &App, body: Entity) -> Vec3 {
        get::<avian3d::prelude::LinearVelocity>(app, body).0
    }

    fn set_velocity(app: &mut App, body: Entity, velocity: Vec3) {
        app.world_mut().entity_mut(body).insert(avian3d::prelude::LinearVelocity(velocity));
    }

    fn set_gravity(app: &mut App, gravity: Vec3) {
        app.insert_resource(avian3d::prelude::Gravity(gravity));
        app.insert_resource(Shared(Gravity(gravity)));
    }

    fn damp(app: &mut App, body: Entity, rate: f32) {
        use avian3d::prelude::*;
        app.world_mut().entity_mut(body).insert((LinearDamping(rate), AngularDamping(rate)));
    }

    fn lock(app: &mut App, body: Entity) {
        use avian3d::prelude::*;
        let axes = LockedAxes::ROTATION_LOCKED.lock_translation_x().lock_translation_z();
        app.world_mut().entity_mut(body).insert(axes);
    }
}

pub struct Rapier;

impl Engine for Rapier {
    fn app_of(tick: Duration) -> App {
        use bevy_rapier3d::prelude::*;
        headless_with(tick, |app| {
            let rapier = RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule();
            app.add_plugins((rapier, ClothRapierPlugin::default()));
            app.insert_resource(TimestepMode::Fixed { dt: tick.as_secs_f32(), substeps: 1 });
        })
    }

    fn spawn(app: &mut App, form: Form, mass: Option<f32>, place: Transform) -> Entity {
        use bevy_rapier3d::prelude::*;
        let collider = match form {
            Form::Ball(radius) => Collider::ball(radius),
            Form::Cuboid(size) => Collider::cuboid(size.x / 2.0, size.y / 2.0, size.z / 2.0),
        };
        let body = if mass.is_some() { RigidBody::Dynamic } else { RigidBody::Fixed };
        let mass = ColliderMassProperties::Mass(mass.unwrap_or(1.0));
        app.world_mut().spawn((body, collider, mass, Friction::coefficient(0.0), Velocity::zero(), place)).id()
    }

    fn velocity(app: &App, body: Entity) -> Vec3 {
        get::<bevy_rapier3d::prelude::Velocity>(app, body).linear
    }

    fn set_velocity(app: &mut App, body: Entity, velocity: Vec3) {
        app.world_mut().entity_mut(body).insert(bevy_rapier3d::prelude::Velocity::linear(velocity));
    }

    fn set_gravity(app: &mut App, gravity: Vec3) {
        app.insert_resource(Shared(Gravity(gravity)));
        let mut all = app.world_mut().query::<&mut bevy_rapier3d::plugin::RapierConfiguration>();
        all.iter_mut(app.world_mut()).for_each(|mut all| all.gravity = gravity);
    }

    fn damp(app: &mut App, body: Entity, rate: f32) {
        let damping = bevy_rapier3d::prelude::Damping { linear_damping: rate, angular_damping: rate };
        app.world_mut().entity_mut(body).insert(damping);
    }

    fn lock(app: &mut App, body: Entity) {
        use bevy_rapier3d::prelude::*;
        let axes = LockedAxes::ROTATION_LOCKED | LockedAxes::TRANSLATION_LOCKED_X | LockedAxes::TRANSLATION_LOCKED_Z;
        app.world_mut().entity_mut(body).insert(axes);
    }
}

pub fn place(app: &App, entity: Entity) -> Vec3 {
    get::<Transform>(app, entity).translation
}

/// The momentum of a cloth, N·s.
pub fn momentum(app: &App, cloth: Entity) -> Vec3 {
    let turn = get::<ClothFrame>(app, cloth).pose.rotation;
    turn * cloth_solver::measure::linear_momentum(get::<Particles>(app, cloth)).as_vec3()
}

/// A cloth of so many cells a side that lies flat.
pub fn flat(size: Vec2, cells: [u32; 2], fabric: Fabric, at: Vec3) -> impl Bundle {
    let lies = Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    let cloth = Cloth::rectangle(size.x, size.y).with_cells(cells[0], cells[1]);
    (cloth, fabric, Transform::from_translation(at).with_rotation(lies))
}

/// Runs a test with each engine.
macro_rules! with_engines {
    ($($name:ident)*) => {
        $(
            mod $name {
                #[test]
                fn of_avian() {
                    super::$name::<super::Avian>();
                }

                #[test]
                fn of_rapier() {
                    super::$name::<super::Rapier>();
                }
            }
        )*
    };
}
use with_engines;
