//! The visible body of each collider, kept in step with its shape.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::PrimitiveTopology;
use bevy::prelude::*;
use bevy_cloth::ClothCollider;

/// Gives every collider with a material a mesh of its shape.
pub struct ShapesPlugin;

impl Plugin for ShapesPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, shape_colliders);
    }
}

fn shape_colliders(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    colliders: Query<(Entity, &ClothCollider), (Changed<ClothCollider>, With<MeshMaterial3d<StandardMaterial>>)>,
) {
    for (entity, collider) in &colliders {
        if let Some(mesh) = mesh_of(collider) {
            commands.entity(entity).insert(Mesh3d(meshes.add(mesh)));
        }
    }
}

/// The surface of a bounded primitive collider; `None` for ground and free convex shapes, and for sizes that are not
/// positive, which the cloth refuses, too.
pub fn mesh_of(collider: &ClothCollider) -> Option<Mesh> {
    let positive = |sizes: &[f32]| sizes.iter().all(|size| size.is_finite() && *size > 0.0);
    match *collider {
        ClothCollider::Sphere { radius } => positive(&[radius]).then(|| Sphere::new(radius).mesh().uv(64, 40)),
        ClothCollider::Capsule { radius, length } => positive(&[radius, length])
            .then(|| Capsule3d::new(radius, length).mesh().longitudes(48).latitudes(24).build()),
        ClothCollider::Cuboid { size } => positive(&size.to_array()).then(|| Cuboid::from_size(size).mesh().build()),
        ClothCollider::Pyramid { base, height } => positive(&[base.x, base.y, height]).then(|| pyramid(base, height)),
        ClothCollider::Convex { .. } | ClothCollider::Ground => None,
    }
}

/// A pyramid centred at half its height, with flat faces.
fn pyramid(base: Vec2, height: f32) -> Mesh {
    let (x, y, z) = (base.x / 2.0, height / 2.0, base.y / 2.0);
    let apex = Vec3::new(0.0, y, 0.0);
    let [a, b, c, d] = [Vec3::new(-x, -y, z), Vec3::new(x, -y, z), Vec3::new(x, -y, -z), Vec3::new(-x, -y, -z)];
    let corners = [[a, b, apex], [b, c, apex], [c, d, apex], [d, a, apex], [a, d, c], [a, c, b]].concat();
    let uvs = vec![[0.0_f32, 0.0]; corners.len()];
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
        .with_computed_flat_normals()
}
