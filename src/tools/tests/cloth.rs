//! The tools that do something to cloth.

use bevy::input::ButtonState;
use bevy::prelude::*;
use bevy_cloth::*;

use crate::fans::Bodiless;
use crate::test_game::{Game, MIDDLE};
use crate::throw::Ball;
use crate::tools::Tool;
use crate::tools::blow::BlowSpeed;
use crate::tools::pins::Head;

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
fn the_wheel_makes_the_breath_stronger() {
    let (mut game, _) = Game::with_sheet(Tool::Blow);
    let before = game.app.world().resource::<BlowSpeed>().0;
    game.press_left();
    game.turn_wheel(2.0);
    game.app.update();
    let speed = game.app.world().resource::<BlowSpeed>().0;
    assert!(speed > 1.2 * before, "{speed} m/s");
    let mut fans = game.app.world_mut().query::<&Fan>();
    assert_eq!(fans.single(game.app.world()).unwrap().speed, speed);
    game.release_left();
    game.turn_wheel(2.0);
    assert_eq!(game.app.world().resource::<BlowSpeed>().0, speed, "then it zooms");
}
