//! Fire: how fast it spreads up, on a slope, aside and down, and the heat that it takes to light.

use core::f32::consts::FRAC_PI_4;

use cloth_solver::damage::fire::{Flammability, ROOM_TEMPERATURE, Surroundings};
use cloth_solver::topology::{MeshSource, Resolution};
use cloth_solver::{ClothError, Fabric, Fire, Flammable, Particles, Topology};
use glam::{Quat, UVec2, Vec2, Vec3};

use super::finding::{Bench, Bound, Finding};

const CHECK: &str = "fire";

/// Areal density of the cotton whose fire was measured, kg/m².
const DENSITY: f32 = 0.15;

/// Up, aside and down on hanging cotton, mm/s (Mathur, Vikas and Kale 2011).
const MEASURED: [f64; 3] = [90.0, 11.0, 2.0];

/// Latent heat of water, J/kg.
const LATENT_HEAT: f64 = 2.26e6;

/// Longest fire, s.
const PATIENCE: f32 = 300.0;

/// How a strip is meshed: the distance of its particles, m, and whether in triangles of equal sides.
type Mesh = (f32, bool);

const MESHES: [Mesh; 4] = [(0.008, false), (0.016, false), (0.025, false), (0.016, true)];

/// A strip that does not move, and the particles along it.
struct Strip {
    topology: Topology,
    particles: Particles,
    fire: Fire,
    dt: f32,
}

impl Strip {
    /// Of `size` m and `density` kg/m², turned by `turn` from hanging.
    fn new(
        size: [f32; 2],
        mesh: Mesh,
        density: f32,
        turn: Quat,
        flammability: Flammability,
    ) -> Result<Self, ClothError> {
        let (spacing, triangles) = mesh;
        let topology = match triangles {
            true => lattice(size, spacing)?,
            false => Topology::rectangle(Vec2::from(size), Resolution::Spacing(spacing))?,
        };
        let mut particles = Particles::new(&topology, density);
        for (slot, rest) in topology.rest.iter().enumerate() {
            particles.position.set(slot, turn * *rest);
        }
        let fabric = Fabric { areal_density: density, ..Fabric::COTTON_POPLIN };
        let fire = Fire::new(&topology, &fabric, &Flammable::Heat(flammability))?;
        Ok(Self { topology, particles, fire, dt: 1.0 / 60.0 })
    }

    /// When each particle lights, s, and where it is along `along`, m, from its lower end; lit over all of that end.
    fn burn(&mut self, along: Vec3) -> Result<Vec<[f64; 2]>, ClothError> {
        let place = |slot: u32| self.topology.rest[slot as usize].dot(along);
        let low = self.topology.particles().map(place).fold(f32::MAX, f32::min);
        let mut way = vec![[f64::NAN; 2]; self.topology.slots()];
        let particles: Vec<u32> = self.topology.particles().collect();
        for slot in &particles {
            way[*slot as usize][1] = f64::from(place(*slot) - low);
            if place(*slot) < low + 1e-4 {
                self.fire.ignite_particle(*slot)?;
            }
        }
        let (mut ticks, mut left) = (0_u32, particles.len());
        while left > 0 && ticks as f32 * self.dt < PATIENCE {
            ticks += 1;
            self.fire.burn(&self.topology, &self.particles, &Surroundings::default(), self.dt)?;
            for slot in self.fire.ignited() {
                way[*slot as usize][0] = f64::from(ticks) * f64::from(self.dt);
                left -= 1;
            }
        }
        Ok(particles.iter().map(|slot| way[*slot as usize]).collect())
    }

    /// The slope of the place over the time past the first quarter of the way, mm/s.
    fn rate(mut self, along: Vec3) -> Result<f64, ClothError> {
        let way = self.burn(along)?;
        let length = way.iter().map(|[_, x]| *x).fold(0.0, f64::max);
        let way: Vec<[f64; 2]> = way.into_iter().filter(|[_, x]| *x > 0.25 * length).collect();
        let mean = |value: &dyn Fn([f64; 2]) -> f64| way.iter().map(|at| value(*at)).sum::<f64>() / way.len() as f64;
        let (time, place) = (mean(&|[t, _]| t), mean(&|[_, x]| x));
        let covariance = mean(&|[t, x]| (t - time) * (x - place));
        Ok(1000.0 * mean(&|[_, x]| (x - place) * (x - place)) / covariance)
    }
}

