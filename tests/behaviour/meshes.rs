//! Meshes as they come: with faults, as lists and strips, with attributes of every kind.

use crate::common::*;
use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, MeshVertexAttribute, PrimitiveTopology, VertexAttributeValues, VertexFormat};
use bevy::prelude::*;
use bevy_cloth::cloth_solver::topology::Mended;
use bevy_cloth::*;

const CUSTOM: MeshVertexAttribute = MeshVertexAttribute::new("Custom", 0x7465_7374_0001, VertexFormat::Float32);
const NUMBER: MeshVertexAttribute = MeshVertexAttribute::new("Number", 0x7465_7374_0002, VertexFormat::Uint32);

fn spawn(app: &mut App, mesh: Mesh, more: impl Bundle) -> Entity {
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
    app.world_mut().spawn((Cloth::mesh(), Mesh3d(mesh))).insert(more).id()
}

fn drawn(app: &App, cloth: Entity) -> &Mesh {
    app.world().resource::<Assets<Mesh>>().get(&get::<Mesh3d>(app, cloth).0).expect("the cloth draws a mesh")
}

/// A stroke through a sheet in the xy plane.
fn cut(entity: Entity, from: Vec2, to: Vec2) -> CutCloth {
    let ray = |at: Vec2| Ray3d::new(at.extend(1.0), Dir3::NEG_Z);
    CutCloth { entity, from: ray(from), to: ray(to), reach: 2.0 }
}

/// A sheet of 1 m × 1 m in the xy plane.
fn sheet(cells: u32) -> Mesh {
    Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(cells - 1).build()
}

#[test]
fn every_primitive_that_bevy_has_is_cloth() {
    let mut app = with_meshes();
    note_events::<ClothRejected>(&mut app);
    let all: Vec<(&str, Mesh)> = vec![
        ("ico sphere", Sphere::new(0.3).mesh().ico(2).expect("few enough triangles")),
        ("uv sphere", Sphere::new(0.3).mesh().uv(12, 8)),
        ("capsule", Capsule3d::new(0.2, 0.4).mesh().longitudes(10).latitudes(6).build()),
        ("torus", Torus::new(0.2, 0.4).mesh().minor_resolution(6).major_resolution(12).build()),
        ("cylinder", Cylinder::new(0.3, 0.5).mesh().resolution(10).segments(4).build()),
        ("cone", Cone::new(0.3, 0.5).mesh().resolution(10).build()),
        ("frustum", ConicalFrustum { radius_top: 0.1, radius_bottom: 0.3, height: 0.5 }.into()),
        ("cuboid", Cuboid::from_length(0.4).into()),
        ("plane", sheet(8)),
        ("tetrahedron", Tetrahedron::default().into()),
        ("circle", Circle::new(0.4).mesh().resolution(16).build()),
        ("ellipse", Ellipse::new(0.4, 0.2).mesh().resolution(16).build()),
        ("annulus", Annulus::new(0.2, 0.4).mesh().resolution(16).build()),
        ("capsule in the plane", Capsule2d::new(0.2, 0.4).into()),
        ("polygon", RegularPolygon::new(0.4, 7).into()),
        ("rhombus", Rhombus::new(0.4, 0.6).into()),
        ("rectangle", Rectangle::new(0.4, 0.6).into()),
        ("triangle", Triangle2d::default().into()),
        ("sector", CircularSector::new(0.4, 1.0).into()),
        ("segment", CircularSegment::new(0.4, 1.0).into()),
        ("extruded annulus", Extrusion::new(Annulus::new(0.2, 0.4), 0.2).into()),
    ];
    let cloths: Vec<(&str, Entity)> =
        all.into_iter().map(|(name, mesh)| (name, spawn(&mut app, mesh, Pins::rods(1)))).collect();
    run(&mut app, 32);
    assert_eq!(seen::<ClothRejected>(&app), []);
    for (name, cloth) in cloths {
        let positions = world_positions(&app, cloth);
        assert!(positions.iter().all(|p| p.is_finite() && p.length() < 3.0), "{name}: {positions:?}");
        let turned = app.world().get::<ClothMended>(cloth).map_or(0, |mended| mended.turned_triangles);
        assert_eq!(turned, 0, "{name}");
    }
}

