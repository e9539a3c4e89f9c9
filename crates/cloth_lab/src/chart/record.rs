//! What is kept of a run, and how two runs differ.

use glam::DVec3;

use super::case::{Case, Judged};
use super::fit::sinusoid;

/// Ticks at the end of a run over which rest is judged.
const LAST: usize = 30;
/// Part of all ticks in which the strain of cloth in wind is smaller than the one that is compared.
const MOSTLY: f64 = 0.95;
/// Part of a small swing, at its end, over which its amplitude is taken, s.
const LAST_SWING: f64 = 2.0;

/// What is kept of a run, after each tick.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// Largest strain.
    pub strain: Vec<f64>,
    /// Where the middle of the lower edge is across the sheet, m.
    pub tip: Vec<f64>,
    /// Kinetic, elastic and gravitational energy, J; the first entry is from before the first tick.
    pub energy: Vec<f64>,
    /// All positions at the end of the time that is compared, row by row, m.
    pub shape: Vec<DVec3>,
}

/// How a run differs from the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// Largest strain within the time that is compared.
    pub strain: f64,
    /// Largest strain of the whole run.
    pub strain_of_run: f64,
    /// Absolute difference of the largest strain: the most over the time that is compared.
    pub strain_error: f64,
    /// The same over the reference's strain.
    pub strain_relative: f64,
    /// Root mean square distance of the particles, mm.
    pub shape_rms: f64,
    /// Largest distance of a particle, mm.
    pub shape_max: f64,
    /// Energy left above rest over the reference's; swings only.
    pub energy_left: Option<f64>,
    /// Largest energy above rest over that at the start; swings only.
    pub energy_most: Option<f64>,
    /// Period over the reference's; small swings only.
    pub period: Option<f64>,
    /// Amplitude at the end over the reference's; small swings only.
    pub amplitude: Option<f64>,
}

impl Record {
    /// Largest strain: at rest that of the last half second, in motion that of the first `until` ticks, in wind the one that is
    /// passed in a twentieth of all ticks.
    pub fn strain_of(&self, case: &Case, until: usize) -> f64 {
        let count = self.strain.len();
        if case.judged == Judged::Wind {
            let mut sorted = self.strain.clone();
            sorted.sort_by(f64::total_cmp);
            return sorted.get((MOSTLY * count as f64) as usize).copied().unwrap_or(f64::NAN);
        }
        let compared =
            if case.judged == Judged::Rest { count.saturating_sub(LAST)..count } else { 0..until.min(count) };
        self.strain[compared].iter().copied().fold(0.0, f64::max)
    }

    /// How this run differs from `truth` over the first `until` ticks. `rest_energy` (J) is the energy at rest.
    pub fn against(&self, truth: &Self, case: &Case, until: usize, rest_energy: f64) -> Difference {
        let strain_error = if case.judged == Judged::Rest {
            let target = truth.strain_of(case, until);
            let last = &self.strain[self.strain.len().saturating_sub(LAST)..];
            last.iter().map(|strain| (strain - target).abs()).fold(0.0, f64::max)
        } else if case.judged == Judged::Wind {
            (self.strain_of(case, until) - truth.strain_of(case, until)).abs()
        } else {
            let pairs = self.strain.iter().zip(&truth.strain).take(until);
            pairs.map(|(strain, other)| (strain - other).abs()).fold(0.0, f64::max)
        };
        let apart = || self.shape.iter().zip(&truth.shape).map(|(a, b)| a.distance_squared(*b));
        let mut difference = Difference {
            strain: self.strain_of(case, until),
            strain_of_run: self.strain.iter().copied().fold(0.0, f64::max),
            strain_error,
            strain_relative: strain_error / truth.strain_of(case, until),
            shape_rms: 1e3 * (apart().sum::<f64>() / self.shape.len().max(1) as f64).sqrt(),
            shape_max: 1e3 * apart().fold(0.0, f64::max).sqrt(),
            ..Difference::default()
        };
        if case.judged.by_energy() {
            let above = |record: &Self| record.energy.last().map(|energy| energy - rest_energy);
            difference.energy_left = above(self).zip(above(truth)).map(|(of, other)| of / other);
            let start = self.energy.first().map(|energy| energy - rest_energy);
            let most = self.energy.iter().map(|energy| energy - rest_energy).fold(0.0, f64::max);
            difference.energy_most = start.map(|start| most / start);
        }
        if case.judged == Judged::Swing {
            let [of, other] = [self, truth].map(|record| record.swing(f64::from(case.scene.rate)));
            difference.period = of.zip(other).map(|(of, other)| of.0 / other.0);
            difference.amplitude = of.zip(other).map(|(of, other)| of.1 / other.1);
        }
        difference
    }

