//! A model as Blender writes it becomes cloth: sizes, pins and fabrics come out right, and mistakes are told.

use crate::common::*;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::VisibilityClass;
use bevy::gltf::{GltfExtras, GltfMaterialExtras, GltfMaterialName, GltfMeshExtras, GltfMeshName, GltfSceneName};
use bevy::image::ImagePlugin;
use bevy::mesh::VertexAttributeValues;
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::world_serialization::{WorldAssetRoot, WorldSerializationPlugin};
use bevy_cloth::gltf::{GltfClothPlugin, GltfClothProblem, gltf_plugin};
use bevy_cloth::*;

/// An app without renderer, in which the model is loaded.
fn loaded() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), ImagePlugin::default()));
    app.add_plugins((bevy::mesh::MeshPlugin, WorldSerializationPlugin, gltf_plugin()));
    app.add_plugins((ClothPlugin::default(), GltfClothPlugin));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(TICK));
    register(&mut app);
    app.finish();
    app.cleanup();
    let scene = app.world().resource::<AssetServer>().load("models/garments.glb#Scene0");
    app.world_mut().spawn(WorldAssetRoot(scene));
    for _ in 0..1000 {
        app.update();
        if primitives(&mut app, "Crate").len() == 1 {
            run(&mut app, 4);
            return app;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    panic!("the model does not load");
}

/// Registers what the model is made of. With Bevy's default features types register themselves.
fn register(app: &mut App) {
    let types = app.world().resource::<AppTypeRegistry>().clone();
    let mut types = types.write();
    types.register::<Transform>();
    types.register::<GlobalTransform>();
    types.register::<TransformTreeChanged>();
    types.register::<Name>();
    types.register::<ChildOf>();
    types.register::<Children>();
    types.register::<Visibility>();
    types.register::<InheritedVisibility>();
    types.register::<ViewVisibility>();
    types.register::<VisibilityClass>();
    types.register::<Aabb>();
    types.register::<Mesh3d>();
    types.register::<GltfExtras>();
    types.register::<GltfMeshExtras>();
    types.register::<GltfMaterialExtras>();
    types.register::<GltfMeshName>();
    types.register::<GltfMaterialName>();
    types.register::<GltfSceneName>();
}

/// The meshes of a node, in their order.
fn primitives(app: &mut App, node: &str) -> Vec<Entity> {
    let mut nodes = app.world_mut().query::<(&Name, &Children)>();
    let children: Vec<Entity> = (nodes.iter(app.world()))
        .filter(|(name, _)| name.as_str() == node)
        .flat_map(|(_, children)| children.iter())
        .collect();
    children.into_iter().filter(|child| app.world().get::<Mesh3d>(*child).is_some()).collect()
}

fn primitive(app: &mut App, node: &str) -> Entity {
    let [only] = primitives(app, node)[..] else { panic!("not one mesh in {node}") };
    only
}

/// Width and height of the rest shape, m.
fn size(app: &App, cloth: Entity) -> Vec2 {
    let topology = get::<ClothTopology>(app, cloth);
    let rest = topology.particles().map(|slot| topology.rest[slot as usize]);
    let (min, max) = rest.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), p| (min.min(p), max.max(p)));
    (max - min).truncate()
}

fn pinned(app: &App, cloth: Entity) -> Vec<Vec3> {
    let constraints = get::<bevy_cloth::cloth_solver::cloth::Constraints>(app, cloth);
    let rest = &get::<ClothTopology>(app, cloth).rest;
    constraints.pins().pins.iter().map(|pin| rest[pin.particle as usize]).collect()
}

