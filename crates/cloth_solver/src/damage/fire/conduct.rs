//! Heat that flows along the cloth.

use super::rings::Rings;
use crate::Topology;

/// The cotangent Laplacian of the cloth at rest, edge by edge (Pinkall and Polthier 1993).
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Laplacian {
    /// Half the sum of the cotangents of the angles opposite to each edge, in the order of [`Topology::edges`]. 0 where
    /// the two angles are wider than a straight one together: heat would flow from cold to hot.
    weight: Vec<f32>,
}

impl Laplacian {
    pub fn new(topology: &Topology, rings: &Rings) -> Self {
        let mut weight = vec![0.0; topology.edges.len()];
        for (triangle, rest) in topology.triangles.iter().zip(&topology.triangle_rest) {
            let place = [glam::Vec2::ZERO, rest.x_axis, rest.y_axis];
            for k in 0..3 {
                let [a, b] = [(k + 1) % 3, (k + 2) % 3];
                let (to_a, to_b) = (place[a] - place[k], place[b] - place[k]);
                if let Some(edge) = rings.edge(triangle[a], triangle[b]) {
                    weight[edge] += 0.5 * to_a.dot(to_b) / rest.determinant();
                }
            }
        }
        weight.iter_mut().for_each(|weight| *weight = weight.max(0.0));
        Self { weight }
    }

    /// Lets heat flow along the edges `range` at the conductance of the cloth times the time, κ t dt (J/K), between
    /// particles of the heat capacities `capacity` (J/K). Each edge brings its ends nearer to their common temperature
    /// and never past it: stable at any step, and no heat is lost or made.
    pub fn flow(
        &self,
        edges: &[[u32; 2]],
        range: core::ops::Range<usize>,
        conductance: f32,
        capacity: impl Fn(usize) -> f32,
        temperature: &mut [f32],
    ) {
        for (edge, weight) in edges[range.clone()].iter().zip(&self.weight[range]) {
            let [a, b] = edge.map(|slot| slot as usize);
            let difference = temperature[a] - temperature[b];
            if difference == 0.0 || *weight == 0.0 {
                continue;
            }
            let (of_a, of_b) = (capacity(a), capacity(b));
            let together = of_a * of_b / (of_a + of_b);
            let rate = weight * conductance / together;
            let heat = difference * together * rate / (1.0 + rate);
            temperature[a] -= heat / of_a;
            temperature[b] += heat / of_b;
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec2, Vec2};

    use super::*;
    use crate::topology::Resolution;

    fn strip() -> Topology {
        Topology::rectangle(Vec2::new(1.0, 0.1), Resolution::Cells(UVec2::new(40, 4))).unwrap()
    }

    /// Lets a wave of half a length fade over `seconds` in `steps`, with a diffusivity of 1 m²/s; what is left of it,
    /// and the heat at the start and at the end.
    fn faded(seconds: f32, steps: u32) -> (f32, [f32; 2]) {
        let topology = strip();
        let laplacian = Laplacian::new(&topology, &Rings::new(&topology));
        let wave = |slot: usize| (core::f32::consts::PI * (topology.rest[slot].x + 0.5)).cos();
        let mut temperature: Vec<f32> = (0..topology.slots()).map(wave).collect();
        let heat = |temperature: &[f32]| topology.area.iter().zip(temperature).map(|(a, t)| a * (t + 1.0)).sum::<f32>();
        let before = heat(&temperature);
        for _ in 0..steps {
            let edges = 0..topology.edges.len();
            laplacian.flow(
                &topology.edges,
                edges,
                seconds / steps as f32,
                |slot| topology.area[slot],
                &mut temperature,
            );
        }
        let project =
            |v: &dyn Fn(usize) -> f32| (0..topology.slots()).map(|i| topology.area[i] * v(i) * wave(i)).sum::<f32>();
        (project(&|i| temperature[i]) / project(&wave), [before, heat(&temperature)])
    }

    #[test]
    fn a_wave_of_temperature_fades_as_heat_diffuses() {
        let (left, _) = faded(0.05, 20_000);
        let expected = (-core::f32::consts::PI.powi(2) * 0.05).exp();
        assert!((left / expected - 1.0).abs() < 0.01, "{left}, not {expected}");
    }

    #[test]
    fn heat_is_kept_and_nothing_overshoots_at_any_step() {
        for seconds in [0.01, 1.0, 1e4] {
            let (left, [before, after]) = faded(seconds, 3);
            assert!((after / before - 1.0).abs() < 1e-5);
            assert!((0.0..1.0).contains(&left), "{left}");
        }
    }

    #[test]
    fn heat_does_not_flow_where_the_weight_would_be_negative() {
        let topology = strip();
        let laplacian = Laplacian::new(&topology, &Rings::new(&topology));
        assert!(laplacian.weight.iter().all(|weight| *weight >= 0.0));
        assert!(laplacian.weight.iter().any(|weight| (*weight - 1.0).abs() < 1e-4), "an inner edge of square cells");
    }
}
