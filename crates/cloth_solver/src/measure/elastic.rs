//! The energy a deformed cloth holds.

use glam::DVec3;

use super::{deformation, lines};
use crate::topology::{Along, Curvature, Quads, QuadsRest, curvatures, hinge_angle, normal, star};
use crate::{Fabric, Grid, Particles, Soa3, Topology};

/// Elastic energy of a cloth of `fabric` against its rest shape, J: stretch, shear and bending.
///
/// These are the energies whose forces the constraints apply, in the limit of a converged solve. Keep the two in step.
///
/// A rectangle, per edge, cell or line of particles:
/// - stretch: `½ Y (w/l) Δl²` per warp and weft edge; `w` the width of fabric it stands for, at the border half of that
///   inside;
/// - shear: `½ G A (u·v)²` per cell; `u`, `v` its mean weft and warp edge over their rest lengths;
/// - bending: `½ D (w/l) |t₂ − t₁|²` per inner particle of each row and column; `t` its edges over their rest length;
/// - twist: `D |x₀₀ + x₁₁ − x₁₀ − x₀₁|² / (l_x l_y)` per cell; `D` the mean of warp and weft.
///
/// A mesh with [`Topology::quads`], the same with the lengths and widths of each link and cell, each angle less the one at rest, and of
/// bends and twist what is in the surface at rest left out and what is across it less than at rest along the normal.
///
/// Any other mesh, and what of a rectangle was cut loose, per triangle or hinge:
/// - stretch and shear: `½ A (Y_u ε_u² + Y_v ε_v² + G (f_u·f_v)²)`; `f_u`, `f_v` what unit weft and warp threads have
///   become, `ε` their elongations;
/// - bending and twist of a mesh that never was a rectangle: `½ A (D_u κ_u² + D_v κ_v² + 2 D κ_uv²)`, κ the curvatures of the
///   paraboloid through the triangle's and its neighbours' corners, less those at rest;
/// - of what was cut loose from a rectangle: `½ (D b/s) (θ − θ₀)²`, see [`Topology::hinge_stiffness`].
pub fn elastic_energy(topology: &Topology, particles: &Particles, fabric: &Fabric) -> f64 {
    let positions = &particles.position;
    if let Some((quads, rest)) = topology.quads_at_rest() {
        return of_quads(&quads, &rest, positions, fabric);
    }
    let woven = topology
        .grid
        .map_or(0.0, |grid| threads(topology, positions, fabric) + cells(topology, grid, positions, fabric));
    let bent = if topology.grid.is_some() { hinges } else { curved };
    woven + triangles(topology, positions, fabric) + bent(topology, positions, fabric)
}

/// Position of a slot, m.
fn at(positions: &Soa3, slot: u32) -> DVec3 {
    positions.get(slot as usize).as_dvec3()
}

/// Stretch and bending of rows and columns, J.
fn threads(topology: &Topology, positions: &Soa3, fabric: &Fabric) -> f64 {
    let mut energy = 0.0;
    for line in lines(topology) {
        let (stretch, bend) = match line.along {
            Along::Weft => (fabric.stretch_weft, fabric.bend_weft),
            Along::Warp => (fabric.stretch_warp, fabric.bend_warp),
        };
        let (stretch, bend) = (f64::from(stretch), f64::from(bend));
        let mut last: Option<(DVec3, f64)> = None;
        for ([a, b], width) in line.links() {
            let edge = at(positions, b) - at(positions, a);
            let tangent = edge / line.spacing;
            let curl =
                last.map_or(0.0, |(last, narrower)| bend * (tangent - last).length_squared() * narrower.min(width));
            energy += 0.5 * (stretch * (edge.length() - line.spacing).powi(2) * width + curl) / line.spacing;
            last = Some((tangent, width));
        }
    }
    energy
}