#[test]
fn properties_of_objects_say_what_is_cloth_of_which_fabric_and_where_pinned() {
    let mut app = loaded();
    let banner = primitive(&mut app, "Banner");
    assert_eq!(*get::<Fabric>(&app, banner), Fabric::CANVAS);
    assert!(size(&app, banner).distance(Vec2::new(2.0, 1.5)) < 1e-4, "the scale is baked in: {}", size(&app, banner));
    let pins = pinned(&app, banner);
    assert!(pins.len() == 13 && pins.iter().all(|at| (at.y - 0.75).abs() < 1e-4), "{pins:?}");
    assert_eq!(get::<Tearable>(&app, banner).scale, 0.05);
    assert!(app.world().get::<Air>(banner).is_some() && app.world().get::<Flammable>(banner).is_none());

    let mirrored = primitive(&mut app, "Mirrored");
    assert_eq!(*get::<Fabric>(&app, mirrored), Fabric::default());
    assert!(app.world().get::<Flammable>(mirrored).is_some() && app.world().get::<Air>(mirrored).is_none());
    let pins = pinned(&app, mirrored);
    assert!(pins.len() == 2 && pins.iter().all(|at| at.y > 0.49 && at.x.abs() > 0.49), "{pins:?}");

    let node = primitive(&mut app, "Crate");
    assert!(app.world().get::<Cloth>(node).is_none());
}

#[test]
fn each_primitive_of_a_mesh_is_of_the_fabric_of_its_material_and_pinned_by_its_attribute() {
    let mut app = loaded();
    let tunic = primitives(&mut app, "Tunic");
    let fabrics: Vec<Fabric> = tunic.iter().map(|part| *get::<Fabric>(&app, *part)).collect();
    assert_eq!(fabrics, [Fabric::WOOL_SUITING, Fabric::COTTON_JERSEY]);
    for part in tunic {
        let pins = pinned(&app, part);
        assert!(pins.len() == 13 && pins.iter().all(|at| (at.y - 0.4).abs() < 1e-5), "{pins:?}");
    }
}

#[test]
fn cloth_of_a_model_stands_where_its_node_does_and_hangs_on_its_pins() {
    let mut app = loaded();
    run(&mut app, 40);
    for (node, along_z) in [("Banner", 2.0), ("Mirrored", 0.0)] {
        let cloth = primitive(&mut app, node);
        // The root stands 1.5 m high, turned by a quarter about y: +x of the model is −z of the world.
        let centre = centre(&app, cloth);
        assert!((centre.z - along_z).abs() < 0.1 && centre.x.abs() < 0.2, "{node}: {centre}");
        assert!(centre.y > 0.9 && centre.y < 1.6, "{node}: {centre}");
        assert!(world_positions(&app, cloth).iter().all(|p| p.y > 0.3 && p.y < 2.4), "{node}");
    }
}

#[test]
fn a_mirrored_cloth_is_lit_from_the_right_side() {
    let mut app = loaded();
    for node in ["Banner", "Mirrored"] {
        let cloth = primitive(&mut app, node);
        let to_world = *get::<GlobalTransform>(&app, cloth);
        let handle = get::<Mesh3d>(&app, cloth).0.clone();
        let mesh = app.world().resource::<Assets<Mesh>>().get(&handle).expect("a mesh");
        let vectors = |attribute| match mesh.attribute(attribute) {
            Some(VertexAttributeValues::Float32x3(all)) => all.iter().copied().map(Vec3::from).collect::<Vec<_>>(),
            _ => panic!("no vectors"),
        };
        let positions: Vec<Vec3> =
            vectors(Mesh::ATTRIBUTE_POSITION).into_iter().map(|p| to_world.transform_point(p)).collect();
        let turn = to_world.affine().matrix3.inverse().transpose();
        let normals: Vec<Vec3> = vectors(Mesh::ATTRIBUTE_NORMAL).into_iter().map(|n| turn * n).collect();
        // As it comes to the screen: the renderer does not turn triangles over, whether a transform mirrors them or not.
        let indices: Vec<usize> = mesh.indices().expect("indices").iter().collect();
        for [a, b, c] in indices.as_chunks::<3>().0 {
            let facing = (positions[*b] - positions[*a]).cross(positions[*c] - positions[*a]);
            assert!(facing.dot(normals[*a]) > 0.0, "{node}: a face is lit from behind");
        }
        // The model's front is +z, which the mirror leaves; the root turns it to +x.
        let middle = normals.len() / 4;
        assert!(normals[middle].normalize().x > 0.7, "{node}: {}", normals[middle]);
    }
}

