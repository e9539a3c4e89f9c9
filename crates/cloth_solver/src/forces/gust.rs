//! Gusts: turbulence that the wind carries along.
//!
//! A sum of plane waves, each with its velocity at a right angle to the direction it runs along, so that no air is made or
//! lost anywhere (random Fourier modes, Kraichnan 1970). The pattern stands still in the air and passes by with the mean
//! wind (Taylor 1938). Waves come in threes at right angles to each other: so the root mean square is the same along every
//! axis, exactly and not only on average over many seeds.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::{DVec3, Quat, Vec3};
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

use crate::lanes::{Vec3x8, splat};
use crate::{ClothError, Pose};

/// Octaves of wavelengths: from the longest down to an eighth of it.
const OCTAVES: usize = 3;
/// Threes of waves in an octave.
const TRIADS: usize = 2;
/// Waves in all.
const WAVES: usize = 3 * OCTAVES * TRIADS;

/// How gusty the wind is.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component, bevy_reflect::Reflect))]
#[cfg_attr(feature = "ecs", reflect(Default))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gusts {
    /// Turbulence intensity: the root mean square of the velocity that gusts add along each axis, over the speed of the
    /// mean wind; 0..=2. Calm weather has 0.05, a town 0.15 to 0.3. Default 0: no gusts.
    pub intensity: f32,
    /// Wavelength of the largest eddies, m; 0.01..=10,000. The smallest are an eighth of it. Default 4.
    pub length: f32,
    /// The same seed gives the same gusts, on every machine. Default 0.
    pub seed: u64,
}

#[cfg(feature = "ecs")]
use bevy_reflect::prelude::ReflectDefault;

impl Default for Gusts {
    fn default() -> Self {
        Self { intensity: 0.0, length: 4.0, seed: 0 }
    }
}

impl Gusts {
    /// Checks every field against its range.
    ///
    /// # Errors
    /// The first field out of range.
    pub fn validate(&self) -> Result<(), ClothError> {
        ClothError::check("Gusts::intensity", self.intensity, 0.0..=2.0, "0..=2")?;
        ClothError::check("Gusts::length", self.length, 0.01..=1e4, "0.01..=10,000 m")
    }
}

/// A wind, the same everywhere but for the gusts that it carries along, as it goes by. World axes.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GustyWind {
    /// m/s.
    velocity: Vec3,
    /// How far the air has gone, m. In double precision, since it goes on for hours.
    carried: DVec3,
    turbulence: Option<Turbulence>,
}

impl GustyWind {
    /// Lets it blow at `velocity` (m/s) with `gusts`, valid ones, for `dt` seconds. Once a tick.
    pub fn advance(&mut self, velocity: Vec3, gusts: &Gusts, dt: f32) {
        self.velocity = velocity;
        self.carried += velocity.as_dvec3() * f64::from(dt);
        if gusts.intensity <= 0.0 {
            self.turbulence = None;
        } else if self.turbulence.as_ref().is_none_or(|turbulence| turbulence.gusts != *gusts) {
            self.turbulence = Some(Turbulence::new(gusts));
        }
    }

    /// As a cloth in `frame` sees it: what is the same everywhere, m/s, and the gusts.
    pub(super) fn seen_from(&self, frame: &Pose) -> (Vec3, Option<Eddies>) {
        let place = frame.position.as_dvec3() - self.carried;
        let eddies = self.turbulence.as_ref().map(|turbulence| {
            let rms = turbulence.gusts.intensity * self.velocity.length();
            turbulence.seen_from(place, frame.rotation.conjugate(), rms)
        });
        (frame.rotation.conjugate() * self.velocity, eddies)
    }
}

/// The pattern of [`Gusts`], in the axes of the world and the place of the air.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, PartialEq)]
struct Turbulence {
    /// What it was made for.
    gusts: Gusts,
    modes: [Mode; WAVES],
}

/// `velocity · cos 2π(wave·x + phase)`.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Mode {
    /// Direction over wavelength, 1/m.
    wave: DVec3,
    /// At a right angle to it; all together have unit root mean square along each axis.
    velocity: Vec3,
    /// Turns.
    phase: f64,
}

