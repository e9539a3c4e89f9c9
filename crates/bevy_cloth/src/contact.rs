//! What colliders are told of the cloth that touches them: events, and the force on them.

use std::time::Duration;

use bevy::ecs::entity::{EntityHashMap, EntityMapper, MapEntities};
use bevy::ecs::query::QueryData;
use bevy::prelude::*;
use cloth_solver::contact::{Contacts, Touch};

use crate::clock::ClothClock;
use crate::cloth::ClothFrame;
use crate::events::{ContactBegan, ContactEnded};
use crate::prepare::{Colliders, StepPlan};
use crate::report::report;
use crate::schedule::{ClothSchedule, ClothSystems};
use crate::sleep::{self, ClothAsleep};
use crate::step::ClothTick;

/// Put this on a [`ClothCollider`](crate::ClothCollider) to be told of each cloth that touches it: by [`ContactBegan`] and
/// [`ContactEnded`]. Without it nothing is watched.
///
/// A cloth that leaves it for less than a tenth of a second has not left it: what flutters against it does not tell so in every
/// tick.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct ContactEvents;

/// Put this on a [`ClothCollider`](crate::ClothCollider) to be told with what force all cloth together pushes it, for whoever wants
/// to move a body by it. Without it nothing is summed. Writing to it has no effect.
///
/// A [`ClothBody`](crate::ClothBody) needs none of this. It is the mean over the last tick, friction included. A cloth that sleeps on the collider goes on weighing on it.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_cloth::{ClothCollider, ClothForce};
/// #[derive(Component)]
/// struct Body { mass: f32, velocity: Vec3 }
///
/// fn push(mut bodies: Query<(&ClothForce, &mut Body)>, time: Res<Time<Fixed>>) {
///     for (cloth, mut body) in &mut bodies {
///         let mass = body.mass;
///         body.velocity += cloth.force / mass * time.delta_secs();
///     }
/// }
/// # bevy::ecs::system::assert_is_system(push);
/// # let body = (ClothCollider::Sphere { radius: 0.1 }, ClothForce::default());
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct ClothForce {
    /// Force, in world axes, N.
    pub force: Vec3,
    /// Torque about the origin of the entity, in world axes, N·m.
    pub torque: Vec3,
    /// How many particles touch it.
    pub touching: u32,
}

/// For how long a cloth must not have touched a collider to have left it.
const RELEASE: Duration = Duration::from_millis(100);

/// The colliders that want to know and that a cloth touches, or has just left.
#[derive(Component, Clone, Debug, Default)]
#[component(clone_behavior = Ignore)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Touching(Vec<Pair>);

#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct Pair {
    #[cfg_attr(feature = "serialize", serde(with = "crate::save::entity"))]
    collider: Entity,
    /// In the last tick.
    now: ClothForce,
    /// The strongest impulse in one tick, N·s.
    strongest: f32,
    /// When the tick began in which they first touched, by the clock of all cloths.
    began: Duration,
    /// When the last tick ended in which they touched; of one that sleeps, when it fell asleep.
    last: Duration,
    /// It was told that it began.
    told: bool,
}

/// A cloth that may touch something.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Toucher {
    entity: Entity,
    contacts: &'static Contacts,
    frame: &'static ClothFrame,
    plan: &'static StepPlan,
    touching: Option<&'static mut Touching>,
}

type Wanted = Or<(With<ContactEvents>, With<ClothForce>)>;

/// Sees what each cloth touched in this tick, of what wants to know.
fn gather(
    mut cloths: Query<Toucher, Without<ClothAsleep>>,
    wanted: Query<Has<ContactEvents>, Wanted>,
    colliders: Res<Colliders>,
    (tick, time): (Res<ClothTick>, Res<Time<ClothClock>>),
    mut commands: Commands,
) {
    if tick.still {
        return;
    }
    for mut cloth in &mut cloths {
        let is_watched = cloth.touching.is_some() || !wanted.is_empty();
        if is_watched && cloth.plan.substeps > 0 {
            cloth.gather(&wanted, &colliders, &time, &mut commands);
        }
    }
}

