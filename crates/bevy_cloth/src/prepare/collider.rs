//! Colliders: from authored shapes to the solver's, and where each stands in this tick.

use std::cmp::Ordering;

use bevy::ecs::query::QueryData;
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use cloth_solver::contact::{Collider, Contacts, Shape};
use cloth_solver::{ClothError, Fabric, Motion, Pose};

use super::DrawnMesh;
use super::authored::user_mesh;
use super::build::not_finite;
use super::collider_shape::{SCALE_TOLERANCE, shape};
use super::placement::{Placement, Placements};
use super::{Follow, StepPlan, relative};
use crate::cloth::ClothFrame;
use crate::collider::{ClothCollider, ColliderFriction};
use crate::events::ColliderRejected;
use crate::report::report;
use crate::sleep::{ClothAsleep, Disturbances};
use crate::step::ClothTick;
use crate::teleport::{Teleport, TeleportPolicy};

/// From where on the move of a collider is a jump. However fast it turns, that is motion.
const JUMP: Teleport = Teleport { distance: 0.75, angle: f32::INFINITY, policy: TeleportPolicy::CarryAlong };

/// What became of a [`ClothCollider`].
#[derive(Component, Clone, Debug, Default)]
#[component(clone_behavior = Ignore)]
pub(crate) struct ColliderState {
    seen: Option<(ClothCollider, Vec3)>,
    friction: Option<ColliderFriction>,
    shape: Option<Shape>,
    /// The mesh that it is made from.
    mesh: Option<AssetId<Mesh>>,
    /// That mesh is not there yet.
    waits_for_mesh: bool,
    /// Where it stood at the last tick, and where it is on its way to, once it was seen.
    pub follow: Option<Follow>,
    /// Its transform was not finite when last looked at.
    lost: bool,
    /// It is another one than in the last tick.
    pub changed: bool,
}

/// The mesh of an entity, past the one that a cloth draws there.
#[derive(QueryData)]
pub(crate) struct OwnMesh {
    mesh: Option<&'static Mesh3d>,
    drawn: Option<&'static DrawnMesh>,
}

impl OwnMeshItem<'_, '_> {
    fn id(&self) -> Option<AssetId<Mesh>> {
        user_mesh(self.mesh, self.drawn)
    }
}

/// Makes the shapes of colliders that are new or changed.
pub(crate) fn build(
    mut colliders: Query<(Entity, Ref<ClothCollider>, Option<Ref<ColliderFriction>>, OwnMesh, &mut ColliderState)>,
    placements: Placements,
    meshes: Option<Res<Assets<Mesh>>>,
    mesh_events: Option<MessageReader<AssetEvent<Mesh>>>,
    mut modified: Local<HashSet<AssetId<Mesh>>>,
    mut commands: Commands,
) {
    modified.clear();
    if let Some(mut events) = mesh_events {
        modified.extend(events.read().filter_map(|event| match event {
            AssetEvent::Modified { id } => Some(*id),
            _ => None,
        }));
    }
    for (entity, collider, friction, own_mesh, mut state) in &mut colliders {
        let is_mesh = matches!(*collider, ClothCollider::Mesh { .. });
        let mesh = own_mesh.id().filter(|_| is_mesh);
        let loaded = mesh.and_then(|id| meshes.as_deref()?.get(id));
        let remeshed = mesh != state.mesh
            || mesh.is_some_and(|id| modified.contains(&id))
            || (state.waits_for_mesh && loaded.is_some());
        let placement = placements.get(entity);
        let lost = placement.filter(|placement| !placement.is_finite());
        if lost.is_some() != state.lost {
            state.lost = lost.is_some();
            if let Some(placement) = lost {
                report(&mut commands, ColliderRejected { entity, error: not_finite("Transform", &placement) });
            }
        }
        let scale = match (placement.filter(Placement::is_finite), &state.seen) {
            (Some(placement), _) => placement.scale,
            (None, Some((_, scale))) => *scale,
            (None, None) => continue,
        };
        let seen = state.seen.as_ref();
        let reshaped = seen.is_none_or(|(known, known_scale)| {
            (scale - known_scale).abs().max_element() > SCALE_TOLERANCE * known_scale.abs().max_element()
                || (collider.is_changed() && *known != *collider)
        });
        let rubbed = match (&friction, &state.friction) {
            (Some(now), Some(seen)) => now.is_changed() && **now != *seen,
            (now, seen) => now.is_some() != seen.is_some(),
        };
        if !reshaped && !rubbed && !remeshed {
            continue;
        }
        state.changed = true;
        state.seen = Some((ClothCollider::clone(&collider), scale));
        state.friction = friction.as_deref().copied();
        (state.mesh, state.waits_for_mesh) = (mesh, is_mesh && loaded.is_none());
        if state.waits_for_mesh {
            state.shape = None;
            continue;
        }
        let made = shape(&collider, scale, loaded).and_then(|shape| state.check_friction().map(|()| shape));
        state.shape = made.as_ref().ok().cloned();
        if let Err(error) = made {
            report(&mut commands, ColliderRejected { entity, error });
        }
    }
}

impl ColliderState {
    /// The shape that cloth meets, in the collider's own frame.
    pub fn shape(&self) -> Option<&Shape> {
        self.shape.as_ref()
    }

