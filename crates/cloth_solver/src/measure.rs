//! What a cloth is doing, in numbers.
//!
//! Sums run in f64, so that a drift seen here is the cloth's and not the measurement's. A state that is not finite
//! gives results that are not finite: nothing here hides an explosion.

use glam::{DMat2, DVec3, Vec3};

use crate::lanes::LANES;
use crate::topology::{Along, Thread, threads};
use crate::{Fabric, Particles, Soa3, Topology};

mod crossing;
mod elastic;

pub use crossing::{Passage, crossings, crossings_between};
pub(crate) use crossing::{passages, passes};
pub use elastic::elastic_energy;

/// Mass, position and velocity of each slot; padding has mass 0.
fn states(particles: &Particles) -> impl Iterator<Item = (f64, DVec3, DVec3)> + '_ {
    (particles.mass.iter().enumerate())
        .filter(|(_, mass)| **mass > 0.0)
        .map(|(i, mass)| (f64::from(*mass), particles.position.get(i).as_dvec3(), particles.velocity.get(i).as_dvec3()))
}

/// Kinetic energy `Σ ½ m v²`, J.
pub fn kinetic_energy(particles: &Particles) -> f64 {
    states(particles).map(|(mass, _, velocity)| 0.5 * mass * velocity.length_squared()).sum()
}

/// Potential energy `−Σ m g·x` in a field of `gravity` (m/s²), J; 0 for a cloth at the origin of its frame.
pub fn gravitational_energy(particles: &Particles, gravity: Vec3) -> f64 {
    let gravity = gravity.as_dvec3();
    -states(particles).map(|(mass, position, _)| mass * gravity.dot(position)).sum::<f64>()
}

/// Kinetic, elastic and gravitational energy together, J, in the middle of the last substep, where the velocities are those that the
/// particles have: see [`crate::method::xpbd`]. With their places at its end it would go up and down by half a substep's work.
pub fn total_energy(topology: &Topology, particles: &Particles, fabric: &Fabric, gravity: Vec3) -> f64 {
    let mut middle = particles.clone();
    for slot in 0..middle.slots() {
        middle.position.set(slot, 0.5 * (particles.position.get(slot) + particles.previous.get(slot)));
    }
    kinetic_energy(particles) + elastic_energy(topology, &middle, fabric) + gravitational_energy(&middle, gravity)
}

/// Linear momentum `Σ m v`, kg·m/s.
pub fn linear_momentum(particles: &Particles) -> DVec3 {
    states(particles).map(|(mass, _, velocity)| mass * velocity).sum()
}

/// Angular momentum `Σ m (x − about) × v`, kg·m²/s.
pub fn angular_momentum(particles: &Particles, about: DVec3) -> DVec3 {
    states(particles).map(|(mass, position, velocity)| mass * (position - about).cross(velocity)).sum()
}

/// Centre of mass, m; the origin if there is no mass.
pub fn centre_of_mass(particles: &Particles) -> DVec3 {
    let (mass, moment) = states(particles)
        .fold((0.0, DVec3::ZERO), |(total, moment), (mass, position, _)| (total + mass, moment + mass * position));
    if mass > 0.0 { moment / mass } else { DVec3::ZERO }
}

/// Root of the mean squared speed of the particles that are free to move, weighted by mass, m/s; 0 if none is free.
pub fn rms_speed(topology: &Topology, particles: &Particles) -> f32 {
    let (mass, squares) = (topology.particles().map(|slot| slot as usize))
        .filter(|slot| particles.inverse_mass[*slot] > 0.0)
        .map(|slot| (f64::from(particles.mass[slot]), particles.velocity.get(slot).as_dvec3().length_squared()))
        .fold((0.0, 0.0), |(total, squares), (mass, square)| (total + mass, squares + mass * square));
    if mass > 0.0 { (squares / mass).sqrt() as f32 } else { 0.0 }
}