impl Turbulence {
    fn new(gusts: &Gusts) -> Self {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(gusts.seed);
        let mut modes = [Mode::default(); WAVES];
        // Energy of an octave of the inertial range, ∫ k^(−5/3) dk over it (Kolmogorov 1941), up to a factor.
        let energy = |octave: usize| libm::exp2(-2.0 / 3.0 * octave as f64);
        let total: f64 = (0..OCTAVES).map(energy).sum();
        for (triad, modes) in modes.chunks_exact_mut(3).enumerate() {
            let octave = triad / TRIADS;
            // A wave has half of its amplitude's square, and each axis one wave of every triad.
            let amplitude = libm::sqrt(2.0 / TRIADS as f64 * energy(octave) / total);
            let axes = random_axes(&mut random);
            for (i, mode) in modes.iter_mut().enumerate() {
                let per_metre = libm::exp2(octave as f64 + random.random::<f64>()) / f64::from(gusts.length);
                mode.wave = axes[i] * per_metre;
                mode.velocity = (axes[(i + 1) % 3] * amplitude).as_vec3();
                mode.phase = random.random();
            }
        }
        Self { gusts: *gusts, modes }
    }

    /// From `place` in the air, in axes that `back` turns those of the world to.
    fn seen_from(&self, place: DVec3, back: Quat, rms: f32) -> Eddies {
        let mut eddies = Eddies { waves: [Wave::default(); WAVES] };
        for (wave, mode) in eddies.waves.iter_mut().zip(&self.modes) {
            let turns = mode.wave.dot(place) + mode.phase;
            *wave = Wave {
                wave: back * mode.wave.as_vec3(),
                velocity: back * (mode.velocity * rms),
                phase: (turns - turns.floor()) as f32,
            };
        }
        eddies
    }
}

/// Three directions at right angles to each other, any as likely as any other.
fn random_axes(random: &mut Xoshiro256PlusPlus) -> [DVec3; 3] {
    loop {
        let mut in_cube = || DVec3::from_array(core::array::from_fn(|_| random.random_range(-1.0..1.0)));
        let (a, b): (DVec3, DVec3) = (in_cube(), in_cube());
        let across = a.cross(b);
        // Those outside of the ball would favour the corners of the cube; those near its middle have no direction.
        let fit = |v: DVec3| (0.01..1.0).contains(&v.length_squared());
        if fit(a) && fit(b) && across.length_squared() > 0.01 * a.length_squared() * b.length_squared() {
            let (first, third) = (a.normalize(), across.normalize());
            return [first, third.cross(first), third];
        }
    }
}

/// Gusts as one cloth sees them in one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Eddies {
    waves: [Wave; WAVES],
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Wave {
    /// Direction over wavelength, 1/m.
    wave: Vec3,
    /// m/s.
    velocity: Vec3,
    /// Turns.
    phase: f32,
}

impl Eddies {
    /// Velocity at eight points, m/s.
    #[inline(always)]
    pub fn at<S: Simd>(&self, simd: S, point: Vec3x8<S>) -> Vec3x8<S> {
        let mut sum = Vec3x8::splat(simd, Vec3::ZERO);
        for wave in &self.waves {
            let turns = point.dot(Vec3x8::splat(simd, wave.wave)) + splat(simd, wave.phase);
            sum = sum + Vec3x8::splat(simd, wave.velocity) * cosine(simd, turns);
        }
        sum
    }
}

/// `cos 2πt` within 1e-4 (Hastings, Approximations for Digital Computers, 1955, sheet 14). Any wave of one turn is as free
/// of divergence as any other.
#[inline(always)]
fn cosine<S: Simd>(simd: S, t: f32x8<S>) -> f32x8<S> {
    let quarter = splat(simd, 1.0) - (t - t.round_ties_even()).abs() * splat(simd, 4.0);
    let square = quarter * quarter;
    quarter * (splat(simd, 1.570_626_8) + square * (splat(simd, -0.643_229_2) + square * splat(simd, 0.072_710_2)))
}
