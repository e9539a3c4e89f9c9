//! Convex solids of one's own: a gem by its planes, and a lampshade by the points of its mesh.

use std::f32::consts::FRAC_PI_2;

use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothCollider, ClothPlugin, Fabric};

fn main() -> AppExit {
    App::new().add_plugins((DefaultPlugins, ClothPlugin::default())).add_systems(Startup, setup).run()
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    // An octahedron, its corners 0.3 m from its middle: all points p with `n · p <= 0.3` for eight directions n.
    let signs = [-1.0, 1.0];
    let directions = signs.iter().flat_map(|x| signs.iter().flat_map(|y| signs.iter().map(|z| Vec3::new(*x, *y, *z))));
    let gem = ClothCollider::Convex { planes: directions.map(|n| n.extend(0.3)).collect() };
    let gem_mesh = Sphere::new(0.3).mesh().uv(4, 2).with_duplicated_vertices().with_computed_flat_normals();
    // The smallest convex solid that holds all points of a mesh.
    let lampshade_mesh =
        ConicalFrustum { radius_top: 0.12, radius_bottom: 0.3, height: 0.45 }.mesh().resolution(24).build();
    let Some(VertexAttributeValues::Float32x3(points)) = lampshade_mesh.attribute(Mesh::ATTRIBUTE_POSITION) else {
        return;
    };
    let lampshade = ClothCollider::Hull { points: points.iter().copied().map(Vec3::from).collect() };

    for (x, collider, mesh) in [(-0.55, gem, gem_mesh), (0.55, lampshade, lampshade_mesh)] {
        commands.spawn((
            collider,
            Mesh3d(meshes.add(mesh)),
            MeshMaterial3d(materials.add(Color::srgb(0.8, 0.6, 0.3))),
            Transform::from_xyz(x, 0.3, 0.0),
        ));
        commands.spawn((
            Cloth::rectangle(0.9, 0.9),
            Fabric::SILK_CHARMEUSE,
            MeshMaterial3d(materials.add(Color::srgb(0.25, 0.5, 0.4))),
            Transform::from_xyz(x, 0.75, 0.0).with_rotation(Quat::from_rotation_x(-FRAC_PI_2)),
        ));
    }
    commands.spawn((
        ClothCollider::Ground,
        Mesh3d(meshes.add(Plane3d::default().mesh().size(6.0, 6.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.6, 0.6, 0.6))),
    ));
    commands
        .spawn((Camera3d::default(), Transform::from_xyz(0.2, 0.8, 1.5).looking_at(Vec3::new(0.0, 0.2, 0.0), Vec3::Y)));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(2.0, 4.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}