#[test]
fn what_was_mended_is_on_the_entity_and_gone_with_the_faults() {
    let mut app = with_meshes();
    let faultless = spawn(&mut app, sheet(4), ());
    let uv_sphere = spawn(&mut app, Sphere::new(0.3).mesh().uv(12, 8), ());
    run(&mut app, 2);
    assert!(app.world().get::<ClothMended>(faultless).is_none());
    let mended: &Mended = get::<ClothMended>(&app, uv_sphere);
    assert!(mended.unused_vertices > 0 && *mended == Mended { unused_vertices: mended.unused_vertices, ..default() });
    let another = app.world_mut().resource_mut::<Assets<Mesh>>().add(sheet(4));
    app.world_mut().entity_mut(uv_sphere).insert(Mesh3d(another));
    run(&mut app, 2);
    assert!(app.world().get::<ClothMended>(uv_sphere).is_none());
    app.world_mut().entity_mut(faultless).remove::<Cloth>();
}

#[test]
fn a_pin_on_an_unused_vertex_is_refused_by_its_number_and_others_hold() {
    let mut app = with_meshes();
    let mut mesh = sheet(4);
    let Some(VertexAttributeValues::Float32x3(positions)) = mesh.attribute_mut(Mesh::ATTRIBUTE_POSITION) else {
        panic!()
    };
    positions.push([5.0, 5.0, 5.0]);
    for attribute in [Mesh::ATTRIBUTE_NORMAL, Mesh::ATTRIBUTE_UV_0] {
        mesh.remove_attribute(attribute);
    }
    let held = spawn(&mut app, mesh.clone(), Pins::vertices([0, 24]));
    let refused = spawn(&mut app, mesh, Pins::vertices([0, 25]));
    run(&mut app, 4);
    assert!(app.world().get::<ClothRejection>(held).is_none());
    let error = get::<ClothRejection>(&app, refused).error().clone();
    assert_eq!(error, ClothError::LoneVertex { field: "PinSelect::Vertices", vertex: 25 });
    // What nothing uses does not make the cloth larger.
    let bounds = get::<bevy::camera::primitives::Aabb>(&app, held);
    assert!(bounds.half_extents.max_element() < 0.6, "{bounds:?}");
}

#[test]
fn lists_and_strips_with_small_large_and_no_indices_are_the_same_cloth() {
    // Two rows of three quads; the strip turns back at the end of the first row by naming vertices twice, or begins again.
    let positions: Vec<[f32; 3]> = (0..12).map(|i| [0.2 * (i % 4) as f32, -0.2 * (i / 4) as f32, 0.0]).collect();
    let row = |first: u32| (0..4).flat_map(move |i| [first + i, first + i + 4]);
    let stitched: Vec<u32> = row(0).chain([7, 4]).chain(row(4)).collect();
    let restarted: Vec<u32> = row(0).chain([u32::MAX]).chain(row(4)).collect();
    let short = |indices: &[u32]| Indices::U16(indices.iter().map(|i| *i as u16).collect());
    let quads = [0, 1, 2, 4, 5, 6];
    let list: Vec<u32> = quads.into_iter().flat_map(|a| [a, a + 4, a + 1, a + 1, a + 4, a + 5]).collect();
    let make = |topology, positions: Vec<[f32; 3]>, indices: Option<Indices>| {
        let mesh = Mesh::new(topology, RenderAssetUsages::default());
        let mut mesh = mesh.with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions);
        indices.into_iter().for_each(|indices| mesh.insert_indices(indices));
        mesh
    };
    let unindexed: Vec<[f32; 3]> = list.iter().map(|i| positions[*i as usize]).collect();
    let (strips, lists) = (PrimitiveTopology::TriangleStrip, PrimitiveTopology::TriangleList);
    let meshes = [
        make(lists, positions.clone(), Some(Indices::U32(list.clone()))),
        make(lists, positions.clone(), Some(short(&list))),
        make(lists, unindexed, None),
        make(strips, positions.clone(), Some(Indices::U32(stitched.clone()))),
        make(strips, positions.clone(), Some(short(&stitched))),
        make(strips, positions.clone(), Some(Indices::U32(restarted.clone()))),
        make(strips, positions, Some(short(&restarted))),
    ];
    let mut app = with_meshes();
    let cloths = meshes.map(|mesh| spawn(&mut app, mesh, Pins::top()));
    run(&mut app, 30);
    for cloth in cloths {
        let topology = get::<ClothTopology>(&app, cloth);
        assert_eq!((topology.particle_count(), topology.triangles.len()), (12, 12));
        assert!(topology.mended.is_nothing(), "{}", topology.mended);
        // Without indices each triangle has vertices of its own: a seam through every cell, so that it is no rectangle.
        assert_eq!(topology.grid.is_some(), cloth != cloths[2]);
        if cloth != cloths[2] {
            assert_eq!(bits(&app, cloth), bits(&app, cloths[0]));
        }
    }
}