/// The strain `l / l₀ − 1` of each warp and weft edge of a rectangle, of every edge of any other mesh, with its ends.
pub fn edge_strains<'a>(
    topology: &'a Topology,
    particles: &'a Particles,
) -> impl Iterator<Item = ([u32; 2], f32)> + 'a {
    let along_lines = lines(topology).flat_map(|line| {
        let spacing = line.spacing;
        line.links().map(move |(edge, _)| (edge, spacing)).collect::<Vec<_>>()
    });
    let edges = if topology.grid.is_some() { &[] } else { topology.edges.as_slice() };
    let of_mesh = edges.iter().map(|edge| {
        let [a, b] = edge.map(|slot| topology.rest[slot as usize].as_dvec3());
        (*edge, a.distance(b))
    });
    along_lines.chain(of_mesh).map(|(edge, rest)| {
        let [a, b] = edge.map(|slot| particles.position.get(slot as usize).as_dvec3());
        (edge, (a.distance(b) / rest - 1.0) as f32)
    })
}

/// The strains a fabric feels along its threads, each with the particles it acts on (repeated to make three): of the
/// warp and weft edges of a rectangle, of the warp and weft directions of each triangle that belongs to none.
pub(crate) fn threads_and_strains<'a>(
    topology: &'a Topology,
    particles: &'a Particles,
) -> impl Iterator<Item = ([u32; 3], Along, f32)> + 'a {
    let of_edges = lines(topology).flat_map(|line| {
        let links = line.links().map(|([a, b], _)| {
            let [from, to] = [a, b].map(|slot| particles.position.get(slot as usize).as_dvec3());
            ([a, b, b], line.along, (from.distance(to) / line.spacing - 1.0) as f32)
        });
        links.collect::<Vec<_>>()
    });
    let of_triangles = topology.loose().flat_map(move |triangle| {
        let threads = deformation(topology, &particles.position, triangle as usize).into_iter();
        threads
            .zip([Along::Weft, Along::Warp])
            .map(move |(thread, along)| (topology.triangles[triangle as usize], along, (thread.length() - 1.0) as f32))
    });
    of_edges.chain(of_triangles)
}

/// The largest tensile strain along warp or weft, dimensionless; 0 where nothing is stretched. Of the edges of a
/// rectangle, of the triangles that belong to none.
pub fn largest_strain(topology: &Topology, particles: &Particles) -> f32 {
    threads_and_strains(topology, particles).map(|(.., strain)| strain).fold(0.0, larger)
}

/// For each slot the largest amount of strain, stretch or compression, along warp or weft at that particle; 0 for
/// padding. Replaces the contents of `out` and allocates only where it is too small.
pub fn particle_strain(topology: &Topology, particles: &Particles, out: &mut Vec<f32>) {
    out.clear();
    out.resize(topology.slots(), 0.0);
    for (slots, _, strain) in threads_and_strains(topology, particles) {
        for slot in slots {
            out[slot as usize] = larger(out[slot as usize], strain.abs());
        }
    }
}

/// The corners of the smallest axis-aligned box around all particles, m; the origin twice if there is none.
/// Coordinates that are NaN are left out.
pub fn bounds(topology: &Topology, positions: &Soa3) -> (Vec3, Vec3) {
    // One extreme per lane: a single one would wait for itself at every particle.
    let around = |values: &[f32]| {
        let (mut low, mut high) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
        let (values, areas) = (values.as_chunks::<LANES>().0, topology.area.as_chunks::<LANES>().0);
        for (values, areas) in values.iter().zip(areas) {
            for lane in 0..LANES {
                let (value, is_particle) = (values[lane], areas[lane] > 0.0);
                low[lane] = if is_particle & (value < low[lane]) { value } else { low[lane] };
                high[lane] = if is_particle & (value > high[lane]) { value } else { high[lane] };
            }
        }
        (low.into_iter().fold(f32::INFINITY, f32::min), high.into_iter().fold(f32::NEG_INFINITY, f32::max))
    };
    let [x, y, z] = [&positions.x, &positions.y, &positions.z].map(|values| around(values));
    let (min, max) = (Vec3::new(x.0, y.0, z.0), Vec3::new(x.1, y.1, z.1));
    if min.cmple(max).all() { (min, max) } else { (Vec3::ZERO, Vec3::ZERO) }
}

