//! Cloth made from a skinned mesh follows its joints.

mod common;

use std::time::Duration;

use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::mesh::{Indices, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_cloth::cloth_solver::cloth::Constraints;
use bevy_cloth::*;
use common::*;

const COLUMNS: u32 = 7;
const ROWS: u32 = 13;

/// A sequence of numbers in -1..1 from a seed.
#[derive(Resource, Clone)]
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::from_array([(); 3].map(|()| self.next()))
    }
}

/// How a cape is painted.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Paint {
    Attribute,
    Color,
    Nothing,
}

/// A cape behind a spine of three joints, one above the other, half a metre apart.
struct Figure {
    app: App,
    root: Entity,
    joints: Vec<Entity>,
    cape: Entity,
    /// Vertices and their joints and weights.
    bind: Vec<(Vec3, [u16; 4], [f32; 4])>,
    inverse: Vec<Mat4>,
}

/// Where the vertices of the cape are in the bind pose, m.
fn vertices() -> Vec<Vec3> {
    let at = |i: u32| {
        let (row, column) = (i / COLUMNS, i % COLUMNS);
        Vec3::new(0.1 * (column as f32 - 3.0), 1.2 - 0.1 * row as f32, -0.2)
    };
    (0..ROWS * COLUMNS).map(at).collect()
}

/// How free a vertex is: not at all in the first two rows, then more and more.
fn freedom(vertex: usize) -> f32 {
    (vertex as u32 / COLUMNS).saturating_sub(1) as f32 / (ROWS - 2) as f32
}

