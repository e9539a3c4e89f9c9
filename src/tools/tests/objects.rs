//! What is done to whole objects: pointing out, selecting, copying, deleting, resetting.

use bevy::prelude::*;
use bevy_cloth::*;
use bevy_cloth_inspector::Hovered;

use super::SHEET;
use crate::scenes::curtain_rod;
use crate::select::Selectable;
use crate::test_game::{Game, MIDDLE};
use crate::throw::Ball;
use crate::tools::{ReopenScene, Tool};

#[test]
fn what_a_click_would_select_is_pointed_out_and_a_click_selects_it() {
    let (mut game, sheet) = Game::with_sheet(Tool::Hand);
    game.app.update();
    assert_eq!(game.app.world().resource::<Hovered>().0, Some(sheet));
    game.click(MIDDLE);
    assert_eq!(game.selected(), Some(sheet));
    game.press(Tool::Pin.face().key);
    game.app.update();
    assert_eq!(game.app.world().resource::<Hovered>().0, None, "the pin does not select cloth");
    game.press(Tool::Hand.face().key);
    game.click(Vec2::new(30.0, 30.0));
    assert_eq!(game.selected(), None, "a click on nothing deselects");
}

#[test]
fn the_keys_go_through_all_objects_in_turn() {
    let mut game = Game::new();
    let [second, last, first] = [2, 0, 1].map(|turn| game.spawn((Selectable(turn), Transform::default())));
    let mut seen = Vec::new();
    for key in [KeyCode::BracketRight; 4].into_iter().chain([KeyCode::BracketLeft; 2]) {
        game.press(key);
        seen.push(game.selected().unwrap());
    }
    assert_eq!(seen, [first, second, last, first, last, second]);
}

#[test]
fn a_copy_stands_beside_its_original_and_is_selected() {
    let mut game = Game::new();
    let look = MeshMaterial3d::<StandardMaterial>::default();
    let ball = (Selectable(1), Name::new("sphere"), ClothCollider::Sphere { radius: 0.3 }, look);
    let ball = game.spawn((ball, Transform::from_xyz(0.5, 1.0, 0.0)));
    game.run(0.1);
    game.select(ball);
    game.press_with(KeyCode::KeyD, Some(KeyCode::ControlLeft));
    let copy = game.selected().unwrap();
    assert_ne!(copy, ball);
    assert_eq!(game.get::<ClothCollider>(copy), game.get::<ClothCollider>(ball));
    let apart = game.place(copy) - game.place(ball);
    assert!(apart.x > 0.1 && apart.x < 0.7 && apart.yz() == Vec2::ZERO, "{apart}");
}

#[test]
fn a_copied_cloth_runs_on_its_own() {
    let (mut game, sheet) = Game::with_sheet(Tool::Hand);
    game.select(sheet);
    game.press_with(KeyCode::KeyD, Some(KeyCode::ControlLeft));
    game.run(0.3);
    let copy = game.selected().unwrap();
    let middle = game.middle(copy);
    let apart = game.particle(copy, middle) - game.particle(sheet, middle);
    assert!((apart.x - (game.place(copy) - SHEET).x).abs() < 0.05, "{apart}");
}

#[test]
fn what_was_deleted_moved_thrown_or_copied_is_undone_by_a_reset() {
    let (mut game, sheet) = Game::with_sheet(Tool::Hand);
    let box_ = (Selectable(2), ClothCollider::Cuboid { size: Vec3::splat(0.2) }, Transform::from_xyz(1.0, 1.0, 0.0));
    let box_ = game.spawn(box_);
    game.run(0.1);
    let rest = game.particle(sheet, 200);
    for entity in [box_, sheet] {
        game.app.world_mut().get_mut::<Transform>(entity).unwrap().translation.x += 0.3;
    }
    game.press(KeyCode::KeyT);
    game.select(sheet);
    game.press_with(KeyCode::KeyD, Some(KeyCode::ControlLeft));
    game.select(box_);
    game.press(KeyCode::Delete);
    game.run(0.2);
    assert_eq!((game.count::<With<Cloth>>(), game.count::<With<Ball>>()), (2, 1));
    assert_eq!(game.count::<(With<ClothCollider>, Without<Ball>)>(), 0, "the box is deleted");
    game.press(KeyCode::KeyR);
    game.run(0.1);
    assert_eq!((game.count::<With<Cloth>>(), game.count::<With<Ball>>()), (1, 0));
    assert_eq!(game.count::<With<ClothCollider>>(), 1, "the box is back");
    assert_eq!((game.place(box_), game.place(sheet)), (Vec3::new(1.0, 1.0, 0.0), SHEET));
    assert!(game.particle(sheet, 200).distance(rest) < 0.1);
}

