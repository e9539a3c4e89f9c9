//! The forces of the constraints' energies, for methods that step forces: `−∇E` of what
//! [`elastic_energy`](crate::measure::elastic_energy) sums up.

use glam::Vec3;

use super::grid::GridConstraints;
use super::removed::Along;
use crate::topology::hinge_angle;
use crate::{Fabric, Grid, Soa3, Topology};

/// Force on each slot of a rectangle, N, added to `force`.
pub(super) fn of_grid(constraints: &GridConstraints, position: &Soa3, force: &mut Soa3) {
    let (grid, fabric) = (constraints.grid, &constraints.fabric);
    let (a, b, stride) = (grid.spacing.x, grid.spacing.y, grid.stride as usize);
    let (columns, rows) = (grid.columns as usize, grid.rows as usize);
    for row in 0..rows {
        let run = Run { first: row * stride, step: 1, count: columns, spacing: a };
        let gone = |k| constraints.is_gone(Along::Weft, row, columns, k);
        run.add(position, force, b * constraints.row_width[row], fabric.stretch_weft, fabric.bend_weft, gone);
    }
    for column in 0..columns {
        let run = Run { first: column, step: stride, count: rows, spacing: b };
        let gone = |k| constraints.is_gone(Along::Warp, column, rows, k);
        run.add(position, force, a * constraints.column_width[column], fabric.stretch_warp, fabric.bend_warp, gone);
    }
    let twist = 0.5 * (fabric.bend_warp + fabric.bend_weft);
    if fabric.shear > 0.0 || twist > 0.0 {
        for row in 0..rows - 1 {
            for at in row * stride..row * stride + columns - 1 {
                cell(position, force, &grid, [at, at + 1, at + stride, at + stride + 1], fabric.shear, twist);
            }
        }
    }
}

/// One row or column.
struct Run {
    first: usize,
    step: usize,
    count: usize,
    spacing: f32,
}

impl Run {
    /// Stretch and bending of a run that stands for `width` metres of fabric, but for its links that are `gone`.
    fn add(
        &self,
        position: &Soa3,
        force: &mut Soa3,
        width: f32,
        stretch: f32,
        bend: f32,
        gone: impl Fn(usize) -> bool,
    ) {
        let (per_strain, l) = (stretch * width / self.spacing, self.spacing);
        let per_curl = bend * width / (l * l * l);
        let (mut last, mut last_gone) = (Vec3::ZERO, true);
        for k in 0..self.count - 1 {
            let this_gone = gone(k);
            let bends = bend > 0.0 && !last_gone && !this_gone;
            last_gone = this_gone;
            if this_gone {
                continue;
            }
            let at = self.first + k * self.step;
            let next = at + self.step;
            let edge = position.get(next) - position.get(at);
            let length = edge.length();
            let pull = if length > 0.0 { edge * (per_strain * (1.0 - l / length)) } else { Vec3::ZERO };
            let mut here = pull;
            if bends {
                let curl = (edge - last) * per_curl;
                force.set(at - self.step, force.get(at - self.step) - curl);
                here += 2.0 * curl;
                force.set(next, force.get(next) - curl - pull);
            } else {
                force.set(next, force.get(next) - pull);
            }
            force.set(at, force.get(at) + here);
            last = edge;
        }
    }
}

/// Shear and twist of a cell with the corners p00, p10, p01, p11.
fn cell(position: &Soa3, force: &mut Soa3, grid: &Grid, corners: [usize; 4], shear: f32, twist: f32) {
    let [p00, p10, p01, p11] = corners.map(|i| position.get(i));
    let (e, f) = (p11 - p00, p10 - p01);
    let area = grid.spacing.x * grid.spacing.y;
    let (per_a, per_b) = (0.5 / grid.spacing.x, 0.5 / grid.spacing.y);
    let (u, v) = ((e + f) * per_a, (e - f) * per_b);
    let (p, q) = (v * per_a, u * per_b);
    let stress = shear * area * u.dot(v);
    let (g11, g10) = ((p + q) * stress, (p - q) * stress);
    let turn = (p00 + p11 - p10 - p01) * (2.0 * twist / area);
    for (slot, pull) in corners.into_iter().zip([g11 - turn, turn - g10, g10 + turn, -g11 - turn]) {
        force.set(slot, force.get(slot) + pull);
    }
}