    fn check_friction(&self) -> Result<(), ClothError> {
        let friction = self.friction.map_or(0.0, |friction| friction.0);
        ClothError::check("ColliderFriction", friction, 0.0..=10.0, "0..=10")
    }
}

/// One collider in this tick, in the world.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub entity: Entity,
    pub shape: Shape,
    pub from: Pose,
    pub to: Pose,
    pub friction: Option<f32>,
    pub changed: bool,
}

/// All colliders in this tick, in the world, in the order of their entities.
#[derive(Resource, Clone, Debug, Default)]
pub(crate) struct Colliders(pub Vec<Placed>);

impl Colliders {
    /// Their entities.
    pub fn entities(&self) -> impl Iterator<Item = Entity> {
        self.0.iter().map(|collider| collider.entity)
    }

    /// All of them as a cloth in `frame` sees them, where the collider itself does not say how it rubs with `friction`.
    pub fn seen_by(&self, frame: &ClothFrame, friction: f32) -> impl Iterator<Item = Collider> {
        self.0.iter().map(move |collider| Collider {
            shape: collider.shape.clone(),
            motion: seen_from(frame, collider),
            friction: collider.friction.unwrap_or(friction),
        })
    }
}

/// Finds where every collider stands, and which of them disturb what is near.
pub(crate) fn place(
    mut colliders: Query<(Entity, &mut ColliderState), With<ClothCollider>>,
    placements: Placements,
    tick: Res<ClothTick>,
    mut placed: ResMut<Colliders>,
    mut before: Local<Colliders>,
    mut disturbances: ResMut<Disturbances>,
) {
    std::mem::swap(&mut *placed, &mut *before);
    placed.0.clear();
    for (entity, mut state) in &mut colliders {
        let now = placements.get(entity).filter(Placement::is_finite).map(|placement| placement.pose);
        let ColliderState { shape: Some(shape), friction, follow, changed, .. } = &mut *state else { continue };
        let Some(target) = now.or(follow.map(|follow| follow.target)) else { continue };
        let Motion { from, to } = follow.get_or_insert(Follow::new(target)).sweep(target, &tick);
        let (shape, friction) = (shape.clone(), friction.map(|friction| friction.0));
        placed.0.push(Placed { entity, shape, from, to, friction, changed: std::mem::take(changed) });
    }
    // The order in a query depends on what else was spawned, and the order of contacts on it down to the last bit.
    placed.0.sort_unstable_by_key(|collider| collider.entity);
    disturbances.clear();
    find_disturbances(&before.0, &placed.0, &mut disturbances);
}

/// Goes through the colliders before and now, both in the order of their entities, for those that are different.
fn find_disturbances(mut before: &[Placed], mut now: &[Placed], disturbances: &mut Disturbances) {
    loop {
        let order = match (before.first(), now.first()) {
            (None, None) => return,
            (None, Some(_)) => Ordering::Greater,
            (Some(_), None) => Ordering::Less,
            (Some(before), Some(now)) => before.entity.cmp(&now.entity),
        };
        let (gone, come) = (order.is_le(), order.is_ge());
        if order.is_ne() || now[0].changed || now[0].to != before[0].to {
            if order.is_eq() && !now[0].changed && now[0].from == before[0].to {
                disturbances.sweep(&now[0].shape, now[0].from, now[0].to);
            } else {
                before.iter().take(usize::from(gone)).for_each(|gone| disturbances.appear(&gone.shape, gone.to));
                now.iter().take(usize::from(come)).for_each(|come| disturbances.appear(&come.shape, come.to));
            }
        }
        (before, now) = (&before[usize::from(gone)..], &now[usize::from(come)..]);
    }
}

/// Gives each cloth the colliders as seen from its own frame.
pub(crate) fn advance(
    mut cloths: Query<(&mut Contacts, &ClothFrame, Option<&Fabric>, &StepPlan), Without<ClothAsleep>>,
    placed: Res<Colliders>,
) {
    for (mut contacts, frame, fabric, plan) in &mut cloths {
        if plan.substeps == 0 || (placed.0.is_empty() && contacts.colliders.is_empty()) {
            continue;
        }
        let friction = fabric.copied().unwrap_or_default().friction;
        contacts.set_colliders(placed.seen_by(frame, friction));
        if placed.0.is_empty() {
            (contacts.touching, contacts.deepest) = (0, 0.0);
        }
    }
}

impl Follow {
    /// How a solid moves over this tick. One that jumps was always where it ends: it strikes nothing on its way.
    pub(crate) fn sweep(&mut self, target: Pose, tick: &ClothTick) -> Motion {
        self.aim(target, tick);
        if self.jumps(&JUMP) {
            self.carry(target);
        }
        Motion { from: self.pose, to: self.advance() }
    }
}

/// How a cloth sees a collider move. One that was carried along sees all at rest, or what went with it would strike it.
fn seen_from(frame: &ClothFrame, collider: &Placed) -> Motion {
    let to = relative(&frame.pose, &collider.to);
    if collider.from == collider.to || frame.carried {
        return Motion::at_rest(to);
    }
    Motion { from: relative(&frame.pose, &collider.from), to }
}
