//! Cloth made from a skinned mesh follows its joints.

use std::time::Duration;

use crate::common::figure::*;
use crate::common::*;
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_cloth::*;

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

#[test]
fn pinned_vertices_follow_their_joints_and_none_gets_farther_than_painted() {
    let mut worst = (0.0_f32, f32::MIN, f32::MIN);
    for (seed, paint) in [Paint::Attribute, Paint::Color].into_iter().enumerate() {
        for units in [1.0, 100.0] {
            for hertz in [24.0, 60.0, 144.0].into_iter().take(cases(1, 3)) {
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
        for k in [1, 2] {
            figure.app.world_mut().get_mut::<Transform>(figure.joints[k]).unwrap().rotate_x(0.02);
        }
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
