//! The shape of a flame's foot: how much of the cloth around a burning particle it heats.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::Vec3;

use super::{Flammability, Surroundings};
use crate::lanes::{Vec3x8, splat};

/// Two half ellipsoids on a burning particle: along the stream of hot gas, and against it.
///
/// The heat flux falls from that of the fabric at the particle to nothing at the surface, in proportion to the way. The
/// surface therefore lies at twice the preheat length, along which the full flux would heat as much.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flame {
    /// Where the hot gas goes, of unit length; zero without wind and gravity, then the flame is a ball.
    axis: Vec3,
    /// One over its half axes, 1/m.
    per_up: f32,
    per_across: f32,
    per_down: f32,
    /// Its longest half axis, m.
    pub longest: f32,
    /// The corners of a box around it, relative to the particle, m.
    pub low: Vec3,
    pub high: Vec3,
}

impl Flame {
    pub fn new(fabric: &Flammability, surroundings: &Surroundings) -> Self {
        let axis = surroundings.stream().normalize_or_zero();
        let [up, across, down] = [fabric.reach_up, fabric.reach_across, fabric.reach_down].map(|reach| 2.0 * reach);
        let extent = |length: f32| {
            let along = axis * axis;
            (along * length * length + (1.0 - along).max(Vec3::ZERO) * across * across).map(f32::sqrt)
        };
        // Each half is widest towards its own side, and towards the other no wider than where the two meet.
        let low = -Vec3::select(axis.cmple(Vec3::ZERO), extent(up), extent(down));
        let high = Vec3::select(axis.cmpge(Vec3::ZERO), extent(up), extent(down));
        let [per_up, per_across, per_down] = [up, across, down].map(f32::recip);
        Self { axis, per_up, per_across, per_down, longest: up.max(across).max(down), low, high }
    }

    /// Which part of the flux the cell between the particle and a neighbour at `offset` (m) gets, 0..=1: the mean over
    /// the way. The front of the fire crosses the edge at the speed of the fabric, however long the edge is.
    pub fn on_neighbour(&self, offset: Vec3) -> f32 {
        let along = offset.dot(self.axis);
        let across = (offset.length_squared() - along * along).max(0.0);
        let scaled = along * if along > 0.0 { self.per_up } else { self.per_down };
        let way = (scaled * scaled + across * self.per_across * self.per_across).sqrt();
        if way < 1.0 { 1.0 - 0.5 * way } else { 0.5 / way }
    }

