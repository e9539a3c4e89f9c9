//! The scene that is open, as it is now: what could be written to a file and opened again.

use bevy::ecs::query::ROQueryItem;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_cloth::cloth_solver::Pose;
use bevy_cloth::{
    Air, Cloth, ClothCollider, ClothSource, ColliderFriction, Fabric, Fan, Flammable, Gravity, Gusts, Method,
    Resolution, SelfContact, Shared, Substeps, Tearable, Wind, WindZone,
};
use cloth_scene::{
    Scene, SceneCloth, SceneCollider, SceneFabric, SceneFan, SceneFigure, SceneFire, ScenePlace, SceneShape,
    SceneTearing, SceneWorn, SceneZone,
};

use super::Opened;
use super::mannequin::Mannequin;
use super::moving::Moving;
use crate::look::View;

/// What the file of a scene says of an entity, and which in its list that is.
#[derive(Component, Clone, Debug)]
pub struct Said<T: Send + Sync + 'static>(pub T, pub usize);

/// Where something is, and whether it moves by itself.
type Placed = (&'static GlobalTransform, Option<&'static Moving>);

/// The components of a cloth that a scene file knows.
type OfCloth = (
    (&'static Cloth, Option<&'static Fabric>, Option<&'static SelfContact>, Option<&'static Flammable>),
    (Option<&'static Tearable>, Option<&'static Method>, Option<&'static Substeps>, Option<&'static Air>),
);

type OfCollider = (Option<&'static ClothCollider>, Option<&'static ColliderFriction>);

