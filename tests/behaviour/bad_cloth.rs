//! Wrong data of a cloth is told with entity, field, value and what is allowed; the rest runs on, and mended data runs.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;

/// An app with a good cloth in it, and the good cloth.
fn app_with_witness() -> (App, Entity) {
    let mut app = headless();
    note_events::<ClothRejected>(&mut app);
    let witness = app.world_mut().spawn((Cloth::rectangle(0.5, 0.5).with_cells(8, 8), Pins::rods(2))).id();
    (app, witness)
}

/// Spawns a cloth with `bad` beside a good one. Checks that it is refused once, with all of `says` in what is told,
/// and that `mended` lets it run.
fn refused_until_mended(bad: impl Bundle, mended: impl Bundle, says: &[&str]) {
    let (mut app, witness) = app_with_witness();
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.5, 0.5).with_cells(8, 8), Pins::rods(2))).insert(bad).id();
    run(&mut app, 20);
    let told = seen::<ClothRejected>(&app).to_vec();
    assert_eq!(told.len(), 1, "told once: {told:?}");
    assert_eq!(told[0].entity, cloth);
    let message = told[0].error.to_string();
    assert!(says.iter().all(|part| message.contains(part)), "`{message}` does not say all of {says:?}");
    assert!(largest_move(&[Vec3::ZERO], &[centre(&app, witness)]) > 1e-4, "the other cloth does not run");
    assert_eq!(get::<ClothRejection>(&app, cloth).error().to_string(), message);
    let stood = app.world().get::<Particles>(cloth).is_some().then(|| bits(&app, cloth));
    run(&mut app, 2);
    assert_eq!(stood, app.world().get::<Particles>(cloth).is_some().then(|| bits(&app, cloth)), "it runs all the same");

    app.world_mut().entity_mut(cloth).insert(mended);
    run(&mut app, 20);
    assert!(app.world().get::<ClothRejection>(cloth).is_none(), "still refused");
    assert!(centre(&app, cloth).y < -1e-4, "it does not fall: {}", centre(&app, cloth));
    assert_eq!(seen::<ClothRejected>(&app).len(), 1);
}

#[test]
fn a_fabric_of_negative_mass() {
    let fabric = Fabric { areal_density: -0.2, ..Fabric::COTTON_POPLIN };
    refused_until_mended(fabric, Fabric::COTTON_POPLIN, &["areal_density", "-0.2", "allowed"]);
}

#[test]
fn a_fabric_of_no_mass() {
    let fabric = Fabric { areal_density: 0.0, ..Fabric::COTTON_POPLIN };
    refused_until_mended(fabric, Fabric::COTTON_POPLIN, &["areal_density", "0", "allowed"]);
}

#[test]
fn a_fabric_whose_stiffness_is_no_number() {
    let fabric = Fabric { stretch_warp: f32::NAN, ..Fabric::COTTON_POPLIN };
    refused_until_mended(fabric, Fabric::COTTON_POPLIN, &["stretch_warp", "NaN", "allowed"]);
}

#[test]
fn a_rectangle_of_no_width() {
    let cloth = Cloth::rectangle(0.0, 1.0);
    refused_until_mended(cloth, Cloth::rectangle(0.5, 0.5).with_cells(8, 8), &["size", "0", "allowed"]);
}

#[test]
fn a_rectangle_of_negative_height() {
    let cloth = Cloth::rectangle(1.0, -2.0);
    refused_until_mended(cloth, Cloth::rectangle(0.5, 0.5).with_cells(8, 8), &["size", "-2", "allowed"]);
}

#[test]
fn a_rectangle_whose_size_is_no_number() {
    let cloth = Cloth::rectangle(f32::NAN, 1.0);
    refused_until_mended(cloth, Cloth::rectangle(0.5, 0.5).with_cells(8, 8), &["size", "NaN", "allowed"]);
}

#[test]
fn a_spacing_that_asks_for_too_many_particles() {
    let cloth = Cloth::rectangle(1.0, 1.0).with_spacing(1e-6);
    refused_until_mended(cloth, Cloth::rectangle(0.5, 0.5).with_cells(8, 8), &["resolution", "allowed"]);
}

#[test]
fn no_cells_at_all() {
    let cloth = Cloth::rectangle(1.0, 1.0).with_cells(0, 4);
    refused_until_mended(cloth, Cloth::rectangle(0.5, 0.5).with_cells(8, 8), &["0", "allowed"]);
}

#[test]
fn no_substeps() {
    let bad = Substeps { count: 0, ..default() };
    refused_until_mended(bad, Substeps::default(), &["Substeps::count", "0", "1..=200"]);
}

#[test]
fn gravity_that_is_no_number() {
    refused_until_mended(Gravity(Vec3::NAN), Gravity::default(), &["Gravity", "NaN", "m/s²"]);
}

#[test]
fn a_pinned_vertex_that_does_not_exist() {
    refused_until_mended(Pins::vertices([3, 5000]), Pins::vertices([3]), &["PinSelect::Vertices", "5000", "81"]);
}

