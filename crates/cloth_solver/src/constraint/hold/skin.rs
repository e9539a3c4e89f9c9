//! Skin: points that several frames take along (linear blend skinning; Magnenat-Thalmann, Laperrière, Thalmann 1988), and how far
//! particles may get from theirs.

use glam::Vec3;

use crate::tick::Substep;
use crate::topology::Change;
use crate::{ClothError, Motion, Particles, Pose};

/// A point of a surface that several frames take along, each by its weight.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SkinPoint {
    /// Indices into [`Pins::frames`](super::super::Pins::frames).
    pub frames: [u32; 4],
    /// The weight of each, 0..=1; they sum to 1.
    pub weights: [f32; 4],
    /// Where in each frame the point is, m.
    pub locals: [Vec3; 4],
    /// Normal of the surface there in each frame, unit length.
    pub normals: [Vec3; 4],
}

impl SkinPoint {
    /// Where it is with its frames at `pose`, m.
    pub fn point(&self, pose: impl Fn(u32) -> Pose) -> Vec3 {
        self.blend(|k, frame| pose(frame).point(self.locals[k]))
    }

    /// The unit normal there with its frames at `pose`; zero if the normals cancel out.
    pub fn normal(&self, pose: impl Fn(u32) -> Pose) -> Vec3 {
        self.blend(|k, frame| pose(frame).rotation * self.normals[k]).normalize_or_zero()
    }

    fn blend(&self, value: impl Fn(usize, u32) -> Vec3) -> Vec3 {
        (0..4).filter(|k| self.weights[*k] > 0.0).map(|k| value(k, self.frames[k]) * self.weights[k]).sum()
    }
}

/// How far one particle may get from a point of the skin.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinLimit {
    /// The particle.
    pub particle: u32,
    /// The point.
    pub point: SkinPoint,
    /// Largest distance from it, m, 0 or more; infinite for none.
    pub distance: f32,
    /// How far behind the plane of the surface through it, against its normal, the particle may get, m, 0 or more; infinite for any,
    /// as it must be where `distance` is: far from the point the plane is not the surface.
    pub backstop: f32,
}

/// What a skin holds of a cloth.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skin {
    /// Particles that follow a point instead of the place in a frame that their pin says. One that is not pinned is left alone.
    pub pins: Vec<(u32, SkinPoint)>,
    /// Particles that are free within limits.
    pub limits: Vec<SkinLimit>,
}

impl Skin {
    pub(crate) fn validate(&self, particles: &Particles, frames: usize) -> Result<(), ClothError> {
        let limited = self.limits.iter().map(|limit| (limit.particle, &limit.point));
        for (particle, point) in self.pins.iter().map(|(particle, point)| (*particle, point)).chain(limited) {
            if particles.mass.get(particle as usize).is_none_or(|m| *m <= 0.0) {
                let particles = particles.mass.iter().filter(|m| **m > 0.0).count();
                return Err(ClothError::NoSuchParticle { field: "Skin", particle, particles });
            }
            let known = |k: &usize| point.weights[*k] <= 0.0 || (point.frames[*k] as usize) < frames;
            if let Some(k) = (0..4).find(|k| !known(k)) {
                let (value, allowed) = (point.frames[k] as f32, "an index of Pins::frames");
                return Err(ClothError::OutOfRange { field: "SkinPoint::frames", value, allowed });
            }
        }
        for limit in &self.limits {
            ClothError::check("SkinLimit::distance", limit.distance, 0.0..=f32::INFINITY, "0 m or more")?;
            let least = if limit.distance.is_finite() { 0.0 } else { f32::INFINITY };
            let allowed = "0 m or more, and infinite with an infinite distance";
            ClothError::check("SkinLimit::backstop", limit.backstop, least..=f32::INFINITY, allowed)?;
        }
        Ok(())
    }

    /// Lets the pinned particles move to where their points are at the fraction `t` of the tick.
    pub(crate) fn move_pins(&self, frames: &[Motion], particles: &mut Particles, t: f32) {
        let at = |frame: u32| frames.get(frame as usize).copied().unwrap_or_default();
        for (particle, point) in &self.pins {
            let i = *particle as usize;
            if particles.inverse_mass[i] > 0.0 {
                continue;
            }
            // On a straight way: to turn every frame for every point in every substep would cost more than the cloth.
            let to = point.point(|k| at(k).to);
            let now = if t >= 1.0 { to } else { point.point(|k| at(k).from).lerp(to, t) };
            particles.moved.set(i, now - particles.position.get(i));
        }
    }
}

