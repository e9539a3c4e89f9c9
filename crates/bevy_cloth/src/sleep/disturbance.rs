//! Colliders that disturb the rest of cloth near them.

use bevy::prelude::*;
use cloth_solver::contact::{Contacts, Shape};
use cloth_solver::{Particles, Pose, Topology};

use crate::prepare::relative;

/// What moved, came or went in this tick, in the world.
#[derive(Resource, Clone, Debug, Default)]
pub(crate) struct Disturbances(Vec<Disturbance>);

#[derive(Clone, Debug)]
struct Disturbance {
    shape: Shape,
    pose: Pose,
    /// How far around the shape it may have been in this tick, m.
    reach: f32,
}

impl Disturbances {
    /// Begins the tick.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Something is at `pose` that was not there, or was there and is not any more.
    pub fn appear(&mut self, shape: &Shape, pose: Pose) {
        self.0.push(Disturbance { shape: shape.clone(), pose, reach: 0.0 });
    }

    /// Something goes from one pose to the other.
    pub fn sweep(&mut self, shape: &Shape, from: Pose, to: Pose) {
        let turn = from.rotation.angle_between(to.rotation);
        // A plane that turns reaches everywhere.
        let turned = if turn > 0.0 { turn * shape.bounding_radius() } else { 0.0 };
        let reach = 0.5 * from.position.distance(to.position) + turned;
        self.0.extend([from, to].map(|pose| Disturbance { shape: shape.clone(), pose, reach }));
    }

    /// Whether any of it is so near to a cloth in `frame`, with `bounds` (cloth frame) around its particles, that it could touch
    /// it.
    pub fn reach(
        &self,
        frame: &Pose,
        bounds: (Vec3, Vec3),
        topology: &Topology,
        particles: &Particles,
        contacts: &Contacts,
    ) -> bool {
        // Between particles the cloth is no farther than an edge from the nearest of them.
        let gap = contacts.offset + contacts.edge;
        self.0.iter().any(|disturbance| disturbance.reaches(frame, bounds, topology, particles, gap))
    }
}

impl Disturbance {
    fn reaches(
        &self,
        frame: &Pose,
        (low, high): (Vec3, Vec3),
        topology: &Topology,
        particles: &Particles,
        gap: f32,
    ) -> bool {
        let pose = relative(frame, &self.pose);
        let gap = gap + self.reach;
        let distance = |point: Vec3| self.shape.distance_and_normal(pose.inverse_point(point)).0;
        let near_box = pose.position.distance(pose.position.clamp(low, high)) < self.shape.bounding_radius() + gap;
        near_box
            && distance(0.5 * (low + high)) < 0.5 * low.distance(high) + gap
            && topology.particles().any(|slot| distance(particles.position.get(slot as usize)) < gap)
    }
}
