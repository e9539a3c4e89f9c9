//! A scene file, spawned as entities.

use bevy::prelude::*;
use bevy_cloth::cloth_solver::{Pose, measure};
use bevy_cloth::{
    Cloth, ClothCollider, ClothFire, ClothReset, ClothTopology, ColliderFriction, Gravity, IgniteCloth, Method,
    PinSelect, Pins, Shared, Substeps, Weight, Weights, Wind,
};
use cloth_scene::{Scene, SceneCloth, SceneCollider, SceneFan, ScenePins, SceneShape, SceneZone, World as ScenePlay};

use super::curtain_rod;
use super::stage::{glossy, matte, spawn_ground};
use crate::camera::Viewpoint;
use crate::select::Selectable;

/// Colours of the cloths, in turn.
const FABRICS: [Color; 4] = [
    Color::srgb(0.42, 0.045, 0.085),
    Color::srgb(0.10, 0.30, 0.45),
    Color::srgb(0.70, 0.58, 0.30),
    Color::srgb(0.16, 0.36, 0.20),
];
/// Colours of the colliders, in turn.
const SOLIDS: [Color; 4] = [
    Color::srgb(0.10, 0.42, 0.46),
    Color::srgb(0.82, 0.55, 0.16),
    Color::srgb(0.24, 0.30, 0.55),
    Color::srgb(0.45, 0.44, 0.42),
];
/// From where a scene is looked at, from its middle.
const DIRECTION: Vec3 = Vec3::new(0.42, 0.32, 1.0);
/// Distance of the camera, in radii of the scene.
const DISTANCE: f32 = 2.2;
/// The least height of the camera above the ground, m.
const LOWEST: f32 = 0.3;
/// How long the scene is played beforehand to see where its cloths will be, s, and how coarsely; by the default method,
/// which so few substeps suffice.
const FORESEEN: (f32, u32, u32) = (3.0, 4, 5);

/// How far a match reaches, m.
const MATCH: f32 = 0.02;

/// The scene to be opened.
#[derive(Resource, Clone, Debug)]
pub struct SceneFile(pub Box<Scene>);

/// Sets the game's clock and what all cloths of `scene` share: the one place that hands its budget over.
pub fn configure(app: &mut App, scene: &Scene) {
    let (count, iterations) = (scene.substeps.min(200), scene.iterations.min(100));
    app.insert_resource(Time::<Fixed>::from_hz(f64::from(scene.rate)))
        .insert_resource(Shared(Substeps { count, max: count.max(Substeps::default().max), iterations }))
        .insert_resource(Shared(scene.method))
        .insert_resource(Shared(Gravity(scene.gravity)))
        .insert_resource(Shared(Wind(scene.wind)))
        .insert_resource(Shared(scene.gusts))
        .insert_resource(SceneFile(Box::new(scene.clone())));
}

/// Spawns the scene.
pub fn spawn(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    file: Res<SceneFile>,
) {
    let scene = &file.0;
    let (low, high) = bounds(scene);
    commands.insert_resource(viewpoint(low, high));
    let mut number = 0_u8;
    let mut next = || {
        number = number.saturating_add(1);
        Selectable(number)
    };
    for (index, cloth) in scene.cloths.iter().enumerate() {
        let material = materials.add(matte(FABRICS[index % FABRICS.len()]));
        spawn_cloth(&mut commands, scene, cloth, named(&cloth.name, "cloth", index), next(), MeshMaterial3d(material));
    }
    for (index, collider) in scene.colliders.iter().enumerate() {
        let place = transform(&collider.place.pose());
        let entity = match shape(collider) {
            ClothCollider::Ground => spawn_ground(&mut commands, &mut meshes, &mut materials, place),
            solid => {
                let material = MeshMaterial3d(materials.add(glossy(SOLIDS[index % SOLIDS.len()])));
                let name = named(&collider.name, "collider", index);
                commands.spawn((name, next(), solid, material, place)).id()
            }
        };
        if let Some(friction) = collider.friction {
            commands.entity(entity).insert(ColliderFriction(friction));
        }
    }
    for (index, SceneFan { name, fan, place }) in scene.fans.iter().enumerate() {
        commands.spawn((named(name, "fan", index), next(), *fan, transform(&place.pose())));
    }
    for (index, SceneZone { name, zone, place }) in scene.zones.iter().enumerate() {
        commands.spawn((named(name, "wind zone", index), next(), *zone, transform(&place.pose())));
    }
    // A scene that says nothing of the ground is shown over some, well below what happens in it.
    if !scene.colliders.iter().any(|collider| collider.shape == SceneShape::Ground) {
        let height = if low.y > 0.0 { 0.0 } else { low.y - 0.5 };
        spawn_ground(&mut commands, &mut meshes, &mut materials, Transform::from_xyz(0.0, height, 0.0));
    }
}