/// A strip of `size` m in triangles of about equal sides of `spacing` m, with a straight border.
fn lattice(size: [f32; 2], spacing: f32) -> Result<Topology, ClothError> {
    let count = (Vec2::from(size) / (spacing * Vec2::new(1.0, 0.866))).round().as_uvec2().max(UVec2::ONE);
    let step = Vec2::from(size) / count.as_vec2();
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    let row_of = |y: u32| count.x + 1 + y % 2;
    for y in 0..=count.y {
        // Every second row stands half a step aside, and has half steps at its ends.
        let first = positions.len() as u32;
        for x in 0..row_of(y) {
            let aside = x as f32 - 0.5 * (y % 2) as f32;
            positions.push(Vec3::new(aside.clamp(0.0, count.x as f32) * step.x, y as f32 * step.y, 0.0));
        }
        if y > 0 {
            let (short, long) =
                if y % 2 == 1 { (first - row_of(y - 1), first) } else { (first, first - row_of(y - 1)) };
            let fan = (0..=count.x).map(|x| [short + x, long + x, long + x + 1]);
            let between = (0..count.x).map(|x| [short + x, long + x + 1, short + x + 1]);
            indices.extend(fan.chain(between).flatten());
        }
    }
    Topology::from_mesh(MeshSource { positions: &positions, uvs: &[], indices: &indices })
}

fn add(bench: &mut Bench, quantity: String, value: f64, expected: f64, bound: Bound) {
    let (check, claimed) = (CHECK, true);
    bench.findings.push(Finding { check, quantity, method: None, value, expected, bound, claimed });
}

/// Rates of spread on cotton of 150 g/m², against measurement, in their order, and on one mesh against the other.
pub fn spread(bench: &mut Bench) -> Result<(), ClothError> {
    let hanging = Quat::IDENTITY;
    let mut all: [Vec<f64>; 4] = Default::default();
    for mesh in MESHES {
        let strip = |size, turn| Strip::new(size, mesh, DENSITY, turn, Flammability::COTTON);
        let rates = [
            strip([0.1, 1.0], hanging)?.rate(Vec3::Y)?,
            strip([0.3, 0.1], hanging)?.rate(Vec3::X)?,
            strip([0.1, 0.1], hanging)?.rate(Vec3::NEG_Y)?,
            strip([0.1, 0.3], Quat::from_rotation_x(FRAC_PI_4))?.rate(Vec3::Y)?,
        ];
        all.iter_mut().zip(rates).for_each(|(all, rate)| all.push(rate));
        let name = format!("{} mm{}", mesh.0 * 1e3, if mesh.1 { " triangles" } else { " cells" });
        for ((way, rate), measured) in ["up", "aside", "down"].iter().zip(rates).zip(MEASURED) {
            add(bench, format!("spread {way}, {name}, mm/s"), rate, measured, Bound::Relative(0.25));
        }
        let [up, aside, down, slope] = rates;
        add(bench, format!("spread up over that at 45°, {name}"), up / slope, 1.0, Bound::AtLeast);
        add(bench, format!("spread at 45° over that aside, {name}"), slope / aside, 1.0, Bound::AtLeast);
        add(bench, format!("spread aside over that down, {name}"), aside / down, 1.0, Bound::AtLeast);
        add(bench, format!("spread up over that down, {name}"), up / down, 10.0, Bound::AtLeast);
    }
    for (way, rates) in ["up", "aside", "down", "at 45°"].iter().zip(&all) {
        let (low, high) = rates.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(*v), h.max(*v)));
        add(bench, format!("spread {way}, fastest mesh over slowest, parts"), high / low - 1.0, 0.15, Bound::AtMost);
    }
    Ok(())
}

