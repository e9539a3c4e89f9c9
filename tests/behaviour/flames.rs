//! Cloth that burns shows flames and their light, and nothing is left of them when it does not.

use crate::common::*;
use bevy::mesh::VertexAttributeValues;
use bevy::pbr::StandardMaterial;
use bevy::prelude::*;
use bevy_cloth::*;

/// A small hanging cloth, two metres before a camera.
fn staged(more: impl Bundle) -> (App, Entity) {
    let mut app = with_meshes();
    app.add_plugins(TransformPlugin).init_asset::<StandardMaterial>().init_asset::<Image>();
    app.world_mut().spawn((Camera3d::default(), Transform::from_xyz(0.0, 0.0, 2.0)));
    let cloth = (Cloth::rectangle(0.3, 0.3).with_cells(8, 8), Pins::top(), Flammable::default());
    let cloth = app.world_mut().spawn(cloth).insert(more).id();
    run(&mut app, 2);
    (app, cloth)
}

fn light(app: &mut App, entity: Entity) {
    let position = app.world().get::<Transform>(entity).expect("a place").translation;
    app.world_mut().trigger(IgniteCloth { entity, position, radius: 0.05 });
    run(app, 20);
}

fn flames(app: &mut App) -> Vec<Entity> {
    app.world_mut().query_filtered::<Entity, With<PointLight>>().iter(app.world()).collect()
}

/// The corners of all flames, in the world, without smoke and sparks.
fn corners(app: &App, flames: Entity) -> Vec<Vec3> {
    let mesh = app.world().resource::<Assets<Mesh>>().get(&get::<Mesh3d>(app, flames).0).expect("a mesh");
    let Some(VertexAttributeValues::Float32x3(places)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION) else {
        panic!("no positions")
    };
    let Some(VertexAttributeValues::Float32x4(colors)) = mesh.attribute(Mesh::ATTRIBUTE_COLOR) else {
        panic!("no colours")
    };
    let place = get::<GlobalTransform>(app, flames);
    // Smoke hides more than it shines, sparks hide nothing.
    let is_flame = |[red, _, _, alpha]: &[f32; 4]| *alpha > 0.0 && red > alpha;
    let flames = places.iter().zip(colors).filter(|(_, color)| is_flame(color)).map(|(place, _)| place);
    flames.map(|at| place.transform_point(Vec3::from_array(*at))).collect()
}

#[test]
fn cloth_shows_flames_and_light_while_it_burns_and_neither_before_nor_after() {
    let (mut app, cloth) = staged(());
    assert_eq!(flames(&mut app), []);
    light(&mut app, cloth);
    let [lit] = flames(&mut app)[..] else { panic!("one entity shows the flames") };
    assert_eq!(get::<ChildOf>(&app, lit).parent(), cloth);
    assert!(get::<PointLight>(&app, lit).intensity > 10.0);
    assert!(corners(&app, lit).len() > 16);
    let water = WetCloth { entity: cloth, position: Vec3::ZERO, radius: 1.0, water: 1.0 };
    app.world_mut().trigger(water);
    run(&mut app, 3);
    assert_eq!(flames(&mut app), []);
}

#[test]
fn flames_stand_above_the_fire_and_between_it_and_the_camera_whatever_the_place_and_scale_of_the_cloth() {
    let place = Transform::from_xyz(3.0, 0.5, -1.0).with_rotation(Quat::from_rotation_y(1.0));
    for place in [Transform::default(), place.with_scale(Vec3::new(2.0, 0.5, 1.0))] {
        let (mut app, cloth) = staged(place);
        light(&mut app, cloth);
        let lit = flames(&mut app)[0];
        let corners = corners(&app, lit);
        let middle = corners.iter().sum::<Vec3>() / corners.len() as f32 - place.translation;
        assert!((0.02..0.6).contains(&middle.y), "{middle}");
        let towards = (Vec3::new(0.0, 0.0, 2.0) - place.translation).normalize();
        assert!((0.0..0.3).contains(&middle.dot(towards)), "{middle}");
        // Each faces the camera.
        let (quads, _) = corners.as_chunks::<4>();
        for [a, b, c, _] in quads.iter().filter(|quad| quad[0].distance(quad[1]) > 1e-3) {
            let normal = (b - a).cross(c - a).normalize();
            let view = (Vec3::new(0.0, 0.0, 2.0) - (a + c) / 2.0).normalize();
            assert!(normal.dot(view) > 0.99, "{normal} {view}");
        }
    }
}