fn spawn_cloth(
    commands: &mut Commands,
    scene: &Scene,
    spec: &SceneCloth,
    name: Name,
    selectable: Selectable,
    material: MeshMaterial3d<StandardMaterial>,
) {
    let place = transform(&spec.place.pose());
    let cloth = Cloth::rectangle(spec.size.x, spec.size.y).with_cells(spec.cells.x, spec.cells.y);
    // A scene with a fabric that is none was refused when it was opened.
    let fabric = spec.fabric().unwrap_or_default();
    let entity = commands.spawn((name, selectable, cloth, fabric, material, place)).id();
    if !spec.pins.is_empty() {
        commands.entity(entity).insert(pins(spec));
    }
    if !spec.weights.is_empty() {
        commands.entity(entity).insert(weights(spec));
    }
    if let Some(self_contact) = spec.self_contact {
        commands.entity(entity).insert(self_contact);
    }
    if let Some(fire) = &spec.fire {
        let at = |part: &Vec2| place.transform_point(((*part - 0.5) * spec.size * Vec2::new(1.0, -1.0)).extend(0.0));
        commands.entity(entity).insert((fire.burns, Lit(fire.lit.iter().map(at).collect())));
    }
    if let Some(air) = scene.air {
        commands.entity(entity).insert(air);
    }
    if let [ScenePins::Rods(_)] = spec.pins[..] {
        let rod = place * Transform::from_xyz(0.0, spec.size.y / 2.0 + curtain_rod::DROP, 0.0);
        curtain_rod::hang(commands, rod, entity);
    }
}

/// Where a cloth is to be lit as soon as it runs, in the world, m.
#[derive(Component)]
#[require(Unlit)]
pub struct Lit(Vec<Vec3>);

/// A cloth that is still to be lit, at first and after each reset.
#[derive(Component, Default)]
pub struct Unlit;

/// Holds the matches to each cloth that has begun to run. One that burnt is whole again a
/// tick after its reset.
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
    let columns = spec.cells.x + 1;
    let groups = spec.pins.iter().map(|group| match *group {
        ScenePins::Top => Pins::top(),
        ScenePins::Corners => Pins::corners(),
        ScenePins::Rods(rods) => Pins::rods(rods),
        ScenePins::Left => Pins::vertices((0..=spec.cells.y).map(|row| row * columns)),
    });
    groups.fold(Pins::default(), Pins::and)
}

fn weights(spec: &SceneCloth) -> Weights {
    let weight = |weight: &cloth_scene::SceneWeight| {
        let place = weight.row_and_column(spec.cells);
        Weight { select: PinSelect::Vertices(vec![place.x * (spec.cells.x + 1) + place.y]), mass: weight.mass }
    };
    Weights(spec.weights.iter().map(weight).collect())
}