/// The larger of two numbers, NaN if one of them is.
fn larger(a: f32, b: f32) -> f32 {
    if b > a || b.is_nan() { b } else { a }
}

/// How a weft thread and a warp thread of unit rest length lie in triangle `index` now: the columns of the deformation
/// gradient.
fn deformation(topology: &Topology, positions: &Soa3, index: usize) -> [DVec3; 2] {
    let [p0, p1, p2] = topology.triangles[index].map(|slot| positions.get(slot as usize).as_dvec3());
    let rest = topology.triangle_rest[index];
    let inverse = DMat2::from_cols(rest.x_axis.as_dvec2(), rest.y_axis.as_dvec2()).inverse();
    [inverse.x_axis, inverse.y_axis].map(|column| (p1 - p0) * column.x + (p2 - p0) * column.y)
}

/// A row or column of a rectangle, or of one that was taken apart a run of links that hang together.
struct Line {
    along: Along,
    /// Rest length of its links, m.
    spacing: f64,
    /// Width of fabric that a link of width 1 stands for, m.
    across: f64,
    thread: Thread,
}

/// All rows and columns, or what is left of them; none of a mesh that is no rectangle.
fn lines(topology: &Topology) -> impl Iterator<Item = Line> {
    let spacing = topology.grid.map_or(glam::DVec2::ONE, |grid| grid.spacing.as_dvec2());
    [(Along::Weft, spacing.x, spacing.y), (Along::Warp, spacing.y, spacing.x)].into_iter().flat_map(
        move |(along, spacing, across)| {
            threads(topology, along, |_| true).into_iter().map(move |thread| Line { along, spacing, across, thread })
        },
    )
}

impl Line {
    /// The ends of its links and the width of fabric each stands for, m.
    fn links(&self) -> impl Iterator<Item = ([u32; 2], f64)> + '_ {
        let Thread { slots, width, .. } = &self.thread;
        slots.windows(2).zip(width).map(|(ends, width)| ([ends[0], ends[1]], f64::from(*width) * self.across))
    }
}

#[cfg(test)]
mod tests {
    use glam::{Mat3, Quat, UVec2, Vec2};

    use super::*;
    use crate::topology::{MeshSource, Resolution};

    fn sheet() -> (Topology, Particles) {
        let topology = Topology::rectangle(Vec2::new(1.2, 0.8), Resolution::Cells(UVec2::new(6, 4))).unwrap();
        let particles = Particles::new(&topology, 0.2);
        (topology, particles)
    }

    /// The sheet as a mesh without rows and columns.
    fn mesh() -> (Topology, Particles) {
        let (sheet, _) = sheet();
        let grid = sheet.grid.unwrap();
        let positions: Vec<Vec3> = sheet.vertex_particle.iter().map(|p| sheet.rest[*p as usize]).collect();
        let vertex = |slot: u32| slot / grid.stride * grid.columns + slot % grid.stride;
        let indices: Vec<u32> = sheet.triangles.iter().flatten().map(|p| vertex(*p)).collect();
        let topology = Topology::from_mesh(MeshSource { positions: &positions, uvs: &[], indices: &indices }).unwrap();
        let particles = Particles::new(&topology, 0.2);
        (topology, particles)
    }

    fn place(particles: &mut Particles, map: impl Fn(Vec3) -> Vec3) {
        for i in 0..particles.slots() {
            let to = map(particles.position.get(i));
            particles.position.set(i, to);
        }
    }

