//! Lift and drag of the air on each triangle.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch, f32x8, mask32x8};
use glam::Vec3;

use crate::batch::{gather, gather3};
use crate::lanes::{LANES, LEVEL, Vec3x8, load, splat};
use crate::topology::Quads;
use crate::{ClothError, Grid, Particles, Soa3, Substep, Topology};

/// Speed of sound in dry air at 15 °C, m/s. The law holds for air that is not compressed: what is faster pulls no harder.
const SPEED_OF_SOUND: f32 = 340.0;

/// The air around a cloth and how it takes hold of it.
///
/// On a triangle of rest area A with unit normal n and mean velocity u the air, moving at w, pulls with
/// `½ ρ A |v| (C_t v_t + C_n (n·v) n) (1 − porosity)`, `v = w − u`, `v_t` its part along the triangle. Air
/// faster than sound, 340 m/s, pulls no harder than at that speed: there the law ends.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component, bevy_reflect::Reflect))]
#[cfg_attr(feature = "ecs", reflect(Default))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    /// Density ρ, kg/m³; 0..=2000. Default 1.225, dry air at sea level and 15 °C.
    pub density: f32,
    /// Coefficient C_n of the force along the normal, dimensionless; 0..=10. Default 1.17, a square plate broadside
    /// (Hoerner 1965).
    pub normal: f32,
    /// Coefficient C_t of the force along the surface, dimensionless; 0..=10. Default 0.03.
    pub tangent: f32,
    /// Part of the wind that goes through, 0..=1. Default 0.
    pub porosity: f32,
}

#[cfg(feature = "ecs")]
use bevy_reflect::prelude::ReflectDefault;

impl Default for Air {
    fn default() -> Self {
        Self { density: 1.225, normal: 1.17, tangent: 0.03, porosity: 0.0 }
    }
}

impl Air {
    /// Checks every field against its range.
    ///
    /// # Errors
    /// The first field out of range.
    pub fn validate(&self) -> Result<(), ClothError> {
        ClothError::check("Air::density", self.density, 0.0..=2000.0, "0..=2000 kg/m³")?;
        ClothError::check("Air::normal", self.normal, 0.0..=10.0, "0..=10")?;
        ClothError::check("Air::tangent", self.tangent, 0.0..=10.0, "0..=10")?;
        ClothError::check("Air::porosity", self.porosity, 0.0..=1.0, "0..=1")
    }

    /// Finds the air's force on every particle, in an air that moves as [`WindField::sample`](super::WindField::sample) found
    /// it in this tick; without it, does nothing. Five times in a tick at most: in between the force stays, which adds little to
    /// the error of the substeps themselves. The faces of a rectangle are its cells, whose corners share their force evenly, as they do
    /// their mass, and so those of a mesh with [`Topology::quads`]; those of any other mesh, and of one that was taken apart, its triangles.
    ///
    /// What a particle gets until the force is found anew never turns its motion against the air round: stable at any wind.
    pub fn blow(&self, topology: &Topology, particles: &mut Particles, sub: &Substep) {
        let Some(mut airflow) = particles.airflow.take() else { return };
        // A thousandth: rounding.
        if sub.start > 0.0 && sub.start - airflow.found_at < FRESH - 1e-3 {
            particles.airflow = Some(airflow);
            return;
        }
        airflow.found_at = sub.start;
        let time = sub.h.max(FRESH * sub.h / (sub.end - sub.start));
        airflow.force.fill(Vec3::ZERO);
        let strength = 0.5 * self.density * (1.0 - self.porosity);
        if strength > 0.0 && time > 0.0 {
            let Airflow { velocity, force, areal_density, shares, .. } = &mut airflow;
            let blow = Blow { air: self, strength, particles, velocity, areal_density, rate: 1.0 / time };
            match topology.grid {
                Some(grid) if topology.weave.is_none() => {
                    dispatch!(*LEVEL, simd => blow.on_cells(simd, &grid, &[], force));
                }
                _ if let Some(quads) = &topology.quads => dispatch!(*LEVEL, simd => {
                    blow.on_cells(simd, &quads.grid, shares, force);
                    if quads.closed {
                        blow.on_seam(simd, quads, shares, force);
                    }
                }),
                _ => dispatch!(*LEVEL, simd => blow.on_triangles(simd, topology, force)),
            }
        }
        particles.airflow = Some(airflow);
    }
}

/// The part of a tick after which the force is found anew.
const FRESH: f32 = 0.2;

/// The air while one force acts.
#[derive(Clone, Copy)]
struct Blow<'a> {
    air: &'a Air,
    /// ½ ρ (1 − porosity), kg/m³.
    strength: f32,
    particles: &'a Particles,
    velocity: &'a Soa3,
    areal_density: &'a [f32],
    /// 1 over the time that the force acts, 1/s.
    rate: f32,
}