#[test]
fn a_material_that_the_loader_made_for_a_mirrored_node_is_replaced_by_one_for_cloth() {
    use bevy::render::render_resource::Face;
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), GltfClothPlugin)).init_asset::<StandardMaterial>();
    let mut spawn = |cull_mode, extras: &str| {
        let material = StandardMaterial { cull_mode, metallic: 0.3, ..default() };
        let material = app.world_mut().resource_mut::<Assets<StandardMaterial>>().add(material);
        let node = app.world_mut().spawn(GltfExtras { value: extras.into() }).id();
        let bundle = (Mesh3d::default(), MeshMaterial3d(material.clone()), ChildOf(node));
        (app.world_mut().spawn(bundle).id(), material)
    };
    let mirrored = spawn(Some(Face::Front), r#"{"cloth": true}"#);
    let others = [spawn(Some(Face::Back), r#"{"cloth": true}"#), spawn(Some(Face::Front), r#"{"cloth": false}"#)];
    run(&mut app, 2);
    let now = |entity| get::<MeshMaterial3d<StandardMaterial>>(&app, entity).0.clone();
    let materials = app.world().resource::<Assets<StandardMaterial>>();
    let turned = materials.get(&now(mirrored.0)).expect("a material");
    assert_eq!((turned.cull_mode, turned.metallic), (Some(Face::Back), 0.3));
    assert_eq!(materials.get(&mirrored.1).expect("it is kept").cull_mode, Some(Face::Front), "an asset was written");
    for (entity, material) in others {
        assert_eq!(now(entity), material);
    }
}

#[test]
fn second_texture_coordinates_of_a_model_are_drawn() {
    let mut app = loaded();
    let banner = primitive(&mut app, "Banner");
    let handle = get::<Mesh3d>(&app, banner).0.clone();
    let mesh = app.world().resource::<Assets<Mesh>>().get(&handle).expect("a mesh");
    let uvs = |attribute| match mesh.attribute(attribute) {
        Some(VertexAttributeValues::Float32x2(uvs)) => uvs.clone(),
        _ => panic!("no texture coordinates"),
    };
    let (first, second) = (uvs(Mesh::ATTRIBUTE_UV_0), uvs(Mesh::ATTRIBUTE_UV_1));
    assert!(first.len() == second.len() && first.iter().zip(&second).all(|([u, v], other)| [*v, *u] == *other));
}

#[test]
fn a_misspelt_fabric_or_key_is_told_with_its_node_and_what_is_allowed_and_makes_no_cloth() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, GltfClothPlugin));
    let node = app.world_mut().spawn(Name::new("Misspelt")).id();
    let extras = |value: &str| GltfExtras { value: value.into() };
    app.world_mut().entity_mut(node).insert(extras(r#"{"cloth": "Cottn", "cloth_pinz": 3, "mass": 1}"#));
    let mesh = app.world_mut().spawn((Mesh3d::default(), ChildOf(node))).id();
    app.update();
    let told = take_messages::<GltfClothProblem>(&mut app);
    let told: Vec<_> = told.iter().map(|told| (told.node.as_str(), told.problem.to_string())).collect();
    assert_eq!(told.len(), 2);
    assert!(told.iter().all(|(node, _)| *node == "Misspelt"));
    assert!(told[0].1.contains("Cottn") && told[0].1.contains("Cotton poplin"), "{}", told[0].1);
    assert!(told[1].1.contains("cloth_pinz") && told[1].1.contains("cloth_pins"), "{}", told[1].1);
    assert!(app.world().get::<Cloth>(mesh).is_none());
    app.update();
    assert_eq!(take_messages::<GltfClothProblem>(&mut app), [], "it is told once");
}
