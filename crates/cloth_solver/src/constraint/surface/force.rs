//! The forces of the constraints' energies, for methods that step forces: `−∇E` of what
//! [`elastic_energy`](crate::measure::elastic_energy) sums up.

use glam::Vec3;

use crate::constraint::kernel::bending::Bending;
use crate::constraint::surface::grid::GridConstraints;
use crate::constraint::wear::Condition;
use crate::topology::{Along, Thread, hinge_angle, threads};
use crate::{Fabric, Grid, Soa3, Topology};

/// Force on each slot of a rectangle in `condition`, N, added to `force`.
pub(in crate::constraint) fn of_grid(
    constraints: &GridConstraints,
    condition: impl Condition,
    position: &Soa3,
    force: &mut Soa3,
) {
    let (grid, fabric) = (constraints.grid, &constraints.fabric);
    let twist = 0.5 * (fabric.bend_warp + fabric.bend_weft);
    let has_cells = fabric.shear > 0.0 || twist > 0.0;
    let cell = |corners: [usize; 4], force: &mut Soa3| {
        let left = condition.of_cell(corners);
        of_cell(position, force, &grid, corners, fabric.shear * left, twist * left);
    };
    if let Some(woven) = &constraints.woven {
        for (along, threads) in [(Along::Weft, &woven.weft), (Along::Warp, &woven.warp)] {
            for Thread { slots, width, .. } in threads {
                let run = Run::new(&grid, fabric, condition, along, slots.len());
                run.add(position, force, |k| slots[k] as usize, |k| width[k]);
            }
        }
        for corners in woven.cells.iter().filter(|_| has_cells) {
            cell(corners.map(|slot| slot as usize), force);
        }
        woven.loose.add(condition, position, force);
        return;
    }
    let (columns, rows, stride) = (grid.columns as usize, grid.rows as usize, grid.stride as usize);
    let weft = Run::new(&grid, fabric, condition, Along::Weft, columns);
    for row in 0..rows {
        let width = constraints.row_width[row];
        weft.add(position, force, |k| row * stride + k, |_| width);
    }
    let warp = Run::new(&grid, fabric, condition, Along::Warp, rows);
    for column in 0..columns {
        let width = constraints.column_width[column];
        warp.add(position, force, |k| k * stride + column, |_| width);
    }
    if has_cells {
        for row in 0..rows - 1 {
            for at in row * stride..row * stride + columns - 1 {
                cell([at, at + 1, at + stride, at + stride + 1], force);
            }
        }
    }
}

/// What the forces of a rectangle that was taken apart need.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(in crate::constraint) struct Woven {
    weft: Vec<Thread>,
    warp: Vec<Thread>,
    cells: Vec<[u32; 4]>,
    loose: MeshForces,
}

impl Woven {
    /// `None` if it was never taken apart.
    pub fn new(topology: &Topology, fabric: &Fabric) -> Option<Self> {
        let (grid, weave) = (topology.grid?, topology.weave.as_ref()?);
        Some(Self {
            weft: threads(topology, Along::Weft, |_| true),
            warp: threads(topology, Along::Warp, |_| true),
            cells: grid.cells().filter_map(|(row, column)| topology.cell(&grid, row, column)).collect(),
            loose: MeshForces::new(topology, weave.loose.clone(), fabric),
        })
    }
}

/// Stretch and bending of a row, a column or a thread.
struct Run<C> {
    condition: C,
    count: usize,
    spacing: f32,
    /// Of one spacing wide.
    per_strain: f32,
    per_curl: f32,
}

impl<C: Condition> Run<C> {
    fn new(grid: &Grid, fabric: &Fabric, condition: C, along: Along, count: usize) -> Self {
        let (a, b) = (grid.spacing.x, grid.spacing.y);
        let (l, across, stretch, bend) = match along {
            Along::Weft => (a, b, fabric.stretch_weft, fabric.bend_weft),
            Along::Warp => (b, a, fabric.stretch_warp, fabric.bend_warp),
        };
        Self { condition, count, spacing: l, per_strain: stretch * across / l, per_curl: bend * across / (l * l * l) }
    }

