//! Capsules along the bones of an armature, as colliders.

use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use crate::cloth::Cloth;
use crate::collider::ClothCollider;
use crate::prepare::TakenSkin;

/// Put this on the root of an armature to have a capsule along each of its bones, which cloth cannot enter.
///
/// A bone leads from a joint to a joint that is its child. Joints are the descendants that a
/// [`SkinnedMesh`] names, or where none is named all descendants without a mesh. The capsules are children of the joints with a [`ClothCollider`],
/// made anew when this component or the hierarchy changes and removed with it. They keep the length that the bones have then.
///
/// ```
/// # use bevy_cloth::BoneColliders;
/// let colliders = BoneColliders::new(0.15).with_radius("Head", 0.12).with_radius("Tail", 0.0);
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct BoneColliders {
    /// Radius of each capsule in lengths of its bone, 0 to 10; 0 for none. Default 0.2.
    pub radius: f32,
    /// Bones with another radius: the [`Name`] of the joint that a bone begins at, and the radius in the armature's own units, 0 for
    /// none.
    pub radii: Vec<(String, f32)>,
}

impl Default for BoneColliders {
    fn default() -> Self {
        Self::new(0.2)
    }
}

impl BoneColliders {
    /// Capsules with this radius in lengths of their bone.
    pub const fn new(radius: f32) -> Self {
        Self { radius, radii: Vec::new() }
    }

    /// The same with another radius, in the armature's own units, for the bones that begin at the joint of this name.
    pub fn with_radius(mut self, joint: impl Into<String>, radius: f32) -> Self {
        self.radii.push((joint.into(), radius));
        self
    }

    /// The radius of a bone of a length.
    fn of(&self, joint: Option<&Name>, length: f32) -> f32 {
        let own = joint.and_then(|name| self.radii.iter().find(|(known, _)| known == name.as_str()));
        own.map_or(self.radius * length, |(_, radius)| *radius)
    }
}

/// The capsules of an armature, and the bones that they were made for.
#[derive(Component, Clone, Debug, Default)]
#[component(clone_behavior = Ignore)]
pub(crate) struct BoneCapsules {
    bones: Vec<[Entity; 2]>,
    capsules: Vec<Entity>,
}

/// Makes the capsules of armatures that are new or changed.
pub(crate) fn build(
    armatures: Query<(Entity, Ref<BoneColliders>, Option<&BoneCapsules>)>,
    arrived: Query<(), Or<(Added<SkinnedMesh>, Added<ChildOf>)>>,
    children: Query<&Children>,
    joints: Query<(&Transform, Option<&Name>), (Without<ClothCollider>, Without<Mesh3d>, Without<Cloth>)>,
    (skins, taken): (Query<&SkinnedMesh>, Query<&TakenSkin>),
    mut commands: Commands,
) {
    if armatures.is_empty() {
        return;
    }
    let is_new = !arrived.is_empty();
    for (root, settings, known) in armatures.iter().filter(|(_, settings, _)| is_new || settings.is_changed()) {
        let below: Vec<Entity> = children.iter_descendants(root).filter(|entity| joints.contains(*entity)).collect();
        let named = skins.iter().flat_map(|skin| &skin.joints).chain(taken.iter().flat_map(TakenSkin::joints));
        let named: Vec<Entity> = named.copied().filter(|joint| *joint == root || below.contains(joint)).collect();
        let is_joint = |entity: Entity| named.is_empty() || named.contains(&entity);
        let mut bones = Vec::new();
        for joint in std::iter::once(root).chain(below.iter().copied()).filter(|joint| is_joint(*joint)) {
            let ends = children.get(joint).into_iter().flatten().copied();
            bones.extend(ends.filter(|end| below.contains(end) && is_joint(*end)).map(|end| [joint, end]));
        }
        if known.is_some_and(|known| known.bones == bones) && !settings.is_changed() {
            continue;
        }
        known.iter().flat_map(|known| &known.capsules).for_each(|capsule| commands.entity(*capsule).try_despawn());
        let mut capsules = Vec::new();
        for [joint, end] in &bones {
            let (Ok((_, name)), Ok((place, _))) = (joints.get(*joint), joints.get(*end)) else { continue };
            let (along, length) = (place.translation, place.translation.length());
            let radius = settings.of(name, length);
            // What is out of range is told by the collider, which names it.
            if length > 0.0 && radius != 0.0 {
                let turn = Quat::from_rotation_arc(Vec3::Y, along / length);
                let place = Transform::from_translation(along / 2.0).with_rotation(turn);
                let capsule = (ClothCollider::Capsule { radius, length }, place, ChildOf(*joint));
                capsules.push(commands.spawn(capsule).id());
            }
        }
        commands.entity(root).try_insert(BoneCapsules { bones, capsules });
    }
}

/// Takes the capsules away with the component.
pub(crate) fn on_removed(removed: On<Remove, BoneColliders>, known: Query<&BoneCapsules>, mut commands: Commands) {
    for capsule in known.get(removed.entity).iter().flat_map(|known| &known.capsules) {
        commands.entity(*capsule).try_despawn();
    }
    commands.entity(removed.entity).try_remove::<BoneCapsules>();
}
