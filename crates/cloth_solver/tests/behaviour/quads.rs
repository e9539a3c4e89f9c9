//! Meshes of quads solved along their rows and columns: which are found, and that they are the fabric that they are made of.

use core::f32::consts::TAU;
use std::sync::Arc;

use crate::common::*;
use cloth_solver::damage::Blade;
use cloth_solver::forces::Air;
use cloth_solver::topology::MeshSource;
use cloth_solver::{Cloth, Fabric, Topology, measure};
use glam::{DVec3, Quat, Vec2, Vec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// A surface over u and v in 0..1, from its upper left corner, and into how many columns and rows of particles it is divided.
#[derive(Clone, Copy, Debug)]
struct Shape {
    columns: u32,
    rows: u32,
    closed: bool,
    /// Width at the top and how much of it is added to the bottom.
    width: f32,
    taper: f32,
    height: f32,
    /// The part of a full turn that it is bent into a cylinder or a cone, about the y axis.
    bend: f32,
    /// How deep it sags between top and bottom, and how far the bottom is moved aside, in heights.
    sag: f32,
    lean: f32,
    /// Rows crowd at the top (above 1) or at the bottom.
    crowd: f32,
    seed: u32,
}

const PLAIN: Shape = Shape {
    columns: 13,
    rows: 11,
    closed: false,
    width: 0.6,
    taper: 0.0,
    height: 0.5,
    bend: 0.0,
    sag: 0.0,
    lean: 0.0,
    crowd: 1.0,
    seed: 1,
};

prop_compose! {
    fn shape(most: u32)(
        columns in 2..=most,
        rows in 2..=most,
        closed in any::<bool>(),
        [width, height] in [0.2_f32..1.0, 0.2_f32..1.0],
        taper in -0.4_f32..0.6,
        bend in 0.0_f32..0.6,
        [sag, lean] in [-0.1_f32..0.1, -0.3_f32..0.3],
        crowd in 0.8_f32..1.3,
        seed in any::<u32>(),
    ) -> Shape {
        // A tube of less than five columns is as good as folded.
        let (columns, bend) = if closed { (columns.max(5), 1.0) } else { (columns, bend) };
        Shape { columns, rows, closed, width, taper, height, bend, sag, lean, crowd, seed }
    }
}

impl Shape {
    fn noise(&self, i: usize) -> u32 {
        let hash = (i as u32 ^ self.seed.rotate_left(16)).wrapping_mul(0x9E37_79B9);
        (hash ^ (hash >> 15)).wrapping_mul(0x85EB_CA6B) >> 8
    }

    fn place(&self, u: f32, v: f32) -> Vec3 {
        let down = v.powf(self.crowd);
        let width = self.width * (1.0 + self.taper * down);
        let angle = TAU * self.bend * (u - 0.5);
        let (x, z) = if self.bend > 0.0 {
            let radius = width / (TAU * self.bend);
            let nearest = if self.closed { 0.0 } else { radius };
            (radius * angle.sin(), radius * angle.cos() - nearest)
        } else {
            (width * (u - 0.5), 0.0)
        };
        let sag = self.height * self.sag * (TAU * 0.5 * v).sin();
        Vec3::new(x + self.lean * self.height * down, self.height * (0.5 - down), z + sag)
    }

    /// Vertices, with a seam of two columns of them in a tube, and triangles, cut either way and in any order.
    fn mesh(&self) -> (Vec<Vec3>, Vec<Vec2>, Vec<[u32; 3]>) {
        let across = if self.closed { self.columns + 1 } else { self.columns };
        let part = |i: u32, count: u32| i as f32 / (count - 1) as f32;
        let count = across * self.rows;
        let mut order: Vec<u32> = (0..count).collect();
        order.sort_by_key(|vertex| self.noise(*vertex as usize));
        let mut number = vec![0; count as usize];
        order.iter().enumerate().for_each(|(i, vertex)| number[*vertex as usize] = i as u32);
        let uv = |vertex: &u32| Vec2::new(part(vertex % across, across), part(vertex / across, self.rows));
        let uvs: Vec<Vec2> = order.iter().map(uv).collect();
        let around = |u: f32| if self.closed && u == 1.0 { 0.0 } else { u };
        let positions = uvs.iter().map(|uv| self.place(around(uv.x), uv.y)).collect();
        let cells = (0..self.rows - 1).flat_map(|row| (0..across - 1).map(move |column| row * across + column));
        let mut triangles: Vec<[u32; 3]> = cells
            .flat_map(|a| {
                let [a, b, c, d] = [a, a + 1, a + across, a + across + 1].map(|vertex| number[vertex as usize]);
                if self.noise(a as usize + 7).is_multiple_of(2) {
                    [[a, c, d], [a, d, b]]
                } else {
                    [[a, c, b], [b, c, d]]
                }
            })
            .collect();
        triangles.sort_by_key(|[a, b, c]| self.noise((a * 31 + b * 17 + c) as usize));
        for (i, triangle) in triangles.iter_mut().enumerate() {
            triangle.rotate_left(self.noise(i) as usize % 3);
        }
        (positions, uvs, triangles)
    }

    fn topology(&self) -> Topology {
        let (positions, uvs, triangles) = self.mesh();
        let source = MeshSource { positions: &positions, uvs: &uvs, indices: triangles.as_flattened() };
        Topology::from_mesh(source).unwrap()
    }

    fn cloth(&self, fabric: &Fabric) -> Cloth {
        Cloth::new(Arc::new(self.topology().into_quads()), fabric).unwrap()
    }

    /// What is at its upper edge at rest.
    fn at_top(&self) -> impl Fn(Vec3) -> bool + use<> {
        let top = 0.5 * self.height;
        move |rest| rest.y > top - 1e-4
    }
}

fn furthest(cloth: &Cloth) -> f32 {
    let off = |p: u32| cloth.particles.position.get(p as usize).distance(cloth.topology.rest[p as usize]);
    cloth.topology.particles().map(off).fold(0.0, f32::max)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(16, 64), failure_persistence: None, rng_seed: RngSeed::Fixed(20), ..ProptestConfig::default() })]

    #[test]
    fn rows_and_columns_are_found_however_quads_are_cut_numbered_and_bent(shape in shape(40)) {
        let before = shape.topology();
        let made = before.clone().into_quads();
        let quads = made.quads.expect("rows and columns");
        let [columns, rows] = [quads.grid.columns, quads.grid.rows];
        prop_assert_eq!([columns, rows, u32::from(quads.closed)], [shape.columns, shape.rows, u32::from(shape.closed)]);
        prop_assert_eq!(&made.triangle_vertices, &before.triangle_vertices);
        for (vertex, slot) in made.vertex_particle.iter().enumerate() {
            prop_assert_eq!(made.rest[*slot as usize], before.rest[before.vertex_particle[vertex] as usize]);
        }
        for ((triangle, drawn), rest) in made.triangles.iter().zip(&made.triangle_vertices).zip(&made.triangle_rest) {
            prop_assert_eq!(drawn.map(|vertex| made.vertex_particle[vertex as usize]), *triangle);
            prop_assert!(rest.determinant() > 0.0);
        }
        // Rows run across, the first one above.
        for row in 0..rows {
            let level = made.rest[quads.grid.slot(row, 0) as usize].y;
            for column in 0..columns {
                let y = made.rest[quads.grid.slot(row, column) as usize].y;
                prop_assert!((y - level).abs() < 1e-4);
                prop_assert!(row == 0 || y < made.rest[quads.grid.slot(row - 1, column) as usize].y);
            }
        }
        let area = |of: &Topology| of.area.iter().sum::<f32>();
        prop_assert!((area(&made) / area(&before) - 1.0).abs() < 1e-4);
        prop_assert_eq!((made.edges.len(), made.hinges.len()), (before.edges.len(), before.hinges.len()));
    }

    #[test]
    fn a_mesh_without_rows_and_columns_comes_back_as_it_was(shape in shape(20), which in any::<usize>()) {
        let (positions, uvs, mut triangles) = shape.mesh();
        triangles.remove(which % triangles.len());
        let used: Vec<bool> = (0..positions.len()).map(|v| triangles.as_flattened().contains(&(v as u32))).collect();
        prop_assume!(used.iter().all(|used| *used) && !triangles.is_empty());
        let made = |positions: &[Vec3], uvs: &[Vec2], triangles: &[[u32; 3]]| {
            Topology::from_mesh(MeshSource { positions, uvs, indices: triangles.as_flattened() }).unwrap()
        };
        let torn = made(&positions, &uvs, &triangles);
        prop_assert_eq!(torn.clone().into_quads(), torn);
        // Threads that run askew.
        let (positions, uvs, triangles) = shape.mesh();
        let size = Vec2::new(shape.width, shape.height);
        let askew: Vec<Vec2> = uvs.iter().map(|uv| Vec2::from_angle(0.785).rotate(*uv * size)).collect();
        let bias = made(&positions, &askew, &triangles);
        prop_assume!(!shape.closed && shape.lean.abs() < 0.1 && shape.taper.abs() < 0.2);
        prop_assert_eq!(bias.clone().into_quads(), bias);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(6, 24), failure_persistence: None, rng_seed: RngSeed::Fixed(21), ..ProptestConfig::default() })]

    #[test]
    fn what_is_bent_at_rest_stays_so_and_comes_back(shape in shape(16), preset in 0..Fabric::PRESETS.len()) {
        let fabric = Fabric::PRESETS[preset].1;
        let mut cloth = shape.cloth(&fabric);
        for _ in 0..600 {
            cloth.step(TICK, Vec3::ZERO);
        }
        prop_assert!(furthest(&cloth) < 1e-4, "moves {} m", furthest(&cloth));
        // Held by its top, struck, and left alone in air.
        cloth.air = Some(Air::default());
        hold(&mut cloth, shape.at_top());
        for slot in 0..cloth.topology.slots() {
            let depth = shape.height * 0.5 - cloth.topology.rest[slot].y;
            cloth.particles.velocity.set(slot, Vec3::new(0.2, 0.0, 0.3) * depth);
        }
        for _ in 0..1200 {
            cloth.step(TICK, Vec3::ZERO);
        }
        prop_assert!(cloth.particles.is_finite());
        prop_assert!(measure::rms_speed(&cloth.topology, &cloth.particles) < 0.02);
    }

    #[test]
    fn momentum_is_kept_whatever_the_shape_and_when_it_is_cut(shape in shape(14), preset in 0..Fabric::PRESETS.len(), is_cut in any::<bool>()) {
        let fabric = Fabric { damping: 0.0, ..Fabric::PRESETS[preset].1 };
        let mut cloth = shape.cloth(&fabric);
        prop_assert!(cloth.topology.quads.is_some());
        let size = shape.width.max(shape.height);
        for slot in 0..cloth.topology.slots() {
            let (x, noise) = (cloth.topology.rest[slot], shape.noise(slot) as f32 / 8_388_608.0 - 1.0);
            if cloth.particles.mass[slot] > 0.0 {
                let wave = 0.03 * size * (7.0 * x.x / size + 5.0 * x.y / size).sin();
                let x = x + Vec3::Z * (wave + 0.001 * noise);
                cloth.particles.position.set(slot, x);
                cloth.particles.previous.set(slot, x);
                cloth.particles.velocity.set(slot, Vec3::new(0.3 + x.y, -x.x, 0.3 * noise));
            }
        }
        let mass: f64 = cloth.particles.mass.iter().map(|m| f64::from(*m)).sum();
        if is_cut {
            let ray = |x: f32| [Vec3::new(x, 0.05, 5.0), Vec3::new(x, 0.05, -5.0)];
            cloth.cut(&Blade { from: ray(-0.4 * size), to: ray(0.1 * size) });
        }
        let now: f64 = cloth.particles.mass.iter().map(|m| f64::from(*m)).sum();
        prop_assert!((now / mass - 1.0).abs() < 1e-5, "mass {now} of {mass}");
        let linear = measure::linear_momentum(&cloth.particles);
        cloth.step(TICK, Vec3::ZERO);
        let angular = measure::angular_momentum(&cloth.particles, DVec3::ZERO);
        let mut speed = 1.0_f64;
        // A cut one is solved as any mesh is, for which other tests speak.
        let ticks = if cloth.topology.quads.is_some() { 60 } else { 2 };
        for _ in 0..ticks {
            cloth.step(TICK, Vec3::ZERO);
            speed = speed.max(f64::from(fastest(&cloth)));
        }
        let drift = (measure::linear_momentum(&cloth.particles) - linear).length() / (mass * speed);
        let turn = (measure::angular_momentum(&cloth.particles, DVec3::ZERO) - angular).length();
        prop_assert!(drift < 2e-5, "linear {drift}");
        if cloth.topology.quads.is_some() {
            prop_assert!(turn / (mass * speed * f64::from(size)) < 1e-5, "angular {turn}");
        }
    }
}