/// The mesh has `units` to a metre, and its armature is scaled by their inverse.
fn figure(paint: Paint, units: f32, pose: impl Fn(usize) -> Transform, more: impl Bundle) -> Figure {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin::default(),
        bevy::mesh::MeshPlugin,
        ClothPlugin::default(),
    ));
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
    fn skinned(&self) -> Vec<Vec3> {
        let joint = |k: u16| get::<GlobalTransform>(&self.app, self.joints[usize::from(k)]).to_matrix();
        let matrices: Vec<Mat4> = (0..3).map(|k| joint(k) * self.inverse[usize::from(k)]).collect();
        let place = |(at, joints, weights): &(Vec3, [u16; 4], [f32; 4])| {
            (0..4).map(|k| matrices[usize::from(joints[k])].transform_point3(*at) * weights[k]).sum()
        };
        self.bind.iter().map(place).collect()
    }

    /// Where each vertex is drawn, in the world.
    fn drawn(&self) -> Vec<Vec3> {
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
    fn pinned_off(&self) -> f32 {
        let pairs = self.drawn().into_iter().zip(self.skinned()).enumerate();
        pairs.filter(|(i, _)| freedom(*i) == 0.0).map(|(_, (a, b))| a.distance(b)).fold(0.0, f32::max)
    }

    /// By how much the worst particle exceeds its largest distance, and its backstop, at the end of the last tick, m.
    fn excess(&self) -> (f32, f32) {
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

/// A joint that turns at random about where it is.
#[derive(Component)]
struct Restless(Numbers, Vec3);

fn fidget(mut joints: Query<(&mut Restless, &mut Transform)>, time: Res<Time>) {
    for (mut restless, mut place) in &mut joints {
        let push = restless.0.vector() * 40.0 * time.delta_secs();
        let spin = ((restless.1 + push) * (1.0 - time.delta_secs())).clamp_length_max(6.0);
        restless.1 = spin;
        place.rotate(Quat::from_scaled_axis(spin * time.delta_secs()));
    }
}

/// Walks and turns.
#[derive(Component)]
struct Walks(Vec3);

fn walk(mut walkers: Query<(&Walks, &mut Transform)>, time: Res<Time>) {
    for (walks, mut place) in &mut walkers {
        place.translation += walks.0 * time.delta_secs();
        place.rotate_y(2.0 * time.delta_secs());
    }
}

const LIMITS: Freedom = Freedom { distance: 0.3, backstop: 0.02 };

#[test]
fn pinned_vertices_follow_their_joints_and_none_gets_farther_than_painted() {
    let mut worst = (0.0_f32, f32::MIN, f32::MIN);
    for (seed, paint) in [Paint::Attribute, Paint::Color].into_iter().enumerate() {
        for units in [1.0, 100.0] {
            for hertz in [24.0, 60.0, 144.0] {
                let mut figure = figure(paint, units, |_| Transform::IDENTITY, LIMITS);
                figure.app.add_systems(Update, (fidget, walk));
                let mut numbers = Numbers(seed as u64 + hertz as u64);
                let velocity = numbers.vector() * 8.0;
                figure.app.world_mut().entity_mut(figure.root).insert(Walks(velocity));
                for (k, joint) in figure.joints.clone().into_iter().enumerate() {
                    let restless = Restless(Numbers(k as u64 + hertz as u64), Vec3::ZERO);
                    figure.app.world_mut().entity_mut(joint).insert(restless);
                }
                let frame = Duration::from_secs_f32(1.0 / hertz);
                figure.app.insert_resource(TimeUpdateStrategy::ManualDuration(frame));
                for _ in 0..(1.5 * hertz) as u32 {
                    figure.app.update();
                    let (off, (far, deep)) = (figure.pinned_off(), figure.excess());
                    let what = format!("{paint:?}, {units} units a metre, {hertz} Hz");
                    assert!(off < 1e-4, "{what}: a pinned vertex is {off} m off");
                    assert!(far < 1e-3 && deep < 1e-3, "{what}: {far} m too far, {deep} m too deep");
                    let strain = get::<ClothStats>(&figure.app, figure.cape).largest_strain;
                    assert!(strain.is_finite(), "{what}: strain {strain}");
                    worst = (worst.0.max(off), worst.1.max(far), worst.2.max(deep));
                }
            }
        }
    }
    println!("pinned {} mm off, {} mm too far, {} mm too deep", 1e3 * worst.0, 1e3 * worst.1, 1e3 * worst.2);
}

#[test]
fn cloth_starts_where_its_joints_are_whatever_pose_they_are_in() {
    for units in [1.0, 100.0] {
        let bent = |k: usize| Transform::from_rotation(Quat::from_rotation_x(0.5 * k as f32));
        let figure = figure(Paint::Attribute, units, bent, (Freedom::default(), Gravity(Vec3::ZERO)));
        let off = largest_move(&figure.drawn(), &figure.skinned());
        assert!(off < 0.02, "{units} units a metre: {off} m");
        let strain = get::<ClothStats>(&figure.app, figure.cape).largest_strain;
        assert!(strain < 0.5, "{units} units a metre: strain {strain}");
    }
}

#[test]
fn pins_on_the_cloth_follow_the_joints_too_and_without_any_it_falls() {
    let mut figure = figure(Paint::Nothing, 1.0, |_| Transform::IDENTITY, Pins::vertices(0..2 * COLUMNS));
    for _ in 0..30 {
        let mut joint = figure.app.world_mut().get_mut::<Transform>(figure.joints[1]).unwrap();
        joint.rotate_x(0.03);
        figure.app.update();
        let off = figure.pinned_off();
        assert!(off < 1e-4, "{off} m off");
    }
    figure.app.world_mut().entity_mut(figure.cape).remove::<Pins>();
    run(&mut figure.app, 30);
    assert!(centre(&figure.app, figure.cape).y < 0.2, "it does not fall");
}

#[test]
fn the_skin_is_not_applied_twice_and_given_back() {
    let mut figure = figure(Paint::Attribute, 1.0, |_| Transform::IDENTITY, LIMITS);
    let cape = figure.cape;
    assert!(figure.app.world().get::<SkinnedMesh>(cape).is_none(), "the renderer would apply it once more");
    let mesh = figure.app.world().resource::<Assets<Mesh>>().get(&get::<Mesh3d>(&figure.app, cape).0).expect("a mesh");
    assert!(mesh.attribute(Mesh::ATTRIBUTE_JOINT_INDEX).is_none());
    figure.app.world_mut().entity_mut(cape).remove::<Cloth>();
    run(&mut figure.app, 2);
    assert_eq!(get::<SkinnedMesh>(&figure.app, cape).joints, figure.joints);
    let mesh = figure.app.world().resource::<Assets<Mesh>>().get(&get::<Mesh3d>(&figure.app, cape).0).expect("a mesh");
    assert!(mesh.attribute(Mesh::ATTRIBUTE_JOINT_INDEX).is_some(), "its own mesh is not back");
    figure.app.world_mut().entity_mut(cape).insert(Cloth::mesh());
    run(&mut figure.app, 4);
    assert!(figure.pinned_off() < 1e-4, "it is no cloth again");
}

#[test]
fn normals_are_those_of_the_shape() {
    let bent = |k: usize| Transform::from_rotation(Quat::from_rotation_x(0.4 * k as f32));
    let stiff = Freedom { distance: 0.0, ..LIMITS };
    let figure = figure(Paint::Attribute, 1.0, bent, stiff);
    let mesh = figure.app.world().resource::<Assets<Mesh>>().get(&get::<Mesh3d>(&figure.app, figure.cape).0);
    let mesh = mesh.expect("a mesh");
    let Some(VertexAttributeValues::Float32x3(normals)) = mesh.attribute(Mesh::ATTRIBUTE_NORMAL) else { panic!() };
    let place = get::<GlobalTransform>(&figure.app, figure.cape).affine();
    let skinned = figure.skinned();
    for row in 1..ROWS - 1 {
        let at = |row: u32| skinned[(row * COLUMNS + 3) as usize];
        // It is seen from behind, and its columns run down.
        let expected = (at(row + 1) - at(row - 1)).cross(Vec3::X).normalize() * -1.0;
        let normal = place.transform_vector3(Vec3::from_array(normals[(row * COLUMNS + 3) as usize])).normalize();
        assert!(normal.dot(expected) > 0.995, "row {row}: {normal} in place of {expected}");
    }
}

#[test]
fn a_figure_that_blinks_carries_its_cape_along() {
    let mut figure = figure(Paint::Attribute, 1.0, |_| Transform::IDENTITY, LIMITS);
    run(&mut figure.app, 64);
    for k in 0..20 {
        let before = get::<ClothStats>(&figure.app, figure.cape).largest_strain;
        let mut place = figure.app.world_mut().get_mut::<Transform>(figure.root).unwrap();
        place.translation += Vec3::new(3.0, 0.0, 4.0) * (k + 1) as f32;
        place.rotate_y(2.0);
        run(&mut figure.app, 1);
        let strain = get::<ClothStats>(&figure.app, figure.cape).largest_strain;
        assert!(strain < before.max(0.02) + 0.02, "blink {k}: strain {strain} after {before}");
        assert!(figure.pinned_off() < 1e-4 && figure.excess().0 < 1e-3);
        run(&mut figure.app, 3);
    }
}

#[test]
fn reset_cloth_is_where_its_joints_are() {
    let mut figure = figure(Paint::Attribute, 1.0, |_| Transform::IDENTITY, LIMITS);
    run(&mut figure.app, 32);
    figure.app.world_mut().get_mut::<Transform>(figure.joints[0]).unwrap().rotate_x(1.0);
    run(&mut figure.app, 8);
    figure.app.world_mut().trigger(ResetCloth { entity: figure.cape });
    figure.app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    figure.app.update();
    let off = largest_move(&figure.drawn(), &figure.skinned());
    assert!(off < 1e-4, "{off} m");
}

#[test]
fn what_is_wrong_with_freedom_or_skin_is_told_by_name() {
    let mut figure = figure(Paint::Attribute, 1.0, |_| Transform::IDENTITY, LIMITS);
    for (freedom, field) in [
        (Freedom { distance: -1.0, ..LIMITS }, "Freedom::distance"),
        (Freedom { backstop: f32::NAN, ..LIMITS }, "Freedom::backstop"),
        (Freedom { distance: f32::INFINITY, ..LIMITS }, "Freedom::backstop"),
    ] {
        figure.app.world_mut().entity_mut(figure.cape).insert(freedom);
        figure.app.update();
        let error = get::<ClothRejection>(&figure.app, figure.cape).error().to_string();
        assert!(error.contains(field), "{error}");
    }
    figure.app.world_mut().entity_mut(figure.cape).insert(LIMITS);
    run(&mut figure.app, 2);
    assert!(figure.app.world().get::<ClothRejection>(figure.cape).is_none());
    assert!(figure.excess().0 < 1e-3);
}

#[test]
fn cloth_that_is_not_skinned_is_limited_about_its_rest_pose() {
    let mut app = headless();
    let freedom = Freedom { distance: 0.1, ..default() };
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.5, 0.5).with_cells(5, 5), freedom)).id();
    run(&mut app, 64);
    let topology = get::<ClothTopology>(&app, cloth);
    let rest: Vec<Vec3> = topology.particles().map(|slot| topology.rest[slot as usize]).collect();
    let away = largest_move(&rest, &world_positions(&app, cloth));
    assert!((away - 0.1).abs() < 1e-3, "{away} m");
}