    /// Adds the forces on its particles `slot(k)`; its links are `width(k)` spacings wide.
    fn add(&self, position: &Soa3, force: &mut Soa3, slot: impl Fn(usize) -> usize, width: impl Fn(usize) -> f32) {
        let (mut last, mut last_left) = (Vec3::ZERO, 1.0);
        for k in 0..self.count - 1 {
            let (at, next) = (slot(k), slot(k + 1));
            let edge = position.get(next) - position.get(at);
            let length = edge.length();
            let (left, rest) = self.condition.of_link([at, next]);
            let (per_strain, rest) = (self.per_strain * width(k) * left, self.spacing * rest);
            let pull = if length > 0.0 { edge * (per_strain * (1.0 - rest / length)) } else { Vec3::ZERO };
            let mut here = pull;
            let mut there = -pull;
            if k > 0 && self.per_curl > 0.0 {
                let per_curl = self.per_curl * width(k).min(width(k - 1)) * f32::min(left, last_left);
                let curl = (edge - last) * per_curl;
                let before = slot(k - 1);
                force.set(before, force.get(before) - curl);
                here += 2.0 * curl;
                there -= curl;
            }
            force.set(at, force.get(at) + here);
            force.set(next, force.get(next) + there);
            (last, last_left) = (edge, left);
        }
    }
}

/// Shear and twist of a cell with the corners p00, p10, p01, p11.
fn of_cell(position: &Soa3, force: &mut Soa3, grid: &Grid, corners: [usize; 4], shear: f32, twist: f32) {
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

/// What the forces of a mesh that is no grid need, or those of loose triangles.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(in crate::constraint) struct MeshForces {
    topology: Topology,
    fabric: Fabric,
    triangles: Vec<u32>,
    /// Of a mesh that never was a grid.
    bending: Option<Bending>,
    /// Else those of its hinges with one of the triangles, and N·m per rad² of each.
    hinges: Vec<(u32, f32)>,
}

impl MeshForces {
    /// Of those triangles of `topology` that `which` names.
    pub fn new(topology: &Topology, which: Vec<u32>, fabric: &Fabric) -> Self {
        let mut named = vec![false; topology.triangles.len()];
        which.iter().for_each(|triangle| named[*triangle as usize] = true);
        let hinges = (topology.hinge_triangles.iter().enumerate())
            .filter(|(_, sharing)| topology.grid.is_some() && sharing.iter().any(|triangle| named[*triangle as usize]))
            .map(|(hinge, _)| (hinge as u32, topology.stiffness_of(hinge, fabric)));
        let bending = if topology.grid.is_none() { Bending::new(topology, fabric) } else { None };
        Self { hinges: hinges.collect(), bending, topology: topology.clone(), fabric: *fabric, triangles: which }
    }

    /// Force on each slot of cloth in `condition`, N, added to `force`.
    pub fn add(&self, condition: impl Condition, position: &Soa3, force: &mut Soa3) {
        let Self { topology, fabric, triangles, bending, hinges } = self;
        for triangle in triangles.iter().map(|triangle| *triangle as usize) {
            of_triangle(topology, fabric, condition, triangle, position, force);
        }
        if let Some(bending) = bending {
            bending.add_forces(position, force);
        }
        for (hinge, stiffness) in hinges {
            let (slots, rest) = (topology.hinges[*hinge as usize], topology.hinge_rest[*hinge as usize]);
            bend(slots.map(|slot| slot as usize), rest, *stiffness, position, force);
        }
    }
}