/// All that a scene file says something of.
#[derive(SystemParam)]
pub struct Present<'w, 's> {
    opened: Res<'w, Opened>,
    view: Res<'w, View>,
    fixed: Res<'w, Time<Fixed>>,
    forces: (Res<'w, Shared<Gravity>>, Res<'w, Shared<Wind>>, Res<'w, Shared<Gusts>>),
    methods: (Res<'w, Shared<Method>>, Res<'w, Shared<Substeps>>),
    cloths: Query<'w, 's, (Entity, &'static Said<SceneCloth>, Placed, OfCloth)>,
    colliders: Query<'w, 's, (&'static Said<SceneCollider>, Placed, OfCollider)>,
    fans: Query<'w, 's, (&'static Said<SceneFan>, Placed, &'static Fan)>,
    zones: Query<'w, 's, (&'static Said<SceneZone>, Placed, &'static WindZone)>,
    figures: Query<'w, 's, (Entity, &'static Said<SceneFigure>, Placed, &'static Mannequin)>,
    parents: Query<'w, 's, &'static ChildOf>,
}

impl Present<'_, '_> {
    /// The scene as it is now: what was moved, scaled, duplicated, deleted, and every value that was changed. Thrown balls, pins that were
    /// set or taken by hand and all damage are left out.
    pub fn scene(&self) -> Scene {
        let mut scene = Scene::clone(&self.opened.scene);
        scene.view = self.view.0.clone();
        let rate = 1.0 / self.fixed.timestep().as_secs_f32();
        // A timestep is a whole number of nanoseconds.
        if (rate - scene.rate).abs() > 1e-4 * rate {
            scene.rate = rate;
        }
        (scene.gravity, scene.wind, scene.gusts) = (self.forces.0.0.0, self.forces.1.0.0, self.forces.2.0);
        let Substeps { count, iterations, .. } = self.methods.1.0;
        (scene.method, scene.substeps, scene.iterations) = (self.methods.0.0, count, iterations);
        let figures: Vec<_> = self.figures.iter().sort_by_key::<&Said<SceneFigure>, _>(|said| said.1).collect();
        let figure = |(_, said, placed, now): &(Entity, &Said<SceneFigure>, _, &Mannequin)| SceneFigure {
            place: place(&said.0.place, *placed),
            ..now.figure.clone()
        };
        scene.figures = figures.iter().map(figure).collect();
        let worn = |entity: Entity, said: &SceneCloth| {
            let wearer = self.parents.root_ancestor(entity);
            let figure = figures.iter().position(|(root, ..)| *root == wearer)?;
            Some(SceneWorn { figure: figure as u32, ..said.worn? })
        };
        let cloths = || self.cloths.iter().sort_by_key::<&Said<SceneCloth>, _>(|said| said.1);
        scene.air = cloths().find_map(|(.., (_, (_, _, _, air)))| air.copied());
        let cloth = |(entity, said, placed, now): (_, &Said<SceneCloth>, _, _)| SceneCloth {
            worn: worn(entity, &said.0),
            ..cloth(&said.0, placed, now)
        };
        scene.cloths = cloths().map(cloth).collect();
        let colliders = self.colliders.iter().sort_by_key::<&Said<SceneCollider>, _>(|said| said.1);
        scene.colliders = colliders.map(|(said, placed, now)| collider(&said.0, placed, now)).collect();
        let fans = self
            .fans
            .iter()
            .sort_by_key::<&Said<SceneFan>, _>(|said| said.1)
            .map(|(said, placed, fan)| SceneFan { fan: *fan, place: place(&said.0.place, placed), ..said.0.clone() });
        scene.fans = fans.collect();
        let zones = self.zones.iter().sort_by_key::<&Said<SceneZone>, _>(|said| said.1).map(|(said, placed, zone)| {
            SceneZone { zone: *zone, place: place(&said.0.place, placed), ..said.0.clone() }
        });
        scene.zones = zones.collect();
        scene
    }
}

/// Where something is; as its file says if it is there still, or moves by itself.
fn place(said: &ScenePlace, (now, moving): (&GlobalTransform, Option<&Moving>)) -> ScenePlace {
    let (_, rotation, position) = now.to_scale_rotation_translation();
    let before = said.pose();
    let is_there = before.position.distance(position) < 1e-4 && before.rotation.angle_between(rotation) < 1e-3;
    if moving.is_some() || is_there { *said } else { ScenePlace::of(&Pose::new(position, rotation)) }
}

fn cloth(
    said: &SceneCloth,
    placed: (&GlobalTransform, Option<&Moving>),
    now: ROQueryItem<'_, '_, OfCloth>,
) -> SceneCloth {
    let ((source, fabric, self_contact, flammable), (tearable, method, substeps, _)) = now;
    let mut cloth = said.clone();
    if let ClothSource::Rectangle { size, resolution } = source.source {
        cloth.size = size;
        cloth.cells = match resolution {
            Resolution::Cells(cells) => cells,
            Resolution::Spacing(spacing) => (size / spacing).round().as_uvec2().max(UVec2::ONE),
        };
    }
    let scale = placed.0.scale().truncate().abs();
    if (scale - 1.0).abs().max_element() > 1e-4 && said.wrap.is_none() {
        cloth.size *= scale;
    }
    let fabric = fabric.copied().unwrap_or_default();
    if said.fabric() != Ok(fabric) {
        let preset = Fabric::PRESETS.iter().find(|(_, preset)| *preset == fabric);
        cloth.damping = None;
        cloth.fabric = preset.map_or(SceneFabric::Custom(fabric), |(name, _)| SceneFabric::Preset((*name).into()));
    }
    cloth.self_contact = self_contact.copied();
    let lit = said.fire.as_ref().map_or_else(Vec::new, |fire| fire.lit.clone());
    cloth.fire = flammable.map(|burns| SceneFire { burns: *burns, lit });
    cloth.tearing = tearable.map(|tearable| SceneTearing { scale: tearable.scale });
    cloth.method = method.copied();
    cloth.substeps = substeps.map(|substeps| substeps.count);
    cloth.motion = said.motion.clone().filter(|_| placed.1.is_some());
    // What is worn has its place on its wearer.
    if said.worn.is_none() {
        cloth.place = place(&said.place, placed);
    }
    cloth
}

fn collider(
    said: &SceneCollider,
    placed: (&GlobalTransform, Option<&Moving>),
    (now, friction): ROQueryItem<'_, '_, OfCollider>,
) -> SceneCollider {
    // A ball that falls begins where it began.
    if said.mass.is_some() {
        return said.clone();
    }
    SceneCollider {
        shape: now.and_then(|now| shape(now, placed.0.scale())).unwrap_or(said.shape),
        place: place(&said.place, placed),
        friction: friction.map(|friction| friction.0),
        motion: said.motion.clone().filter(|_| placed.1.is_some()),
        ..said.clone()
    }
}

/// The form of a collider under `scale`; `None` of one that no scene file knows.
fn shape(collider: &ClothCollider, scale: Vec3) -> Option<SceneShape> {
    let scale = scale.abs();
    let is_even = (scale - scale.x).abs().max_element() < 1e-4 * scale.x;
    // So that what was not scaled stays what it was to the last bit.
    let scale = if (scale - 1.0).abs().max_element() < 1e-4 { Vec3::ONE } else { scale };
    Some(match *collider {
        ClothCollider::Sphere { radius } if is_even => SceneShape::Sphere { radius: radius * scale.x },
        ClothCollider::Sphere { radius } => SceneShape::Ellipsoid { radii: radius * scale },
        ClothCollider::Capsule { radius, length } => {
            SceneShape::Capsule { radius: radius * scale.x, length: length * scale.x }
        }
        ClothCollider::Cuboid { size } => SceneShape::Cuboid { size: size * scale },
        ClothCollider::Pyramid { base, height } => {
            SceneShape::Pyramid { base: base * scale.xz(), height: height * scale.y }
        }
        ClothCollider::Ellipsoid { radii } => SceneShape::Ellipsoid { radii: radii * scale },
        ClothCollider::Cylinder { radius, height } => {
            SceneShape::Cylinder { radius: radius * scale.x, height: height * scale.y }
        }
        ClothCollider::Cone { radius, height } => {
            SceneShape::Cone { radius: radius * scale.x, height: height * scale.y }
        }
        ClothCollider::RoundedCuboid { size, radius } => {
            SceneShape::RoundedCuboid { size: size * scale, radius: radius * scale.min_element() }
        }
        ClothCollider::Ground => SceneShape::Ground,
        ClothCollider::Convex { .. }
        | ClothCollider::Hull { .. }
        | ClothCollider::HeightField { .. }
        | ClothCollider::Mesh { .. }
        | ClothCollider::Triangles { .. } => return None,
    })
}

#[cfg(test)]
mod tests {
    use bevy::ecs::system::RunSystemOnce;

    use super::*;
    use crate::camera::Viewpoint;
    use crate::scenes::finish::Grains;
    use crate::scenes::{OpenScene, open, open_scene};
    use crate::select::Selectable;
    use crate::test_game::Game;

    fn opened(name: &str) -> Game {
        let mut game = Game::new();
        let grains = Grains { oak: default(), stone: default() };
        game.app.init_resource::<Opened>().init_resource::<View>().init_resource::<Viewpoint>();
        game.app.insert_resource(grains).add_observer(open_scene);
        game.app.world_mut().trigger(OpenScene(open(name).expect("there")));
        game.run(0.05);
        game
    }

    fn now(game: &mut Game) -> Scene {
        game.app.world_mut().run_system_once(|present: Present| present.scene()).expect("it runs")
    }

    #[test]
    fn a_scene_that_nobody_touched_is_saved_as_its_file_says() {
        for name in
            ["sandbox", "flag", "laundry", "tablecloth", "curtains", "fire_test", "trampoline", "tearing", "mannequin"]
        {
            let mut game = opened(name);
            assert_eq!(now(&mut game), *open(name).expect("there"), "{name}");
        }
    }

    #[test]
    fn what_was_moved_scaled_changed_and_deleted_is_so_in_what_is_saved() {
        let mut game = opened("sandbox");
        let before = now(&mut game);
        let world = game.app.world_mut();
        let mut colliders = world.query_filtered::<(Entity, &Said<SceneCollider>), With<Selectable>>();
        let all: Vec<(Entity, SceneShape)> =
            colliders.iter(world).map(|(entity, said)| (entity, said.0.shape)).collect();
        let ball = all.iter().find(|(_, shape)| matches!(shape, SceneShape::Sphere { .. })).expect("a ball").0;
        let other = all.iter().find(|(entity, _)| *entity != ball).expect("another").0;
        let turn = Quat::from_rotation_y(0.5);
        world
            .entity_mut(ball)
            .insert(Transform::from_xyz(1.0, 2.0, 3.0).with_rotation(turn).with_scale(Vec3::splat(2.0)));
        world.entity_mut(other).despawn();
        let mut cloths = world.query_filtered::<Entity, With<Cloth>>();
        let cloth = cloths.iter(world).next().expect("a cloth");
        world.entity_mut(cloth).insert((Fabric { shear: 77.0, ..Fabric::VOILE }, Tearable { scale: 0.5, ..default() }));
        world.insert_resource(Shared(Wind(Vec3::X)));
        game.run(0.1);
        let after = now(&mut game);
        assert_eq!(after.colliders.len(), before.colliders.len() - 1);
        let balls = |scene: &Scene| {
            let mut balls = scene.colliders.iter().filter_map(|collider| match collider.shape {
                SceneShape::Sphere { radius } => Some((radius, collider.place.pose())),
                _ => None,
            });
            balls.next().expect("a ball")
        };
        let (radius, pose) = balls(&after);
        assert_eq!(radius, 2.0 * balls(&before).0);
        assert!(pose.position.distance(Vec3::new(1.0, 2.0, 3.0)) < 1e-5 && pose.rotation.angle_between(turn) < 1e-3);
        assert_eq!(after.cloths[0].fabric().map(|fabric| fabric.shear), Ok(77.0));
        assert_eq!((after.cloths[0].tearing, after.wind), (Some(SceneTearing { scale: 0.5 }), Vec3::X));
        let read = Scene::from_ron(&after.to_ron()).expect("it opens");
        assert_eq!(read, after);
    }
}