/// Shear and twist of the whole cells of a rectangle, J.
fn cells(topology: &Topology, grid: Grid, positions: &Soa3, fabric: &Fabric) -> f64 {
    let spacing = grid.spacing.as_dvec2();
    let area = spacing.x * spacing.y;
    let shear = f64::from(fabric.shear);
    let bend = 0.5 * (f64::from(fabric.bend_warp) + f64::from(fabric.bend_weft));
    grid.cells()
        .filter_map(|(row, column)| topology.cell(&grid, row, column))
        .map(|corners| {
            let [x00, x10, x01, x11] = corners.map(|slot| at(positions, slot));
            let weft = 0.5 * ((x10 - x00) + (x11 - x01)) / spacing.x;
            let warp = 0.5 * ((x01 - x00) + (x11 - x10)) / spacing.y;
            let twist = (x00 + x11 - x10 - x01).length_squared();
            0.5 * shear * area * weft.dot(warp).powi(2) + bend * twist / area
        })
        .sum()
}

/// A mesh of quads, J.
fn of_quads(quads: &Quads, rest: &QuadsRest, positions: &Soa3, fabric: &Fabric) -> f64 {
    let along = [quads.along_rows(), quads.along_columns()];
    let [weft, warp] = [(fabric.stretch_weft, fabric.bend_weft), (fabric.stretch_warp, fabric.bend_warp)];
    let stiff = along.map(|along| if along == Along::Weft { weft } else { warp });
    let stiff = stiff.map(|(stretch, bend)| (f64::from(stretch), f64::from(bend)));
    let mut energy = 0.0;
    for (row, column) in (0..quads.grid.rows).flat_map(|row| (0..quads.grid.columns).map(move |column| (row, column))) {
        let slot = quads.grid.slot(row, column) as usize;
        let around = quads.neighbours(row, column);
        let places = around.map(|slot| slot.map(|slot| at(positions, slot)));
        let here = at(positions, slot as u32);
        let [a, b] = star(here, places);
        let normal = normal(a.cross(b), rest.stars[slot]);
        for along in 0..2 {
            let (stretch, bend) = stiff[along];
            let (before, after) = (2 * along, 2 * along + 1);
            let Some(next) = places[after] else { continue };
            let link = rest.links[along][slot];
            energy += 0.5 * stretch * link.y / link.x * (next.distance(here) - link.x).powi(2);
            let (Some(last), Some(slot_before)) = (places[before], around[before]) else { continue };
            let of = rest.bends[along][slot];
            let length = rest.links[along][slot_before as usize].x;
            let curl = (next - here) / link.x - (here - last) / length;
            let left = curl - a * of.skew.x - b * of.skew.y - normal * of.curl;
            energy += 0.5 * bend * of.shape * left.length_squared();
        }
    }
    let twist = 0.5 * (f64::from(fabric.bend_warp) + f64::from(fabric.bend_weft));
    let cells = quads.cells().map(|(row, column)| {
        let corners = quads.cell(row, column);
        let of = rest.cells[corners[0] as usize];
        let [x00, x10, x01, x11] = corners.map(|slot| at(positions, slot));
        let (e, f) = (x11 - x00, x10 - x01);
        let (u, v) = ((e + f) / (2.0 * of.size.x), (e - f) / (2.0 * of.size.y));
        let normal = normal(e.cross(f), 2.0 * of.area);
        let left = x00 + x11 - x10 - x01 - e * of.skew.x - f * of.skew.y - normal * of.twist;
        0.5 * f64::from(fabric.shear) * of.area * (u.dot(v) - of.shear).powi(2)
            + twist * left.length_squared() / of.area
    });
    energy + cells.sum::<f64>()
}

/// Stretch and shear of the triangles that belong to no rectangle, J.
fn triangles(topology: &Topology, positions: &Soa3, fabric: &Fabric) -> f64 {
    let [weft_stiffness, warp_stiffness, shear] =
        [fabric.stretch_weft, fabric.stretch_warp, fabric.shear].map(f64::from);
    topology
        .loose()
        .map(|triangle| {
            let index = triangle as usize;
            let [weft, warp] = deformation(topology, positions, index);
            let area = 0.5 * f64::from(topology.triangle_rest[index].determinant());
            let stretch =
                weft_stiffness * (weft.length() - 1.0).powi(2) + warp_stiffness * (warp.length() - 1.0).powi(2);
            0.5 * area * (stretch + shear * weft.dot(warp).powi(2))
        })
        .sum()
}

