//! The highest frequency of a sheet.

use glam::DVec3;

use super::Sheet;

/// Iterations of the power method: enough for a fraction of a percent on meshes of the lab's sizes.
const ITERATIONS: usize = 400;

/// The highest angular frequency ω of small motions about `x`, rad/s, by power iteration (von Mises & Pollaczek-Geiringer
/// 1929) on the difference quotient of the forces. Explicit methods need steps below 2/ω (RK4: 2.83/ω).
pub fn highest_frequency(sheet: &Sheet, x: &[DVec3]) -> f64 {
    let free = |i: usize| if sheet.pinned[i] { 0.0 } else { 1.0 / sheet.mass[i].sqrt() };
    // Alternating along and across, which is what the highest mode looks like, and a little of everything else.
    let mut mode: Vec<DVec3> = (0..x.len())
        .map(|i| {
            let sign = if (i / sheet.columns + i % sheet.columns).is_multiple_of(2) { 1.0 } else { -1.0 };
            DVec3::new(sign, sign, 0.3) + DVec3::splat(0.1 * (i as f64 * 0.7).sin())
        })
        .collect();
    let (mut there, mut back) = (vec![DVec3::ZERO; x.len()], vec![DVec3::ZERO; x.len()]);
    let small = 1e-6 * sheet.spacing.min_element();
    let mut square: f64 = 0.0;
    for _ in 0..ITERATIONS {
        let moved: Vec<DVec3> = mode.iter().enumerate().map(|(i, mode)| *mode * free(i)).collect();
        let largest = moved.iter().map(|m| m.length()).fold(0.0, f64::max);
        if largest <= 0.0 {
            return 0.0;
        }
        let step = small / largest;
        let at = |sign: f64| -> Vec<DVec3> { x.iter().zip(&moved).map(|(x, m)| *x + *m * (sign * step)).collect() };
        sheet.forces(&at(1.0), &mut there);
        sheet.forces(&at(-1.0), &mut back);
        let next: Vec<DVec3> = (0..x.len()).map(|i| (back[i] - there[i]) * (free(i) / (2.0 * step))).collect();
        let (dot, norm) = (mode.iter().zip(&next))
            .fold((0.0, 0.0), |(dot, norm), (a, b)| (dot + a.dot(*b), norm + a.length_squared()));
        square = dot / norm;
        let length = next.iter().map(|v| v.length_squared()).sum::<f64>().sqrt();
        mode = next.into_iter().map(|v| v / length.max(f64::MIN_POSITIVE)).collect();
    }
    square.max(0.0).sqrt()
}
