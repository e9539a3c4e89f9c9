//! The shape of a flame's foot: how much of the cloth around a burning particle it heats.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::Vec3;

use super::{Flammability, Surroundings};
use crate::lanes::{Vec3x8, splat};

/// Speed at which the hot gas of a flame rises in still air, m/s: √(g L) of a flame of a tenth of a metre. The wind adds to it.
const BUOYANT_SPEED: f32 = 1.0;

/// Two half ellipsoids on a burning particle: along the stream of hot gas, and against it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flame {
    /// Where the hot gas goes, of unit length; zero without wind and gravity, then the flame is a ball.
    axis: Vec3,
    /// Its half axes, m, and one over them.
    up: f32,
    across: f32,
    down: f32,
    per_up: f32,
    per_across: f32,
    per_down: f32,
    /// The corners of a box around it, relative to the particle, m.
    pub low: Vec3,
    pub high: Vec3,
}

impl Flame {
    pub fn new(fabric: &Flammability, surroundings: &Surroundings) -> Self {
        let stream = surroundings.up.normalize_or_zero() * BUOYANT_SPEED + surroundings.wind;
        let axis = stream.normalize_or_zero();
        let Flammability { reach_up: up, reach_across: across, reach_down: down, .. } = *fabric;
        let [per_up, per_across, per_down] = [up, across, down].map(f32::recip);
        let extent =
            |length: f32| (axis * axis * length * length + (1.0 - axis * axis) * across * across).map(f32::sqrt);
        // Each half is widest towards its own side, and towards the other no wider than where the two meet.
        let low = -Vec3::select(axis.cmple(Vec3::ZERO), extent(up), extent(down));
        let high = Vec3::select(axis.cmpge(Vec3::ZERO), extent(up), extent(down));
        Self { axis, up, across, down, per_up, per_across, per_down, low, high }
    }

    /// How far `offset` goes along the axis, and the square of how far across it.
    fn split(&self, offset: Vec3) -> (f32, f32) {
        let along = offset.dot(self.axis);
        (along, (offset.length_squared() - along * along).max(0.0))
    }

    /// The square of the distance `along` and (squared) `across` in distances to its surface: below 1 within.
    fn depth(&self, along: f32, across: f32) -> f32 {
        let scaled = along * if along > 0.0 { self.per_up } else { self.per_down };
        scaled * scaled + across * self.per_across * self.per_across
    }

    /// Which part of the cell of a neighbour at `offset` (m) it heats, 0..=1. The front of the fire crosses the edge at the
    /// speed of the fabric, however long the edge is.
    pub fn on_neighbour(&self, offset: Vec3) -> f32 {
        let (along, across) = self.split(offset);
        1.0 / self.depth(along, across).max(1.0).sqrt()
    }

    /// Which part of each of eight cells of the widths `cloth` (m) at `offset` it heats, 0..=1. The cell under the flame burns
    /// up to its border, half a width nearer, and the one at `offset` begins half a width before `offset`; what lies
    /// between the two and the flame's surface is heated. In a row of cells that adds up to the flame's reach, however
    /// wide they are. 0 where a place or width is not a number.
    #[inline(always)]
    pub fn on_cells<S: Simd>(&self, simd: S, offset: Vec3x8<S>, cloth: f32x8<S>) -> f32x8<S> {
        let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
        let along = offset.dot(Vec3x8::splat(simd, self.axis));
        let square = offset.dot(offset);
        let across = (square - along * along).max(zero);
        let scaled = along * along.simd_gt(zero).select(splat(simd, self.per_up), splat(simd, self.per_down));
        let depth = scaled * scaled + across * splat(simd, self.per_across * self.per_across);
        let beyond = (square.sqrt() / cloth).max(one) * (one - one / depth.max(one).sqrt());
        let part = one - beyond;
        part.simd_gt(zero).select(part, zero)
    }

    /// Its longest reach, m.
    pub fn longest(&self) -> f32 {
        self.up.max(self.across).max(self.down)
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;

    use super::*;
    use crate::lanes::LEVEL;

    /// How far the surface is in the direction of `offset`, in lengths of `offset`.
    fn surface(flame: &Flame, offset: Vec3) -> f32 {
        let (along, across) = flame.split(offset);
        1.0 / flame.depth(along, across).sqrt()
    }

    /// Which part of a cell of the width `cloth` at `offset` the flame heats.
    fn on_cell(flame: &Flame, offset: Vec3, cloth: f32) -> f32 {
        dispatch!(*LEVEL, simd => flame.on_cells(simd, Vec3x8::splat(simd, offset), splat(simd, cloth))[0])
    }

    fn flame(wind: Vec3) -> Flame {
        Flame::new(&Flammability::COTTON, &Surroundings { wind, ..Surroundings::default() })
    }

    #[test]
    fn a_flame_reaches_as_far_as_the_fabric_says_up_across_and_down() {
        let flame = flame(Vec3::ZERO);
        for (direction, reach) in [(Vec3::Y, 0.12), (Vec3::X, 0.0146), (Vec3::Z, 0.0146), (Vec3::NEG_Y, 0.0027)] {
            assert!((surface(&flame, direction) / reach - 1.0).abs() < 1e-5, "{direction}");
            assert_eq!(flame.on_neighbour(direction * reach * 0.99), 1.0);
            assert!((flame.on_neighbour(direction * reach * 4.0) - 0.25).abs() < 1e-5);
        }
    }

    #[test]
    fn what_a_row_of_cells_gets_adds_up_to_the_reach_however_wide_they_are() {
        let flame = flame(Vec3::ZERO);
        for (direction, reach) in [(Vec3::Y, 0.12), (Vec3::X, 0.0146), (Vec3::NEG_Y, 0.0027)] {
            for cell in [0.001, 0.0037, 0.01, 0.016, 0.05, 0.3] {
                let first = flame.on_neighbour(direction * cell);
                let rest: f32 = (2..400).map(|k| on_cell(&flame, direction * cell * k as f32, cell)).sum();
                assert!(((first + rest) * cell / reach - 1.0).abs() < 1e-3, "{direction} {cell}");
            }
        }
    }

    #[test]
    fn wind_lays_the_flame_down_and_without_wind_and_gravity_it_is_a_ball() {
        let tilted = flame(Vec3::X);
        assert!((surface(&tilted, Vec3::new(1.0, 1.0, 0.0)) * core::f32::consts::SQRT_2 / 0.12 - 1.0).abs() < 1e-4);
        assert!(surface(&tilted, Vec3::X) > 1.3 * surface(&tilted, Vec3::NEG_X));
        let still = Surroundings { up: Vec3::ZERO, ..Surroundings::default() };
        let ball = Flame::new(&Flammability::COTTON, &still);
        assert_eq!(surface(&ball, Vec3::Y), surface(&ball, Vec3::NEG_X));
    }

    #[test]
    fn nothing_outside_the_bounds_is_heated() {
        for wind in [Vec3::ZERO, Vec3::new(3.0, -2.0, 0.5), Vec3::new(0.0, -5.0, 0.0), Vec3::new(-0.3, 0.0, 1.0)] {
            let flame = flame(wind);
            let (low, high) = (flame.low - 0.02, flame.high + 0.02);
            for i in 0..40 * 40 * 40 {
                let offset = Vec3::new((i % 40) as f32, (i / 40 % 40) as f32, (i / 1600) as f32) * 0.008 - 0.156;
                let outside = offset.cmplt(low).any() || offset.cmpgt(high).any();
                assert!(!outside || on_cell(&flame, offset, 0.02) == 0.0, "{offset} in the wind {wind}");
            }
        }
    }
}