/// Eight faces.
#[derive(Clone, Copy)]
struct Faces<S: Simd> {
    /// Of any length.
    normal: Vec3x8<S>,
    /// Velocity of the air past them, m/s.
    relative: Vec3x8<S>,
    /// Least mass over area of their corners, kg/m².
    lightest: f32x8<S>,
    /// Part of their area at rest that each corner has, m².
    share: f32x8<S>,
}

/// Eight particles of a row and their neighbours to the right.
#[derive(Clone, Copy)]
struct Pair<S: Simd> {
    left: Vec3x8<S>,
    right: Vec3x8<S>,
    /// Sum of the velocities of the air past them, m/s.
    relative: Vec3x8<S>,
    /// The lesser mass over area, kg/m².
    lightest: f32x8<S>,
}

// No closures in the kernels: they would be compiled without the instruction set that is dispatched to.
impl Blow<'_> {
    /// Adds the force on every cell of a rectangle, or of rows and columns of which each cell has its own of `shares`, to its corners, eight neighbours in a row at a time, down the columns: the
    /// lower corners of one row of cells are the upper ones of the next.
    #[inline(always)]
    fn on_cells<S: Simd>(self, simd: S, grid: &Grid, shares: &[f32], force: &mut Soa3) {
        let (columns, rows, stride) = (grid.columns as usize - 1, grid.rows as usize, grid.stride as usize);
        let share = splat(simd, 0.25 * grid.spacing.x * grid.spacing.y);
        let (zero, quarter) = (Vec3x8::splat(simd, Vec3::ZERO), splat(simd, 0.25));
        let lanes = f32x8::simd_from(simd, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        for column in (0..columns).step_by(LANES) {
            let there = lanes.simd_lt(splat(simd, (columns - column) as f32));
            let (mut above, mut force_above) = (self.pair(simd, column), zero);
            for row in 1..=rows {
                let at = row * stride + column;
                let mut each = zero;
                if row < rows {
                    let below = self.pair(simd, at);
                    let share = if shares.is_empty() { share } else { load(simd, shares, at - stride) };
                    let faces = Faces {
                        normal: (below.right - above.left).cross(above.right - below.left),
                        relative: (above.relative + below.relative) * quarter,
                        lightest: above.lightest.min(below.lightest),
                        share,
                    };
                    each = self.on_each_corner(simd, faces, there);
                    above = below;
                }
                let upper = at - stride;
                let both = force_above + each;
                (Vec3x8::load(simd, force, upper) + both).store(force, upper);
                (Vec3x8::load(simd, force, upper + 1) + both).store(force, upper + 1);
                force_above = each;
            }
        }
    }

    /// The same of the cells between the last column and the first.
    #[inline(always)]
    fn on_seam<S: Simd>(self, simd: S, quads: &Quads, shares: &[f32], force: &mut Soa3) {
        let Particles { position, velocity, .. } = self.particles;
        let quarter = splat(simd, 0.25);
        for first in (0..quads.grid.rows - 1).step_by(LANES) {
            let (mut corners, mut share) = ([[0; LANES]; 4], [0.0; LANES]);
            for lane in 0..LANES {
                let row = first + lane as u32;
                if row < quads.grid.rows - 1 {
                    let cell = quads.cell(row, quads.grid.columns - 1);
                    (0..4).for_each(|corner| corners[corner][lane] = cell[corner]);
                    share[lane] = shares[cell[0] as usize];
                }
            }
            let (p00, p10) = (gather3(simd, position, &corners[0]), gather3(simd, position, &corners[1]));
            let (p01, p11) = (gather3(simd, position, &corners[2]), gather3(simd, position, &corners[3]));
            let mut relative = Vec3x8::splat(simd, Vec3::ZERO);
            let mut lightest = splat(simd, f32::INFINITY);
            for corner in &corners {
                relative = relative + (gather3(simd, self.velocity, corner) - gather3(simd, velocity, corner));
                lightest = lightest.min(gather(simd, self.areal_density, corner));
            }
            let share = f32x8::simd_from(simd, share);
            let normal = (p11 - p00).cross(p10 - p01);
            let faces = Faces { normal, relative: relative * quarter, lightest, share };
            let each = self.on_each_corner(simd, faces, share.simd_gt(splat(simd, 0.0)));
            for lane in 0..LANES {
                let on_lane = Vec3::new(each.x[lane], each.y[lane], each.z[lane]);
                for slot in corners.map(|corner| corner[lane] as usize) {
                    force.set(slot, force.get(slot) + on_lane);
                }
            }
        }
    }

    /// The particles from `at` on and their neighbours to the right.
    #[inline(always)]
    fn pair<S: Simd>(self, simd: S, at: usize) -> Pair<S> {
        let Particles { position, velocity, .. } = self.particles;
        let left = Vec3x8::load(simd, self.velocity, at) - Vec3x8::load(simd, velocity, at);
        let right = Vec3x8::load(simd, self.velocity, at + 1) - Vec3x8::load(simd, velocity, at + 1);
        let density = (load(simd, self.areal_density, at), load(simd, self.areal_density, at + 1));
        Pair {
            left: Vec3x8::load(simd, position, at),
            right: Vec3x8::load(simd, position, at + 1),
            relative: left + right,
            lightest: density.0.min(density.1),
        }
    }

    /// Adds the force on every triangle to its corners, eight triangles at a time.
    #[inline(always)]
    fn on_triangles<S: Simd>(self, simd: S, topology: &Topology, force: &mut Soa3) {
        let third = splat(simd, 1.0 / 3.0);
        let Particles { position, velocity, .. } = self.particles;
        for (triangles, rest) in topology.triangles.chunks(LANES).zip(topology.triangle_rest.chunks(LANES)) {
            let mut corners = [[0; LANES]; 3];
            let mut share = [0.0; LANES];
            for lane in 0..triangles.len() {
                for corner in 0..3 {
                    corners[corner][lane] = triangles[lane][corner];
                }
                share[lane] = rest[lane].determinant().abs() / 6.0;
            }
            let [a, b, c] = &corners;
            let origin = gather3(simd, position, a);
            let normal = (gather3(simd, position, b) - origin).cross(gather3(simd, position, c) - origin);
            let mut relative = Vec3x8::splat(simd, Vec3::ZERO);
            let mut lightest = splat(simd, f32::INFINITY);
            for corner in &corners {
                relative = relative + (gather3(simd, self.velocity, corner) - gather3(simd, velocity, corner));
                lightest = lightest.min(gather(simd, self.areal_density, corner));
            }
            let share = f32x8::simd_from(simd, share);
            let faces = Faces { normal, relative: relative * third, lightest, share };
            let each = self.on_each_corner(simd, faces, share.simd_gt(splat(simd, 0.0)));
            for lane in 0..triangles.len() {
                let on_lane = Vec3::new(each.x[lane], each.y[lane], each.z[lane]);
                for slot in triangles[lane].map(|slot| slot as usize) {
                    force.set(slot, force.get(slot) + on_lane);
                }
            }
        }
    }

    /// The force on each corner of eight faces, 0 where there is none.
    #[inline(always)]
    fn on_each_corner<S: Simd>(self, simd: S, faces: Faces<S>, there: mask32x8<S>) -> Vec3x8<S> {
        let Faces { normal, relative, lightest, share } = faces;
        // Within what the law is good for.
        let speed = relative.length();
        let sound = splat(simd, SPEED_OF_SOUND);
        let (relative, speed) = (relative * (sound / speed.max(sound)), speed.min(sound));
        let (zero, square) = (splat(simd, 0.0), normal.dot(normal));
        let facing = square.simd_gt(zero).select(normal.dot(relative) / square, zero);
        let across = normal * facing;
        let along = relative - across;
        let pressure = speed * splat(simd, self.strength);
        // What would stop the lightest of the corners within that time, per area.
        let most = lightest * splat(simd, self.rate);
        let push = (pressure * splat(simd, self.air.normal)).min(most) * share;
        let drag = (pressure * splat(simd, self.air.tangent)).min(most) * share;
        let force = across * push + along * drag;
        Vec3x8 { x: there.select(force.x, zero), y: there.select(force.y, zero), z: there.select(force.z, zero) }
    }
}