/// Bending of a mesh, J.
fn curved(topology: &Topology, positions: &Soa3, fabric: &Fabric) -> f64 {
    let energy = |curvature: Curvature| {
        let at = |slot| at(positions, slot);
        let now = curvature.at(at);
        let targets = curvature.targets(now, at, |slot| topology.rest[slot as usize].as_dvec3());
        let of = |i: usize| 0.5 * curvature.stiffness(fabric)[i] * (now[i] - targets[i]).length_squared();
        (0..3).map(of).sum::<f64>()
    };
    curvatures(topology).into_iter().map(energy).sum()
}

/// Bending of the hinges of those triangles, J.
fn hinges(topology: &Topology, positions: &Soa3, fabric: &Fabric) -> f64 {
    let mut is_loose = vec![false; topology.triangles.len()];
    topology.loose().for_each(|triangle| is_loose[triangle as usize] = true);
    (0..topology.hinges.len())
        .filter(|hinge| topology.hinge_triangles[*hinge].iter().any(|triangle| is_loose[*triangle as usize]))
        .map(|hinge| {
            let [a, b, c, d] = topology.hinges[hinge].map(|slot| positions.get(slot as usize));
            let angle = turn(hinge_angle(a, b, c, d) - topology.hinge_rest[hinge]);
            0.5 * f64::from(topology.stiffness_of(hinge, fabric)) * f64::from(angle).powi(2)
        })
        .sum()
}

/// The same turn within −π..=π: a hinge that swings through ±π has not gone all the way round.
fn turn(angle: f32) -> f32 {
    use core::f32::consts::{PI, TAU};
    if angle > PI {
        angle - TAU
    } else if angle < -PI {
        angle + TAU
    } else {
        angle
    }
}

#[cfg(test)]
mod tests {
    use glam::{Quat, UVec2, Vec2, Vec3};

    use super::*;
    use crate::topology::curvature::tests::irregular;
    use crate::topology::{MeshSource, Resolution};

    const SIZE: Vec2 = Vec2::new(1.2, 0.8);
    const AREA: f64 = 1.2 * 0.8;

    fn sheet(cells: u32) -> Topology {
        Topology::rectangle(SIZE, Resolution::Cells(UVec2::new(3 * cells, 2 * cells))).unwrap()
    }

    /// The same sheet without rows and columns.
    fn mesh(cells: u32) -> Topology {
        let sheet = sheet(cells);
        let grid = sheet.grid.unwrap();
        let positions: Vec<Vec3> = sheet.vertex_particle.iter().map(|p| sheet.rest[*p as usize]).collect();
        let vertex = |slot: u32| slot / grid.stride * grid.columns + slot % grid.stride;
        let indices: Vec<u32> = sheet.triangles.iter().flatten().map(|p| vertex(*p)).collect();
        Topology::from_mesh(MeshSource { positions: &positions, uvs: &[], indices: &indices }).unwrap()
    }

    fn energy(topology: &Topology, fabric: &Fabric, map: impl Fn(Vec3) -> Vec3) -> f64 {
        let mut particles = Particles::new(topology, 1.0);
        for i in 0..particles.slots() {
            let to = map(particles.position.get(i));
            particles.position.set(i, to);
        }
        elastic_energy(topology, &particles, fabric)
    }

    /// No stiffness but what a test asks for (stretch must not be 0, but may be as good as that).
    const LIMP: Fabric = Fabric {
        stretch_warp: 1e-9,
        stretch_weft: 1e-9,
        shear: 0.0,
        bend_warp: 0.0,
        bend_weft: 0.0,
        ..Fabric::COTTON_POPLIN
    };

    fn assert_close(value: f64, expected: f64, tolerance: f64) {
        assert!((value / expected - 1.0).abs() < tolerance, "{value} J, expected {expected} J");
    }