fn shape(collider: &SceneCollider) -> ClothCollider {
    match collider.shape {
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

/// The box around all that the scene shows in its first seconds, ground apart, m: found by playing it coarsely.
fn bounds(scene: &Scene) -> (Vec3, Vec3) {
    let (seconds, fewer, substeps) = FORESEEN;
    let mut coarse = scene.clone();
    (coarse.rate, coarse.substeps, coarse.method) = (60.0, substeps, Method::default());
    for cloth in &mut coarse.cloths {
        cloth.cells = (cloth.cells / fewer).max(UVec2::ONE);
    }
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for collider in &scene.colliders {
        let (at, half) = (collider.place.at, half_extent(&collider.shape));
        if let Some(half) = half {
            (low, high) = (low.min(at - half), high.max(at + half));
        }
    }
    for SceneFan { fan, place, .. } in &scene.fans {
        (low, high) = (low.min(place.at - fan.diameter / 2.0), high.max(place.at + fan.diameter / 2.0));
    }
    if let Ok(mut play) = ScenePlay::new(&coarse) {
        for _ in 0..=(seconds.min(scene.seconds) * coarse.rate) as u32 {
            for (cloth, frame) in play.cloths.iter().zip(&play.frames) {
                let (from, to) = measure::bounds(&cloth.topology, &cloth.particles.position);
                for corner in 0..8 {
                    let pick = |axis: usize| if corner >> axis & 1 == 0 { from[axis] } else { to[axis] };
                    let corner = frame.point(Vec3::new(pick(0), pick(1), pick(2)));
                    if corner.is_finite() {
                        (low, high) = (low.min(corner), high.max(corner));
                    }
                }
            }
            play.tick();
        }
    }
    if low.cmple(high).all() { (low, high) } else { (Vec3::NEG_ONE, Vec3::ONE) }
}

/// Half the edges of a box around a shape however it is turned, m; `None` of what has no end.
fn half_extent(shape: &SceneShape) -> Option<Vec3> {
    match *shape {
        SceneShape::Sphere { radius } => Some(Vec3::splat(radius)),
        SceneShape::Capsule { radius, length } => Some(Vec3::new(radius, radius + length / 2.0, radius)),
        SceneShape::Cuboid { size } => Some(size / 2.0),
        SceneShape::Pyramid { base, height } => Some(Vec3::new(base.x, height, base.y) / 2.0),
        SceneShape::Ellipsoid { radii } => Some(radii),
        SceneShape::Cylinder { radius, height } | SceneShape::Cone { radius, height } => {
            Some(Vec3::new(radius, height / 2.0, radius))
        }
        SceneShape::RoundedCuboid { size, .. } => Some(size / 2.0),
        SceneShape::Ground => None,
    }
}

/// A place from where the whole box is seen.
fn viewpoint(low: Vec3, high: Vec3) -> Viewpoint {
    let middle = (low + high) / 2.0;
    let radius = ((high - low).length() / 2.0).clamp(0.1, 20.0);
    let mut from = middle + DIRECTION.normalize() * (DISTANCE * radius);
    from.y = from.y.max(LOWEST);
    Viewpoint { from, to: middle }
}

#[cfg(test)]
mod tests {
    use bevy_cloth::{Flammable, ResetCloth};

    use super::*;
    use crate::scenes::catalog;
    use crate::test_game::Game;

    fn scene(name: &str) -> Scene {
        match catalog::open(name) {
            Ok(catalog::Scene::File(scene)) => *scene,
            other => panic!("{name}: {other:?}"),
        }
    }

    #[test]
    fn a_weight_on_the_lower_right_corner_hangs_on_the_last_vertex() {
        let spec = &scene("weight_on_corner").cloths[0];
        let Weights(weights) = weights(spec);
        assert_eq!(weights[0].select, PinSelect::Vertices(vec![64 * 64 - 1]));
        assert_eq!(weights[0].mass, spec.weights[0].mass);
    }

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
    fn a_flag_is_held_along_its_left_edge() {
        let spec = &scene("flag_in_wind").cloths[0];
        let PinSelect::Vertices(vertices) = &pins(spec).0[0].select else { panic!() };
        assert_eq!((vertices.len(), vertices[0], vertices[40]), (41, 0, 40 * 61));
    }

    #[test]
    fn the_camera_has_in_view_what_a_swing_falls_to() {
        let (low, high) = bounds(&scene("swing"));
        assert!(low.y < 0.6 && high.y >= 1.5 && high.z > 0.4, "{low} {high}");
        let Viewpoint { from, to } = viewpoint(low, high);
        assert!((to - (low + high) / 2.0).length() < 1e-6 && from.z > high.z);
    }
}
