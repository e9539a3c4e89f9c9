//! Fitting a sinusoid.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};

/// A sinusoid `c + A cos(2π t/T + φ)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sinusoid {
    /// Period T, s.
    pub period: f64,
    /// Amplitude A, in the unit of the samples.
    pub amplitude: f64,
    /// Offset c, in the unit of the samples.
    pub offset: f64,
}

/// The sinusoid nearest to `samples` taken every `dt` seconds, by least squares. Periods between four samples and twice
/// the whole time are looked at.
///
/// `None` with fewer than eight samples or with one that is not finite.
pub fn sinusoid(samples: &[f64], dt: f64) -> Option<Sinusoid> {
    if samples.len() < 8 || samples.iter().any(|sample| !sample.is_finite()) {
        return None;
    }
    let (low, high) = (TAU / (2.0 * dt * samples.len() as f64), TAU / (4.0 * dt));
    // The misfit has one valley per turn within the time: finer than that, then downhill.
    let count = 8 * samples.len();
    let at = |i: usize| low * (high / low).powf(i as f64 / count as f64);
    let misfit = |frequency: f64| linear(samples, dt, frequency).1;
    let best = (0..=count).min_by(|a, b| misfit(at(*a)).total_cmp(&misfit(at(*b))))?;
    let (mut from, mut to) = (at(best.saturating_sub(1)), at((best + 1).min(count)));
    for _ in 0..60 {
        let (a, b) = (from + (to - from) / 3.0, to - (to - from) / 3.0);
        if misfit(a) < misfit(b) { to = b } else { from = a }
    }
    let frequency = 0.5 * (from + to);
    let (parts, _) = linear(samples, dt, frequency);
    Some(Sinusoid { period: TAU / frequency, amplitude: parts.x.hypot(parts.y), offset: parts.z })
}

/// Parts of cosine, sine and constant, and the sum of squares that they leave.
fn linear(samples: &[f64], dt: f64, frequency: f64) -> (DVec3, f64) {
    let base = |i: usize| {
        let (sin, cos) = (frequency * dt * i as f64).sin_cos();
        DVec3::new(cos, sin, 1.0)
    };
    let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for (i, sample) in samples.iter().enumerate() {
        let b = base(i);
        matrix += DMat3::from_cols(b * b.x, b * b.y, b * b.z);
        right += b * *sample;
    }
    let parts = matrix.inverse() * right;
    let left = samples.iter().enumerate().map(|(i, sample)| (sample - parts.dot(base(i))).powi(2)).sum();
    (parts, if parts.is_finite() { left } else { f64::INFINITY })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sinusoid_is_found_again_from_less_than_two_turns_of_it() {
        let samples: Vec<f64> = (0..120).map(|i| 0.3 + 0.05 * (TAU * f64::from(i) / 60.0 / 1.67 + 0.4).cos()).collect();
        let found = sinusoid(&samples, 1.0 / 60.0).unwrap();
        assert!((found.period - 1.67).abs() < 1e-6, "{found:?}");
        assert!((found.amplitude - 0.05).abs() < 1e-7 && (found.offset - 0.3).abs() < 1e-7, "{found:?}");
    }

    #[test]
    fn what_is_not_finite_or_too_short_is_no_sinusoid() {
        assert_eq!(sinusoid(&[0.0; 7], 0.1), None);
        assert_eq!(sinusoid(&[0.0, 1.0, 0.0, f64::NAN, 0.0, 1.0, 0.0, 1.0, 0.0], 0.1), None);
    }
}
