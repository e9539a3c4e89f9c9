//! A fan: the free round turbulent jet before it, the air it draws from behind it, and the shadows of what stands in its way.
//!
//! ```text
//!        ╲ sink        outlet       core, 6 d long                    U = U₀ 6 d/x on the axis
//!   ──▶  ──▶  ──▶  ▏▒▒▒▒▒▒▒▒▒▒▒▒▒▒▒▒▒▒──────                          Gaussian across, half as fast
//!        ╱            ▏      U₀                 ───────────────        at 0.095 x from the axis
//! ```

use core::f32::consts::{FRAC_PI_4, FRAC_PI_6, SQRT_2};
use core::f64::consts::TAU;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};
use glam::{Quat, Vec3};

use crate::contact::{Collider, Shape, segment};
use crate::lanes::{Frame, LANES, Vec3x8, splat};
use crate::{ClothError, Pose};

/// Length of the core of a free round jet, in diameters of the outlet (Rajaratnam, Turbulent Jets, 1976).
const CORE: f32 = 6.0;
/// Distance from the axis at which the jet has half the speed it has on the axis, over the distance from the outlet
/// (likewise).
const HALF_WIDTH: f32 = 0.095;
/// √ln 2: a Gaussian's half-width over the distance at which it has fallen to 1/e.
const HALF: f32 = 0.832_554_6;
/// √(π/8), from the momentum of a core with Gaussian sides.
const SIDE: f32 = 0.626_657_07;

/// A fan that blows along the −z of its frame. Its air is the free round turbulent jet; what it blows it draws in from
/// behind.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component, bevy_reflect::Reflect))]
#[cfg_attr(feature = "ecs", reflect(Default))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fan {
    /// Whether it runs. Default `true`.
    pub on: bool,
    /// Diameter of the outlet, m; 0.01..=100. Default 0.4.
    pub diameter: f32,
    /// Speed of the air at the outlet, m/s; 0..=1000. Default 5.
    pub speed: f32,
    /// Angle of the cone, from side to side and from the outlet's rim on, that its air stays within, rad; 0..=2.5. Default
    /// π/6 (30°), which holds the whole of a free jet: less cuts its sides off, more adds nothing.
    pub spread: f32,
    /// How it turns from side to side. Default `None`: not.
    pub oscillation: Option<Oscillation>,
}

/// How a fan turns from side to side, about the y axis of its frame.
#[cfg_attr(feature = "ecs", derive(bevy_reflect::Reflect))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillation {
    /// How far to either side, rad; 0..=3.2. Default π/4 (45°).
    pub angle: f32,
    /// How often there and back, 1/min; 0..=600. Default 6.
    pub rate: f32,
}

#[cfg(feature = "ecs")]
use bevy_reflect::prelude::ReflectDefault;

impl Default for Fan {
    fn default() -> Self {
        Self { on: true, diameter: 0.4, speed: 5.0, spread: FRAC_PI_6, oscillation: None }
    }
}

impl Default for Oscillation {
    fn default() -> Self {
        Self { angle: FRAC_PI_4, rate: 6.0 }
    }
}

impl Oscillation {
    /// Where it is `seconds` after it stood in the middle, rad, positive to the left of what it blows at.
    pub fn angle(&self, seconds: f64) -> f32 {
        let turns = seconds * f64::from(self.rate) / 60.0;
        self.angle * libm::sin(TAU * (turns - turns.floor())) as f32
    }
}

impl Fan {
    /// Checks every field against its range.
    ///
    /// # Errors
    /// The first field out of range.
    pub fn validate(&self) -> Result<(), ClothError> {
        ClothError::check("Fan::diameter", self.diameter, 0.01..=100.0, "0.01..=100 m")?;
        ClothError::check("Fan::speed", self.speed, 0.0..=1e3, "0..=1,000 m/s")?;
        ClothError::check("Fan::spread", self.spread, 0.0..=2.5, "0..=2.5 rad")?;
        if let Some(Oscillation { angle, rate }) = self.oscillation {
            ClothError::check("Fan::oscillation.angle", angle, 0.0..=3.2, "0..=3.2 rad")?;
            ClothError::check("Fan::oscillation.rate", rate, 0.0..=600.0, "0..=600 1/min")?;
        }
        Ok(())
    }

    /// The pose that its oscillation has turned it to, `seconds` after it stood at `pose`.
    pub fn turned(&self, pose: Pose, seconds: f64) -> Pose {
        let half = 0.5 * self.oscillation.map_or(0.0, |oscillation| oscillation.angle(seconds));
        let turn = Quat::from_xyzw(0.0, libm::sinf(half), 0.0, libm::cosf(half));
        Pose::new(pose.position, pose.rotation * turn)
    }
}

/// The air of a fan, in the frame of a cloth.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Jet {
    origin: Vec3,
    /// Unit vector along which it blows.
    axis: Vec3,
    /// m/s.
    speed: f32,
    /// m.
    diameter: f32,
    /// Tangent of half the spread angle.
    slope: f32,
    /// What stands in the cone.
    shadows: Vec<(Shape, Frame)>,
}