/// The ends of each capsule, in the world, and its radius.
fn capsules(app: &mut App) -> Vec<(Vec3, Vec3, f32)> {
    let mut all = app.world_mut().query::<(&ClothCollider, &GlobalTransform)>();
    let ends = all.iter(app.world()).filter_map(|(collider, place)| match collider {
        ClothCollider::Capsule { radius, length } => {
            let [top, bottom] = [0.5, -0.5].map(|half| place.transform_point(Vec3::Y * half * *length));
            Some((bottom, top, *radius))
        }
        _ => None,
    });
    let mut ends: Vec<_> = ends.collect();
    ends.sort_by(|a, b| a.0.y.total_cmp(&b.0.y));
    ends
}

#[test]
fn bones_have_capsules_that_go_along_and_go_away() {
    let mut figure = figure(Paint::Attribute, 1.0, |_| Transform::IDENTITY, LIMITS);
    let named = Name::new("chest");
    figure.app.world_mut().entity_mut(figure.joints[1]).insert(named);
    figure.app.world_mut().entity_mut(figure.root).insert(BoneColliders::new(0.3).with_radius("chest", 0.2));
    figure.app.world_mut().get_mut::<Transform>(figure.joints[1]).unwrap().rotate_z(-0.5);
    run(&mut figure.app, 3);
    let joint = |figure: &Figure, k: usize| get::<GlobalTransform>(&figure.app, figure.joints[k]).translation();
    let found = capsules(&mut figure.app);
    assert_eq!(found.len(), 2);
    for (k, ((from, to, radius), wanted)) in found.iter().zip([0.15, 0.2]).enumerate() {
        let off = from.distance(joint(&figure, k)).max(to.distance(joint(&figure, k + 1)));
        assert!(off < 1e-5 && (radius - wanted).abs() < 1e-6, "bone {k}: {off} m off, radius {radius} m");
    }
    // A hand that comes later.
    let hand = Transform::from_xyz(0.2, 0.0, 0.0);
    let hand = figure.app.world_mut().spawn((hand, ChildOf(figure.joints[2]))).id();
    run(&mut figure.app, 2);
    assert_eq!(capsules(&mut figure.app).len(), 2, "no skin names it");
    figure.app.world_mut().entity_mut(figure.cape).remove::<Cloth>();
    run(&mut figure.app, 2);
    figure.app.world_mut().get_mut::<SkinnedMesh>(figure.cape).unwrap().joints.push(hand);
    figure.app.world_mut().get_mut::<BoneColliders>(figure.root).unwrap().radius = 0.25;
    run(&mut figure.app, 2);
    assert_eq!(capsules(&mut figure.app).len(), 3);
    figure.app.world_mut().entity_mut(figure.root).remove::<BoneColliders>();
    run(&mut figure.app, 2);
    assert!(capsules(&mut figure.app).is_empty());
}

#[test]
fn a_cape_does_not_enter_the_bones() {
    let mut figure = figure(Paint::Attribute, 1.0, |_| Transform::IDENTITY, Freedom::default());
    figure.app.world_mut().entity_mut(figure.root).insert((BoneColliders::new(0.3), Walks(Vec3::new(0.0, 0.0, -3.0))));
    figure.app.add_systems(FixedUpdate, walk);
    for _ in 0..96 {
        figure.app.update();
        let bones = capsules(&mut figure.app);
        let radius = |bone: &(Vec3, Vec3, f32), at: Vec3| {
            let (from, along) = (bone.0, bone.1 - bone.0);
            let part = ((at - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            at.distance(from + along * part) - bone.2
        };
        let positions = world_positions(&figure.app, figure.cape);
        let depth = positions.iter().flat_map(|at| bones.iter().map(|bone| radius(bone, *at))).fold(f32::MAX, f32::min);
        assert!(bones.len() == 2 && depth > -0.01, "{depth} m in a bone");
    }
}
