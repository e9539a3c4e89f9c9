//! A scene, played without an engine.

use std::sync::Arc;

use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::contact::{Collider, Shape};
use cloth_solver::damage::fire::{Fire, Surroundings};
use cloth_solver::forces::GustyWind;
use cloth_solver::topology::{MeshSource, Resolution};
use cloth_solver::{Cloth, ClothError, Fabric, Motion, Pose, Tick, Topology, measure};
use glam::{Vec2, Vec3};

use crate::figure::Body;
use crate::fire::SceneFire;
use crate::scene::{SceneCloth, SceneCollider, ScenePlace, SceneWeight};
use crate::{Scene, SceneError, ScenePiece, SceneShape};

/// The cloths of a scene, each in its own frame ([`Scene::frame`]). Mannequins stand as they do at first, and so does what they wear.
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
        let frames: Vec<Pose> = scene.cloths.iter().map(|cloth| scene.frame(cloth)).collect();
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
        let dt = 1.0 / scene.rate;
        let before = self.elapsed;
        self.elapsed += f64::from(dt);
        self.wind.advance(scene.wind, &scene.gusts, dt);
        let all = self.cloths.iter_mut().zip(&mut self.fires).zip(&self.frames).zip(&scene.cloths);
        for (((cloth, fire), frame), spec) in all {
            cloth.air = scene.air;
            if scene.air.is_some() {
                let seen = |place: &ScenePlace| frame.inverse_pose(&place.pose());
                cloth.wind.set_wind(&self.wind, frame);
                cloth.wind.set_zones(scene.zones.iter().map(|spec| (spec.zone, seen(&spec.place))));
                let fans = scene.fans.iter().map(|spec| (spec.fan, spec.fan.turned(seen(&spec.place), self.elapsed)));
                cloth.wind.set_fans(fans, &cloth.contacts.colliders);
            }
            if spec.motion.is_some() || spec.gather < 1.0 {
                let rest: Vec<Vec3> = cloth.constraints.pins().pins.iter().map(|pin| pin.local).collect();
                for (local, moved) in rest.iter().zip(cloth.constraints.pin_frames_mut()) {
                    *moved = Motion { from: spec.held(*local, before), to: spec.held(*local, self.elapsed) };
                }
            }
            let held = scene.colliders.iter().filter(|collider| collider.mass.is_none());
            for (spec, collider) in held.zip(&mut cloth.contacts.colliders) {
                if let Some(motion) = &spec.motion {
                    let seen = |time| frame.inverse_pose(&placed(&spec.place.pose(), &motion.at(time)));
                    collider.motion = Motion { from: seen(before), to: seen(self.elapsed) };
                }
            }
            let gravity = frame.rotation.conjugate() * scene.gravity;
            let substeps = spec.substeps.unwrap_or(scene.substeps);
            cloth.step(Tick { iterations: scene.iterations, ..Tick::at_least(dt, substeps) }, gravity);
            if let Some(fire) = fire {
                let wind = match scene.air {
                    Some(_) => cloth.wind.at(measure::centre_of_mass(&cloth.particles).as_vec3()),
                    None => frame.rotation.conjugate() * scene.wind,
                };
                let around = Surroundings { wind, up: -gravity, ..Surroundings::default() };
                // Refused only where wind or gravity were changed to what no scene may have; then the fire stands still.
                let _ = cloth.burn(fire, &around, dt);
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
    let rectangle = Topology::rectangle(spec.size, Resolution::Cells(spec.cells)).map_err(of_cloth)?;
    let topology = match spec.piece() {
        Some(ScenePiece { positions, uvs, triangles }) => {
            let indices = triangles.as_flattened();
            let topology = Topology::from_mesh(MeshSource { positions: &positions, uvs: &uvs, indices });
            let topology = topology.map_err(of_cloth)?;
            // As an engine makes it, which finds rows and columns.
            if spec.wrap.is_some() { topology.into_quads() } else { topology }
        }
        None => rectangle,
    };
    let mut cloth = Cloth::new(Arc::new(topology), &fabric).map_err(of_cloth)?;
    cloth.set_method(spec.method.unwrap_or(scene.method));
    if let Some(settings) = &spec.self_contact {
        cloth.set_self_contact(&fabric, settings).map_err(of_cloth)?;
    }
    for weight in &spec.weights {
        hang(&mut cloth, weight, spec).map_err(of_cloth)?;
    }
    let pins = pins(&cloth.topology, spec).map_err(of_cloth)?;
    cloth.constraints.set_pins(&mut cloth.particles, pins).map_err(of_cloth)?;
    for (number, collider) in scene.colliders.iter().enumerate().filter(|(_, collider)| collider.mass.is_none()) {
        let error = |error| SceneError::Collider { collider: number, error };
        cloth.contacts.colliders.push(solid(collider, frame, &fabric).map_err(error)?);
    }
    for (figure, spec) in scene.figures.iter().enumerate() {
        for (part, shape, inner) in Body::new(spec.height).solids() {
            let at = placed(&spec.standing(part), &inner);
            let solid = form(&shape).map_err(|error| SceneError::Figure { figure, error })?;
            let motion = Motion::at_rest(frame.inverse_pose(&at));
            cloth.contacts.colliders.push(Collider { shape: solid, motion, friction: fabric.friction });
        }
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
        let particle = match cloth.topology.grid {
            Some(grid) => {
                let place = (*at * spec.cells.as_vec2()).round().as_uvec2();
                Some(grid.slot(place.y, place.x))
            }
            None => nearest(&cloth.topology, spec, *at),
        };
        if let Some(particle) = particle {
            fire.ignite_particle(particle)?;
        }
    }
    Ok(Some(fire))
}

/// A collider in the frame of a cloth of `fabric`.
pub(crate) fn solid(collider: &SceneCollider, frame: &Pose, fabric: &Fabric) -> Result<Collider, ClothError> {
    let shape = form(&collider.shape)?;
    let friction = collider.friction.unwrap_or(fabric.friction);
    ClothError::check("SceneCollider::friction", friction, 0.0..=10.0, "0..=10")?;
    Ok(Collider { shape, motion: Motion::at_rest(frame.inverse_pose(&collider.place.pose())), friction })
}

/// The form of a collider, as the solver knows it.
fn form(shape: &SceneShape) -> Result<Shape, ClothError> {
    match *shape {
        SceneShape::Sphere { radius } => Shape::sphere(radius),
        SceneShape::Capsule { radius, length } => Shape::capsule(radius, length),
        SceneShape::Cuboid { size } => Shape::cuboid(size),
        SceneShape::Pyramid { base, height } => Shape::pyramid(base, height),
        SceneShape::Ellipsoid { radii } => Shape::ellipsoid(radii),
        SceneShape::Cylinder { radius, height } => Shape::cylinder(radius, height),
        SceneShape::Cone { radius, height } => Shape::cone(radius, height),
        SceneShape::RoundedCuboid { size, radius } => Shape::rounded_cuboid(size, radius),
        SceneShape::Ground => Ok(Shape::HalfSpace),
    }
}

/// Hangs a weight on a cloth.
fn hang(cloth: &mut Cloth, weight: &SceneWeight, spec: &SceneCloth) -> Result<(), ClothError> {
    ClothError::check("SceneWeight::at.x", weight.at.x, 0.0..=1.0, "0..=1, parts of the width from the left")?;
    ClothError::check("SceneWeight::at.y", weight.at.y, 0.0..=1.0, "0..=1, parts of the height from the top")?;
    ClothError::check("SceneWeight::mass", weight.mass, 0.0..=1e6, "0..=1,000,000 kg")?;
    let particle = match cloth.topology.grid {
        Some(grid) => {
            let place = weight.row_and_column(spec.cells);
            Some(grid.slot(place.x, place.y))
        }
        None => nearest(&cloth.topology, spec, weight.at),
    };
    particle.map_or(Ok(()), |particle| cloth.particles.add_mass(particle as usize, weight.mass))
}

/// A pose seen from another that is placed in the world.
fn placed(place: &Pose, local: &Pose) -> Pose {
    Pose::new(place.point(local.position), (place.rotation * local.rotation).normalize())
}

fn pins(topology: &Topology, spec: &SceneCloth) -> Result<Pins, ClothError> {
    let mut slots: Vec<u32> = Vec::new();
    for group in &spec.pins {
        group.validate()?;
        match topology.grid {
            Some(grid) => {
                slots.extend(group.rows_and_columns(spec.cells).iter().map(|place| grid.slot(place.x, place.y)))
            }
            None => slots.extend(group.places(spec.cells).iter().filter_map(|part| nearest(topology, spec, *part))),
        }
    }
    slots.sort_unstable();
    slots.dedup();
    let moves = spec.motion.is_some() || spec.gather < 1.0;
    // Where pins move, each has a frame of its own.
    let frame = |index: usize| if moves { index as u32 } else { 0 };
    let pin = |(index, particle): (usize, u32)| Pin {
        particle,
        frame: frame(index),
        local: topology.rest[particle as usize],
    };
    let pins: Vec<Pin> = slots.into_iter().enumerate().map(pin).collect();
    let frames = match moves {
        true => pins.iter().map(|pin| Motion::at_rest(spec.held(pin.local, 0.0))).collect(),
        false => vec![Motion::default()],
    };
    Ok(Pins { frames, pins })
}

/// The particle at rest nearest to a point of the rectangle.
fn nearest(topology: &Topology, spec: &SceneCloth, part: Vec2) -> Option<u32> {
    let at = spec.point(part);
    let distance = |slot: &u32| topology.rest[*slot as usize].distance_squared(at);
    topology.particles().min_by(|a, b| distance(a).total_cmp(&distance(b)))
}
