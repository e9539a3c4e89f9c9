//! Contact among cloths: which of them step together in a tick, and how they keep off one another.
//!
//! Cloths with [`SelfContact`](crate::SelfContact) whose boxes meet, as far as they may move in the tick, are a group: they take the same
//! substeps, and fall asleep together.

use std::sync::Arc;

use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::ecs::query::QueryData;
use bevy::prelude::*;
use cloth_solver::cloth::Constraints;
use cloth_solver::contact::{Contacts, GroupContacts, SelfContacts};
use cloth_solver::{Particles, Pose, Topology, measure};

use crate::cloth::{ClothFrame, ClothTopology};
use crate::prepare::{StepPlan, relative};
use crate::sleep::{ClothAsleep, WakeCause, wake_up};
use crate::step::ClothTick;
use crate::substeps::{self, SubstepTimes};

/// The groups of this tick.
#[derive(Resource, Clone, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Groups(Vec<Group>);

#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct Group {
    /// In the order of their entities.
    #[cfg_attr(feature = "serialize", serde(with = "crate::save::entity::list"))]
    members: Vec<Entity>,
    #[cfg_attr(feature = "serialize", serde(skip))]
    topologies: Vec<Arc<Topology>>,
    /// Its frame in the world: that of its first cloth when it was made.
    frame: Pose,
    contacts: GroupContacts,
}

/// A cloth that may keep off others.
#[derive(QueryData)]
pub(crate) struct Near {
    entity: Entity,
    own: &'static SelfContacts,
    topology: &'static ClothTopology,
    frame: &'static ClothFrame,
    particles: &'static Particles,
    contacts: &'static Contacts,
    constraints: &'static Constraints,
    asleep: Option<&'static ClothAsleep>,
}

/// A box in the world, m.
#[derive(Clone, Copy, Debug)]
struct Reach {
    low: Vec3,
    high: Vec3,
}

impl Reach {
    fn meets(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }
}

impl NearItem<'_, '_> {
    /// Where it may be until the end of a tick of `dt` s: as far around its particles as the fastest of them goes, and what moves it.
    fn reach(&self, dt: f32) -> Reach {
        let pose = &self.frame.pose;
        let (low, high) = match self.asleep {
            Some(asleep) => asleep.bounds(),
            None => measure::bounds(self.topology, &self.particles.position),
        };
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let turned = Mat3::from_quat(pose.rotation);
        let half = turned.x_axis.abs() * half.x + turned.y_axis.abs() * half.y + turned.z_axis.abs() * half.z;
        let around = Vec3::splat(if self.asleep.is_some() { 0.0 } else { self.way(dt) } + self.contacts.edge);
        let middle = pose.point(middle);
        Reach { low: middle - half - around, high: middle + half + around }
    }

    /// How far any of it may go in the tick, m.
    fn way(&self, dt: f32) -> f32 {
        let fastest = self.topology.particles().map(|slot| self.particles.velocity.get(slot as usize).length_squared());
        let speed = fastest.fold(0.0, f32::max).sqrt() + self.particles.acceleration.length() * dt;
        let moved = |from: &Pose, to: &Pose| {
            let turn = from.rotation.angle_between(to.rotation);
            from.position.distance(to.position) + turn * self.particles.position.get(0).distance(from.position)
        };
        let pins = self.constraints.pins().frames.iter().map(|motion| moved(&motion.from, &motion.to));
        let solids = self.contacts.colliders.iter().map(|solid| {
            let Some(radius) = Some(solid.shape.bounding_radius()).filter(|radius| radius.is_finite()) else {
                return moved(&solid.motion.from, &solid.motion.to);
            };
            let turn = solid.motion.from.rotation.angle_between(solid.motion.to.rotation);
            solid.motion.from.position.distance(solid.motion.to.position) + turn * radius
        });
        let hands = self.constraints.grabs.iter().map(|grab| grab.from.distance(grab.to));
        speed * dt + pins.chain(solids).chain(hands).fold(0.0, f32::max)
    }
}

/// Those of `cloths` that keep off others, with where they may be, in the order of their entities.
fn in_reach<'w, 's>(cloths: &'w Query<'w, 's, Near>, dt: f32) -> Vec<(NearItem<'w, 's>, Reach)> {
    let mut near: Vec<_> = cloths.iter().filter(|cloth| cloth.own.meets_others()).collect();
    if near.len() < 2 || near.iter().all(|cloth| cloth.asleep.is_some()) {
        return Vec::new();
    }
    near.sort_unstable_by_key(|cloth| cloth.entity);
    near.into_iter().map(|cloth| (cloth.reach(dt), cloth)).map(|(reach, cloth)| (cloth, reach)).collect()
}

/// Wakes the cloths that sleep near one that is awake.
pub(crate) fn wake_neighbors(cloths: Query<Near>, tick: Res<ClothTick>, mut commands: Commands) {
    let near = in_reach(&cloths, tick.dt);
    for (cloth, reach) in near.iter().filter(|(cloth, _)| cloth.asleep.is_some()) {
        if near.iter().any(|(other, other_reach)| other.asleep.is_none() && reach.meets(other_reach)) {
            wake_up(&mut commands, cloth.entity, WakeCause::Cloth);
        }
    }
}

