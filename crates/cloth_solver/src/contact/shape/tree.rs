//! A hierarchy of boxes around triangles, by `parry3d`. Without that there is none, and so no shape that needs one.

use glam::Vec3;

/// Boxes around numbered things, in a hierarchy.
#[cfg(feature = "parry")]
#[derive(Clone, Debug)]
pub(super) struct Tree(parry3d::partitioning::Bvh);

/// Cannot be made without the feature `parry`.
#[cfg(not(feature = "parry"))]
#[derive(Clone, Debug)]
pub(super) enum Tree {}

#[cfg(feature = "parry")]
impl Tree {
    /// Over boxes by their lowest and highest corners, in the order of their numbers.
    pub fn new(boxes: impl Iterator<Item = [Vec3; 2]>) -> Self {
        let boxes = boxes.map(|[low, high]| aabb(low, high)).enumerate();
        Self(parry3d::partitioning::Bvh::from_iter(parry3d::partitioning::BvhBuildStrategy::Binned, boxes))
    }

    /// The nearest to `p` that is nearer than `reach`, m; `distance` tells how far one is.
    pub fn nearest(&self, p: Vec3, reach: f32, distance: impl Fn(u32) -> f32) -> Option<u32> {
        let p = vector(p);
        let nearest = self.0.find_best(
            reach,
            |node, _| parry3d::query::PointQuery::distance_to_local_point(&node.aabb(), p, true),
            |which, _| Some(distance(which)),
        );
        nearest.map(|(which, _)| which)
    }

    /// Calls `meet` with each whose box meets the one from `low` to `high`.
    pub fn for_each_in(&self, low: Vec3, high: Vec3, meet: impl FnMut(u32)) {
        self.0.intersect_aabb(&aabb(low, high)).for_each(meet);
    }

    /// Whether any box meets the one from `low` to `high`.
    pub fn any_in(&self, low: Vec3, high: Vec3) -> bool {
        self.0.intersect_aabb(&aabb(low, high)).next().is_some()
    }

    /// Whether anything for which `is_met` holds is on the way between two points.
    pub fn any_between(&self, [from, to]: [Vec3; 2], is_met: impl Fn(u32) -> bool) -> bool {
        let ray = parry3d::query::Ray::new(vector(from), vector(to - from));
        self.0.cast_ray(&ray, 1.0, |which, _| is_met(which).then_some(0.0)).is_some()
    }
}

#[cfg(not(feature = "parry"))]
impl Tree {
    pub fn nearest(&self, _: Vec3, _: f32, _: impl Fn(u32) -> f32) -> Option<u32> {
        match *self {}
    }

    pub fn for_each_in(&self, _: Vec3, _: Vec3, _: impl FnMut(u32)) {
        match *self {}
    }

    pub fn any_in(&self, _: Vec3, _: Vec3) -> bool {
        match *self {}
    }

    pub fn any_between(&self, _: [Vec3; 2], _: impl Fn(u32) -> bool) -> bool {
        match *self {}
    }
}

#[cfg(feature = "parry")]
fn vector(p: Vec3) -> parry3d::math::Vector {
    parry3d::math::Vector::new(p.x, p.y, p.z)
}

#[cfg(feature = "parry")]
fn aabb(low: Vec3, high: Vec3) -> parry3d::bounding_volume::Aabb {
    parry3d::bounding_volume::Aabb::new(vector(low), vector(high))
}