    /// Period, s, and amplitude at the end, m, of a small swing.
    pub fn swing(&self, rate: f64) -> Option<(f64, f64)> {
        let whole = sinusoid(&self.tip, 1.0 / rate)?;
        let last = &self.tip[self.tip.len().saturating_sub((LAST_SWING * rate) as usize)..];
        Some((whole.period, sinusoid(last, 1.0 / rate)?.amplitude))
    }
}

#[cfg(test)]
mod tests {
    use super::super::case::cases;
    use super::*;

    fn case(name: &str) -> Case {
        cases(4).into_iter().find(|case| case.name == name).unwrap()
    }

    #[test]
    fn rest_is_judged_at_the_end_and_motion_while_it_is_compared() {
        let truth = Record { strain: vec![0.01; 100], shape: vec![DVec3::ZERO; 2], ..Record::default() };
        let mut strain = vec![0.01; 100];
        strain[10] = 0.5;
        let run = Record { strain, shape: vec![DVec3::X * 3e-3, DVec3::ZERO], ..Record::default() };
        let rest = run.against(&truth, &case("top-hung"), 100, 0.0);
        assert_eq!((rest.strain_error, rest.strain_of_run), (0.0, 0.5));
        assert!((rest.shape_max - 3.0).abs() < 1e-9 && (rest.shape_rms - 3.0 / 2_f64.sqrt()).abs() < 1e-9);
        assert_eq!(run.against(&truth, &case("drape"), 10, 0.0).strain_error, 0.0);
        assert!((run.against(&truth, &case("drape"), 11, 0.0).strain_error - 0.49).abs() < 1e-12);
    }

    #[test]
    fn in_wind_the_strain_counts_that_is_passed_in_a_twentieth_of_all_ticks() {
        let record = |strain: Vec<f64>| Record { strain, shape: vec![DVec3::ZERO], ..Record::default() };
        let truth = record((0..100).map(|tick| f64::from((tick * 37) % 100)).collect());
        assert_eq!(truth.strain_of(&case("flag"), 1), 95.0);
        assert_eq!(record(vec![90.0; 100]).against(&truth, &case("flag"), 1, 0.0).strain_error, 5.0);
    }

    #[test]
    fn a_small_swing_is_told_by_its_period_and_by_the_amplitude_at_its_end() {
        let swing = |period: f64, fade: f64| Record {
            strain: vec![0.0; 300],
            tip: (0..300)
                .map(|i| f64::from(i) / 60.0)
                .map(|t| (std::f64::consts::TAU * t / period).cos() * (-fade * t).exp())
                .collect(),
            energy: vec![2.0, 1.5],
            ..Record::default()
        };
        let found = swing(1.7, 0.05).against(&swing(1.6, 0.0), &case("small-swing"), 300, 1.0);
        assert!((found.period.unwrap() - 1.7 / 1.6).abs() < 0.005, "{found:?}");
        assert!((found.amplitude.unwrap() - (-0.05_f64 * 4.0).exp()).abs() < 0.02, "{found:?}");
        assert_eq!((found.energy_left, found.energy_most), (Some(1.0), Some(1.0)));
    }
}
