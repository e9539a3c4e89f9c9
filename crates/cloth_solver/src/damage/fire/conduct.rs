//! Heat that flows along the cloth.

use crate::Topology;

/// The cotangent Laplacian of the cloth at rest, edge by edge (Pinkall and Polthier 1993).
#[derive(Clone, Debug, Default)]
pub(super) struct Laplacian {
    /// Half the sum of the cotangents of the angles opposite to each edge, in the order of [`Topology::edges`]. 0 where the
    /// two angles are wider than a straight one together: heat would flow from cold to hot.
    weight: Vec<f32>,
}

impl Laplacian {
    pub fn new(topology: &Topology) -> Self {
        let mut weight = vec![0.0; topology.edges.len()];
        for (triangle, rest) in topology.triangles.iter().zip(&topology.triangle_rest) {
            let place = [glam::Vec2::ZERO, rest.x_axis, rest.y_axis];
            for k in 0..3 {
                let [a, b] = [(k + 1) % 3, (k + 2) % 3];
                let (p, q) = (triangle[a].min(triangle[b]), triangle[a].max(triangle[b]));
                let (to_a, to_b) = (place[a] - place[k], place[b] - place[k]);
                if let Ok(edge) = topology.edges.binary_search(&[p, q]) {
                    weight[edge] += 0.5 * to_a.dot(to_b) / rest.determinant();
                }
            }
        }
        weight.iter_mut().for_each(|weight| *weight = weight.max(0.0));
        Self { weight }
    }

    /// Lets heat flow along the edges `range` at the conductance of the cloth times the time, κ t dt (J/K), between particles
    /// of the heat capacities `capacity` (J/K). Each edge brings its ends nearer to their common temperature and never
    /// past it: stable at any step, and no heat is lost or made.
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
