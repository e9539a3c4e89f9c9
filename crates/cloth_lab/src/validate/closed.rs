//! The known answers in closed form, or by integrating an ordinary differential equation.

use core::f64::consts::{PI, TAU};

/// Drop and reach of the tip over the length of a strip clamped level at one end, for `Γ = σ g L³/D` (the heavy elastica).
///
/// The slope θ obeys `θ'' = −Γ t cos θ` with t the arc length from the free end over L, `θ'(0) = 0`, `θ(1) = 0`. Shooting
/// from the free end with its slope as the unknown, bisected, Runge–Kutta of fourth order.
pub fn elastica(gamma: f64) -> (f64, f64) {
    let [drop, reach] = elastica_curve(gamma).last().copied().unwrap_or_default();
    (drop, reach)
}

/// Drop and reach over the length at equal distances along the strip, from the clamp to the tip.
pub fn elastica_curve(gamma: f64) -> Vec<[f64; 2]> {
    let (mut low, mut high) = (0.0, PI / 2.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if shoot(gamma, middle).0 > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    let (_, from_tip) = shoot(gamma, 0.5 * (low + high));
    let [drop, reach] = from_tip.last().copied().unwrap_or_default();
    from_tip.iter().rev().map(|[down, along]| [drop - down, reach - along]).collect()
}

/// Slope at the clamp for a slope at the free end; drop and reach of the strip against the free end.
fn shoot(gamma: f64, free: f64) -> (f64, Vec<[f64; 2]>) {
    const STEPS: u32 = 2000;
    let h = 1.0 / f64::from(STEPS);
    let rate = |t: f64, [angle, turn, ..]: [f64; 4]| [turn, -gamma * t * angle.cos(), angle.sin(), angle.cos()];
    let along = |y: [f64; 4], k: [f64; 4], s: f64| core::array::from_fn(|i| y[i] + s * k[i]);
    let mut y = [free, 0.0, 0.0, 0.0];
    let mut curve = vec![[0.0, 0.0]];
    for step in 0..STEPS {
        let t = f64::from(step) * h;
        let k1 = rate(t, y);
        let k2 = rate(t + 0.5 * h, along(y, k1, 0.5 * h));
        let k3 = rate(t + 0.5 * h, along(y, k2, 0.5 * h));
        let k4 = rate(t + h, along(y, k3, h));
        y = core::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        curve.push([y[2], y[3]]);
    }
    (y[0], curve)
}

/// Period of a pendulum let go at `amplitude` (rad) over that of small swings, `(2/π) K(sin(amplitude/2))`; the complete
/// elliptic integral by the arithmetic-geometric mean (Gauss).
pub fn pendulum(amplitude: f64) -> f64 {
    let (mut a, mut b) = (1.0, (amplitude / 2.0).cos());
    while (a - b).abs() > 1e-15 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    1.0 / a
}

/// Sag and horizontal force over the weight of an inextensible chain of length 1 between two points of equal height
/// `span` (0..1) apart.
pub fn catenary(span: f64) -> (f64, f64) {
    // 2 a sinh(span/2a) = 1 falls with a.
    let (mut low, mut high) = (1e-3, 1e3);
    for _ in 0..200 {
        let a = 0.5 * (low + high);
        if 2.0 * a * (span / (2.0 * a)).sinh() > 1.0 {
            low = a;
        } else {
            high = a;
        }
    }
    let a = 0.5 * (low + high);
    (a * ((span / (2.0 * a)).cosh() - 1.0), a)
}

/// Frequency of the mode of `across` × `down` half waves of a square membrane of `side` m under `tension` N/m with
/// `density` kg/m², divided into `cells` × `cells`, Hz. Of a continuous membrane with `cells` = ∞.
pub fn membrane(side: f64, tension: f64, density: f64, [across, down]: [u32; 2], cells: f64) -> f64 {
    let wave = |half_waves: u32| {
        let number = PI * f64::from(half_waves) / side;
        let spacing = side / cells;
        if spacing > 0.0 { 2.0 / spacing * (0.5 * number * spacing).sin() } else { number }
    };
    (tension / density).sqrt() * wave(across).hypot(wave(down)) / TAU
}

/// Zeros of the Bessel function J₀ (Abramowitz & Stegun, table 9.5).
pub const BESSEL_ZEROS: [f64; 3] = [2.404_825_557_695_773, 5.520_078_110_286_311, 8.653_727_912_911_013];

/// The Bessel function J₀ by its series; for |x| up to 20.
pub fn bessel(x: f64) -> f64 {
    let quarter = -0.25 * x * x;
    let mut term = 1.0;
    let mut sum = 1.0;
    for k in 1..80 {
        term *= quarter / f64::from(k * k);
        sum += term;
    }
    sum
}

/// Frequency of small swings of a chain or sheet of `length` m hung by its top, mode 0, 1 or 2 (Bernoulli 1733), Hz.
pub fn hanging(length: f64, gravity: f64, mode: usize) -> f64 {
    BESSEL_ZEROS[mode.min(2)] / (2.0 * TAU) * (gravity / length).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_elastica_has_the_published_droops() {
        let table = [(0.5, 0.06244), (1.0, 0.12456), (3.0, 0.36462), (8.0, 0.88433), (30.0, 2.5472), (100.0, 5.8881)];
        for (gamma, expected) in table {
            let (drop, reach) = elastica(gamma);
            assert!((drop / reach / expected - 1.0).abs() < 1e-4, "{} at {gamma}", drop / reach);
        }
    }

    #[test]
    fn at_the_bar_of_the_bending_test_the_chord_falls_by_forty_one_and_a_half_degrees() {
        let (drop, reach) = elastica(8.0);
        assert!((drop.atan2(reach).to_degrees() - 41.5).abs() < 0.05);
    }

    #[test]
    fn a_pendulum_slows_down_with_its_amplitude() {
        for (degrees, expected) in [(10.0_f64, 1.001_907), (45.0, 1.039_973), (90.0, 1.180_341), (150.0, 1.762_204)] {
            assert!((pendulum(degrees.to_radians()) - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn chains_sag_and_pull_as_the_catenary() {
        for (span, sag, pull) in [(0.5, 0.398_194, 0.11482), (0.8, 0.265_438, 0.33820), (0.9, 0.190_709, 0.56009)] {
            let found = catenary(span);
            assert!((found.0 - sag).abs() < 1e-5 && (found.1 - pull).abs() < 1e-5, "{found:?} at {span}");
        }
    }

    #[test]
    fn a_membrane_rings_lower_on_a_grid() {
        for (mode, whole, grid) in [([1, 1], 5.0, 4.99486), ([1, 2], 7.9057, 7.87810), ([2, 2], 10.0, 9.95893)] {
            assert!((membrane(1.0, 10.0, 0.2, mode, f64::INFINITY) - whole).abs() < 1e-4);
            assert!((membrane(1.0, 10.0, 0.2, mode, 20.0) - grid).abs() < 1e-4);
        }
    }

    #[test]
    fn a_hung_sheet_swings_at_the_zeros_of_the_bessel_function() {
        for (mode, expected) in [0.59939, 1.37585, 2.15689].into_iter().enumerate() {
            assert!((hanging(1.0, 9.81, mode) - expected).abs() < 1e-4);
            assert!(bessel(BESSEL_ZEROS[mode]).abs() < 1e-12);
        }
    }
}
