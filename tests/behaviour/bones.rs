//! Bones of an armature have capsules that cloth cannot enter.

use crate::common::figure::*;
use crate::common::*;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_cloth::*;

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
    let found = capsules(&mut figure.app);
    assert_eq!(found.len(), 3);
    let [wrist, fingers] =
        [figure.joints[2], hand].map(|joint| get::<GlobalTransform>(&figure.app, joint).translation());
    let off = |(from, to, _): &(Vec3, Vec3, f32)| from.distance(wrist).max(to.distance(fingers));
    let nearest = found.iter().map(off).fold(f32::MAX, f32::min);
    assert!(nearest < 1e-5, "the hand's capsule is {nearest} m off");
    let bones = BoneColliders::new(0.25).with_radius("chest", 0.0);
    figure.app.world_mut().entity_mut(figure.root).insert(bones);
    run(&mut figure.app, 2);
    assert_eq!(capsules(&mut figure.app).len(), 2, "a radius of 0 is no capsule");
    figure.app.world_mut().entity_mut(figure.root).remove::<BoneColliders>();
    run(&mut figure.app, 2);
    assert!(capsules(&mut figure.app).is_empty());
}

#[test]
fn an_armature_that_arrives_later_than_its_colliders_has_capsules() {
    let mut app = headless();
    app.add_plugins(TransformPlugin);
    let root = app.world_mut().spawn((BoneColliders::default(), Transform::IDENTITY)).id();
    run(&mut app, 3);
    assert!(capsules(&mut app).is_empty());
    let hip = app.world_mut().spawn((Transform::from_xyz(0.0, 1.0, 0.0), ChildOf(root))).id();
    app.world_mut().spawn((Transform::from_xyz(0.0, 0.0, 0.5), ChildOf(hip)));
    run(&mut app, 2);
    let found = capsules(&mut app);
    assert_eq!(found.len(), 2);
    let (hip, knee, _) = found[1];
    assert!(hip.distance(Vec3::Y) < 1e-6 && knee.distance(Vec3::new(0.0, 1.0, 0.5)) < 1e-6, "from {hip} to {knee}");
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