impl Jet {
    /// Places a fan, valid and on, among the colliders.
    pub fn aim(&mut self, fan: Fan, pose: Pose, colliders: &[Collider]) {
        let Fan { diameter, speed, spread, .. } = fan;
        let slope = libm::tanf(0.5 * spread);
        (self.origin, self.axis) = (pose.position, pose.rotation * Vec3::NEG_Z);
        (self.speed, self.diameter, self.slope) = (speed, diameter, slope);
        self.shadows.clear();
        for Collider { shape, motion, .. } in colliders {
            let (radius, to) = (shape.bounding_radius(), motion.to.position - self.origin);
            let along = to.dot(self.axis);
            let aside = (to - self.axis * along).length();
            // By how far a ball at a distance from the cone touches it: its radius over the cosine of the slope.
            let within = 0.5 * diameter + slope * along + radius * (1.0 + slope * slope).sqrt();
            if !radius.is_finite() || (along > -radius && aside <= within) {
                self.shadows.push((shape.clone(), Frame::new(motion.to)));
            }
        }
    }

    /// Velocity at eight points, m/s.
    #[inline(always)]
    pub fn at<S: Simd>(&self, simd: S, point: Vec3x8<S>) -> Vec3x8<S> {
        let (zero, radius) = (splat(simd, 0.0), splat(simd, 0.5 * self.diameter));
        let axis = Vec3x8::splat(simd, self.axis);
        let to = point - Vec3x8::splat(simd, self.origin);
        let along = to.dot(axis);
        let aside = to - axis * along;
        let away = aside.length();
        let rim = radius + along * splat(simd, self.slope);
        let mut within = along.simd_ge(zero) & away.simd_le(rim);
        if within.any_true() {
            within = within & !self.shadowed(simd, point, aside * (radius / rim), within);
        }
        let mut velocity = Vec3x8::splat(simd, Vec3::ZERO);
        if within.any_true() {
            velocity = axis * within.select(self.blown(simd, along, away), zero);
        }
        let behind = along.simd_lt(zero);
        if behind.any_true() {
            velocity = velocity - to * behind.select(self.drawn(simd, to), zero);
        }
        velocity
    }

    /// Speed along the axis at the distances `along` and `away` from it, m/s: a core of full speed that has gone after six
    /// diameters, and Gaussian sides that are just so wide that the momentum flux is the same everywhere (Albertson et al.
    /// 1950). It is that of 0.97 of the outlet's diameter: at its rim the air is slow.
    #[inline(always)]
    fn blown<S: Simd>(&self, simd: S, along: f32x8<S>, away: f32x8<S>) -> f32x8<S> {
        let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
        // Gaussian width at the core's end over √2: from there on all momentum is in the sides.
        let radius = splat(simd, CORE * HALF_WIDTH / (HALF * SQRT_2) * self.diameter);
        let reach = along / splat(simd, CORE * self.diameter);
        let core = radius * (one - reach).max(zero);
        let side = core * splat(simd, SIDE);
        let rest = (radius * radius - core * core) * splat(simd, 0.5);
        let spread = reach.max(one);
        let width = (rest + rest) / (side + (side * side + rest).sqrt()) * spread;
        let beyond = (away - core).max(zero) / width.max(splat(simd, f32::MIN_POSITIVE));
        let exponent: [f32; LANES] = (-(beyond * beyond)).into();
        let mut part = [0.0; LANES];
        for lane in 0..LANES {
            part[lane] = libm::expf(exponent[lane]);
        }
        f32x8::simd_from(simd, part) * splat(simd, self.speed) / spread
    }

    /// Speed towards the outlet over the distance from it, 1/s: a sink that takes in what the jet blows out, from one side.
    #[inline(always)]
    fn drawn<S: Simd>(&self, simd: S, to: Vec3x8<S>) -> f32x8<S> {
        let square = splat(simd, 0.25 * self.diameter * self.diameter);
        let away = to.dot(to);
        splat(simd, self.speed) * square / ((away + away + square) * away.sqrt().max(splat(simd, f32::MIN_POSITIVE)))
    }

    /// Where something stands on the straight way of the air from the outlet, `start` from its middle, to `point`. What the
    /// fan itself stands in shadows nothing.
    #[inline(always)]
    fn shadowed<S: Simd>(&self, simd: S, point: Vec3x8<S>, start: Vec3x8<S>, wanted: mask32x8<S>) -> mask32x8<S> {
        let start = start + Vec3x8::splat(simd, self.origin);
        let mut found = !wanted;
        for (shape, frame) in &self.shadows {
            if found.all_true() {
                break;
            }
            let (from, to) = (frame.inverse_point(simd, start), frame.inverse_point(simd, point));
            found |= segment::enters(simd, shape, from, to);
        }
        found
    }
}