#[test]
fn a_flat_sheet_of_quads_swings_as_the_rectangle_that_it_is() {
    let shape = Shape { columns: 21, rows: 17, ..PLAIN };
    let mut quads = shape.cloth(&Fabric::COTTON_POPLIN);
    let mut grid = rectangle(shape.width, shape.height, 20, 16, &Fabric::COTTON_POPLIN);
    for cloth in [&mut quads, &mut grid] {
        hold(cloth, |rest| rest.x < -0.29);
        cloth.air = Some(Air::default());
        run(cloth, 0.5);
    }
    let layout = quads.topology.quads.expect("rows and columns").grid;
    for row in 0..17 {
        for column in 0..21 {
            let at = |cloth: &Cloth, slot: u32| cloth.particles.position.get(slot as usize);
            let slots = [layout.slot(row, column), grid.topology.grid.expect("a rectangle").slot(row, column)];
            let apart = at(&quads, slots[0]).distance(at(&grid, slots[1]));
            assert!(apart < 2e-3, "{apart} m at {row}, {column}");
        }
    }
}

/// Strain down the middle of what hangs by its top, and what it should be: the weight below over width and stiffness.
fn hanging_strains(shape: Shape, fabric: &Fabric) -> Vec<[f32; 2]> {
    let mut cloth = shape.cloth(fabric);
    hold(&mut cloth, shape.at_top());
    settle(&mut cloth, 20.0);
    let layout = cloth.topology.quads.expect("rows and columns").grid;
    let width = |down: f32| shape.width * (1.0 + shape.taper * down / shape.height);
    (0..layout.rows - 1)
        .map(|row| {
            let slots = [row, row + 1].map(|row| layout.slot(row, layout.columns / 2) as usize);
            let [rest, now] =
                [slots.map(|slot| cloth.topology.rest[slot]), slots.map(|slot| cloth.particles.position.get(slot))];
            let down = 0.5 * shape.height - 0.5 * (rest[0].y + rest[1].y);
            let below = 0.5 * (width(down) + width(shape.height)) * (shape.height - down);
            let told = fabric.areal_density * 9.81 * below / (width(down) * fabric.stretch_warp);
            [now[0].distance(now[1]) / rest[0].distance(rest[1]) - 1.0, told]
        })
        .collect()
}