    #[test]
    fn turning_and_moving_a_cloth_costs_nothing() {
        let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.4, 1.1, -0.7);
        for topology in [sheet(3), mesh(3)] {
            let cost = energy(&topology, &Fabric::COTTON_POPLIN, |p| turn * p + Vec3::new(1.0, -2.0, 3.0));
            assert!(cost < 1e-8, "{cost} J");
        }
    }

    #[test]
    fn stretch_and_shear_cost_the_same_as_of_a_continuous_membrane() {
        let fabric = Fabric { stretch_warp: 300.0, stretch_weft: 70.0, shear: 40.0, ..LIMP };
        for topology in [sheet(3), mesh(3)] {
            let stretched = energy(&topology, &fabric, |p| p * Vec3::new(1.02, 1.05, 1.0));
            assert_close(stretched, 0.5 * AREA * (300.0 * 0.05_f64.powi(2) + 70.0 * 0.02_f64.powi(2)), 1e-4);
            let sheared = energy(&topology, &Fabric { shear: 40.0, ..LIMP }, |p| p + Vec3::X * 0.1 * p.y);
            assert_close(sheared, 0.5 * AREA * 40.0 * 0.01, 1e-4);
        }
    }

    #[test]
    fn rolling_a_cloth_up_costs_half_d_curvature_squared_per_area() {
        let radius = 0.5_f64;
        let wrapped = |s: f32| {
            let angle = f64::from(s) / radius;
            ((radius * angle.sin()) as f32, (radius * angle.cos() - radius) as f32)
        };
        for (fabric, along_warp) in
            [(Fabric { bend_warp: 3e-3, ..LIMP }, true), (Fabric { bend_weft: 3e-3, ..LIMP }, false)]
        {
            // The first and last half spacing stay straight, so the energy approaches the limit from below.
            for topology in [sheet(20), mesh(20)] {
                let cost = energy(&topology, &fabric, |p| {
                    let (across, depth) = wrapped(if along_warp { p.y } else { p.x });
                    if along_warp { Vec3::new(p.x, across, depth) } else { Vec3::new(across, p.y, depth) }
                });
                assert_close(cost, 0.5 * 3e-3 * AREA / radius.powi(2), 0.03);
            }
        }
    }

    #[test]
    fn rolling_an_irregular_mesh_costs_the_same_whichever_way() {
        let topology = irregular(24);
        let radius = 2.0_f64;
        for (bend_warp, bend_weft) in [(2e-3, 2e-3), (3e-3, 1e-3)] {
            let fabric = Fabric { bend_warp, bend_weft, ..LIMP };
            for degrees in [0.0_f64, 22.5, 45.0, 67.5, 90.0, 120.0, 150.0] {
                let along = glam::DVec2::from_angle(degrees.to_radians());
                let cost = energy(&topology, &fabric, |p| {
                    let p = p.as_dvec3().truncate();
                    let (s, t) = (p.dot(along) / radius, p.perp_dot(along));
                    let flat = along * (radius * s.sin()) - along.perp() * t;
                    flat.extend(radius - radius * s.cos()).as_vec3()
                });
                // κ_uu, κ_vv and κ_uv of 1/r along the way it is rolled.
                let [u, v] = [along.x * along.x, along.y * along.y];
                let [warp, weft] = [bend_warp, bend_weft].map(f64::from);
                let bend = weft * u * u + warp * v * v + (weft + warp) * u * v;
                assert_close(cost, 0.5 * bend / radius.powi(2), 0.04);
            }
        }
    }

    #[test]
    fn twisting_a_rectangle_costs_the_mean_of_warp_and_weft_stiffness() {
        // A saddle z = κ x y: energy D κ² per area.
        let cost = |fabric| energy(&sheet(10), &fabric, |p| Vec3::new(p.x, p.y, 0.1 * p.x * p.y));
        let bending = cost(Fabric { bend_warp: 4e-3, bend_weft: 2e-3, ..LIMP }) - cost(LIMP);
        assert_close(bending, 3e-3 * 0.1_f64.powi(2) * AREA, 1e-3);
    }

    #[test]
    fn a_mesh_is_at_rest_in_the_folded_shape_it_was_made_in() {
        let positions = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.5, 0.0], [0.2, 0.5, -1.0]].map(Vec3::from);
        let source = MeshSource { positions: &positions, uvs: &[], indices: &[0, 1, 2, 1, 0, 3] };
        let topology = Topology::from_mesh(source).unwrap();
        assert!(topology.hinge_rest[0] > 1.0);
        assert!(energy(&topology, &Fabric::PAPER, |p| p) < 1e-9);
    }

    #[test]
    fn a_hinge_swung_through_the_back_is_measured_the_short_way_round() {
        assert!((turn(6.0) - (6.0 - core::f32::consts::TAU)).abs() < 1e-6);
        assert!((turn(-6.0) + (6.0 - core::f32::consts::TAU)).abs() < 1e-6);
        assert_eq!(turn(3.0), 3.0);
    }
}
