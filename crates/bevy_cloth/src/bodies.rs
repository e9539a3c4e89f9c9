//! Rigid bodies that cloth pushes and pulls: what a physics engine has to say of them, and what it is told.

use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;
use cloth_solver::body::{Body, Push};
use cloth_solver::cloth::Constraints;
use cloth_solver::contact::Contacts;
use cloth_solver::{Motion, Particles, Pose};

use crate::cloth::ClothFrame;
use crate::prepare::{Anchors, ColliderState, Colliders, Follow, Placement, Placements, StepPlan, relative};
use crate::schedule::{ClothSchedule, ClothSystems};
use crate::sleep::{self, ClothAsleep};
use crate::step::ClothTick;

/// A rigid body that cloth pushes and pulls. Put it on the entity that a physics engine of your own moves; the plugins for avian and
/// rapier (features `avian` and `rapier`) do so for theirs.
///
/// Every [`ClothCollider`](crate::ClothCollider) on the entity and below it is part of the body, and what is pinned to any of them
/// ([`PinTarget::Entity`](crate::PinTarget::Entity)) pulls it. In each tick the body goes from where its [`Transform`] was to where that
/// is now, but for what cloth does to it on the way: the body meets the cloth in the cloth's own substeps, with its inertia. After the
/// tick [`ClothPush`] says what came of it, and the transform is already moved by [`ClothPush::shift`] and [`ClothPush::turn`]: the engine
/// has to take that over, and to add the velocities that the body gained.
///
/// Wrong values (mass not above 0, anything not finite) make it a body that nothing moves.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
#[require(Transform, ClothPush, BodyState)]
pub struct ClothBody {
    /// Mass, kg, above 0. Default 1.
    pub mass: f32,
    /// Centre of mass in the frame of the entity, m; the scale of the transform is not applied. Default its origin.
    pub center_of_mass: Vec3,
    /// Inverse of the inertia about the centre of mass, in the axes of the entity, 1/(kg m²). 0 is a body that does not turn. Default that
    /// of a ball of 1 kg and half a metre.
    pub inverse_inertia: Mat3,
    /// The acceleration that its engine gives it evenly over each step, gravity and the like, in world axes, m/s². With it the body is at
    /// the right speed where it meets cloth within a step. Default none.
    pub acceleration: Vec3,
    /// Along which axes of the world it does not move. Default none.
    pub locked_translation: BVec3,
    /// About which axes of the world it does not turn. Default none.
    pub locked_rotation: BVec3,
}

impl Default for ClothBody {
    fn default() -> Self {
        Self {
            mass: 1.0,
            center_of_mass: Vec3::ZERO,
            inverse_inertia: Mat3::from_diagonal(Vec3::splat(10.0)),
            acceleration: Vec3::ZERO,
            locked_translation: BVec3::FALSE,
            locked_rotation: BVec3::FALSE,
        }
    }
}

/// What all cloth together did to a [`ClothBody`] in the last tick, in world axes. Writing to it has no effect.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct ClothPush {
    /// Velocity of the centre of mass that the body gained, m/s.
    pub velocity: Vec3,
    /// Angular velocity that it gained, rad/s.
    pub spin: Vec3,
    /// How far the centre of mass is from where it would be without cloth, m.
    pub shift: Vec3,
    /// How it is turned against how it would be without cloth.
    pub turn: Quat,
    /// The impulse on it, N·s.
    pub impulse: Vec3,
    /// The angular impulse on it about its centre of mass, N·m·s.
    pub moment: Vec3,
    /// How many cloths touched or pulled it.
    pub cloths: u32,
}

/// How a body moves without cloth.
#[derive(Component, Clone, Copy, Debug, Default)]
#[component(clone_behavior = Ignore)]
pub(crate) struct BodyState {
    follow: Option<Follow>,
}

impl BodyState {
    /// Sees it before the first fixed step in a frame.
    pub fn look(&mut self, target: Pose, ticks: f32) {
        if let Some(follow) = &mut self.follow {
            follow.look(target, ticks);
        }
    }
}

/// A body in this tick, in the world.
#[derive(Clone, Copy, Debug)]
struct PlacedBody {
    entity: Entity,
    body: ClothBody,
    motion: Motion,
    /// Among how many cloths it is shared.
    shares: f32,
}

/// All bodies in this tick, in the order of their entities.
#[derive(Resource, Clone, Debug, Default)]
pub(crate) struct Bodies(Vec<PlacedBody>);

impl Bodies {
    fn index(&self, entity: Entity) -> Option<u32> {
        self.0.binary_search_by_key(&entity, |placed| placed.entity).ok().map(|index| index as u32)
    }
}

