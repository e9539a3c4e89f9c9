//! The visible body of each collider, kept in step with its shape.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{PrimitiveTopology, VertexAttributeValues};
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

/// The surface of a bounded primitive collider; `None` for ground, free shapes and meshes, and for sizes that are not
/// positive, which the cloth refuses, too.
pub fn mesh_of(collider: &ClothCollider) -> Option<Mesh> {
    let positive = |sizes: &[f32]| sizes.iter().all(|size| size.is_finite() && *size > 0.0);
    match *collider {
        ClothCollider::Sphere { radius } => positive(&[radius]).then(|| Sphere::new(radius).mesh().uv(64, 40)),
        ClothCollider::Capsule { radius, length } => positive(&[radius, length])
            .then(|| Capsule3d::new(radius, length).mesh().longitudes(48).latitudes(24).build()),
        ClothCollider::Cuboid { size } => positive(&size.to_array()).then(|| Cuboid::from_size(size).mesh().build()),
        ClothCollider::Pyramid { base, height } => positive(&[base.x, base.y, height]).then(|| pyramid(base, height)),
        ClothCollider::Ellipsoid { radii } => {
            positive(&radii.to_array()).then(|| Sphere::new(1.0).mesh().uv(64, 40).scaled_by(radii))
        }
        ClothCollider::Cylinder { radius, height } => {
            positive(&[radius, height]).then(|| Cylinder::new(radius, height).mesh().resolution(64).build())
        }
        ClothCollider::Cone { radius, height } => {
            positive(&[radius, height]).then(|| Cone::new(radius, height).mesh().resolution(64).build())
        }
        ClothCollider::RoundedCuboid { size, radius } => {
            let core = size / 2.0 - radius;
            positive(&[core.min_element(), radius]).then(|| rounded(core, radius))
        }
        // A mesh is its own body.
        ClothCollider::Convex { .. }
        | ClothCollider::Hull { .. }
        | ClothCollider::HeightField { .. }
        | ClothCollider::Mesh { .. }
        | ClothCollider::Triangles { .. }
        | ClothCollider::Ground => None,
    }
}

/// A box of half its edges, and all that is no farther than `radius`: a ball taken apart at its middle along each axis.
fn rounded(core: Vec3, radius: f32) -> Mesh {
    let mut mesh = Sphere::new(radius).mesh().uv(63, 39);
    if let Some(VertexAttributeValues::Float32x3(positions)) = mesh.attribute_mut(Mesh::ATTRIBUTE_POSITION) {
        for place in positions {
            *place = (Vec3::from_array(*place) + core * Vec3::ONE.copysign(Vec3::from_array(*place))).to_array();
        }
    }
    mesh
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
