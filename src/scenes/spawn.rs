//! A scene file, spawned as entities.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy_cloth::cloth_solver::Pose;
use bevy_cloth::{
    Cloth, ClothCollider, ClothFire, ClothReset, ClothTopology, ColliderFriction, IgniteCloth, PinSelect, Pins,
    Substeps, Tearable, Weight, Weights,
};
use cloth_scene::{Finish, Hardware, Scene, SceneCloth, SceneFan, ScenePins, SceneProp, SceneShape, SceneZone};

use super::finish::{Finishes, SOLIDS};
use super::hardware::Fitted;
use super::moving::Moving;
use super::riders::Rider;
use super::save::Said;
use super::{OfScene, curtain_rod, dress, mannequin, setting};
use crate::select::Selectable;
use crate::shapes::mesh_of;
use crate::throw::{Ball, ball};

/// How far a match reaches, m.
const MATCH: f32 = 0.02;

/// Spawns what a scene says, and what is around it; `low` is the lowest place that anything of it reaches, m.
pub fn spawn(
    In((scene, low)): In<(Box<Scene>, Vec3)>,
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut finishes: Finishes,
) {
    let mut number = 0_u8;
    let mut next = || {
        number = number.saturating_add(1);
        Selectable(number)
    };
    let mut figures = Vec::new();
    for (index, figure) in scene.figures.iter().enumerate() {
        let named = (named(&figure.name, "mannequin", index), next());
        figures.push(mannequin::spawn(&mut commands, &mut meshes, &mut finishes, (figure, index), named));
    }
    for (index, cloth) in scene.cloths.iter().enumerate() {
        let (name, look) = (named(&cloth.name, "cloth", index), dress::look(cloth, index));
        let entity = spawn_cloth(&mut commands, &mut meshes, &scene, cloth, (name, next()));
        commands.entity(entity).insert((look, Said(cloth.clone(), index)));
        let wearer = cloth.worn.and_then(|worn| Some(figures.get(worn.figure as usize)?[worn.part as usize]));
        if let Some(part) = wearer {
            commands.entity(entity).insert(ChildOf(part));
        }
        for weight in &cloth.weights {
            let Some((form, finish)) = &weight.body else { continue };
            if let (Some(mesh), Some(material)) = (mesh_of(&shape(form)), finishes.material(*finish)) {
                let half = half_height(form);
                let vertex = vertices(cloth, &[weight.at]).first().copied().unwrap_or_default();
                let rider = Rider { cloth: entity, vertex, half };
                commands.spawn((OfScene, rider, Mesh3d(meshes.add(mesh)), material, Pickable::IGNORE));
            }
        }
    }
    for (index, collider) in scene.colliders.iter().enumerate() {
        let name = named(&collider.name, "collider", index);
        let place = transform(&collider.place.pose());
        if let (Some(mass), SceneShape::Sphere { radius }) = (collider.mass, &collider.shape) {
            let finish = collider.finish.unwrap_or(Finish::Paint(SOLIDS[index % SOLIDS.len()]));
            let material = finishes.material(finish).unwrap_or_default();
            let at = place.translation;
            let said = Said(collider.clone(), index);
            commands.spawn((name, said, ball(Ball::new(0, at, Vec3::ZERO).of_mass(mass), at, *radius, material)));
            continue;
        }
        let (said, shape) = (Said(collider.clone(), index), shape(&collider.shape));
        let mut entity = commands.spawn((OfScene, name, said, shape, place, Visibility::default()));
        if collider.shape != SceneShape::Ground {
            let finish = collider.finish.unwrap_or(Finish::Paint(SOLIDS[index % SOLIDS.len()]));
            entity.insert(next());
            if let Some(material) = finishes.material(finish) {
                entity.insert(material);
            }
        }
        if let Some(friction) = collider.friction {
            entity.insert(ColliderFriction(friction));
        }
        if let Some(motion) = &collider.motion {
            entity.insert(Moving::new(motion, place));
        }
    }
    for SceneProp { shape: form, finish, place } in &scene.props {
        if let (Some(mesh), Some(material)) = (mesh_of(&shape(form)), finishes.material(*finish)) {
            let place = transform(&place.pose());
            commands.spawn((OfScene, Mesh3d(meshes.add(mesh)), material, place, Pickable::IGNORE));
        }
    }
    for (index, said) in scene.fans.iter().enumerate() {
        let SceneFan { name, fan, place } = said;
        let (name, said, place) = (named(name, "fan", index), Said(said.clone(), index), transform(&place.pose()));
        commands.spawn((OfScene, name, next(), said, *fan, place));
    }
    for (index, said) in scene.zones.iter().enumerate() {
        let SceneZone { name, zone, place } = said;
        let (name, said, place) =
            (named(name, "wind zone", index), Said(said.clone(), index), transform(&place.pose()));
        commands.spawn((OfScene, name, next(), said, *zone, place));
    }
    // A scene that says nothing of the ground is shown over some, well below what happens in it.
    let ground = scene.colliders.iter().find(|collider| collider.shape == SceneShape::Ground);
    if ground.is_none() {
        let height = if low.y > 0.0 { 0.0 } else { low.y - 0.5 };
        commands.spawn((
            OfScene,
            Name::new("ground"),
            ClothCollider::Ground,
            Transform::from_xyz(0.0, height, 0.0),
            Visibility::default(),
        ));
    }
    let height = ground.map_or(if low.y > 0.0 { 0.0 } else { low.y - 0.5 }, |ground| ground.place.at.y);
    commands.trigger(setting::Build { setting: scene.view.setting, height });
}

