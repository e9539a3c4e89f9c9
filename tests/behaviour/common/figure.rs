//! A figure of three joints made in code, with a skinned mesh that is a cape.

use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::mesh::{Indices, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_cloth::cloth_solver::cloth::Constraints;
use bevy_cloth::*;

use super::{TICK, get, run, with_transforms};

pub const COLUMNS: u32 = 7;
pub const ROWS: u32 = 13;

/// A sequence of numbers in -1..1 from a seed.
#[derive(Resource, Clone)]
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::from_array([(); 3].map(|()| self.next()))
    }
}

/// How a cape is painted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Paint {
    Attribute,
    Color,
    Nothing,
}

/// A cape behind a spine of three joints, one above the other, half a metre apart.
pub struct Figure {
    pub app: App,
    pub root: Entity,
    pub joints: Vec<Entity>,
    pub cape: Entity,
    /// Vertices and their joints and weights.
    pub bind: Vec<(Vec3, [u16; 4], [f32; 4])>,
    pub inverse: Vec<Mat4>,
}

/// Where the vertices of the cape are in the bind pose, m.
pub fn vertices() -> Vec<Vec3> {
    let at = |i: u32| {
        let (row, column) = (i / COLUMNS, i % COLUMNS);
        Vec3::new(0.1 * (column as f32 - 3.0), 1.2 - 0.1 * row as f32, -0.2)
    };
    (0..ROWS * COLUMNS).map(at).collect()
}

/// How free a vertex is: not at all in the first two rows, then more and more.
pub fn freedom(vertex: usize) -> f32 {
    (vertex as u32 / COLUMNS).saturating_sub(1) as f32 / (ROWS - 2) as f32
}

/// The mesh has `units` to a metre, and its armature is scaled by their inverse.
pub fn figure(paint: Paint, units: f32, pose: impl Fn(usize) -> Transform, more: impl Bundle) -> Figure {
    let mut app = with_transforms();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(TICK));
    let heights = [0.0, 0.5, 1.0];
    let bind: Vec<_> = vertices()
        .into_iter()
        .map(|at| {
            let height = (at.y / 0.5).clamp(0.0, 1.999);
            let (lower, upper) = (height as u16, height as u16 + 1);
            (at * units, [lower, upper, 0, 0], [1.0 - height.fract(), height.fract(), 0.0, 0.0])
        })
        .collect();
    let mut triangles = vec![];
    for row in 0..ROWS - 1 {
        for column in 0..COLUMNS - 1 {
            let a = row * COLUMNS + column;
            let [b, c, d] = [a + 1, a + COLUMNS, a + COLUMNS + 1];
            // Seen from behind.
            triangles.extend(if (row + column) % 2 == 0 { [a, b, c, b, d, c] } else { [a, b, d, a, d, c] });
        }
    }
    let mut mesh = Mesh::new(PrimitiveTopology::TriangleList, default())
        .with_inserted_attribute(
            Mesh::ATTRIBUTE_POSITION,
            bind.iter().map(|(at, ..)| at.to_array()).collect::<Vec<_>>(),
        )
        .with_inserted_attribute(
            Mesh::ATTRIBUTE_JOINT_INDEX,
            VertexAttributeValues::Uint16x4(bind.iter().map(|(_, joints, _)| *joints).collect()),
        )
        .with_inserted_attribute(
            Mesh::ATTRIBUTE_JOINT_WEIGHT,
            bind.iter().map(|(.., weights)| *weights).collect::<Vec<_>>(),
        )
        .with_inserted_indices(Indices::U32(triangles));
    let free = (0..bind.len()).map(freedom);
    match paint {
        Paint::Attribute => mesh.insert_attribute(ATTRIBUTE_FREEDOM, free.collect::<Vec<f32>>()),
        Paint::Color => {
            mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, free.map(|f| [f, 0.5, 0.5, 1.0]).collect::<Vec<_>>())
        }
        Paint::Nothing => {}
    }
    let inverse: Vec<Mat4> = heights.iter().map(|height| Mat4::from_translation(-Vec3::Y * *height * units)).collect();
    let world = app.world_mut();
    let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
    let inverse_bindposes = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>().add(inverse.clone());
    let root = world.spawn(Transform::from_scale(Vec3::splat(1.0 / units))).id();
    let mut joints: Vec<Entity> = vec![];
    for k in 0..heights.len() {
        let parent = joints.last().copied().unwrap_or(root);
        let lift = if k == 0 { 0.0 } else { 0.5 * units };
        let mut place = pose(k);
        place.translation += Vec3::Y * lift;
        joints.push(world.spawn((place, ChildOf(parent))).id());
    }
    let skin = SkinnedMesh { inverse_bindposes, joints: joints.clone() };
    let cape = world.spawn((Cloth::mesh(), Mesh3d(mesh), skin, ClothStats::default(), ChildOf(root))).insert(more).id();
    run(&mut app, 2);
    Figure { app, root, joints, cape, bind, inverse }
}

