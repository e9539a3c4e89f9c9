//! A thousand tears and cuts at random, and what must hold after each.

use crate::common::damage::*;
use crate::common::rectangle;
use cloth_solver::damage::Direction;
use cloth_solver::topology::Change;
use cloth_solver::{Cloth, Fabric};
use glam::{Vec2, Vec3};
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

/// The texture coordinates of a particle at `rest`: those of the sheet as it was made.
fn uv_at(rest: Vec3) -> Vec2 {
    Vec2::new(0.5 + rest.x, 0.5 - rest.y)
}

/// A sheet with texture coordinates, which follow what is done to it as those of a drawn mesh do.
struct Sheet {
    cloth: Cloth,
    uvs: Vec<Vec2>,
    area: f64,
    mass: f64,
}

impl Sheet {
    fn new(cloth: Cloth) -> Self {
        let rest = |slot: &u32| uv_at(cloth.topology.rest[*slot as usize]);
        let uvs = cloth.topology.vertex_particle.iter().map(rest).collect();
        Self { uvs, area: area(&cloth.topology), mass: mass(&cloth), cloth }
    }

    fn follow(&mut self, change: &Change) {
        for born in &change.vertices {
            let [a, b] = born.parents.map(|vertex| self.uvs[vertex as usize]);
            self.uvs.push(if a == b { a } else { a.lerp(b, born.t) });
        }
    }

    /// The texture coordinates of all corners of all triangles, in order.
    fn corners(&self) -> Vec<[[u32; 2]; 3]> {
        let bits = |vertex: u32| self.uvs[vertex as usize].to_array().map(f32::to_bits);
        let mut corners: Vec<_> = self.cloth.topology.triangle_vertices.iter().map(|t| t.map(bits)).collect();
        corners.sort_unstable();
        corners
    }

    fn assert_kept(&self) {
        let topology = &self.cloth.topology;
        assert_sound(&self.cloth);
        assert!((area(topology) / self.area - 1.0).abs() < 2e-6, "area {}", area(topology) / self.area);
        assert!((mass(&self.cloth) / self.mass - 1.0).abs() < 2e-6, "mass {}", mass(&self.cloth) / self.mass);
        assert_eq!(self.uvs.len(), topology.vertex_particle.len());
        for (uv, slot) in self.uvs.iter().zip(&topology.vertex_particle) {
            let off = uv.distance(uv_at(topology.rest[*slot as usize]));
            assert!(off < 1e-6, "the texture is off by {off}");
        }
    }
}

#[test]
fn a_thousand_random_tears_and_cuts_keep_area_mass_and_texture_and_a_sound_surface() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(4);
    let (mut tears, mut cuts) = (0, 0);
    for round in 0..20 {
        let [columns, rows] = [0, 1].map(|_| random.random_range(3..=9));
        let grid = rectangle(1.0, 1.0, columns, rows, &Fabric::COTTON_POPLIN);
        let cloth = if round % 2 == 0 { grid } else { as_mesh(&grid, &Fabric::COTTON_POPLIN) };
        let mut sheet = Sheet::new(cloth);
        while (tears + cuts) / 50 == round {
            let before = sheet.corners();
            if random.random_bool(0.7) {
                let particles: Vec<u32> = sheet.cloth.topology.particles().collect();
                let particle = particles[random.random_range(0..particles.len())];
                let pull = if random.random_bool(0.5) { Direction::Weft } else { Direction::Warp };
                let Some(change) = sheet.cloth.tear_at(particle, pull) else { continue };
                sheet.follow(&change);
                assert_eq!(sheet.corners(), before, "a tear moves no texture");
                tears += 1;
            } else {
                let mut end = || [0, 1].map(|_| random.random_range(-0.7_f32..0.7));
                let Some(cut) = sheet.cloth.cut(&blade(end(), end())) else { continue };
                sheet.follow(&cut.change);
                cuts += 1;
            }
            sheet.assert_kept();
        }
    }
    assert!(tears + cuts == 1000 && tears > 300 && cuts > 100, "{tears} tears, {cuts} cuts");
}
