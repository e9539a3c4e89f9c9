//! Every tool in a game with the real mouse and keys, also while time stands.

use bevy::input::ButtonState;
use bevy_cloth::*;
use bevy_cloth_inspector::{Hovered, Selected};

use super::pins::Head;
use super::*;
use crate::fans::Bodiless;
use crate::select::Selectable;
use crate::test_game::{Game, MIDDLE};
use crate::throw::Ball;

/// A cloth of 1 m × 1 m in the middle of the view.
const SHEET: Vec3 = Vec3::new(0.0, 1.5, 0.0);

impl Game {
    /// A game with a cloth that hangs in the middle of the view, and that tool in the hand.
    fn with_sheet(tool: Tool) -> (Self, Entity) {
        let mut game = Self::new();
        let sheet = (Cloth::rectangle(1.0, 1.0).with_cells(16, 16), Pins::top(), Flammable::default());
        let sheet = game.spawn((Selectable(1), sheet, Transform::from_translation(SHEET)));
        game.run(0.1);
        game.press(tool.face().key);
        (game, sheet)
    }

    /// Where a particle is in the world, m.
    fn particle(&self, cloth: Entity, particle: u32) -> Vec3 {
        let local = self.get::<Particles>(cloth).position.get(particle as usize);
        self.get::<ClothFrame>(cloth).to_world(local)
    }

    /// The particle in the middle of the cloth.
    fn middle(&self, cloth: Entity) -> u32 {
        self.get::<ClothTopology>(cloth).grid.expect("a rectangle has a grid").slot(8, 8)
    }

    fn hangs_free(&self, cloth: Entity, particle: u32) -> bool {
        self.get::<Particles>(cloth).inverse_mass[particle as usize] > 0.0
    }

    fn select(&mut self, entity: Entity) {
        self.app.world_mut().resource_mut::<Selected>().0 = Some(entity);
    }

    fn selected(&self) -> Option<Entity> {
        self.app.world().resource::<Selected>().0
    }

    fn count<F: bevy::ecs::query::QueryFilter>(&mut self) -> usize {
        self.app.world_mut().query_filtered::<Entity, F>().iter(self.app.world()).count()
    }
}

#[test]
fn the_hand_pulls_cloth_also_while_time_stands() {
    for paused in [false, true] {
        let (mut game, sheet) = Game::with_sheet(Tool::Hand);
        if paused {
            game.pause();
        }
        let middle = game.middle(sheet);
        let before = game.particle(sheet, middle);
        game.press_left();
        game.drag_to(MIDDLE + Vec2::new(120.0, 0.0));
        game.run(0.5);
        let pulled = game.particle(sheet, middle) - before;
        assert!(pulled.x > 0.1, "paused: {paused}, pulled by {pulled}");
    }
}

#[test]
fn scissors_cut_from_beside_the_cloth_and_the_camera_stays_where_it_is() {
    for paused in [false, true] {
        let (mut game, sheet) = Game::with_sheet(Tool::Scissors);
        if paused {
            game.pause();
        }
        game.point_at(Vec2::new(100.0, 330.0));
        game.press_left();
        game.drag_to(Vec2::new(700.0, 330.0));
        game.release_left();
        game.run(0.1);
        assert_eq!(game.get::<ClothPieces>(sheet).pieces.len(), 2, "paused: {paused}");
        assert_eq!(game.selected(), None);
    }
}

#[test]
fn a_match_lights_the_cloth_and_water_puts_it_out() {
    let (mut game, sheet) = Game::with_sheet(Tool::Match);
    game.press_left();
    game.run(0.5);
    game.release_left();
    assert!(game.get::<ClothFire>(sheet).flaming() > 0, "it burns");
    game.press(Tool::Water.face().key);
    game.press_left();
    game.run(0.5);
    game.release_left();
    game.run(0.2);
    assert_eq!(game.get::<ClothFire>(sheet).flaming(), 0, "it is out");
    assert_eq!(game.selected(), None, "neither of them selects");
}

#[test]
fn the_right_button_cuts_and_the_middle_one_burns_with_any_tool() {
    for tool in Tool::ALL {
        let (mut game, sheet) = Game::with_sheet(tool);
        game.point_at(MIDDLE + Vec2::new(0.0, 60.0));
        game.app.update();
        game.button(MouseButton::Middle, ButtonState::Pressed);
        game.run(0.3);
        game.button(MouseButton::Middle, ButtonState::Released);
        assert!(game.get::<ClothFire>(sheet).flaming() > 0, "{tool:?}");
        game.point_at(Vec2::new(100.0, 290.0));
        game.app.update();
        game.button(MouseButton::Right, ButtonState::Pressed);
        game.drag_to(Vec2::new(700.0, 290.0));
        game.button(MouseButton::Right, ButtonState::Released);
        assert!(game.get::<ClothPieces>(sheet).pieces.len() > 1, "{tool:?}");
    }
}

#[test]
fn a_click_with_the_pin_holds_the_cloth_where_it_is_and_a_second_one_lets_it_go() {
    for paused in [false, true] {
        let (mut game, sheet) = Game::with_sheet(Tool::Pin);
        if paused {
            game.pause();
        }
        let middle = game.middle(sheet);
        let at = game.pixel_of(game.particle(sheet, middle));
        let before = game.particle(sheet, middle);
        game.click(at);
        game.run(0.1);
        assert!(!game.hangs_free(sheet, middle), "paused: {paused}");
        assert_eq!(game.count::<With<Head>>(), 1);
        assert!(game.particle(sheet, middle).distance(before) < 0.01);
        game.click(at);
        game.run(0.1);
        assert!(game.hangs_free(sheet, middle), "paused: {paused}");
        assert_eq!(game.count::<With<Head>>(), 0);
        assert_eq!(game.selected(), None);
    }
}

#[test]
fn a_press_with_the_ball_throws_one_also_at_nothing() {
    let (mut game, _) = Game::with_sheet(Tool::Ball);
    game.click(Vec2::new(60.0, 60.0));
    game.click(MIDDLE);
    assert_eq!(game.count::<With<Ball>>(), 2);
    assert_eq!(game.selected(), None);
}

#[test]
fn blowing_moves_the_cloth_while_the_button_is_held_and_leaves_nothing_behind() {
    let (mut game, sheet) = Game::with_sheet(Tool::Blow);
    let middle = game.middle(sheet);
    let before = game.particle(sheet, middle);
    game.press_left();
    game.run(0.7);
    assert_eq!(game.count::<(With<Fan>, With<Bodiless>)>(), 1);
    let blown = game.particle(sheet, middle) - before;
    assert!(blown.z < -0.03, "blown by {blown}");
    game.release_left();
    game.app.update();
    assert_eq!(game.count::<With<Fan>>(), 0);
    assert!(game.app.world().get::<Air>(sheet).is_none(), "its scene has no air");
}

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