/// A sheet with attributes that are functions of the place: (x, y), x and the vertex's half of the sheet.
fn attributed(cells: u32) -> Mesh {
    let mut mesh = sheet(cells);
    let Some(VertexAttributeValues::Float32x3(positions)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION) else { panic!() };
    let places: Vec<Vec2> = positions.iter().map(|p| Vec2::new(p[0], p[1])).collect();
    let vertices = places.len();
    mesh.insert_attribute(Mesh::ATTRIBUTE_UV_0, places.iter().map(Vec2::to_array).collect::<Vec<_>>());
    mesh.insert_attribute(Mesh::ATTRIBUTE_UV_1, places.iter().map(|p| [p.y, p.x]).collect::<Vec<_>>());
    mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, places.iter().map(|p| [p.x + 0.5, 0.0, 1.0, 1.0]).collect::<Vec<_>>());
    mesh.insert_attribute(CUSTOM, places.iter().map(|p| 3.0 * p.x).collect::<Vec<_>>());
    mesh.insert_attribute(NUMBER, places.iter().map(|p| u32::from(p.x > 0.0)).collect::<Vec<_>>());
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, VertexAttributeValues::Uint16x4(vec![[0; 4]; vertices]));
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, vec![[1.0, 0.0, 0.0, 0.0]; vertices]);
    mesh
}

#[test]
fn all_attributes_stay_with_their_vertices_through_tears_cuts_and_subdivision() {
    for subdivision in ClothSubdivision::ALL {
        let mut app = with_meshes();
        let cloth = spawn(&mut app, attributed(6), (Pins::top(), subdivision));
        run(&mut app, 2);
        let whole = drawn(&app, cloth).count_vertices();
        for (x, y) in [(-0.3, 0.1), (0.1, -0.2)] {
            app.world_mut().trigger(cut(cloth, Vec2::new(x, y), Vec2::new(x + 0.37, y)));
        }
        app.world_mut().trigger(TearCloth { entity: cloth, position: Vec3::ZERO, pull: Direction::Weft });
        run(&mut app, 3);
        let mesh = drawn(&app, cloth);
        assert!(mesh.count_vertices() > whole + 8, "nothing was cut");
        let floats = |attribute| match mesh.attribute(attribute) {
            Some(VertexAttributeValues::Float32x2(values)) => values.clone(),
            other => panic!("{attribute:?} is {other:?}"),
        };
        let (first, second) = (floats(Mesh::ATTRIBUTE_UV_0), floats(Mesh::ATTRIBUTE_UV_1));
        let Some(VertexAttributeValues::Float32(custom)) = mesh.attribute(CUSTOM) else { panic!("it is gone") };
        let Some(VertexAttributeValues::Uint32(number)) = mesh.attribute(NUMBER) else { panic!("it is gone") };
        let Some(VertexAttributeValues::Float32x4(color)) = mesh.attribute(Mesh::ATTRIBUTE_COLOR) else { panic!() };
        for (vertex, [x, y]) in first.into_iter().enumerate() {
            let near = |a: f32, b: f32| (a - b).abs() < 1e-5;
            assert!(near(second[vertex][0], y) && near(second[vertex][1], x), "{vertex}: {:?}", second[vertex]);
            assert!(near(custom[vertex], 3.0 * x) && near(color[vertex][0], x + 0.5));
            assert!(number[vertex] == u32::from(x > 0.0) || x.abs() < 1.0 / 6.0);
        }
        assert!(mesh.attribute(Mesh::ATTRIBUTE_JOINT_INDEX).is_none(), "the renderer would move it once more");
        assert!(mesh.attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT).is_none());
    }
}

