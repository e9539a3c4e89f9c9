//! The shape of cloths at one moment, and how far two of them are apart.

use cloth_solver::Topology;
use glam::{DVec3, UVec2, Vec2, Vec3};

/// All cloths that are compared, at one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shape(pub Vec<Sheet>);

/// A rectangle of points, row by row from the upper left, in the world, m.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Points in a row (x) and in a column (y).
    pub points_across: UVec2,
    /// Where they are, m.
    pub points: Vec<Vec3>,
}

/// How far corresponding points of two shapes are apart, m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// Root of the mean square.
    pub rms: f64,
    /// The farthest pair.
    pub most: f64,
}

impl Difference {
    /// Of what has no shape any more.
    pub const INFINITE: Self = Self { rms: f64::INFINITY, most: f64::INFINITY };

    /// Of the worst of several moments.
    pub fn worst(all: impl IntoIterator<Item = Self>) -> Self {
        all.into_iter().fold(Self::default(), |a, b| Self { rms: a.rms.max(b.rms), most: a.most.max(b.most) })
    }
}

impl Shape {
    /// Adds the points of another moment of the same cloths, to find a mean.
    pub fn add(&mut self, other: &Self) {
        if self.0.is_empty() {
            *self = other.clone();
            return;
        }
        for (sum, sheet) in self.0.iter_mut().zip(&other.0) {
            sum.points.iter_mut().zip(&sheet.points).for_each(|(sum, point)| *sum += *point);
        }
    }

    /// Multiplies every point.
    pub fn scale(&mut self, factor: f32) {
        self.0.iter_mut().flat_map(|sheet| &mut sheet.points).for_each(|point| *point *= factor);
    }

    /// How far the material points of `self` are from where `other`, whose meshes may be coarser or finer, has them.
    pub fn difference(&self, other: &Self) -> Difference {
        let (mut squares, mut count, mut most) = (0.0, 0_usize, 0.0_f64);
        for (here, there) in self.0.iter().zip(&other.0) {
            let last = (here.points_across - 1).max(UVec2::ONE).as_vec2();
            let same_mesh = here.points_across == there.points_across;
            for (index, point) in here.points.iter().enumerate() {
                let (row, column) = (index as u32 / here.points_across.x, index as u32 % here.points_across.x);
                let part = Vec2::new(column as f32, row as f32) / last;
                let other = if same_mesh { there.points[index].as_dvec3() } else { there.at(part) };
                let square = point.as_dvec3().distance_squared(other);
                if !square.is_finite() {
                    return Difference::INFINITE;
                }
                (squares, count, most) = (squares + square, count + 1, most.max(square));
            }
        }
        Difference { rms: (squares / count.max(1) as f64).sqrt(), most: most.sqrt() }
    }
}

impl Sheet {
    /// The particles of a rectangle that is whole, row by row, each at `place` of its slot. `None` for any other cloth.
    pub fn of_grid(topology: &Topology, place: impl Fn(usize) -> Vec3) -> Option<Self> {
        let grid = topology.grid?;
        let points =
            (0..grid.rows).flat_map(|row| (0..grid.columns).map(move |column| grid.slot(row, column) as usize));
        Some(Self { points_across: UVec2::new(grid.columns, grid.rows), points: points.map(place).collect() })
    }

    /// All particles of a cloth of any form, in one row.
    pub fn of_particles(topology: &Topology, place: impl Fn(usize) -> Vec3) -> Self {
        let points: Vec<Vec3> = topology.particles().map(|slot| place(slot as usize)).collect();
        Self { points_across: UVec2::new(points.len() as u32, 1), points }
    }

    /// The material point at parts of width (from the left) and height (from the top), bilinear between its neighbours.
    pub fn at(&self, part: Vec2) -> DVec3 {
        let last = self.points_across - 1;
        let place = (part.as_dvec2() * last.as_dvec2()).clamp(glam::DVec2::ZERO, last.as_dvec2());
        let corner = place.floor().as_uvec2().min(last.saturating_sub(UVec2::ONE));
        let within = place - corner.as_dvec2();
        let point = |x: u32, y: u32| {
            let (x, y) = ((corner.x + x).min(last.x), (corner.y + y).min(last.y));
            self.points[(y * self.points_across.x + x) as usize].as_dvec3()
        };
        let upper = point(0, 0).lerp(point(1, 0), within.x);
        upper.lerp(point(0, 1).lerp(point(1, 1), within.x), within.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A saddle, which is bilinear in its parts.
    fn saddle(across: u32, down: u32, lift: f32) -> Shape {
        let part = |i: u32, n: u32| i as f32 / (n - 1) as f32;
        let points = (0..down).flat_map(|y| {
            (0..across).map(move |x| {
                let (u, v) = (part(x, across), part(y, down));
                Vec3::new(u, v, u * v + lift)
            })
        });
        Shape(vec![Sheet { points_across: UVec2::new(across, down), points: points.collect() }])
    }

    #[test]
    fn the_same_shape_on_a_coarser_mesh_is_no_other_shape() {
        let (fine, coarse) = (saddle(17, 9, 0.0), saddle(3, 2, 0.0));
        assert!(fine.difference(&coarse).most < 1e-6);
        assert!(coarse.difference(&fine).most < 1e-6);
    }

    #[test]
    fn a_shape_that_is_lifted_differs_by_its_lift_everywhere() {
        let difference = saddle(9, 9, 0.0).difference(&saddle(5, 3, 0.25));
        assert!((difference.rms - 0.25).abs() < 1e-6 && (difference.most - 0.25).abs() < 1e-6, "{difference:?}");
    }

    #[test]
    fn one_point_that_strays_shows_in_the_farthest_and_hardly_in_the_mean() {
        let here = saddle(10, 10, 0.0);
        let mut there = here.clone();
        there.0[0].points[37].z += 1.0;
        let difference = here.difference(&there);
        assert!((difference.most - 1.0).abs() < 1e-6 && (difference.rms - 0.1).abs() < 1e-6, "{difference:?}");
    }

    #[test]
    fn a_number_that_is_none_is_infinitely_far_away() {
        let mut there = saddle(4, 4, 0.0);
        there.0[0].points[5].x = f32::NAN;
        assert_eq!(saddle(4, 4, 0.0).difference(&there), Difference::INFINITE);
    }
}