fn spawn_cloth(
    commands: &mut Commands,
    meshes: &mut Assets<Mesh>,
    scene: &Scene,
    spec: &SceneCloth,
    named: (Name, Selectable),
) -> Entity {
    let place = transform(&spec.place.pose());
    // A scene with a fabric that is none was refused when it was opened.
    let fabric = spec.fabric().unwrap_or_default();
    let mut entity = commands.spawn((OfScene, named, fabric, place, Visibility::default()));
    match cut_out(spec) {
        Some(piece) => entity.insert((Cloth::mesh(), Mesh3d(meshes.add(piece)))),
        None => entity.insert(Cloth::rectangle(spec.size.x, spec.size.y).with_cells(spec.cells.x, spec.cells.y)),
    };
    if !spec.pins.is_empty() {
        entity.insert(pins(spec));
    }
    if !spec.weights.is_empty() {
        entity.insert(weights(spec));
    }
    if let Some(self_contact) = spec.self_contact {
        entity.insert(self_contact);
    }
    if let Some(fire) = &spec.fire {
        let frame = scene.frame(spec);
        let at = |part: &Vec2| frame.point(spec.point(*part));
        entity.insert((fire.burns, Lit(fire.lit.iter().map(at).collect())));
    }
    if let Some(tearing) = spec.tearing {
        entity.insert(Tearable { scale: tearing.scale, ..default() });
    }
    if let Some(method) = spec.method {
        entity.insert(method);
    }
    if let Some(count) = spec.substeps {
        entity.insert(Substeps { count, max: count.max(Substeps::default().max), iterations: scene.iterations });
    }
    if let Some(air) = scene.air {
        entity.insert(air);
    }
    if let Some(motion) = &spec.motion {
        entity.insert(Moving::new(motion, place));
    }
    let entity = entity.id();
    let places = spec.pins.iter().flat_map(|group| group.places(spec.cells));
    let places = places.map(|part| spec.point(part));
    match (spec.hardware, &spec.pins[..]) {
        (Hardware::Auto, [ScenePins::Rods(_)]) | (Hardware::SlidingRod, _) => {
            let rod = place * Transform::from_xyz(0.0, spec.size.y / 2.0 + curtain_rod::DROP, 0.0);
            curtain_rod::hang(commands, rod, entity, spec.gather, spec.hardware == Hardware::SlidingRod);
        }
        (Hardware::Pegs | Hardware::Rings, _) => {
            commands.entity(entity).insert(Fitted { what: spec.hardware, at: places.collect() });
        }
        _ => {}
    }
    entity
}

/// The mesh of a piece that is cut out of a rectangle, or goes around something.
fn cut_out(spec: &SceneCloth) -> Option<Mesh> {
    let piece = spec.piece()?;
    let indices = piece.triangles.concat();
    Some(
        Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, piece.positions)
            .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, piece.uvs)
            .with_inserted_indices(Indices::U32(indices))
            .with_computed_normals(),
    )
}

/// Where a cloth is to be lit as soon as it runs, in the world, m.
#[derive(Component)]
#[require(Unlit)]
pub struct Lit(Vec<Vec3>);

/// A cloth that is still to be lit, at first and after each reset.
#[derive(Component, Default)]
pub struct Unlit;

/// Holds the matches to each cloth that has begun to run. One that burnt is whole again a tick after its reset.
pub fn light(
    mut reset: MessageReader<ClothReset>,
    cloths: Query<(Entity, &Lit, Option<&ClothFire>), (With<Unlit>, With<ClothTopology>)>,
    lit: Query<(), With<Lit>>,
    mut commands: Commands,
) {
    let is_whole = |fire: &ClothFire| !fire.is_warm() && fire.char().iter().all(|char| *char == 0.0);
    for (entity, Lit(places), _) in cloths.iter().filter(|(_, _, fire)| fire.is_none_or(is_whole)) {
        for position in places {
            commands.trigger(IgniteCloth { entity, position: *position, radius: MATCH });
        }
        commands.entity(entity).remove::<Unlit>();
    }
    for ClothReset { entity } in reset.read().filter(|reset| lit.contains(reset.entity)) {
        commands.entity(*entity).insert(Unlit);
    }
}