#[test]
fn a_double_with_other_texture_coordinates_is_what_is_seen_of_the_back() {
    for subdivision in ClothSubdivision::ALL {
        let mut app = with_meshes();
        let mut mesh = sheet(4);
        let mut indices: Vec<u32> = mesh.indices().expect("indices").iter().map(|i| i as u32).collect();
        let count = mesh.count_vertices() as u32;
        // As a modeller makes a lining: the same faces once more, turned over, with texture coordinates beside the others.
        let lining: Vec<u32> =
            indices.as_chunks::<3>().0.iter().flat_map(|[a, b, c]| [c, b, a]).map(|v| v + count).collect();
        indices.extend(lining);
        mesh.insert_indices(Indices::U32(indices));
        for (_, values) in mesh.attributes_mut() {
            match values {
                VertexAttributeValues::Float32x3(all) => all.extend_from_within(..),
                VertexAttributeValues::Float32x2(all) => {
                    let beside: Vec<[f32; 2]> = all.iter().map(|[u, v]| [u + 2.0, *v]).collect();
                    all.extend(beside);
                }
                other => panic!("{other:?}"),
            }
        }
        let cloth = spawn(&mut app, mesh, (Pins::top(), subdivision));
        run(&mut app, 2);
        app.world_mut().trigger(cut(cloth, Vec2::new(-0.3, 0.1), Vec2::new(0.2, 0.13)));
        run(&mut app, 2);
        let topology = get::<ClothTopology>(&app, cloth);
        assert!(topology.mended.doubled_triangles == 32 && topology.triangles.len() > 32);
        let mesh = drawn(&app, cloth);
        let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute(Mesh::ATTRIBUTE_UV_0) else { panic!() };
        let Some(VertexAttributeValues::Float32x3(normals)) = mesh.attribute(Mesh::ATTRIBUTE_NORMAL) else { panic!() };
        let Some(VertexAttributeValues::Float32x3(at)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION) else { panic!() };
        let indices: Vec<usize> = mesh.indices().expect("indices").iter().collect();
        let (front, back) = indices.split_at(indices.len() / 2);
        assert!(front.iter().all(|vertex| uvs[*vertex][0] <= 1.0 && normals[*vertex][2] > 0.5));
        assert!(back.iter().all(|vertex| uvs[*vertex][0] >= 2.0 && normals[*vertex][2] < -0.5));
        for (front, back) in front.iter().zip(back.as_chunks::<3>().0.iter().flat_map(|[a, b, c]| [a, c, b])) {
            assert!(Vec3::from(at[*front]).distance(Vec3::from(at[*back])) < 2e-3);
            assert!(
                (uvs[*front][0] + 2.0 - uvs[*back][0]).abs() < 1e-5 && (uvs[*front][1] - uvs[*back][1]).abs() < 1e-5
            );
        }
    }
}