/// Finds where every body is in this tick.
pub(crate) fn place(
    mut bodies: Query<(Entity, &ClothBody, &ClothPush, &mut BodyState)>,
    placements: Placements,
    tick: Res<ClothTick>,
    mut placed: ResMut<Bodies>,
) {
    placed.0.clear();
    for (entity, body, push, mut state) in &mut bodies {
        let Some(now) = placements.get(entity).filter(Placement::is_finite) else { continue };
        let motion = state.follow.get_or_insert(Follow::new(now.pose)).sweep(now.pose, &tick);
        placed.0.push(PlacedBody { entity, body: *body, motion, shares: push.cloths.max(1) as f32 });
    }
    placed.0.sort_unstable_by_key(|body| body.entity);
}

/// The body that an entity is part of: its own or the nearest above it.
fn body_of(entity: Entity, bodies: &Bodies, parents: &Query<&ChildOf>) -> Option<u32> {
    std::iter::once(entity).chain(parents.iter_ancestors(entity)).find_map(|entity| bodies.index(entity))
}

/// Gives each cloth the bodies as seen from its own frame.
pub(crate) fn advance(
    mut cloths: Query<
        (&mut Constraints, &mut Contacts, &Particles, &Anchors, &ClothFrame, &StepPlan),
        Without<ClothAsleep>,
    >,
    placed: Res<Bodies>,
    colliders: Res<Colliders>,
    parents: Query<&ChildOf>,
    tick: Res<ClothTick>,
) {
    for (mut constraints, mut contacts, particles, anchors, frame, plan) in &mut cloths {
        if plan.substeps == 0 || (placed.0.is_empty() && constraints.bodies().is_empty()) {
            continue;
        }
        // What is carried along, or dragged while time stands, pushes nothing.
        if tick.still || frame.carried {
            constraints.set_bodies(particles, [], []);
            continue;
        }
        let bodies = placed.0.iter().map(|body| body.seen_from(frame, tick.dt));
        let frames = anchors.entities().map(|entity| body_of(entity?, &placed, &parents));
        constraints.set_bodies(particles, bodies, frames);
        contacts.bodies.clear();
        contacts.bodies.extend(colliders.entities().map(|collider| body_of(collider, &placed, &parents)));
    }
}

impl PlacedBody {
    fn seen_from(&self, frame: &ClothFrame, dt: f32) -> Body {
        let Self { body, motion, shares, .. } = self;
        let [from, to] = [motion.from, motion.to].map(|pose| relative(&frame.pose, &pose));
        let center = [from, to].map(|pose| pose.point(body.center_of_mass));
        let is_right = body.mass > 0.0
            && body.mass.is_finite()
            && body.center_of_mass.is_finite()
            && body.inverse_inertia.is_finite();
        if !is_right {
            return Body::new(Mat3::ZERO, Mat3::ZERO, [from.position, to.position]);
        }
        let turn = Mat3::from_quat(frame.pose.rotation).transpose();
        let own = Mat3::from_quat(motion.from.rotation);
        let free = |locked: BVec3| Mat3::from_diagonal(Vec3::select(locked, Vec3::ZERO, Vec3::ONE));
        let (moves, turns) = (free(body.locked_translation), free(body.locked_rotation));
        let inverse_mass = turn * moves * turn.transpose() * (shares / body.mass);
        let inverse_inertia = turns * own * body.inverse_inertia * own.transpose() * turns;
        let bend = if body.acceleration.is_finite() { turn * body.acceleration * (dt * dt) } else { Vec3::ZERO };
        let inverse_inertia = turn * inverse_inertia * turn.transpose() * *shares;
        let mut seen = Body::new(inverse_mass, inverse_inertia, center);
        seen.bend = bend;
        seen
    }
}

/// Adds up what the cloths did to each body.
pub(crate) fn collect(
    cloths: Query<(&Constraints, &ClothFrame, &StepPlan), Without<ClothAsleep>>,
    mut pushes: Query<&mut ClothPush>,
    placed: Res<Bodies>,
    mut sums: Local<EntityHashMap<ClothPush>>,
) {
    sums.clear();
    for (constraints, frame, _) in cloths.iter().filter(|(.., plan)| plan.substeps > 0) {
        for (placed, body) in placed.0.iter().zip(constraints.bodies()) {
            if body.push.touched {
                sums.entry(placed.entity).or_default().add(&body.push, frame, placed.shares);
            }
        }
    }
    for placed in &placed.0 {
        if let Ok(mut push) = pushes.get_mut(placed.entity) {
            push.set_if_neq(sums.get(&placed.entity).copied().unwrap_or_default());
        }
    }
}