/// The 45° test, and how the rate of spread goes with the mass of the cloth and the tick.
pub fn slope(bench: &mut Bench) -> Result<(), ClothError> {
    let turn = Quat::from_rotation_x(FRAC_PI_4);
    for mesh in MESHES {
        let way = Strip::new([0.05, 0.15], mesh, DENSITY, turn, Flammability::COTTON)?.burn(Vec3::Y)?;
        // The particles before and behind 127 mm, and between them.
        let nearest = |side: f64| {
            let nearer = |a: &&[f64; 2], b: &&[f64; 2]| (a[1] - 0.127).abs().total_cmp(&(b[1] - 0.127).abs());
            way.iter().filter(|[_, x]| (x - 0.127) * side >= 0.0).min_by(nearer).copied().unwrap_or([f64::NAN; 2])
        };
        let ([t0, x0], [t1, x1]) = (nearest(-1.0), nearest(1.0));
        let time = if x1 > x0 { t0 + (t1 - t0) * (0.127 - x0) / (x1 - x0) } else { t0 };
        let name = format!("127 mm at 45°, {} mm{}, s", mesh.0 * 1e3, if mesh.1 { " triangles" } else { " cells" });
        add(bench, name.clone(), time, 3.5, Bound::AtLeast);
        add(bench, name, time, 15.0, Bound::AtMost);
    }
    let rate = |density, dt| {
        let mut strip = Strip::new([0.1, 1.0], MESHES[1], density, Quat::IDENTITY, Flammability::COTTON)?;
        strip.dt = dt;
        strip.rate(Vec3::Y)
    };
    let one = rate(DENSITY, 1.0 / 60.0)?;
    for density in [0.05, 0.30, 0.60] {
        let quantity = format!("spread up at {density} kg/m² over that at 0.15");
        add(bench, quantity, rate(density, 1.0 / 60.0)? / one, f64::from(DENSITY / density), Bound::Relative(0.05));
    }
    for dt in [1.0 / 240.0, 1.0 / 30.0, 0.1] {
        let quantity = format!("spread up in ticks of {dt:.4} s over that in 1/60 s");
        add(bench, quantity, rate(DENSITY, dt)? / one, 1.0, Bound::Relative(0.03));
    }
    Ok(())
}

/// The time within a flame that dry and wet cotton takes to light: (σ c (T_ig − T₀) + w L) / q.
pub fn ignition(bench: &mut Bench) -> Result<(), ClothError> {
    let cotton = Flammability::COTTON;
    let warm = f64::from(cotton.specific_heat) * f64::from(cotton.ignition - ROOM_TEMPERATURE);
    for (density, water) in [(0.08_f32, 0.0_f32), (0.15, 0.0), (0.40, 0.0), (0.15, 0.02), (0.15, 0.05)] {
        let [lit, middle] = lit_from_below(density, water)?;
        let expected = (f64::from(density) * warm + f64::from(water) * LATENT_HEAT) / f64::from(cotton.heat_flux);
        let quantity = format!("time to light in a flame, {density} kg/m² with {water} kg/m² of water, s");
        add(bench, quantity, middle - lit, expected, Bound::Absolute(2.0 / 60.0));
    }
    // The flame below lasts 4.3 s, and this much water 4.5 s, before the cloth has been heated at all.
    let lights = lit_from_below(DENSITY, 0.1)?[1].is_finite();
    add(bench, "1 if cloth with 0.1 kg/m² of water lights".into(), f64::from(lights), 0.0, Bound::AtMost);
    Ok(())
}

/// When the lower end and the middle of a strip light, s: a high flame stands on the end, and the middle, 2 cm above
/// it, is wet with `water` kg/m². NaN for what does not light.
fn lit_from_below(density: f32, water: f32) -> Result<[f64; 2], ClothError> {
    // So high that the middle gets all of its flux.
    let tall = Flammability { reach_up: 10.0, ..Flammability::COTTON };
    let mut strip = Strip::new([0.02, 0.04], (0.02, false), density, Quat::IDENTITY, tall)?;
    strip.fire.wet(&strip.particles, Vec3::ZERO, 0.015, water)?;
    let way = strip.burn(Vec3::Y)?;
    let at = |height: f64| way.iter().find(|[_, x]| (x - height).abs() < 1e-4).map_or(f64::NAN, |[time, _]| *time);
    Ok([at(0.0), at(0.02)])
}