#[test]
fn a_pinned_region_that_is_no_number() {
    refused_until_mended(Pins::region(Vec3::NAN, Vec3::ONE), Pins::rods(2), &["Region", "NaN"]);
}

#[test]
fn a_pin_by_vertex_colours_on_a_cloth_that_has_none() {
    refused_until_mended(Pins::vertex_color(0.5), Pins::rods(2), &["VertexColor", "0.5", "ATTRIBUTE_COLOR"]);
}

#[test]
fn a_transform_that_is_no_number_from_the_start() {
    let nowhere = Transform::from_xyz(f32::NAN, 0.0, 0.0);
    refused_until_mended(nowhere, Transform::IDENTITY, &["Transform", "NaN", "finite"]);
}

#[test]
fn a_scale_of_zero() {
    refused_until_mended(Transform::from_scale(Vec3::new(1.0, 0.0, 1.0)), Transform::IDENTITY, &["size", "0"]);
}

#[test]
fn a_grab_of_a_triangle_that_does_not_exist() {
    let bad = Grabs(vec![Grab { triangle: 100_000, ..default() }]);
    refused_until_mended(bad, Grabs::default(), &["Grab::triangle", "100000", "allowed"]);
}

#[test]
fn a_pin_to_an_entity_that_is_not_there_waits_for_it() {
    let (mut app, _) = app_with_witness();
    let hand = app.world_mut().spawn_empty().id();
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.5, 0.5), Pins::corners().to_entity(hand))).id();
    run(&mut app, 10);
    let told = seen::<ClothRejected>(&app);
    assert_eq!(told.len(), 1, "told once: {told:?}");
    assert!(told[0].error.to_string().contains("PinTarget::Entity"), "{}", told[0].error);
    app.world_mut().entity_mut(hand).insert(Transform::IDENTITY);
    run(&mut app, 10);
    assert!(app.world().get::<ClothRejection>(cloth).is_none());
    assert!(centre(&app, cloth).y < 0.0);
}

#[test]
fn a_bad_value_shared_by_all_is_told_for_each_cloth_that_uses_it() {
    let (mut app, witness) = app_with_witness();
    let own = app.world_mut().spawn((Cloth::rectangle(0.5, 0.5), Gravity(Vec3::NEG_Y))).id();
    run(&mut app, 4);
    app.world_mut().resource_mut::<Shared<Gravity>>().0 = Gravity(Vec3::splat(f32::INFINITY));
    run(&mut app, 4);
    assert_eq!(seen::<ClothRejected>(&app).iter().map(|told| told.entity).collect::<Vec<_>>(), [witness]);
    let before = centre(&app, own);
    app.world_mut().resource_mut::<Shared<Gravity>>().0 = Gravity::default();
    run(&mut app, 4);
    assert!(app.world().get::<ClothRejection>(witness).is_none());
    assert!(centre(&app, own).y < before.y);
}

#[test]
fn a_cloth_that_goes_bad_stands_in_its_last_shape_and_goes_on_from_it() {
    let (mut app, cloth) = app_with_witness();
    run(&mut app, 30);
    let stood = bits(&app, cloth);
    app.world_mut().entity_mut(cloth).insert(Fabric { thickness: 0.0, ..Fabric::COTTON_POPLIN });
    run(&mut app, 30);
    assert_eq!(bits(&app, cloth), stood);
    app.world_mut().entity_mut(cloth).insert(Fabric::SILK_CHARMEUSE);
    let before = world_positions(&app, cloth);
    app.update();
    let moved = largest_move(&before, &world_positions(&app, cloth));
    assert!(moved > 0.0 && moved < 0.1, "moved {moved} m in the tick after it was mended");
}

#[test]
fn two_faults_at_once_are_told_one_after_the_other() {
    let (mut app, _) = app_with_witness();
    let fabric = Fabric { thickness: -1.0, ..Fabric::COTTON_POPLIN };
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.0, 1.0), fabric)).id();
    run(&mut app, 4);
    app.world_mut().entity_mut(cloth).insert(Cloth::rectangle(1.0, 1.0));
    run(&mut app, 4);
    assert!(app.world().get::<Particles>(cloth).is_none(), "it runs with a fabric of negative thickness");
    app.world_mut().entity_mut(cloth).insert(Fabric::COTTON_POPLIN);
    run(&mut app, 4);
    assert!(centre(&app, cloth).y < 0.0);
    let told: Vec<_> = seen::<ClothRejected>(&app).iter().map(|told| told.error.to_string()).collect();
    assert!(told.len() == 2 && told[0].contains("size") && told[1].contains("thickness"), "{told:?}");
}

#[test]
fn what_is_told_is_a_message_too() {
    let (mut app, _) = app_with_witness();
    let cloth = app.world_mut().spawn(Cloth::rectangle(-1.0, 1.0)).id();
    app.update();
    let messages = take_messages::<ClothRejected>(&mut app);
    assert_eq!(messages.iter().map(|told| told.entity).collect::<Vec<_>>(), [cloth]);
}