/// The air at the particles of one cloth: what [`WindField::sample`](super::WindField::sample) and [`Air::blow`] find.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Airflow {
    /// Velocity of the air at each slot in this tick, m/s.
    pub velocity: Soa3,
    /// Force of the air on each slot, N.
    pub force: Soa3,
    /// Mass over area of each slot, kg/m²; infinite without area.
    areal_density: Vec<f32>,
    /// Of rows and columns of quads a quarter of the area of each cell at rest, m²; else empty.
    shares: Vec<f32>,
    /// Where in the tick the force was found.
    found_at: f32,
}

impl Airflow {
    /// Makes room for the slots of `topology` and notes their `mass`.
    pub(super) fn fit(&mut self, topology: &Topology, mass: &[f32]) {
        let slots = mass.len();
        if self.velocity.len() != slots {
            let areal_density = vec![0.0; slots];
            let [velocity, force] = [Soa3::zeros(slots), Soa3::zeros(slots)];
            *self = Self { velocity, force, areal_density, shares: Vec::new(), found_at: 0.0 };
        }
        if let Some(quads) = topology.quads.filter(|_| self.shares.len() != slots) {
            self.shares = vec![0.0; slots];
            for (row, column) in quads.cells() {
                let corners = quads.cell(row, column);
                let [p00, p10, p01, p11] = corners.map(|slot| topology.rest[slot as usize]);
                self.shares[corners[0] as usize] = 0.125 * (p11 - p00).cross(p10 - p01).length();
            }
        }
        for ((density, mass), area) in self.areal_density.iter_mut().zip(mass).zip(&topology.area) {
            *density = if *area > 0.0 { mass / area } else { f32::INFINITY };
        }
    }
}