    /// Which part of the flux each of eight cells of the widths `cloth` (m) at `offset` gets, 0..=1, and how far
    /// `offset` is on the way from the particle to the surface, 1 there.
    ///
    /// The cell under the flame burns up to its border, half a width nearer, and the one at `offset` begins half a
    /// width before `offset`: what it gets is the mean over its width that ends at `offset`. In a row of cells that
    /// adds up to the preheat length, however wide they are. 0 where a place or width is not a number.
    #[inline(always)]
    pub fn on_cells<S: Simd>(&self, simd: S, offset: Vec3x8<S>, cloth: f32x8<S>) -> [f32x8<S>; 2] {
        let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
        let along = offset.dot(Vec3x8::splat(simd, self.axis));
        let square = offset.dot(offset);
        let across = (square - along * along).max(zero);
        let scaled = along * along.simd_gt(zero).select(splat(simd, self.per_up), splat(simd, self.per_down));
        let way = (scaled * scaled + across * splat(simd, self.per_across * self.per_across)).sqrt();
        let width = way * (cloth / square.sqrt()).min(one);
        let within = one - (way - one).max(zero) / width.max(splat(simd, f32::MIN_POSITIVE));
        let part = within * (one - splat(simd, 0.5) * (way - width + way.min(one)));
        [(within.simd_gt(zero) & part.simd_gt(zero)).select(part, zero), way]
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;

    use super::*;
    use crate::lanes::LEVEL;

    /// Which part of the flux a cell of the width `cloth` at `offset` gets.
    fn on_cell(flame: &Flame, offset: Vec3, cloth: f32) -> f32 {
        dispatch!(*LEVEL, simd => flame.on_cells(simd, Vec3x8::splat(simd, offset), splat(simd, cloth))[0][0])
    }

    fn flame(wind: Vec3) -> Flame {
        Flame::new(&Flammability::COTTON, &Surroundings { wind, ..Surroundings::default() })
    }

    const WAYS: [(Vec3, f32); 4] = [(Vec3::Y, 0.12), (Vec3::X, 0.0146), (Vec3::Z, 0.0146), (Vec3::NEG_Y, 0.0027)];

    #[test]
    fn the_flux_falls_to_nothing_at_twice_the_preheat_length() {
        let flame = flame(Vec3::ZERO);
        for (direction, reach) in WAYS {
            let thin = 1e-3 * reach;
            for (way, part) in [(0.2, 0.9), (1.0, 0.5), (1.6, 0.2), (2.01, 0.0)] {
                let found = on_cell(&flame, direction * reach * way, thin);
                assert!((found - part).abs() < 2e-3, "{found}, not {part}, {way} preheat lengths along {direction}");
            }
            assert!((flame.on_neighbour(direction * reach * 4.0) - 0.25).abs() < 1e-5);
        }
        assert_eq!((on_cell(&flame, Vec3::ZERO, 0.01), flame.on_neighbour(Vec3::ZERO)), (1.0, 1.0));
    }

    #[test]
    fn what_a_row_of_cells_gets_adds_up_to_the_preheat_length_however_wide_they_are() {
        let flame = flame(Vec3::ZERO);
        for (direction, reach) in WAYS {
            for cell in [0.001, 0.0037, 0.01, 0.016, 0.05, 0.3] {
                let first = flame.on_neighbour(direction * cell);
                let rest: f32 = (2..400).map(|k| on_cell(&flame, direction * cell * k as f32, cell)).sum();
                assert!(((first + rest) * cell / reach - 1.0).abs() < 1e-3, "{direction} {cell}");
                let alike = on_cell(&flame, direction * cell, cell);
                assert!((first - alike).abs() < 1e-4, "{first} over an edge, {alike} over a cell as wide");
            }
        }
    }

    #[test]
    fn wind_lays_the_flame_down_and_without_wind_and_gravity_it_is_a_ball() {
        let far = |flame: &Flame, direction: Vec3| flame.on_neighbour(direction.normalize());
        let (upright, tilted) = (flame(Vec3::ZERO), flame(Vec3::X));
        assert!((far(&tilted, Vec3::new(1.0, 1.0, 0.0)) / far(&upright, Vec3::Y) - 1.0).abs() < 1e-4);
        assert!(far(&tilted, Vec3::X) > 1.3 * far(&tilted, Vec3::NEG_X));
        let still = Surroundings { up: Vec3::ZERO, ..Surroundings::default() };
        let ball = Flame::new(&Flammability::COTTON, &still);
        assert_eq!(far(&ball, Vec3::Y), far(&ball, Vec3::NEG_X));
    }

    #[test]
    fn nothing_outside_the_bounds_is_heated() {
        for wind in [Vec3::ZERO, Vec3::new(3.0, -2.0, 0.5), Vec3::new(0.0, -5.0, 0.0), Vec3::new(-0.3, 0.0, 1.0)] {
            let flame = flame(wind);
            let (low, high) = (flame.low - 0.02, flame.high + 0.02);
            for i in 0..40 * 40 * 40 {
                let offset = Vec3::new((i % 40) as f32, (i / 40 % 40) as f32, (i / 1600) as f32) * 0.014 - 0.273;
                let outside = offset.cmplt(low).any() || offset.cmpgt(high).any();
                assert!(!outside || on_cell(&flame, offset, 0.02) == 0.0, "{offset} in the wind {wind}");
            }
        }
    }
}
