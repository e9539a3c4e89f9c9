//! A scene, played without an engine.

use std::sync::Arc;

use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::contact::{Collider, Shape};
use cloth_solver::damage::fire::{Fire, Surroundings};
use cloth_solver::forces::GustyWind;
use cloth_solver::topology::Resolution;
use cloth_solver::{Cloth, ClothError, Fabric, Motion, Pose, Tick, Topology, measure};
use glam::UVec2;

use crate::fire::SceneFire;
use crate::scene::{SceneCloth, SceneCollider, ScenePins, ScenePlace, SceneShape, SceneWeight};
use crate::{Scene, SceneError};

/// The cloths of a scene, each in its own frame (the scene's [`place`](SceneCloth::place)).
#[derive(Clone, Debug)]
pub struct World {
    /// What it was built from. Air and all that moves it, gravity, rate, substeps and iterations may be changed while it
    /// runs.
    pub scene: Scene,
    /// The cloths.
    pub cloths: Vec<Cloth>,
    /// Their frames.
    pub frames: Vec<Pose>,
    /// The fires of those that may burn.
    pub fires: Vec<Option<Fire>>,
    wind: GustyWind,
    /// s.
    elapsed: f64,
}

impl World {
    /// The scene at rest.
    ///
    /// # Errors
    /// What in the scene is out of range.
    pub fn new(scene: &Scene) -> Result<Self, SceneError> {
        let frames: Vec<Pose> = scene.cloths.iter().map(|cloth| cloth.place.pose()).collect();
        let (mut cloths, mut fires) = (Vec::with_capacity(scene.cloths.len()), Vec::new());
        for (index, (spec, frame)) in scene.cloths.iter().zip(&frames).enumerate() {
            let cloth = build(index, spec, frame, scene)?;
            fires.push(light(spec, &cloth).map_err(|error| SceneError::Cloth { cloth: index, error })?);
            cloths.push(cloth);
        }
        Ok(Self { scene: scene.clone(), cloths, frames, fires, wind: GustyWind::default(), elapsed: 0.0 })
    }

    /// Advances by one tick of `1/rate` seconds.
    pub fn tick(&mut self) {
        let scene = &self.scene;
        let tick = Tick { iterations: scene.iterations, ..Tick::at_least(1.0 / scene.rate, scene.substeps) };
        self.elapsed += f64::from(tick.dt);
        self.wind.advance(scene.wind, &scene.gusts, tick.dt);
        for ((cloth, fire), frame) in self.cloths.iter_mut().zip(&mut self.fires).zip(&self.frames) {
            cloth.air = scene.air;
            if scene.air.is_some() {
                let seen = |place: &ScenePlace| frame.inverse_pose(&place.pose());
                cloth.wind.set_wind(&self.wind, frame);
                cloth.wind.set_zones(scene.zones.iter().map(|spec| (spec.zone, seen(&spec.place))));
                let fans = scene.fans.iter().map(|spec| (spec.fan, spec.fan.turned(seen(&spec.place), self.elapsed)));
                cloth.wind.set_fans(fans, &cloth.contacts.colliders);
            }
            let gravity = frame.rotation.conjugate() * scene.gravity;
            cloth.step(tick, gravity);
            if let Some(fire) = fire {
                let wind = match scene.air {
                    Some(_) => cloth.wind.at(measure::centre_of_mass(&cloth.particles).as_vec3()),
                    None => frame.rotation.conjugate() * scene.wind,
                };
                let around = Surroundings { wind, up: -gravity, ..Surroundings::default() };
                // Refused only where wind or gravity were changed to what no scene may have; then the fire stands still.
                let _ = cloth.burn(fire, &around, tick.dt);
            }
        }
    }

    /// Number of ticks in the scene's [`seconds`](Scene::seconds), at least 1.
    pub fn ticks(&self) -> u32 {
        (self.scene.seconds * self.scene.rate).round().max(1.0) as u32
    }
}

fn build(index: usize, spec: &SceneCloth, frame: &Pose, scene: &Scene) -> Result<Cloth, SceneError> {
    let of_cloth = |error| SceneError::Cloth { cloth: index, error };
    let fabric = spec.fabric().map_err(|name| SceneError::NoSuchFabric {
        cloth: index,
        name,
        allowed: Fabric::PRESETS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", "),
    })?;
    let topology = Topology::rectangle(spec.size, Resolution::Cells(spec.cells)).map_err(of_cloth)?;
    let mut cloth = Cloth::new(Arc::new(topology), &fabric).map_err(of_cloth)?;
    cloth.set_method(scene.method);
    if let Some(settings) = &spec.self_contact {
        cloth.set_self_contact(&fabric, settings).map_err(of_cloth)?;
    }
    for weight in &spec.weights {
        hang(&mut cloth, weight, spec.cells).map_err(of_cloth)?;
    }
    let pins = pins(&cloth.topology, &spec.pins).map_err(of_cloth)?;
    cloth.constraints.set_pins(&mut cloth.particles, pins).map_err(of_cloth)?;
    for (number, collider) in scene.colliders.iter().enumerate() {
        let error = |error| SceneError::Collider { collider: number, error };
        cloth.contacts.colliders.push(solid(collider, frame, &fabric).map_err(error)?);
    }
    Ok(cloth)
}