/// A skin, and where the points of its limits are in the tick at hand.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(crate) struct SkinHold {
    pub skin: Skin,
    /// For each limit where its point is at the start and at the end of the tick, and the normal there at the end.
    points: Vec<(Vec3, Vec3, Vec3)>,
}

impl SkinHold {
    pub fn new(skin: Skin) -> Self {
        Self { points: vec![Default::default(); skin.limits.len()], skin }
    }

    /// Takes over that the cloth was taken apart. A copy of a particle is limited as that was; what is born between two others is
    /// not.
    pub fn follow(&mut self, change: &Change) {
        let Skin { pins, limits } = &mut self.skin;
        for born in change.born.iter().filter(|born| born.parents[0] == born.parents[1]) {
            let parent = limits.iter().find(|limit| limit.particle == born.parents[0]);
            let copy = parent.map(|limit| SkinLimit { particle: born.slot, ..*limit });
            limits.extend(copy);
        }
        pins.retain(|(particle, _)| !change.gone.contains(particle));
        limits.retain(|limit| !change.gone.contains(&limit.particle));
        self.points.resize(limits.len(), Default::default());
    }

    /// Brings back what got too far in a substep. It comes to rest against its limit: what it is moved by adds to no speed, and the
    /// speed with which it would go on outwards, seen from the skin, is gone.
    pub fn limit(&mut self, frames: &[Motion], particles: &mut Particles, sub: &Substep) {
        let limits = &self.skin.limits;
        if sub.start == 0.0 {
            for (limit, point) in limits.iter().zip(&mut self.points) {
                let at = |frame: u32| frames.get(frame as usize).copied().unwrap_or_default();
                let (from, to) = (limit.point.point(|k| at(k).from), limit.point.point(|k| at(k).to));
                *point = (from, to, limit.point.normal(|k| at(k).to));
            }
        }
        let dt = sub.h / (sub.end - sub.start);
        for (limit, (from, to, normal)) in limits.iter().zip(&self.points) {
            let i = limit.particle as usize;
            if particles.inverse_mass[i] <= 0.0 {
                continue;
            }
            let (target, speed) = (from.lerp(*to, sub.end), (*to - *from) / dt);
            let mut away = particles.position.get(i) - target;
            let mut velocity = particles.velocity.get(i) - speed;
            let distance = away.length();
            let too_far = distance > limit.distance;
            if too_far {
                let outward = away / distance;
                away = outward * limit.distance;
                velocity -= outward * velocity.dot(outward).max(0.0);
            }
            // Behind the surface it is nearer to the point after this than before.
            let depth = -away.dot(*normal) - limit.backstop;
            let too_deep = depth > 0.0;
            if too_deep {
                away += *normal * depth;
                velocity -= *normal * velocity.dot(*normal).min(0.0);
            }
            if too_far || too_deep {
                particles.position.set(i, target + away);
                particles.velocity.set(i, velocity + speed);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{Quat, UVec2, Vec2};

    use super::*;
    use crate::constraint::Pins;
    use crate::tick::Tick;
    use crate::topology::Resolution;
    use crate::{Cloth, Fabric, Topology, measure};

    struct Numbers(u64);

    impl Numbers {
        /// -1..1.
        fn next(&mut self) -> f32 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
        }

        fn vector(&mut self) -> Vec3 {
            Vec3::new(self.next(), self.next(), self.next())
        }
    }

    const FREE: f32 = f32::INFINITY;

    /// A cloth that two frames take along: one its left side, one its right.
    fn worn(distance: f32, backstop: f32) -> Cloth {
        let topology =
            Topology::rectangle(Vec2::new(0.6, 0.8), Resolution::Cells(UVec2::new(6, 8))).expect("a rectangle");
        let mut cloth = Cloth::new(Arc::new(topology), &Fabric::default()).expect("a cloth");
        let pins = Pins { frames: vec![Motion::default(); 2], ..Pins::default() };
        cloth.constraints.set_pins(&mut cloth.particles, pins).expect("no pins");
        let rest = cloth.topology.rest.clone();
        let limit = |particle: u32| {
            let at = rest[particle as usize];
            let right = at.x / 0.6 + 0.5;
            let point = SkinPoint {
                frames: [0, 1, 0, 0],
                weights: [1.0 - right, right, 0.0, 0.0],
                locals: [at; 4],
                normals: [Vec3::Z; 4],
            };
            SkinLimit { particle, point, distance, backstop }
        };
        let limits = cloth.topology.particles().map(limit).collect();
        let skin = Skin { limits, ..Skin::default() };
        cloth.constraints.set_skin(&cloth.particles, Some(skin)).expect("limits");
        cloth
    }

    /// How far the farthest particle is from its place, and how far the deepest is behind the surface.
    fn farthest(cloth: &Cloth) -> (f32, f32) {
        let frames = &cloth.constraints.pins().frames;
        let pose = |frame: u32| frames[frame as usize].to;
        let skin = cloth.constraints.skin().expect("a skin");
        skin.limits.iter().fold((0.0, f32::MIN), |(far, deep), limit| {
            let away = cloth.particles.position.get(limit.particle as usize) - limit.point.point(pose);
            (away.length().max(far), (-away.dot(limit.point.normal(pose))).max(deep))
        })
    }

    #[test]
    fn nothing_gets_farther_than_its_limit_however_the_frames_move() {
        for seed in 0..24 {
            let mut numbers = Numbers(seed);
            let distance = [0.0, 0.02, 0.3, FREE][seed as usize % 4];
            let backstop = if distance < FREE { [FREE, 0.01, 0.0][seed as usize % 3] } else { FREE };
            let mut cloth = worn(distance, backstop);
            let [mut velocity, mut spin] = [[Vec3::ZERO; 2]; 2];
            for _ in 0..120 {
                for k in 0..2 {
                    velocity[k] = (velocity[k] + numbers.vector() * 3.0).clamp_length_max(20.0);
                    spin[k] = (spin[k] + numbers.vector() * 2.0).clamp_length_max(10.0);
                    let motion = &mut cloth.constraints.pin_frames_mut()[k];
                    let turn = Quat::from_scaled_axis(spin[k] / 64.0) * motion.to.rotation;
                    let at = (motion.to.position + velocity[k] / 64.0).clamp_length_max(3.0);
                    *motion = Motion { from: motion.to, to: Pose::new(at, turn) };
                }
                cloth.step(Tick::new(1.0 / 64.0), Vec3::NEG_Y * 9.81);
                let (far, deep) = farthest(&cloth);
                assert!(cloth.particles.is_finite() && far < distance + 1e-4, "seed {seed}: {far} m of {distance} m");
                assert!(deep < backstop + 1e-4, "seed {seed}: {deep} m behind of {backstop} m");
            }
        }
    }

    #[test]
    fn limits_that_stand_still_never_add_energy() {
        for seed in 0..12 {
            let mut numbers = Numbers(seed);
            let mut cloth = worn([0.05, 0.3][seed as usize % 2], [0.01, FREE][seed as usize / 2 % 2]);
            for slot in cloth.topology.particles() {
                cloth.particles.velocity.set(slot as usize, numbers.vector() * 3.0);
            }
            let energy = |cloth: &Cloth| measure::kinetic_energy(&cloth.particles);
            let first = energy(&cloth);
            let mut largest = 0.0_f64;
            for _ in 0..120 {
                cloth.step(Tick::new(1.0 / 64.0), Vec3::ZERO);
                largest = largest.max(energy(&cloth));
            }
            assert!(largest < first && energy(&cloth) < 0.5 * first, "seed {seed}: {largest} J of {first} J");
        }
    }

    #[test]
    fn a_limit_out_of_range_is_refused_by_name() {
        let mut cloth = worn(0.1, FREE);
        let fine = cloth.constraints.skin().expect("a skin").limits[0];
        let mut nowhere = fine;
        nowhere.point.frames[0] = 7;
        for (wrong, field) in [
            (SkinLimit { distance: -0.1, ..fine }, "SkinLimit::distance"),
            (SkinLimit { backstop: f32::NAN, ..fine }, "SkinLimit::backstop"),
            (SkinLimit { distance: FREE, backstop: 0.1, ..fine }, "SkinLimit::backstop"),
            (SkinLimit { particle: 100_000, ..fine }, "Skin"),
            (nowhere, "SkinPoint::frames"),
        ] {
            let skin = Skin { limits: vec![wrong], ..Skin::default() };
            let error = cloth.constraints.set_skin(&cloth.particles, Some(skin)).expect_err("it is wrong");
            assert!(error.to_string().contains(field), "{error}");
        }
        let kept = cloth.constraints.skin().expect("a skin").limits.len();
        assert_eq!(kept, cloth.topology.particle_count(), "the others are gone");
    }
}