fn of_triangle(
    topology: &Topology,
    fabric: &Fabric,
    condition: impl Condition,
    triangle: usize,
    position: &Soa3,
    force: &mut Soa3,
) {
    let (compliance, length) = condition.of_triangle(topology.triangles[triangle]);
    let rest = topology.triangle_rest[triangle];
    let slots = topology.triangles[triangle].map(|slot| slot as usize);
    let [p0, p1, p2] = slots.map(|slot| position.get(slot));
    let m = rest.inverse();
    let (e1, e2) = (p1 - p0, p2 - p0);
    let (u, v) = (e1 * m.x_axis.x + e2 * m.x_axis.y, e1 * m.y_axis.x + e2 * m.y_axis.y);
    let area = 0.5 * rest.determinant().abs();
    let along = |f: Vec3, stiffness: f32| f.normalize_or_zero() * (stiffness * (f.length() - length));
    let shear = fabric.shear * u.dot(v);
    // The stress that acts on unit weft and warp threads, times the area.
    let area = area / compliance;
    let on_u = (along(u, fabric.stretch_weft) + v * shear) * area;
    let on_v = (along(v, fabric.stretch_warp) + u * shear) * area;
    let (f1, f2) = (on_u * m.x_axis.x + on_v * m.y_axis.x, on_u * m.x_axis.y + on_v * m.y_axis.y);
    for (slot, pull) in slots.into_iter().zip([f1 + f2, -f1, -f2]) {
        force.set(slot, force.get(slot) + pull);
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

#[cfg(test)]
mod tests {
    use glam::{UVec2, Vec2};

    use crate::constraint::{Constraints, Wear};
    use crate::method::Method;
    use crate::topology::{MeshSource, Resolution};
    use crate::{Cloth, Fabric, Soa3, Topology};

    /// A sheet pulled out of shape: as a rectangle, as one that is torn, as a mesh.
    fn sheets() -> [Cloth; 3] {
        let fabric = Fabric { shear: 0.0, ..Fabric::COTTON_POPLIN };
        let whole = Topology::rectangle(Vec2::ONE, Resolution::Cells(UVec2::splat(6))).expect("a rectangle");
        let positions: Vec<_> = whole.vertex_particle.iter().map(|slot| whole.rest[*slot as usize]).collect();
        let source = MeshSource { positions: &positions, indices: &whole.triangle_vertices.concat(), uvs: &[] };
        let mesh = Topology::from_mesh(source).expect("a mesh");
        let plain = Fabric { bend_warp: 0.0, bend_weft: 0.0, ..fabric };
        let mut sheets = [(whole.clone(), fabric), (whole, fabric), (mesh, plain)]
            .map(|(topology, fabric)| Cloth::new(topology.into(), &fabric).expect("a cloth"));
        sheets[1].remove_triangles(&[20, 21, 33]).expect("triangles");
        for sheet in &mut sheets {
            sheet.set_method(Method::SymplecticEuler);
        }
        sheets
    }

    fn forces(constraints: &Constraints, position: &Soa3) -> Soa3 {
        let mut force = Soa3::zeros(position.len());
        constraints.add_forces(position, &mut force);
        force
    }

    #[test]
    fn worn_cloth_pulls_as_new_cloth_of_its_stiffness_and_size_does() {
        let (stiffness, rest) = (0.4, 0.8);
        for mut sheet in sheets() {
            let slots = sheet.particles.slots();
            let bent = |i: usize, scale: f32| {
                let at = sheet.topology.rest[i];
                glam::Vec3::new(at.x * (1.1 + 0.1 * at.y), at.y * 1.05, at.x * at.x) * scale
            };
            let [new_shape, worn_shape] =
                [1.0, rest].map(|scale| Soa3::from_slice(&(0..slots).map(|i| bent(i, scale)).collect::<Vec<_>>()));
            let new = forces(&sheet.constraints, &new_shape);
            sheet.constraints.wear(Some(Wear { stiffness: &vec![stiffness; slots], rest: &vec![rest; slots] }));
            let worn = forces(&sheet.constraints, &worn_shape);
            let largest = (0..slots).map(|i| new.get(i).length()).fold(0.0, f32::max);
            assert!(largest > 1.0);
            for i in 0..slots {
                let difference = worn.get(i) - new.get(i) * (stiffness * rest);
                assert!(difference.length() < 1e-4 * largest, "{i}: {difference} of {largest}");
            }
            sheet.constraints.wear(None);
            assert_eq!(forces(&sheet.constraints, &new_shape), new);
        }
    }
}