impl Figure {
    /// Where each vertex is by its joints as they are drawn.
    pub fn skinned(&self) -> Vec<Vec3> {
        let joint = |k: u16| get::<GlobalTransform>(&self.app, self.joints[usize::from(k)]).to_matrix();
        let matrices: Vec<Mat4> = (0..3).map(|k| joint(k) * self.inverse[usize::from(k)]).collect();
        let place = |(at, joints, weights): &(Vec3, [u16; 4], [f32; 4])| {
            (0..4).map(|k| matrices[usize::from(joints[k])].transform_point3(*at) * weights[k]).sum()
        };
        self.bind.iter().map(place).collect()
    }

    /// Where each vertex is drawn, in the world.
    pub fn drawn(&self) -> Vec<Vec3> {
        let mesh = self.app.world().resource::<Assets<Mesh>>().get(&get::<Mesh3d>(&self.app, self.cape).0);
        let Some(VertexAttributeValues::Float32x3(at)) = mesh.expect("a mesh").attribute(Mesh::ATTRIBUTE_POSITION)
        else {
            panic!("no positions")
        };
        let place = get::<GlobalTransform>(&self.app, self.cape);
        let (front, back) = at.split_at(at.len() / 2);
        let middle = |(a, b): (&[f32; 3], &[f32; 3])| 0.5 * (Vec3::from_array(*a) + Vec3::from_array(*b));
        front.iter().zip(back).map(middle).map(|at| place.transform_point(at)).collect()
    }

    /// How far the farthest pinned vertex is drawn from where its joints take it, m.
    pub fn pinned_off(&self) -> f32 {
        let pairs = self.drawn().into_iter().zip(self.skinned()).enumerate();
        pairs.filter(|(i, _)| freedom(*i) == 0.0).map(|(_, (a, b))| a.distance(b)).fold(0.0, f32::max)
    }

    /// By how much the worst particle exceeds its largest distance, and its backstop, at the end of the last tick, m.
    pub fn excess(&self) -> (f32, f32) {
        let (constraints, particles) =
            (get::<Constraints>(&self.app, self.cape), get::<Particles>(&self.app, self.cape));
        let frames = &constraints.pins().frames;
        let pose = |frame: u32| frames[frame as usize].to;
        let limits = &constraints.skin().expect("it is limited").limits;
        assert_eq!(limits.len(), (COLUMNS * (ROWS - 2)) as usize);
        limits.iter().fold((f32::MIN, f32::MIN), |(far, deep), limit| {
            let away = particles.position.get(limit.particle as usize) - limit.point.point(pose);
            let depth = -away.dot(limit.point.normal(pose));
            (far.max(away.length() - limit.distance), deep.max(depth - limit.backstop))
        })
    }
}

/// Walks and turns.
#[derive(Component)]
pub struct Walks(pub Vec3);

pub fn walk(mut walkers: Query<(&Walks, &mut Transform)>, time: Res<Time>) {
    for (walks, mut place) in &mut walkers {
        place.translation += walks.0 * time.delta_secs();
        place.rotate_y(2.0 * time.delta_secs());
    }
}

/// Limits of a cape that swings.
pub const LIMITS: Freedom = Freedom { distance: 0.3, backstop: 0.02 };