#[test]
fn tapered_strips_and_tubes_hang_with_the_strain_of_the_weight_below() {
    // Heavy and soft, so that f32 tells the strain; without bending or shear to hold anything up.
    let fabric = Fabric {
        areal_density: 2.0,
        stretch_warp: 500.0,
        stretch_weft: 2e4,
        shear: 0.0,
        bend_warp: 0.0,
        bend_weft: 0.0,
        ..Fabric::COTTON_POPLIN
    };
    let strip = Shape { columns: 17, rows: 33, width: 0.3, height: 0.8, ..PLAIN };
    let tube = Shape { columns: 32, rows: 33, width: 0.9, height: 0.8, closed: true, bend: 1.0, ..PLAIN };
    let crowded = Shape { crowd: 1.25, ..strip };
    for shape in [strip, crowded, Shape { taper: 0.15, ..strip }, Shape { taper: -0.15, ..strip }, tube] {
        // The last links carry next to nothing.
        let strains = hanging_strains(shape, &fabric);
        for [found, told] in strains.iter().take(28) {
            assert!((found / told - 1.0).abs() < 0.01, "{found}, not {told}: {shape:?}");
        }
    }
}

#[test]
fn a_closed_row_does_not_know_where_it_begins() {
    let make = |turn: f32| {
        let shape = Shape { columns: 24, rows: 12, closed: true, bend: 1.0, width: 0.8, height: 0.5, ..PLAIN };
        let (positions, uvs, triangles) = shape.mesh();
        let positions: Vec<Vec3> = positions.iter().map(|x| Quat::from_rotation_y(turn) * *x).collect();
        let source = MeshSource { positions: &positions, uvs: &uvs, indices: triangles.as_flattened() };
        let topology = Topology::from_mesh(source).unwrap().into_quads();
        let mut cloth = Cloth::new(Arc::new(topology), &Fabric::LEATHER_GARMENT).unwrap();
        hold(&mut cloth, |rest| rest.y > 0.249);
        for slot in 0..cloth.topology.slots() {
            let x = cloth.topology.rest[slot];
            cloth.particles.velocity.set(slot, Vec3::new(1.0, 0.0, 2.0 * x.x) * (0.25 - x.y));
        }
        for _ in 0..20 {
            cloth.step(TICK, GRAVITY);
        }
        cloth
    };
    let (here, there) = (make(0.0), make(TAU / 24.0 * 7.0));
    for p in here.topology.particles() {
        let rest = here.topology.rest[p as usize];
        let apart = |q: &u32| there.topology.rest[*q as usize].distance(rest);
        let q = there.topology.particles().min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap();
        let apart = here.particles.position.get(p as usize).distance(there.particles.position.get(q as usize));
        assert!(apart < 1e-4, "{apart} m");
    }
}

