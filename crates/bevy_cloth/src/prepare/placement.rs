//! Where entities stand in the world at this moment.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use cloth_solver::Pose;

/// Place, orientation and scale of an entity in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Placement {
    pub pose: Pose,
    pub scale: Vec3,
}

impl Placement {
    /// Of an entity without parent. Straight from the fields: a transform that nobody touches gives the same bits at every tick.
    pub fn of(transform: &Transform) -> Self {
        Self { pose: Pose::new(transform.translation, transform.rotation.normalize()), scale: transform.scale }
    }

    pub fn is_finite(&self) -> bool {
        self.pose.is_finite() && self.scale.is_finite()
    }
}

/// Computes placements from [`Transform`]s up the hierarchy.
///
/// [`GlobalTransform`] is propagated once a frame after the fixed steps, or never without a `TransformPlugin`; a tick
/// needs it now.
#[derive(SystemParam)]
pub(crate) struct Placements<'w, 's> {
    transforms: Query<'w, 's, &'static Transform>,
    parents: Query<'w, 's, &'static ChildOf>,
}

impl Placements<'_, '_> {
    /// The placement of `entity`, or `None` if it is gone or has no [`Transform`].
    pub fn get(&self, entity: Entity) -> Option<Placement> {
        let own = self.transforms.get(entity).ok()?;
        if self.parents.get(entity).is_err() {
            return Some(Placement::of(own));
        }
        let (scale, rotation, translation) = self.affine(entity)?.to_scale_rotation_translation();
        Some(Placement { pose: Pose::new(translation, rotation.normalize()), scale })
    }

    /// The whole transform of `entity`, shear included.
    pub fn affine(&self, entity: Entity) -> Option<GlobalTransform> {
        let mut global = GlobalTransform::from(*self.transforms.get(entity).ok()?);
        for ancestor in self.parents.iter_ancestors(entity) {
            let Ok(transform) = self.transforms.get(ancestor) else { break };
            global = *transform * global;
        }
        Some(global)
    }
}