    #[test]
    fn a_flying_and_turning_sheet_has_the_momenta_and_energy_of_a_rigid_body() {
        let (_, mut particles) = sheet();
        let (velocity, spin) = (Vec3::new(1.0, -2.0, 0.5), Vec3::new(0.0, 0.0, 3.0));
        place(&mut particles, |p| p + Vec3::new(5.0, 1.0, 0.0));
        for i in 0..particles.slots() {
            let arm = particles.position.get(i) - Vec3::new(5.0, 1.0, 0.0);
            particles.velocity.set(i, velocity + spin.cross(arm));
        }
        let mass = 0.2 * 1.2 * 0.8;
        let inertia: f64 =
            states(&particles).map(|(m, p, _)| m * (p - DVec3::new(5.0, 1.0, 0.0)).length_squared()).sum();
        assert!((linear_momentum(&particles) - mass * velocity.as_dvec3()).length() < 1e-7);
        assert!((centre_of_mass(&particles) - DVec3::new(5.0, 1.0, 0.0)).length() < 1e-6);
        let turning = angular_momentum(&particles, DVec3::new(5.0, 1.0, 0.0));
        assert!((turning - inertia * spin.as_dvec3()).length() < 1e-6);
        let energy = 0.5 * mass * f64::from(velocity.length_squared()) + 0.5 * inertia * 9.0;
        assert!((kinetic_energy(&particles) / energy - 1.0).abs() < 1e-6);
        assert!((gravitational_energy(&particles, Vec3::NEG_Y * 10.0) - mass * 10.0).abs() < 1e-6);
    }

    #[test]
    fn pinned_particles_and_padding_do_not_count_in_the_rms_speed() {
        let (topology, mut particles) = sheet();
        particles.velocity.fill(Vec3::new(0.0, 3.0, 4.0));
        assert!((rms_speed(&topology, &particles) - 5.0).abs() < 1e-6);
        particles.velocity.set(0, Vec3::X * 1e6);
        particles.inverse_mass[0] = 0.0;
        assert!((rms_speed(&topology, &particles) - 5.0).abs() < 1e-6);
        particles.inverse_mass.fill(0.0);
        assert_eq!(rms_speed(&topology, &particles), 0.0);
    }

    #[test]
    fn a_uniform_stretch_is_the_strain_of_every_warp_edge_and_of_every_triangle() {
        let turn = Mat3::from_quat(Quat::from_euler(glam::EulerRot::XYZ, 0.4, 1.1, -0.7));
        for (topology, mut particles) in [sheet(), mesh()] {
            place(&mut particles, |p| turn * (p * Vec3::new(0.95, 1.02, 1.0)));
            assert!((largest_strain(&topology, &particles) - 0.02).abs() < 1e-5);
            let mut strain = Vec::new();
            particle_strain(&topology, &particles, &mut strain);
            assert_eq!(strain.len(), topology.slots());
            for (slot, strain) in strain.iter().enumerate() {
                let expected = if topology.is_particle(slot as u32) { 0.05 } else { 0.0 };
                assert!((strain - expected).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn a_rectangle_tells_its_warp_and_weft_edges_and_a_mesh_all_of_them() {
        let (topology, particles) = sheet();
        assert_eq!(edge_strains(&topology, &particles).count(), 6 * 5 + 4 * 7);
        let (topology, particles) = mesh();
        assert_eq!(edge_strains(&topology, &particles).count(), topology.edges.len());
        assert!(edge_strains(&topology, &particles).all(|(_, strain)| strain.abs() < 1e-6));
    }

    #[test]
    fn compression_is_no_tensile_strain_and_nan_is_not_hidden() {
        let (topology, mut particles) = sheet();
        place(&mut particles, |p| p * 0.9);
        assert_eq!(largest_strain(&topology, &particles), 0.0);
        particles.position.set(3, Vec3::NAN);
        assert!(largest_strain(&topology, &particles).is_nan());
    }

    #[test]
    fn bounds_leave_padding_out() {
        let (topology, mut particles) = sheet();
        let padding = topology.slots() - 1;
        particles.position.set(padding, Vec3::splat(99.0));
        particles.position.set(0, Vec3::new(-0.6, 0.4, -2.0));
        let (min, max) = bounds(&topology, &particles.position);
        assert_eq!((min, max), (Vec3::new(-0.6, -0.4, -2.0), Vec3::new(0.6, 0.4, 0.0)));
        assert_eq!(bounds(&Topology::default(), &Soa3::default()), (Vec3::ZERO, Vec3::ZERO));
    }
}