impl ToucherItem<'_, '_> {
    fn gather(
        &mut self,
        wanted: &Query<Has<ContactEvents>, Wanted>,
        colliders: &Colliders,
        time: &Time<ClothClock>,
        commands: &mut Commands,
    ) {
        let (now, dt) = (time.elapsed(), time.delta());
        let before = now.saturating_sub(dt);
        let mut new = Touching::default();
        let is_new = self.touching.is_none();
        let pairs = self.touching.as_deref_mut().map_or(&mut new.0, |touching| &mut touching.0);
        for pair in pairs.iter_mut() {
            // A cloth that slept touched it all the time.
            pair.last = pair.last_touch(before);
            pair.now = ClothForce::default();
        }
        for (collider, touch) in colliders.entities().zip(&self.contacts.touches) {
            if touch.touching == 0 {
                continue;
            }
            let Ok(tells) = wanted.get(collider) else { continue };
            let known = pairs.iter().position(|pair| pair.collider == collider);
            let index = known.unwrap_or_else(|| {
                pairs.push(Pair::new(collider, before));
                pairs.len() - 1
            });
            let pair = &mut pairs[index];
            pair.touch(touch, self.frame, dt.as_secs_f32());
            pair.last = now;
            if tells && !pair.told {
                pair.told = true;
                let (speed, impulse) = (touch.speed, touch.impulse.length());
                report(commands, ContactBegan { entity: collider, cloth: self.entity, speed, impulse });
            }
        }
        pairs.retain(|pair| {
            let goes_on = now.saturating_sub(pair.last) < RELEASE && wanted.contains(pair.collider);
            if !goes_on {
                pair.end(self.entity, now, commands);
            }
            goes_on
        });
        if is_new && !new.0.is_empty() {
            commands.entity(self.entity).try_insert(new);
        }
    }
}

impl MapEntities for Touching {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        self.0.iter_mut().for_each(|pair| pair.collider = mapper.get_mapped(pair.collider));
    }
}

impl Pair {
    fn new(collider: Entity, began: Duration) -> Self {
        Self { collider, now: ClothForce::default(), strongest: 0.0, began, last: began, told: false }
    }

    fn touch(&mut self, touch: &Touch, frame: &ClothFrame, dt: f32) {
        let to_world = |impulse: Vec3| frame.pose.rotation * impulse / dt;
        let (force, torque) = (to_world(touch.impulse), to_world(touch.moment));
        self.now = ClothForce { force, torque, touching: touch.touching };
        self.strongest = self.strongest.max(touch.impulse.length());
    }

    /// When they last touched, `until` being the end of the last tick that is over. What sleeps touches on.
    fn last_touch(&self, until: Duration) -> Duration {
        if self.now.touching > 0 { until } else { self.last }
    }

    /// Tells that it is over, if it was told that it began.
    fn end(&self, cloth: Entity, now: Duration, commands: &mut Commands) {
        if self.told {
            let Self { collider: entity, strongest: impulse, .. } = *self;
            let duration = self.last_touch(now).saturating_sub(self.began).as_secs_f32();
            report(commands, ContactEnded { entity, cloth, impulse, duration });
        }
    }
}

/// Sums up the force of all cloth on each collider that asks for it, that of sleeping cloth included.
fn sum_forces(
    cloths: Query<&Touching>,
    mut colliders: Query<(Entity, &mut ClothForce)>,
    mut sums: Local<EntityHashMap<ClothForce>>,
) {
    if colliders.is_empty() {
        return;
    }
    sums.clear();
    for pair in cloths.iter().flat_map(|touching| &touching.0) {
        let sum = sums.entry(pair.collider).or_default();
        sum.force += pair.now.force;
        sum.torque += pair.now.torque;
        sum.touching += pair.now.touching;
    }
    for (entity, mut force) in &mut colliders {
        force.set_if_neq(sums.get(&entity).copied().unwrap_or_default());
    }
}

/// Ends the contacts of a cloth that is no more.
fn on_removed(
    removed: On<Remove, Touching>,
    cloths: Query<&Touching>,
    time: Res<Time<ClothClock>>,
    mut commands: Commands,
) {
    if let Ok(touching) = cloths.get(removed.entity) {
        let mut end = |pair: &Pair| pair.end(removed.entity, time.elapsed(), &mut commands);
        touching.0.iter().for_each(&mut end);
    }
}

/// Adds the systems of this file.
pub(crate) fn plugin(app: &mut App) {
    app.register_type::<ContactEvents>()
        .register_type::<ClothForce>()
        .add_message::<ContactBegan>()
        .add_message::<ContactEnded>()
        .add_systems(
            ClothSchedule,
            (gather, sum_forces).chain().before(sleep::fall_asleep).in_set(ClothSystems::Writeback),
        )
        .add_observer(on_removed);
}
