//! Energies, forces and stiffness of the reference.

use glam::{DMat3, DVec3};

use super::Sheet;

/// Part of the weft edge and of the warp edge of a cell in each of its corners, over their rest lengths.
const WEFT: [f64; 4] = [-0.5, 0.5, -0.5, 0.5];
const WARP: [f64; 4] = [-0.5, -0.5, 0.5, 0.5];

impl Sheet {
    /// Elastic energy, J.
    pub fn elastic_energy(&self, x: &[DVec3]) -> f64 {
        let stretch: f64 = (self.links.iter())
            .map(|link| 0.5 * link.stiffness * (x[link.ends[0]].distance(x[link.ends[1]]) - link.length).powi(2))
            .sum();
        let bend: f64 = (self.bends.iter())
            .map(|bend| {
                0.5 * bend.stiffness * (0..4).map(|i| x[bend.at[i]] * bend.weight[i]).sum::<DVec3>().length_squared()
            })
            .sum();
        let shear: f64 = (self.cells())
            .map(|cell| {
                let (weft, warp) = self.threads(x, cell);
                0.5 * self.shear * weft.dot(warp).powi(2)
            })
            .sum();
        stretch + bend + shear
    }

    /// Elastic energy and that of the weight, J.
    pub fn potential_energy(&self, x: &[DVec3]) -> f64 {
        self.elastic_energy(x) - x.iter().zip(&self.mass).map(|(x, mass)| mass * self.gravity.dot(*x)).sum::<f64>()
    }

    /// Elastic forces and weight on every particle, N, in place of what `force` held.
    pub fn forces(&self, x: &[DVec3], force: &mut [DVec3]) {
        for (force, mass) in force.iter_mut().zip(&self.mass) {
            *force = self.gravity * *mass;
        }
        for link in &self.links {
            let [a, b] = link.ends;
            let edge = x[b] - x[a];
            let pull = edge * (link.stiffness * (1.0 - link.length / edge.length()));
            force[a] += pull;
            force[b] -= pull;
        }
        for bend in &self.bends {
            let [a, b, c, d] = bend.at;
            let [i, j, k, l] = bend.weight;
            let pull = (x[a] * i + x[b] * j + x[c] * k + x[d] * l) * bend.stiffness;
            force[a] -= pull * i;
            force[b] -= pull * j;
            force[c] -= pull * k;
            force[d] -= pull * l;
        }
        for cell in self.cells() {
            let (weft, warp) = self.threads(x, cell);
            let push = self.shear * weft.dot(warp);
            let (along, down) = (warp * (push * 0.5 / self.spacing.x), weft * (push * 0.5 / self.spacing.y));
            force[cell[0]] += along + down;
            force[cell[1]] += down - along;
            force[cell[2]] += along - down;
            force[cell[3]] -= along + down;
        }
    }

    /// Adds the force of the air on every triangle, N.
    pub fn blow(&self, x: &[DVec3], v: &[DVec3], force: &mut [DVec3]) {
        let Some(wind) = &self.wind else { return };
        let [density, normal, tangent, porosity] =
            [wind.air.density, wind.air.normal, wind.air.tangent, wind.air.porosity].map(f64::from);
        let third = 0.5 * density * (1.0 - porosity) * 0.5 * self.spacing.x * self.spacing.y / 3.0;
        for [a, b, c] in self.triangles() {
            let relative = wind.velocity - (v[a] + v[b] + v[c]) / 3.0;
            let facing = (x[b] - x[a]).cross(x[c] - x[a]).normalize_or_zero();
            let across = facing * facing.dot(relative);
            let pull = (across * normal + (relative - across) * tangent) * (third * relative.length());
            for corner in [a, b, c] {
                force[corner] += pull;
            }
        }
    }

    /// Calls `add(i, j, block)` with the 3×3 blocks of the stiffness matrix, the negative gradient of the forces. Without
    /// `exact`, what could make it indefinite is left out.
    pub(super) fn stiffness(&self, x: &[DVec3], exact: bool, mut add: impl FnMut(usize, usize, DMat3)) {
        for link in &self.links {
            let [a, b] = link.ends;
            let edge = x[b] - x[a];
            let length = edge.length();
            let along = outer(edge, edge) * (1.0 / (length * length));
            let taut = 1.0 - link.length / length;
            let across = if exact { taut } else { taut.max(0.0) };
            let block = (along + (DMat3::IDENTITY - along) * across) * link.stiffness;
            add(a, a, block);
            add(b, b, block);
            add(a, b, -block);
            add(b, a, -block);
        }
        for bend in &self.bends {
            for (i, wi) in bend.at.iter().zip(bend.weight).filter(|(_, w)| *w != 0.0) {
                for (j, wj) in bend.at.iter().zip(bend.weight).filter(|(_, w)| *w != 0.0) {
                    add(*i, *j, DMat3::from_diagonal(DVec3::splat(bend.stiffness * wi * wj)));
                }
            }
        }
        for cell in self.cells() {
            let (weft, warp) = self.threads(x, cell);
            let [p, q] = [WEFT.map(|part| part / self.spacing.x), WARP.map(|part| part / self.spacing.y)];
            let slope: [DVec3; 4] = std::array::from_fn(|i| warp * p[i] + weft * q[i]);
            let strain = if exact { weft.dot(warp) } else { 0.0 };
            for i in 0..4 {
                for j in 0..4 {
                    let bent = DMat3::from_diagonal(DVec3::splat(strain * (p[i] * q[j] + q[i] * p[j])));
                    add(cell[i], cell[j], (outer(slope[i], slope[j]) + bent) * self.shear);
                }
            }
        }
    }

    /// The corners of each cell: upper left, upper right, lower left, lower right.
    fn cells(&self) -> impl Iterator<Item = [usize; 4]> + use<> {
        let (columns, rows) = (self.columns, self.rows);
        (0..rows - 1)
            .flat_map(move |row| (0..columns - 1).map(move |column| row * columns + column))
            .map(move |a| [a, a + 1, a + columns, a + columns + 1])
    }

    /// Mean weft and warp edge of a cell over their rest lengths.
    fn threads(&self, x: &[DVec3], [a, b, c, d]: [usize; 4]) -> (DVec3, DVec3) {
        let (rise, fall) = (x[d] - x[a], x[b] - x[c]);
        ((rise + fall) * (0.5 / self.spacing.x), (rise - fall) * (0.5 / self.spacing.y))
    }
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}