fn pins(spec: &SceneCloth) -> Pins {
    let is_flat = spec.outline.is_empty() && spec.wrap.is_none();
    let groups = spec.pins.iter().map(|group| match group {
        // By name where there is one: they follow a change of the size.
        ScenePins::Top if is_flat => Pins::top(),
        ScenePins::Corners if is_flat => Pins::corners(),
        ScenePins::Rods(rods) if is_flat => Pins::rods(*rods),
        _ => Pins::vertices(vertices(spec, &group.places(spec.cells))),
    });
    groups.fold(Pins::default(), Pins::and)
}

/// The vertices nearest to points of the rectangle.
fn vertices(spec: &SceneCloth, places: &[Vec2]) -> Vec<u32> {
    let Some(piece) = spec.piece() else {
        let nearest = |part: &Vec2| (part.clamp(Vec2::ZERO, Vec2::ONE) * spec.cells.as_vec2()).round().as_uvec2();
        return places.iter().map(nearest).map(|place| place.y * (spec.cells.x + 1) + place.x).collect();
    };
    let nearest = |part: &Vec2| {
        let distance = |uv: &Vec2| ((uv - part) * spec.size).length_squared();
        let best = piece.uvs.iter().enumerate().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
        best.map(|(vertex, _)| vertex as u32)
    };
    places.iter().filter_map(nearest).collect()
}

fn weights(spec: &SceneCloth) -> Weights {
    let weight = |weight: &cloth_scene::SceneWeight| Weight {
        select: PinSelect::Vertices(vertices(spec, &[weight.at])),
        mass: weight.mass,
    };
    Weights(spec.weights.iter().map(weight).collect())
}

/// Half the height of what stands on a cloth, m.
fn half_height(shape: &SceneShape) -> f32 {
    match *shape {
        SceneShape::Sphere { radius } => radius,
        SceneShape::Capsule { radius, length } => radius + length / 2.0,
        SceneShape::Cuboid { size } | SceneShape::RoundedCuboid { size, .. } => size.y / 2.0,
        SceneShape::Pyramid { height, .. } | SceneShape::Cylinder { height, .. } | SceneShape::Cone { height, .. } => {
            height / 2.0
        }
        SceneShape::Ellipsoid { radii } => radii.y,
        SceneShape::Ground => 0.0,
    }
}

pub fn shape(shape: &SceneShape) -> ClothCollider {
    match *shape {
        SceneShape::Sphere { radius } => ClothCollider::Sphere { radius },
        SceneShape::Capsule { radius, length } => ClothCollider::Capsule { radius, length },
        SceneShape::Cuboid { size } => ClothCollider::Cuboid { size },
        SceneShape::Pyramid { base, height } => ClothCollider::Pyramid { base, height },
        SceneShape::Ellipsoid { radii } => ClothCollider::Ellipsoid { radii },
        SceneShape::Cylinder { radius, height } => ClothCollider::Cylinder { radius, height },
        SceneShape::Cone { radius, height } => ClothCollider::Cone { radius, height },
        SceneShape::RoundedCuboid { size, radius } => ClothCollider::RoundedCuboid { size, radius },
        SceneShape::Ground => ClothCollider::Ground,
    }
}

fn named(name: &str, kind: &str, index: usize) -> Name {
    if name.is_empty() { Name::new(format!("{kind} {}", index + 1)) } else { Name::new(name.to_owned()) }
}

fn transform(pose: &Pose) -> Transform {
    Transform::from_translation(pose.position).with_rotation(pose.rotation)
}

#[cfg(test)]
mod tests {
    use bevy_cloth::{Flammable, ResetCloth};

    use super::*;
    use crate::scenes::open;
    use crate::test_game::Game;

    #[test]
    fn a_cloth_that_is_opened_burning_burns_again_after_a_reset() {
        let mut game = Game::new();
        game.app.add_systems(Update, light);
        let place = Vec3::new(0.0, 1.0, 0.0);
        let cloth = (Cloth::rectangle(1.0, 1.0).with_cells(16, 16), Pins::top(), Flammable::default());
        let cloth = game.spawn((cloth, Transform::from_xyz(0.0, 1.5, 0.0), Lit(vec![place])));
        for _ in 0..2 {
            game.run(1.0);
            assert!(game.get::<ClothFire>(cloth).flaming() > 0, "it burns");
            game.app.world_mut().trigger(ResetCloth { entity: cloth });
        }
    }

    #[test]
    fn a_weight_on_the_lower_right_corner_hangs_on_the_last_vertex() {
        let spec = &open("weight_on_corner").expect("there").cloths[0];
        let Weights(weights) = weights(spec);
        assert_eq!(weights[0].select, PinSelect::Vertices(vec![64 * 64 - 1]));
        assert_eq!(weights[0].mass, spec.weights[0].mass);
    }

    #[test]
    fn a_flag_is_held_along_its_left_edge() {
        let spec = &open("flag_in_wind").expect("there").cloths[0];
        let PinSelect::Vertices(vertices) = &pins(spec).0[0].select else { panic!() };
        assert_eq!((vertices.len(), vertices[0], vertices[40]), (41, 0, 40 * 61));
    }
}
