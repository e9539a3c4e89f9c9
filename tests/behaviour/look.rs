//! `ClothLook`: a fabric material that comes, follows and goes with the component, and what its shader is told.

use crate::common::*;
use bevy::mesh::VertexAttributeValues;
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::prelude::*;
use bevy_cloth::render::ClothMaterial;
use bevy_cloth::*;

/// An app with all assets that looks need, and a cloth of 20 × 20 cells of 2.5 cm with `more` components.
fn drawn(more: impl Bundle) -> (App, Entity) {
    let mut app = with_meshes();
    app.init_asset::<StandardMaterial>().init_asset::<Image>().init_asset::<ClothMaterial>();
    let cloth = Cloth::rectangle(0.5, 0.5).with_cells(20, 20);
    let cloth = app.world_mut().spawn((cloth, Pins::top(), Gravity(Vec3::ZERO))).insert(more).id();
    run(&mut app, 2);
    (app, cloth)
}

fn colors(app: &App, cloth: Entity) -> Vec<[f32; 4]> {
    match mesh(app, cloth).attribute(Mesh::ATTRIBUTE_COLOR) {
        Some(VertexAttributeValues::Float32x4(values)) => values.clone(),
        other => panic!("colours are {other:?}"),
    }
}

fn burn_and_wet(app: &App, cloth: Entity) -> Vec<[f32; 2]> {
    match mesh(app, cloth).attribute(Mesh::ATTRIBUTE_UV_1) {
        Some(VertexAttributeValues::Float32x2(values)) => values.clone(),
        other => panic!("the second texture coordinates are {other:?}"),
    }
}

/// A stroke down the middle, from below the lower hem half way up.
fn cut(app: &mut App, cloth: Entity) {
    let ray = |y: f32| Ray3d::new(Vec3::new(0.001, y, 1.0), Dir3::NEG_Z);
    app.world_mut().trigger(CutCloth { entity: cloth, from: ray(-0.4), to: ray(0.0), reach: 2.0 });
    run(app, 2);
}

#[test]
fn a_look_is_shown_while_it_is_there_and_the_own_material_comes_back() {
    let (mut app, cloth) = drawn(());
    let red = StandardMaterial::from(Color::srgb(1.0, 0.0, 0.0));
    let red = MeshMaterial3d(app.world_mut().resource_mut::<Assets<StandardMaterial>>().add(red));
    app.world_mut().entity_mut(cloth).insert(red.clone());
    run(&mut app, 1);
    app.world_mut().entity_mut(cloth).insert(ClothLook::DENIM);
    run(&mut app, 1);
    let entity = app.world().entity(cloth);
    assert!(entity.contains::<MeshMaterial3d<ClothMaterial>>(), "it has no fabric material");
    assert!(!entity.contains::<MeshMaterial3d<StandardMaterial>>(), "it has two materials");
    app.world_mut().entity_mut(cloth).remove::<ClothLook>();
    run(&mut app, 1);
    let entity = app.world().entity(cloth);
    assert!(!entity.contains::<MeshMaterial3d<ClothMaterial>>(), "the fabric material is left");
    assert_eq!(entity.get::<MeshMaterial3d<StandardMaterial>>(), Some(&red));
    run(&mut app, 3);
    assert_eq!(app.world().resource::<Assets<ClothMaterial>>().len(), 0, "the asset is left");
}

#[test]
fn a_cloth_that_had_no_material_gets_a_plain_one_when_its_look_is_removed() {
    let (mut app, cloth) = drawn(ClothLook::silk(Color::WHITE));
    assert!(!app.world().entity(cloth).contains::<MeshMaterial3d<StandardMaterial>>());
    app.world_mut().entity_mut(cloth).remove::<ClothLook>();
    run(&mut app, 1);
    assert!(app.world().entity(cloth).contains::<MeshMaterial3d<StandardMaterial>>());
    app.world_mut().entity_mut(cloth).insert(ClothLook::default()).remove::<Cloth>();
    run(&mut app, 2);
    let entity = app.world().entity(cloth);
    assert!(
        !entity.contains::<MeshMaterial3d<ClothMaterial>>() && !entity.contains::<MeshMaterial3d<StandardMaterial>>()
    );
}

#[test]
fn a_changed_look_changes_the_material_in_place() {
    let (mut app, cloth) = drawn(ClothLook::cotton(Color::WHITE));
    let shown = get::<MeshMaterial3d<ClothMaterial>>(&app, cloth).clone();
    let through = |app: &App| {
        app.world().resource::<Assets<ClothMaterial>>().get(&shown.0).expect("a material").base.diffuse_transmission
    };
    assert_eq!(through(&app), 0.15);
    app.world_mut().get_mut::<ClothLook>(cloth).unwrap().translucency = 0.5;
    run(&mut app, 1);
    assert_eq!(get::<MeshMaterial3d<ClothMaterial>>(&app, cloth), &shown);
    assert_eq!(through(&app), 0.5);
    // What is no number, or out of range, is clamped.
    let wrong = ClothLook { translucency: -3.0, threads: f32::NAN, gloss: 7.0, ..default() };
    app.world_mut().entity_mut(cloth).insert(wrong);
    run(&mut app, 1);
    assert!((0.0..0.01).contains(&through(&app)), "{}", through(&app));
}

/// Particles on the cut: each has a twin that is on the other side of it, at the same place at rest.
fn on_the_cut(topology: &ClothTopology) -> Vec<u32> {
    let same = |a: u32, b: u32| topology.rest[a as usize].distance(topology.rest[b as usize]) < 1e-5;
    let has_twin = |slot: &u32| topology.particles().any(|other| other != *slot && same(other, *slot));
    topology.particles().filter(has_twin).collect()
}

