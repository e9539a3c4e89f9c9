//! The motion of the air around one cloth: a sum of fields.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch};
use glam::Vec3;

use super::Airflow;
use super::fan::{Fan, Jet};
use super::gust::{Eddies, GustyWind};
use super::zone::{Placed, WindZone};
use crate::contact::Collider;
use crate::lanes::{Frame, LANES, LEVEL, Vec3x8, splat};
use crate::{Particles, Pose, Soa3, Topology};

/// Velocity of the air around one cloth in one tick, in the cloth's frame: the sum of a wind that is the same everywhere,
/// gusts, zones and fans. What is not there costs nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WindField {
    /// The same everywhere, m/s.
    uniform: Vec3,
    gusts: Option<Eddies>,
    zones: Vec<Placed>,
    jets: Vec<Jet>,
}

impl WindField {
    /// A wind that is the same everywhere, m/s.
    pub fn uniform(velocity: Vec3) -> Self {
        Self { uniform: velocity, ..Self::default() }
    }

    /// Replaces the wind and its gusts, as a cloth in `frame` sees them.
    pub fn set_wind(&mut self, wind: &GustyWind, frame: &Pose) {
        (self.uniform, self.gusts) = wind.seen_from(frame);
    }

    /// Replaces all zones, each with its pose in the cloth's frame. Allocates only when there are more than ever before.
    pub fn set_zones(&mut self, zones: impl IntoIterator<Item = (WindZone, Pose)>) {
        self.zones.clear();
        self.zones.extend(zones.into_iter().map(|(zone, pose)| Placed { zone, frame: Frame::new(pose) }));
    }

    /// Replaces all fans, each with its pose in the cloth's frame; those that are off are left away. `colliders`, where
    /// they are at the end of the tick, shadow them. Allocates only when there are more than ever before.
    pub fn set_fans(&mut self, fans: impl IntoIterator<Item = (Fan, Pose)>, colliders: &[Collider]) {
        let mut count = 0;
        for (fan, pose) in fans.into_iter().filter(|(fan, _)| fan.on) {
            if count == self.jets.len() {
                self.jets.push(Jet::default());
            }
            self.jets[count].aim(fan, pose, colliders);
            count += 1;
        }
        self.jets.truncate(count);
    }

    /// Velocity of the air at a point of the cloth's frame, m/s.
    pub fn at(&self, point: Vec3) -> Vec3 {
        dispatch!(*LEVEL, simd => {
            let found = self.at_eight(simd, Vec3x8::splat(simd, point));
            Vec3::new(found.x[0], found.y[0], found.z[0])
        })
    }

    /// Whether the air is slower than `limit`, m/s, at every one of these points.
    pub fn is_below(&self, limit: f32, points: &Soa3) -> bool {
        let limit = limit * limit;
        dispatch!(*LEVEL, simd => (0..points.len() / LANES).map(|group| group * LANES).all(|i| {
            let air = self.at_eight(simd, Vec3x8::load(simd, points, i));
            air.dot(air).simd_lt(splat(simd, limit)).all_true()
        }))
    }

    /// Finds the velocity of the air at every particle, for [`Air::blow`](super::Air::blow). Once a tick.
    pub fn sample(&self, topology: &Topology, particles: &mut Particles) {
        let airflow = particles.airflow.get_or_insert_default();
        airflow.fit(topology, &particles.mass);
        dispatch!(*LEVEL, simd => self.fill(simd, &particles.position, airflow));
    }

    #[inline(always)]
    fn fill<S: Simd>(&self, simd: S, position: &Soa3, airflow: &mut Airflow) {
        for i in (0..position.len() / LANES).map(|group| group * LANES) {
            self.at_eight(simd, Vec3x8::load(simd, position, i)).store(&mut airflow.velocity, i);
        }
    }

    #[inline(always)]
    fn at_eight<S: Simd>(&self, simd: S, point: Vec3x8<S>) -> Vec3x8<S> {
        let mut velocity = Vec3x8::splat(simd, self.uniform);
        if let Some(gusts) = &self.gusts {
            velocity = velocity + gusts.at(simd, point);
        }
        for zone in &self.zones {
            velocity = velocity + zone.at(simd, point);
        }
        for jet in &self.jets {
            velocity = velocity + jet.at(simd, point);
        }
        velocity
    }
}