/// Finds which cloths step together in this tick.
pub(crate) fn form(
    cloths: Query<Near>,
    mut plans: Query<&mut StepPlan>,
    mut groups: ResMut<Groups>,
    tick: Res<ClothTick>,
) {
    let mut near = in_reach(&cloths, tick.dt);
    near.retain(|(cloth, _)| cloth.asleep.is_none() && plans.get(cloth.entity).is_ok_and(|plan| plan.substeps > 0));
    for group in &groups.0 {
        for member in &group.members {
            if let Ok(mut plan) = plans.get_mut(*member) {
                (plan.group, plan.at_least) = (None, 0.0);
            }
        }
    }
    let mut before = std::mem::take(&mut groups.0);
    for members in components(&near) {
        let entities: Vec<Entity> = members.iter().map(|index| near[*index].0.entity).collect();
        let cloths = || members.iter().map(|index| &near[*index].0);
        let known = before.iter().position(|group| {
            let mut topologies = cloths().zip(&group.topologies);
            group.members == entities
                && topologies.all(|(cloth, topology)| Arc::ptr_eq(&cloth.topology.0, topology))
                && group.contacts.is_of(cloths().map(|cloth| cloth.own))
        });
        let known = known.map(|index| before.swap_remove(index));
        let known = known.filter(|group| group.contacts.is_near(cloths().map(|cloth| group.seen(cloth.frame))));
        let mut group = known.unwrap_or_else(|| Group {
            members: entities,
            topologies: cloths().map(|cloth| cloth.topology.0.clone()).collect(),
            frame: near[members[0]].0.frame.pose,
            contacts: GroupContacts::new(cloths().map(|cloth| (&*cloth.topology.0, cloth.own))),
        });
        let frame = group.frame;
        group
            .contacts
            .begin_tick(cloths().map(|cloth| (relative(&frame, &cloth.frame.pose), cloth.particles, cloth.contacts)));
        let at_least = group.contacts.least_substeps(cloths().map(|cloth| cloth.particles), tick.dt);
        for member in &group.members {
            if let Ok(mut plan) = plans.get_mut(*member) {
                (plan.group, plan.at_least) = (Some(groups.0.len()), at_least);
            }
        }
        groups.0.push(group);
    }
}

impl Groups {
    /// The same with the topologies that their cloths have now.
    pub fn linked(mut self, world: &World) -> Self {
        for group in &mut self.0 {
            let topology = |member: &Entity| Some(world.get::<ClothTopology>(*member)?.0.clone());
            group.topologies = group.members.iter().filter_map(topology).collect();
        }
        self.0.retain(|group| group.topologies.len() == group.members.len());
        self
    }

    /// The contact of group number `group`, and which of its cloths `entity` is.
    pub fn contacts_of(&self, group: usize, entity: Entity) -> Option<(&GroupContacts, usize)> {
        let group = self.0.get(group)?;
        let index = group.members.iter().position(|member| *member == entity)?;
        Some((&group.contacts, index))
    }
}

impl MapEntities for Groups {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        let members = self.0.iter_mut().flat_map(|group| &mut group.members);
        members.for_each(|member| *member = mapper.get_mapped(*member));
        // Where their order is another one, contact has to number them anew.
        self.0.retain(|group| group.members.is_sorted());
    }
}

impl Group {
    /// A cloth's frame as seen from that of the group.
    fn seen(&self, frame: &ClothFrame) -> Pose {
        relative(&self.frame, &frame.pose)
    }

    fn collide(&mut self, cloths: &mut Members) {
        let Self { members, contacts, .. } = self;
        let sub = members.first().and_then(|first| cloths.get(*first).ok()?.2.substep);
        let Some(sub) = sub else { return };
        for (index, member) in members.iter().enumerate() {
            if let Ok((particles, ..)) = cloths.get(*member) {
                contacts.take(index, particles);
            }
        }
        contacts.collide(&sub);
        for (index, member) in members.iter().enumerate() {
            let Ok((mut particles, mut own, _)) = cloths.get_mut(*member) else { continue };
            contacts.give(index, &mut particles);
            if sub.is_last() {
                contacts.report(index, &mut own);
            }
        }
    }
}

/// The sets of two and more cloths whose boxes are connected, each in ascending order.
fn components(near: &[(NearItem, Reach)]) -> Vec<Vec<usize>> {
    let mut first: Vec<usize> = (0..near.len()).collect();
    for i in 0..near.len() {
        for j in i + 1..near.len() {
            if first[i] != first[j] && near[i].1.meets(&near[j].1) {
                let (to, from) = (first[i].min(first[j]), first[i].max(first[j]));
                first.iter_mut().filter(|first| **first == from).for_each(|first| *first = to);
            }
        }
    }
    let of = |root: usize| (0..near.len()).filter(|index| first[*index] == root).collect::<Vec<_>>();
    (0..near.len()).filter(|index| first[*index] == *index).map(of).filter(|all| all.len() > 1).collect()
}

/// Takes the substep of each group unless it was too long for one of its cloths.
pub(crate) fn accept(
    mut cloths: Query<(&mut Particles, &mut Constraints, &mut StepPlan), Without<ClothAsleep>>,
    groups: Res<Groups>,
) {
    for group in &groups.0 {
        let refused = group.members.iter().any(|member| cloths.get(*member).is_ok_and(|cloth| cloth.2.is_refused()));
        for member in &group.members {
            let Ok((mut particles, mut constraints, mut plan)) = cloths.get_mut(*member) else { continue };
            if refused {
                plan.repeat();
            } else if let Some(sub) = plan.substep {
                cloth_solver::method::accept(&mut particles, &mut constraints, &sub);
            }
        }
    }
}

type Members<'w, 's> =
    Query<'w, 's, (&'static mut Particles, &'static mut SelfContacts, &'static StepPlan), Without<ClothAsleep>>;

/// Keeps the cloths of each group off one another and off themselves, after they were kept off colliders.
pub(crate) fn collide(mut cloths: Members, mut groups: ResMut<Groups>, watch: Option<ResMut<SubstepTimes>>) {
    substeps::measured(watch, substeps::COLLIDE, || groups.0.iter_mut().for_each(|group| group.collide(&mut cloths)));
}