/// The fire of a cloth that may burn, lit where the scene says.
fn light(spec: &SceneCloth, cloth: &Cloth) -> Result<Option<Fire>, ClothError> {
    let Some(SceneFire { burns, lit }) = &spec.fire else { return Ok(None) };
    // A fabric that is none was refused before.
    let mut fire = Fire::new(&cloth.topology, &spec.fabric().unwrap_or_default(), burns)?;
    for at in lit {
        ClothError::check("SceneFire::lit.x", at.x, 0.0..=1.0, "0..=1, parts of the width from the left")?;
        ClothError::check("SceneFire::lit.y", at.y, 0.0..=1.0, "0..=1, parts of the height from the top")?;
        if let Some(grid) = cloth.topology.grid {
            let place = (*at * spec.cells.as_vec2()).round().as_uvec2();
            fire.ignite_particle(grid.slot(place.y, place.x))?;
        }
    }
    Ok(Some(fire))
}

/// A collider in the frame of a cloth of `fabric`.
pub(crate) fn solid(collider: &SceneCollider, frame: &Pose, fabric: &Fabric) -> Result<Collider, ClothError> {
    let shape = match collider.shape {
        SceneShape::Sphere { radius } => Shape::sphere(radius)?,
        SceneShape::Capsule { radius, length } => Shape::capsule(radius, length)?,
        SceneShape::Cuboid { size } => Shape::cuboid(size)?,
        SceneShape::Pyramid { base, height } => Shape::pyramid(base, height)?,
        SceneShape::Ellipsoid { radii } => Shape::ellipsoid(radii)?,
        SceneShape::Cylinder { radius, height } => Shape::cylinder(radius, height)?,
        SceneShape::Cone { radius, height } => Shape::cone(radius, height)?,
        SceneShape::RoundedCuboid { size, radius } => Shape::rounded_cuboid(size, radius)?,
        SceneShape::Ground => Shape::HalfSpace,
    };
    let friction = collider.friction.unwrap_or(fabric.friction);
    ClothError::check("SceneCollider::friction", friction, 0.0..=10.0, "0..=10")?;
    Ok(Collider { shape, motion: Motion::at_rest(frame.inverse_pose(&collider.place.pose())), friction })
}

/// Hangs a weight on a rectangle of `cells`.
fn hang(cloth: &mut Cloth, weight: &SceneWeight, cells: UVec2) -> Result<(), ClothError> {
    ClothError::check("SceneWeight::at.x", weight.at.x, 0.0..=1.0, "0..=1, parts of the width from the left")?;
    ClothError::check("SceneWeight::at.y", weight.at.y, 0.0..=1.0, "0..=1, parts of the height from the top")?;
    ClothError::check("SceneWeight::mass", weight.mass, 0.0..=1e6, "0..=1,000,000 kg")?;
    let Some(grid) = cloth.topology.grid else { return Ok(()) };
    let place = weight.row_and_column(cells);
    cloth.particles.add_mass(grid.slot(place.x, place.y) as usize, weight.mass)
}

fn pins(topology: &Topology, groups: &[ScenePins]) -> Result<Pins, ClothError> {
    let Some(grid) = topology.grid else { return Ok(Pins::default()) };
    let mut slots: Vec<u32> = Vec::new();
    for group in groups {
        match *group {
            ScenePins::Top => slots.extend((0..grid.columns).map(|column| grid.slot(0, column))),
            ScenePins::Corners => slots.extend([grid.slot(0, 0), grid.slot(0, grid.columns - 1)]),
            ScenePins::Rods(rods) => {
                ClothError::check("ScenePins::Rods", rods as f32, 0.0..=1e5, "0..=100,000")?;
                slots.extend((0..rods).map(|rod| {
                    let part = if rods > 1 { rod as f32 / (rods - 1) as f32 } else { 0.5 };
                    grid.slot(0, (part * (grid.columns - 1) as f32).round() as u32)
                }));
            }
            ScenePins::Left => slots.extend((0..grid.rows).map(|row| grid.slot(row, 0))),
        }
    }
    slots.sort_unstable();
    slots.dedup();
    let pin = |particle: u32| Pin { particle, frame: 0, local: topology.rest[particle as usize] };
    Ok(Pins { frames: vec![Motion::default()], pins: slots.into_iter().map(pin).collect() })
}