#[test]
fn a_reset_takes_pins_out_and_a_full_reset_is_asked_for_with_shift() {
    #[derive(Resource, Default)]
    struct Asked(u32);
    let (mut game, sheet) = Game::with_sheet(Tool::Pin);
    game.app.init_resource::<Asked>();
    game.app.add_observer(|_: On<ReopenScene>, mut asked: ResMut<Asked>| asked.0 += 1);
    game.click(MIDDLE);
    game.run(0.1);
    assert!(game.app.world().get::<ParticlePins>(sheet).is_some());
    game.press_with(KeyCode::KeyR, Some(KeyCode::ShiftLeft));
    assert!(game.app.world().get::<ParticlePins>(sheet).is_some(), "the scenes answer a full reset");
    assert_eq!(game.app.world().resource::<Asked>().0, 1);
    game.press(KeyCode::KeyR);
    assert!(game.app.world().get::<ParticlePins>(sheet).is_none());
    assert_eq!(game.app.world().resource::<Asked>().0, 1);
}

#[test]
fn a_copied_rod_has_a_curtain_of_its_own_and_a_reset_leaves_the_first() {
    let mut game = Game::new();
    let curtain = (Cloth::rectangle(1.0, 1.0).with_cells(16, 16), Pins::rods(4), Selectable(1));
    let curtain = game.app.world_mut().spawn(curtain).id();
    let place = Transform::from_xyz(0.0, 2.0, 0.0);
    let rod = curtain_rod::hang(&mut game.app.world_mut().commands(), place, curtain, 1.0, false);
    game.app.world_mut().flush();
    // A click takes the curtain.
    game.app.world_mut().entity_mut(rod).remove::<Selectable>();
    game.spawn((Selectable(2), ClothCollider::default(), Transform::from_xyz(0.0, 0.0, -3.0)));
    game.run(0.2);
    game.press(KeyCode::BracketLeft);
    game.press(KeyCode::Delete);
    game.select(rod);
    game.press_with(KeyCode::KeyD, Some(KeyCode::ControlLeft));
    game.run(0.2);
    assert_eq!(game.count::<(With<Cloth>, With<ChildOf>)>(), 2);
    assert_eq!(game.count::<With<curtain_rod::Ring>>(), 8);
    let copy = game.selected().unwrap();
    assert!(game.place(copy).x > 0.1, "it stands at {}", game.place(copy));
    game.press(KeyCode::KeyR);
    game.run(0.1);
    assert_eq!((game.count::<With<Cloth>>(), game.count::<With<curtain_rod::Ring>>()), (1, 4));
    assert_eq!(game.count::<With<ClothCollider>>(), 1, "what was deleted is back");
}

#[test]
fn a_copied_fan_gets_a_body_of_its_own() {
    let mut game = Game::new();
    let fan = game.spawn((Selectable(1), Fan::default(), Transform::from_xyz(0.5, 1.0, 0.0)));
    game.run(0.1);
    let parts = game.get::<Children>(fan).len();
    game.select(fan);
    game.press_with(KeyCode::KeyD, Some(KeyCode::ControlLeft));
    game.run(0.1);
    let copy = game.selected().unwrap();
    assert_ne!(copy, fan);
    assert_eq!(game.get::<Children>(copy).len(), parts);
    assert_eq!(game.get::<Children>(fan).len(), parts);
}
