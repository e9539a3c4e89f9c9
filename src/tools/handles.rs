//! The gizmo's handles move, turn and scale the selected object.
//!
//! Bevy's gizmo moves an entity of its own, the grip; what that does is done to the object. So an object may have a parent,
//! may refuse some scales (a capsule has but one), and may have sizes of its own in place of a scale (a fan's diameter).

use bevy::gizmos::transform_gizmo::{TransformGizmoFocus, TransformGizmoState};
use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothCollider, ClothSource, Fan};
use bevy_cloth_inspector::Selected;

use crate::scenes::Mannequin;
use crate::throw::Ball;

/// The object that is being moved by its handles, if any.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dragged(pub Option<Entity>);

/// The entity that the gizmo moves.
#[derive(Component)]
#[require(Transform)]
struct Grip;

/// What the dragged object was like when the drag began.
#[derive(Resource, Default)]
struct Start {
    /// Where it stood in the world.
    object: Transform,
    /// Its parent, if it has one.
    parent: GlobalTransform,
    /// Where the grip stood.
    grip: Transform,
    fan: Option<Fan>,
    /// The cloth whose size is scaled in place of the object, and that size, m.
    cloth: Option<(Entity, Vec2)>,
}

pub fn plugin(app: &mut App) {
    app.init_resource::<Dragged>()
        .init_resource::<Start>()
        .add_systems(PreUpdate, drag.run_if(resource_exists::<TransformGizmoState>))
        .add_systems(Update, attach);
}

/// The object whose handles are shown: the selected one, or what it hangs on. A curtain is moved by its rod.
fn target(selected: &Selected, parents: &Query<&ChildOf>) -> Option<Entity> {
    selected.0.map(|entity| parents.root_ancestor(entity))
}

/// Puts the grip on the selected object while it is not dragged.
fn attach(
    selected: Res<Selected>,
    gizmo: Option<Res<TransformGizmoState>>,
    parents: Query<&ChildOf>,
    places: Query<&GlobalTransform, Without<Grip>>,
    mut grips: Query<(Entity, &mut Transform), With<Grip>>,
    mut commands: Commands,
) {
    let place = target(&selected, &parents).and_then(|entity| places.get(entity).ok());
    let Some(place) = place else {
        grips.iter().for_each(|(grip, _)| commands.entity(grip).despawn());
        return;
    };
    let (_, rotation, translation) = place.to_scale_rotation_translation();
    let place = Transform { translation, rotation, scale: Vec3::ONE };
    match grips.single_mut() {
        Ok((_, mut grip)) if gizmo.is_none_or(|gizmo| !gizmo.active) => drop(grip.set_if_neq(place)),
        Ok(_) => {}
        Err(_) => drop(commands.spawn((Name::new("grip"), Grip, TransformGizmoFocus, place))),
    }
}

/// Does to the object what the gizmo did to the grip.
fn drag(
    gizmo: Res<TransformGizmoState>,
    selected: Res<Selected>,
    parents: Query<&ChildOf>,
    grips: Query<&Transform, With<Grip>>,
    mut objects: Query<
        (&mut Transform, Option<&mut Fan>, Option<&ClothCollider>, (Has<Ball>, Has<Mannequin>)),
        Without<Grip>,
    >,
    places: Query<&GlobalTransform>,
    children: Query<&Children>,
    mut cloths: Query<&mut Cloth>,
    (mut dragged, mut start): (ResMut<Dragged>, ResMut<Start>),
) {
    let entity = target(&selected, &parents).filter(|_| gizmo.active);
    let (Some(entity), Ok(grip)) = (entity, grips.single()) else {
        dragged.set_if_neq(Dragged(None));
        return;
    };
    let Ok((mut object, mut fan, collider, (is_ball, is_mannequin))) = objects.get_mut(entity) else { return };
    if dragged.0 != Some(entity) {
        dragged.0 = Some(entity);
        let place = places.get(entity).copied().unwrap_or_default();
        let cloth = children.iter_descendants(entity).find_map(|child| match cloths.get(child).ok()?.source {
            ClothSource::Rectangle { size, .. } => Some((child, size)),
            ClothSource::Mesh => None,
        });
        let parent = parents.get(entity).ok().and_then(|parent| places.get(parent.parent()).ok());
        *start = Start {
            object: place.compute_transform(),
            parent: parent.copied().unwrap_or_default(),
            grip: gizmo.start_transform,
            fan: fan.as_deref().copied(),
            cloth,
        };
    }
    let factor = grip.scale / start.grip.scale;
    let mut moved = start.object;
    moved.translation += grip.translation - start.grip.translation;
    moved.rotation = (grip.rotation * start.grip.rotation.inverse() * moved.rotation).normalize();
    if let (Some(fan), Some(before)) = (&mut fan, start.fan) {
        fan.set_if_neq(Fan { diameter: (before.diameter * single(factor)).clamp(0.05, 5.0), ..before });
    } else if let Some((cloth, size)) = start.cloth {
        let wanted = (size * factor.truncate()).clamp(Vec2::splat(0.1), Vec2::splat(20.0));
        if let Ok(mut cloth) = cloths.get_mut(cloth)
            && let ClothSource::Rectangle { size, resolution } = cloth.source
            && size != wanted
        {
            cloth.source = ClothSource::Rectangle { size: wanted, resolution };
        }
    } else if !is_mannequin {
        moved.scale *= allowed(factor, collider, is_ball);
    }
    let moved = GlobalTransform::from(moved).reparented_to(&start.parent);
    object.set_if_neq(moved);
}

/// The one factor of the axis that was pulled.
fn single(factor: Vec3) -> f32 {
    let farthest = |a: f32, b: f32| if b.ln().abs() > a.ln().abs() { b } else { a };
    factor.to_array().into_iter().reduce(farthest).unwrap_or(1.0)
}

/// The scale that comes nearest to `factor` among those that a shape may have.
fn allowed(factor: Vec3, collider: Option<&ClothCollider>, is_ball: bool) -> Vec3 {
    match collider {
        _ if is_ball => Vec3::splat(single(factor)),
        Some(ClothCollider::Capsule { .. }) => Vec3::splat(single(factor)),
        Some(ClothCollider::Cylinder { .. } | ClothCollider::Cone { .. }) => {
            let around = single(Vec3::new(factor.x, 1.0, factor.z));
            Vec3::new(around, factor.y, around)
        }
        _ => factor,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_capsule_keeps_its_form_and_a_cylinder_stays_round() {
        let capsule = ClothCollider::Capsule { radius: 0.1, length: 0.3 };
        assert_eq!(allowed(Vec3::new(1.0, 2.0, 1.0), Some(&capsule), false), Vec3::splat(2.0));
        assert_eq!(allowed(Vec3::new(0.5, 1.0, 1.0), Some(&capsule), false), Vec3::splat(0.5));
        let cylinder = ClothCollider::Cylinder { radius: 0.1, height: 0.3 };
        assert_eq!(allowed(Vec3::new(1.0, 1.0, 3.0), Some(&cylinder), false), Vec3::new(3.0, 1.0, 3.0));
        assert_eq!(allowed(Vec3::new(1.0, 3.0, 1.0), Some(&cylinder), false), Vec3::new(1.0, 3.0, 1.0));
        let cuboid = ClothCollider::Cuboid { size: Vec3::ONE };
        assert_eq!(allowed(Vec3::new(1.0, 3.0, 1.0), Some(&cuboid), false), Vec3::new(1.0, 3.0, 1.0));
    }
}