#[test]
fn a_swinging_skirt_and_cape_gain_no_energy() {
    let cape = Shape { columns: 25, rows: 25, taper: 0.5, bend: 0.4, ..PLAIN };
    for shape in [PLAIN, cape, Shape { closed: true, bend: 1.0, columns: 24, taper: 0.3, ..cape }] {
        let mut cloth = shape.cloth(&UNDAMPED);
        hold(&mut cloth, shape.at_top());
        for slot in 0..cloth.topology.slots() {
            let depth = shape.height * 0.5 - cloth.topology.rest[slot].y;
            cloth.particles.velocity.set(slot, Vec3::new(0.2, 0.0, 0.5) * depth);
        }
        run(&mut cloth, 0.1);
        let mut last = f64::MAX;
        for second in 0..6 {
            let mut sum = 0.0;
            for _ in 0..60 {
                run(&mut cloth, TICK.dt);
                sum += measure::total_energy(&cloth.topology, &cloth.particles, &UNDAMPED, GRAVITY);
            }
            assert!(sum < last, "{} J more in second {second}: {shape:?}", (sum - last) / 60.0);
            last = sum;
        }
    }
}

#[test]
fn a_cut_or_torn_cape_goes_on_where_it_is() {
    let shape = Shape { columns: 25, rows: 25, taper: 0.5, bend: 0.4, ..PLAIN };
    let mut cloth = shape.cloth(&Fabric::COTTON_POPLIN);
    hold(&mut cloth, shape.at_top());
    run(&mut cloth, 2.0);
    let before = cloth.clone();
    let ray = |x: f32| [Vec3::new(x, -0.05, 5.0), Vec3::new(x, -0.05, -5.0)];
    cloth.cut(&Blade { from: ray(-1.0), to: ray(0.05) }).expect("a cut");
    assert_eq!(cloth.topology.quads, None);
    for p in before.topology.particles().map(|p| p as usize) {
        assert_eq!(cloth.particles.position.get(p), before.particles.position.get(p));
        assert_eq!(cloth.particles.velocity.get(p), before.particles.velocity.get(p));
    }
    cloth.step(TICK, GRAVITY);
    let mut uncut = before.clone();
    uncut.step(TICK, GRAVITY);
    let apart = |p: u32| cloth.particles.position.get(p as usize).distance(uncut.particles.position.get(p as usize));
    let most = before.topology.particles().map(apart).fold(0.0, f32::max);
    assert!(most < 3e-3, "{most} m in the tick of the cut");
    run(&mut cloth, 1.0);
    assert!(cloth.particles.is_finite());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(1, 16), failure_persistence: None, rng_seed: RngSeed::Fixed(19), ..ProptestConfig::default() })]

    #[test]
    fn paper_of_any_shape_thrown_on_the_ground_gains_no_energy(
        shape in shape(40), is_mesh in any::<bool>(),
        turn in [-3.0_f32..3.0, -3.0_f32..3.0, -3.0_f32..3.0], velocity in [-3.0_f32..3.0, -5.0_f32..1.0, -3.0_f32..3.0],
    ) {
        // Its shear is stiffer than the most substeps of a tick resolve.
        let topology = if is_mesh { shape.topology() } else { shape.topology().into_quads() };
        let cloth = Cloth::new(Arc::new(topology), &Fabric::PAPER).unwrap();
        let gain = gain_of_thrown(cloth, turn, velocity);
        prop_assert!(gain < 1e-3, "{} of its energy", gain);
    }
}