impl ClothPush {
    fn add(&mut self, push: &Push, frame: &ClothFrame, shares: f32) {
        let to_world = |v: Vec3| frame.pose.rotation * v;
        self.velocity += to_world(push.velocity) / shares;
        self.spin += to_world(push.spin) / shares;
        self.shift += to_world(push.shift) / shares;
        let turn = to_world(push.turn.to_scaled_axis()) / shares;
        self.turn = (Quat::from_scaled_axis(turn) * self.turn).normalize();
        self.impulse += to_world(push.impulse);
        self.moment += to_world(push.moment);
        self.cloths += 1;
    }

    /// Where something fixed to the body is that would be at `pose` with the centre of mass at `center`.
    fn carry(&self, pose: Pose, center: Vec3) -> Pose {
        Pose::new(center + self.shift + self.turn * (pose.position - center), (self.turn * pose.rotation).normalize())
    }
}

/// Moves the bodies that cloth pushed off their way.
pub(crate) fn move_bodies(
    pushed: Query<(Entity, &ClothBody, &ClothPush)>,
    mut places: ParamSet<(Placements, Query<&mut Transform>)>,
    parents: Query<&ChildOf>,
    mut moved: Local<Vec<(Entity, Transform)>>,
) {
    moved.clear();
    let placements = places.p0();
    for (entity, body, push) in pushed.iter().filter(|(_, _, push)| push.cloths > 0) {
        let Some(Placement { pose, scale }) = placements.get(entity) else { continue };
        let to = push.carry(pose, pose.point(body.center_of_mass));
        let wanted = Transform { translation: to.position, rotation: to.rotation, scale };
        let parent = parents.get(entity).ok().and_then(|parent| placements.affine(parent.parent()));
        let local = parent.map_or(wanted, |parent| GlobalTransform::from(wanted).reparented_to(&parent));
        moved.push((entity, local));
    }
    let mut transforms = places.p1();
    for (entity, Transform { translation, rotation, .. }) in moved.drain(..) {
        if let Ok(mut transform) = transforms.get_mut(entity) {
            (transform.translation, transform.rotation) = (translation, rotation);
        }
    }
}

/// Lets everything fixed to bodies that cloth pushed off their way begin the next tick where it is now.
pub(crate) fn follow_bodies(
    mut bodies: Query<(Entity, &ClothBody, &ClothPush, &mut BodyState)>,
    mut colliders: Query<(Entity, &mut ColliderState)>,
    mut cloths: Query<&mut Anchors>,
    placements: Placements,
    placed: Res<Bodies>,
    parents: Query<&ChildOf>,
) {
    if bodies.iter().all(|(.., push, _)| push.cloths == 0) {
        return;
    }
    let pushes: EntityHashMap<(ClothPush, Vec3)> = (placed.0.iter())
        .filter_map(|placed| {
            let (_, body, push, _) = bodies.get(placed.entity).ok()?;
            (push.cloths > 0).then(|| (placed.entity, (*push, placed.motion.to.point(body.center_of_mass))))
        })
        .collect();
    let shift = |entity: Entity, follow: &mut Follow| {
        let body = std::iter::once(entity).chain(parents.iter_ancestors(entity)).find(|e| placed.index(*e).is_some());
        let Some((push, center)) = body.and_then(|body| pushes.get(&body)) else { return };
        let Some(now) = placements.get(entity).filter(Placement::is_finite) else { return };
        follow.shift(now.pose, |pose| push.carry(pose, *center));
    };
    for (entity, .., mut state) in &mut bodies {
        if let Some(follow) = &mut state.follow {
            shift(entity, follow);
        }
    }
    for (entity, mut state) in &mut colliders {
        if let Some(follow) = &mut state.follow {
            shift(entity, follow);
        }
    }
    for mut anchors in &mut cloths {
        if anchors.follow_entities() {
            anchors.shift(shift);
        }
    }
}

/// Adds the systems of this file.
pub(crate) fn plugin(app: &mut App) {
    app.register_type::<ClothBody>().register_type::<ClothPush>().init_resource::<Bodies>().add_systems(
        ClothSchedule,
        (collect, move_bodies, follow_bodies)
            .chain()
            .in_set(ClothBodySystems::Push)
            .before(sleep::fall_asleep)
            .in_set(ClothSystems::Writeback),
    );
}

/// Where bodies learn what cloth did to them, in [`ClothSystems::Writeback`] of [`ClothSchedule`]. What takes it over to an engine goes
/// after it.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClothBodySystems {
    /// Writes [`ClothPush`] and moves the transforms of bodies.
    Push,
}