/// How high above the middle of the cloth the highest is that rises from it, m; `None` if nothing does.
fn rises(app: &mut App, cloth: Entity) -> Option<f32> {
    let mut risen = app.world_mut().query::<(&Name, &ChildOf, &Mesh3d, &GlobalTransform)>();
    let mut risen = risen.iter(app.world()).filter(|(name, of, ..)| name.as_str() == "flames" && of.parent() == cloth);
    let (.., mesh, place) = risen.next()?;
    let mesh = app.world().resource::<Assets<Mesh>>().get(&mesh.0).expect("a mesh");
    let Some(VertexAttributeValues::Float32x3(places)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION) else {
        panic!("no positions")
    };
    let heights = places.iter().map(|at| place.transform_point(Vec3::from_array(*at)).y);
    Some(heights.fold(f32::MIN, f32::max))
}

#[test]
fn smoke_rises_above_the_flames_steam_where_water_meets_them_and_in_the_end_nothing_is_left() {
    let (mut app, cloth) = staged(());
    assert_eq!(rises(&mut app, cloth), None);
    light(&mut app, cloth);
    let lit = flames(&mut app)[0];
    let highest = corners(&app, lit).iter().map(|at| at.y).fold(f32::MIN, f32::max);
    assert!(rises(&mut app, cloth).expect("smoke") > highest + 0.2, "smoke above flames of {highest} m");
    app.world_mut().trigger(WetCloth { entity: cloth, position: Vec3::ZERO, radius: 1.0, water: 0.2 });
    run(&mut app, 3);
    assert_eq!(flames(&mut app), []);
    assert!(rises(&mut app, cloth).expect("steam") > 0.1);
    let is_cold = |_: &usize| {
        run(&mut app, 60);
        rises(&mut app, cloth).is_none()
    };
    assert!((0..50).find(is_cold).is_some(), "cold by now");
}

#[test]
fn flames_are_hidden_where_they_are_not_wanted() {
    let (mut app, cloth) = staged(ClothFlames::Hidden);
    light(&mut app, cloth);
    assert!(get::<ClothFire>(&app, cloth).flaming() > 0);
    assert_eq!(flames(&mut app), []);
    app.world_mut().entity_mut(cloth).remove::<ClothFlames>();
    run(&mut app, 2);
    assert_eq!(flames(&mut app).len(), 1);
    app.world_mut().resource_mut::<Shared<ClothFlames>>().0 = ClothFlames::Hidden;
    run(&mut app, 2);
    assert_eq!(flames(&mut app), []);
}

#[test]
fn nothing_is_left_of_the_flames_of_a_cloth_that_is_none_any_more() {
    let end: [fn(&mut EntityWorldMut); 2] = [
        |cloth| {
            cloth.remove::<Cloth>();
        },
        |cloth| {
            cloth.remove::<Flammable>();
        },
    ];
    for end in end {
        let (mut app, cloth) = staged(());
        light(&mut app, cloth);
        assert_eq!(flames(&mut app).len(), 1);
        end(&mut app.world_mut().entity_mut(cloth));
        run(&mut app, 2);
        assert_eq!(flames(&mut app), []);
    }
    let (mut app, cloth) = staged(());
    light(&mut app, cloth);
    app.world_mut().despawn(cloth);
    assert_eq!(flames(&mut app), []);
}