#[test]
fn cloth_frays_at_a_cut_and_not_at_its_hem() {
    let (mut app, cloth) = drawn(ClothLook::default());
    assert!(colors(&app, cloth).iter().all(|color| color[3] == 1.0), "whole cloth frays");
    cut(&mut app, cloth);
    let (topology, colors) = (get::<ClothTopology>(&app, cloth).clone(), colors(&app, cloth));
    let on_cut = on_the_cut(&topology);
    assert!(on_cut.len() > 16, "{} particles on the cut", on_cut.len());
    for (vertex, slot) in topology.vertex_particle.iter().enumerate() {
        let (at, fray) = (topology.rest[*slot as usize], colors[vertex][3]);
        let away = on_cut.iter().map(|slot| topology.rest[*slot as usize].distance(at)).fold(f32::MAX, f32::min);
        if on_cut.contains(slot) {
            assert_eq!(fray, 0.0, "on the cut, at {at}");
        } else if away > 0.06 {
            assert_eq!(fray, 1.0, "{away} m away from the cut, at {at}");
        }
    }
    let zeros = colors.iter().filter(|color| color[3] == 0.0).count();
    // Beside those on the cut there is its end, on both faces.
    assert!(zeros <= 2 * (on_cut.len() + 3), "{zeros} vertices are torn, {} particles on the cut", on_cut.len());
    app.world_mut().trigger(ResetCloth { entity: cloth });
    run(&mut app, 2);
    assert!(self::colors(&app, cloth).iter().all(|color| color[3] == 1.0), "it is whole again and frays");
}

#[test]
fn each_side_of_a_cut_has_its_own_normals() {
    let (mut app, cloth) = drawn(ClothLook::default());
    cut(&mut app, cloth);
    app.world_mut().resource_mut::<Time<ClothClock>>().pause();
    let topology = get::<ClothTopology>(&app, cloth).clone();
    let on_cut = on_the_cut(&topology);
    let x = topology.rest[on_cut[0] as usize].x;
    // Everything left of the cut is turned back about the vertical, by hand.
    let mut is_left = vec![false; topology.slots()];
    for triangle in &topology.triangles {
        let middle = triangle.iter().map(|slot| topology.rest[*slot as usize].x).sum::<f32>() / 3.0;
        triangle.iter().for_each(|slot| is_left[*slot as usize] |= middle < x);
    }
    let mut particles = app.world_mut().get_mut::<Particles>(cloth).unwrap();
    for slot in topology.particles().filter(|slot| is_left[*slot as usize]) {
        let at = topology.rest[slot as usize];
        particles.position.set(slot as usize, Vec3::new(at.x, at.y, 2.0 * (x - at.x)));
    }
    let position = particles.position.clone();
    app.world_mut().get_mut::<ClothHistory>(cloth).unwrap().position = position;
    run(&mut app, 1);
    let Some(VertexAttributeValues::Float32x3(normals)) = mesh(&app, cloth).attribute(Mesh::ATTRIBUTE_NORMAL) else {
        panic!("no normals")
    };
    let mut sides = [0, 0];
    for (vertex, slot) in topology.vertex_particle.iter().enumerate() {
        // Near its end the cut is one particle wide.
        if on_cut.contains(slot) && topology.rest[*slot as usize].y < -0.06 {
            let (normal, is_left) = (Vec3::from_array(normals[vertex]), is_left[*slot as usize]);
            assert_eq!(normal.x > 0.5, is_left, "{normal}");
            sides[usize::from(is_left)] += 1;
        }
    }
    assert!(sides.iter().all(|count| *count > 4), "{sides:?}");
}

#[test]
fn the_shader_is_told_of_water_and_fire() {
    let (mut app, cloth) = drawn((ClothLook::default(), Flammable::default()));
    run(&mut app, 2);
    assert!(burn_and_wet(&app, cloth).iter().all(|mark| *mark == [0.0, 0.0]));
    let water = WetCloth { entity: cloth, position: Vec3::new(-0.2, 0.0, 0.0), radius: 0.1, water: 0.3 };
    app.world_mut().trigger(water);
    let lighter = IgniteCloth { entity: cloth, position: Vec3::new(0.2, -0.2, 0.0), radius: 0.05 };
    app.world_mut().trigger(lighter);
    run(&mut app, 128);
    let marks = burn_and_wet(&app, cloth);
    assert!(marks.iter().any(|[_, wet]| *wet > 0.9), "nothing is wet");
    assert!(marks.iter().any(|[burn, _]| *burn > 1.5), "nothing is charred");
    // The colours of the vertices are those of the folds alone.
    assert!(colors(&app, cloth).iter().all(|[red, green, blue, _]| red == green && green == blue));
}

#[test]
fn a_colouring_tells_on_a_look_by_the_same_material_and_layout() {
    let (mut app, cloth) = drawn(ClothLook::velvet(Color::srgb(0.5, 0.0, 0.1)));
    let layout = |app: &App| mesh(app, cloth).attributes().map(|(attribute, _)| attribute.id).collect::<Vec<_>>();
    let (shown, before) = (get::<MeshMaterial3d<ClothMaterial>>(&app, cloth).clone(), layout(&app));
    app.world_mut().entity_mut(cloth).insert(ClothColoring::Speed);
    run(&mut app, 1);
    assert_eq!(get::<MeshMaterial3d<ClothMaterial>>(&app, cloth), &shown);
    assert_eq!(layout(&app), before);
    assert!(colors(&app, cloth).iter().all(|color| color[2] > color[0]), "at rest it is not blue");
}