/// What the forces of a mesh that is no grid need.
#[derive(Clone, Debug)]
pub(super) struct MeshForces {
    topology: Topology,
    fabric: Fabric,
    /// N·m per rad² of each hinge.
    hinge_stiffness: Vec<f32>,
}

impl MeshForces {
    pub fn new(topology: &Topology, fabric: &Fabric) -> Self {
        Self { topology: topology.clone(), fabric: *fabric, hinge_stiffness: topology.hinge_stiffness(fabric) }
    }

    /// Force on each slot, N, added to `force`.
    pub fn add(&self, position: &Soa3, force: &mut Soa3) {
        of_triangles(&self.topology, &self.fabric, position, force);
        for ((hinge, rest), stiffness) in
            self.topology.hinges.iter().zip(&self.topology.hinge_rest).zip(&self.hinge_stiffness)
        {
            bend(hinge.map(|slot| slot as usize), *rest, *stiffness, position, force);
        }
    }
}

fn of_triangles(topology: &Topology, fabric: &Fabric, position: &Soa3, force: &mut Soa3) {
    for (triangle, rest) in topology.triangles.iter().zip(&topology.triangle_rest) {
        let slots = triangle.map(|slot| slot as usize);
        let [p0, p1, p2] = slots.map(|slot| position.get(slot));
        let m = rest.inverse();
        let (e1, e2) = (p1 - p0, p2 - p0);
        let (u, v) = (e1 * m.x_axis.x + e2 * m.x_axis.y, e1 * m.y_axis.x + e2 * m.y_axis.y);
        let area = 0.5 * rest.determinant().abs();
        let along = |f: Vec3, stiffness: f32| f.normalize_or_zero() * (stiffness * (f.length() - 1.0));
        let shear = fabric.shear * u.dot(v);
        // The stress that acts on unit weft and warp threads, times the area.
        let on_u = (along(u, fabric.stretch_weft) + v * shear) * area;
        let on_v = (along(v, fabric.stretch_warp) + u * shear) * area;
        let (f1, f2) = (on_u * m.x_axis.x + on_v * m.y_axis.x, on_u * m.x_axis.y + on_v * m.y_axis.y);
        for (slot, pull) in slots.into_iter().zip([f1 + f2, -f1, -f2]) {
            force.set(slot, force.get(slot) + pull);
        }
    }
}

/// Bending of one hinge; gradients after Bridson, Marino, Fedkiw 2003.
fn bend(slots: [usize; 4], rest: f32, stiffness: f32, position: &Soa3, force: &mut Soa3) {
    use core::f32::consts::{PI, TAU};
    let [a, b, c, d] = slots.map(|slot| position.get(slot));
    let edge = b - a;
    let (n1, n2) = (edge.cross(c - a), (d - a).cross(edge));
    let (length, s1, s2) = (edge.length(), n1.length_squared(), n2.length_squared());
    if length <= 0.0 || s1 <= 0.0 || s2 <= 0.0 {
        return;
    }
    let turn = hinge_angle(a, b, c, d) - rest;
    let turn = if turn > PI {
        turn - TAU
    } else if turn < -PI {
        turn + TAU
    } else {
        turn
    };
    let moment = stiffness * turn;
    let (q1, q2) = (n1 / s1, n2 / s2);
    let gradient = [
        q1 * ((b - c).dot(edge) / length) + q2 * ((b - d).dot(edge) / length),
        q1 * ((c - a).dot(edge) / length) + q2 * ((d - a).dot(edge) / length),
        q1 * -length,
        q2 * -length,
    ];
    for (slot, gradient) in slots.into_iter().zip(gradient) {
        force.set(slot, force.get(slot) - gradient * moment);
    }
}
