//! Balls are thrown by the key in an app with the real input, transforms and cloth.

use bevy_cloth::*;
use bevy_cloth_inspector::Selected;
use cloth_cases::cases;

use super::*;
use crate::select::Selectable;
use crate::test_game::{Game, TICKS_PER_SECOND};

/// What is allowed for rounding, m or m/s.
const ROUNDING: f32 = 1e-4;

impl Game {
    /// Throws a ball with that speed, m/s.
    fn throw(&mut self, speed: f32) -> Entity {
        self.app.world_mut().resource_mut::<ThrowSpeed>().0 = speed;
        self.press(KeyCode::KeyT);
        *self.balls().last().unwrap()
    }

    /// All balls, the oldest first.
    fn balls(&mut self) -> Vec<Entity> {
        let mut balls = self.app.world_mut().query::<(Entity, &Ball)>();
        let mut balls: Vec<_> = balls.iter(self.app.world()).map(|(entity, ball)| (ball.number, entity)).collect();
        balls.sort_unstable();
        balls.into_iter().map(|(_, entity)| entity).collect()
    }

    fn velocity(&self, ball: Entity) -> Vec3 {
        self.app.world().get::<Ball>(ball).unwrap().velocity
    }

    /// Kinetic and potential energy over the ball's mass, J/kg.
    fn energy(&self, ball: Entity) -> f32 {
        0.5 * self.velocity(ball).length_squared() + 9.81 * self.place(ball).y
    }

    fn weightless(&mut self) {
        self.app.insert_resource(Shared(Gravity(Vec3::ZERO)));
    }
}

#[test]
fn the_key_throws_a_ball_through_the_cursor_with_the_chosen_speed() {
    for (cursor, speed) in
        [(Vec2::new(400.0, 300.0), 1.0), (Vec2::new(120.0, 90.0), 12.0), (Vec2::new(700.0, 500.0), 40.0)]
    {
        let mut game = Game::new();
        game.weightless();
        game.point_at(cursor);
        let ball = game.throw(speed);
        assert!((game.velocity(ball).length() - speed).abs() < ROUNDING * speed, "{}", game.velocity(ball));
        game.run(0.25);
        let mut cameras = game.app.world_mut().query::<(&Camera, &GlobalTransform)>();
        let (camera, eye) = cameras.single(game.app.world()).unwrap();
        let seen = camera.world_to_viewport(eye, game.place(ball)).unwrap();
        assert!(seen.distance(cursor) < 0.1, "seen at {seen}, thrown through {cursor}");
    }
}

#[test]
fn a_cursor_outside_of_the_window_throws_through_the_middle_of_the_view() {
    let mut game = Game::new();
    game.app.world_mut().get_mut::<Window>(game.window).unwrap().set_physical_cursor_position(None);
    let ball = game.throw(10.0);
    assert!(game.velocity(ball).xz().normalize().distance(Vec2::NEG_Y) < ROUNDING, "{}", game.velocity(ball));
}

#[test]
fn it_flies_along_the_parabola_of_gravity() {
    let mut game = Game::new();
    let ball = game.throw(10.0);
    let (from, velocity) = (game.place(ball), game.velocity(ball));
    game.run(1.0);
    let expected = from + velocity - 0.5 * 9.81 * Vec3::Y;
    assert!(game.place(ball).distance(expected) < 1e-3, "{} and not {expected}", game.place(ball));
}

#[test]
fn it_stands_in_a_pause_also_while_a_hand_pulls_cloth() {
    let mut game = Game::new();
    let cloth =
        game.spawn((Cloth::rectangle(1.0, 1.0).with_cells(8, 8), Pins::top(), Transform::from_xyz(5.0, 1.0, 0.0)));
    let ball = game.throw(10.0);
    game.app.world_mut().resource_mut::<Time<ClothClock>>().pause();
    game.run(0.1);
    let before = game.place(ball);
    let grab = Grab { triangle: 40, target: Vec3::new(5.0, 1.0, 0.5), ..default() };
    game.app.world_mut().entity_mut(cloth).insert(Grabs(vec![grab]));
    game.run(0.5);
    assert_eq!(game.place(ball), before);
}

#[test]
fn it_bounces_off_the_ground_lower_each_time_and_comes_to_lie() {
    let mut game = Game::new();
    game.spawn((ClothCollider::Ground, Transform::IDENTITY));
    let ball = game.throw(3.0);
    let (mut energy, mut bounces) = (game.energy(ball), 0);
    for _ in 0..10 * TICKS_PER_SECOND {
        let falls = game.velocity(ball).y < 0.0;
        game.app.update();
        let now = game.energy(ball);
        assert!(now < energy * (1.0 + ROUNDING), "{now} J/kg after {energy}");
        assert!(game.place(ball).y > RADIUS - ROUNDING, "it is {} m above the ground", game.place(ball).y);
        bounces += u32::from(falls && game.velocity(ball).y > 0.0);
        energy = now;
    }
    assert!(bounces > 3, "{bounces} bounces");
    assert!(game.velocity(ball).length() < 0.2, "{}", game.velocity(ball));
    assert!((game.place(ball).y - RADIUS).abs() < 0.01);
}

#[test]
fn no_solid_is_passed_however_fast_the_ball() {
    let thin = Quat::from_rotation_x(0.2);
    for (collider, rotation) in [
        (ClothCollider::Sphere { radius: 0.3 }, Quat::IDENTITY),
        (ClothCollider::Capsule { radius: 0.05, length: 2.0 }, Quat::IDENTITY),
        (ClothCollider::Cuboid { size: Vec3::new(2.0, 2.0, 0.01) }, thin),
        (ClothCollider::Pyramid { base: Vec2::splat(1.0), height: 1.0 }, thin),
        (ClothCollider::Ground, Quat::from_rotation_x(1.57)),
    ] {
        for speed in [3.0, 40.0].into_iter().skip(cases(1, 0)) {
            let mut game = Game::new();
            game.weightless();
            game.spawn((collider.clone(), Transform::from_xyz(0.0, 1.5, 0.0).with_rotation(rotation)));
            game.app.update();
            let ball = game.throw(speed);
            game.run(8.0 / speed);
            assert!(game.velocity(ball).z > 0.0, "{collider:?}: {} m/s", game.velocity(ball));
            assert!(game.velocity(ball).length() < speed, "{collider:?}: {} m/s", game.velocity(ball));
        }
    }
}

#[test]
fn a_wall_of_a_mesh_is_not_passed_also_after_it_was_scaled() {
    let wall = Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(3).build();
    for (scale, speed) in [(1.0, 3.0), (1.0, 40.0), (3.0, 40.0)] {
        let mut game = Game::new();
        game.weightless();
        let mesh = game.app.world_mut().resource_mut::<Assets<Mesh>>().add(wall.clone());
        let at = Transform::from_xyz(0.3 * scale, 1.5, 0.0);
        let wall = game.spawn((ClothCollider::Mesh { thickness: 0.01 }, Mesh3d(mesh), at));
        game.run(0.1);
        game.app.world_mut().get_mut::<Transform>(wall).unwrap().scale = Vec3::splat(scale);
        game.run(0.1);
        let ball = game.throw(speed);
        game.run(8.0 / speed);
        assert!(game.velocity(ball).z > 0.0 && game.place(ball).z > 0.0, "{speed} m/s, scale {scale}");
    }
}

#[test]
fn two_balls_that_meet_keep_their_momentum() {
    let mut game = Game::new();
    game.weightless();
    let first = game.throw(2.0);
    game.run(0.3);
    let second = game.throw(12.0);
    let sum = |game: &Game| game.velocity(first) + game.velocity(second);
    let before = sum(&game);
    game.run(1.0);
    assert!(sum(&game).distance(before) < 1e-3, "{} and not {before}", sum(&game));
    assert!(game.velocity(first).length() > game.velocity(second).length());
    assert!(game.place(first).distance(game.place(second)) > 2.0 * RADIUS - ROUNDING);
}

#[test]
fn cloth_slows_it_down_and_throws_it_back_with_less_than_it_brought() {
    let bottom = Pins::vertices((0..31).map(|column| 30 * 31 + column));
    let throws = [
        (Fabric::VELVET_CURTAIN, 12.0),
        (Fabric::COTTON_POPLIN, 12.0),
        (Fabric::COTTON_POPLIN, 40.0),
        (Fabric::CANVAS, 25.0),
    ];
    for (fabric, speed) in throws.into_iter().step_by(cases(3, 1)) {
        for (is_taut, pins) in [(false, Pins::top()), (true, Pins::top().and(bottom.clone()))] {
            let mut game = Game::new();
            let curtain = (Cloth::rectangle(2.0, 1.8).with_cells(30, 30), fabric, pins, Air::default());
            game.spawn((curtain, Transform::from_xyz(0.0, 1.25, 0.0)));
            game.run(0.2);
            let ball = game.throw(speed);
            let brought = game.energy(ball);
            for _ in 0..TICKS_PER_SECOND {
                game.app.update();
                assert!(game.energy(ball) < brought * (1.0 + ROUNDING), "{} J/kg of {brought}", game.energy(ball));
            }
            let velocity = game.velocity(ball).z;
            let told = format!("{velocity} m/s after {speed} m/s, taut: {is_taut}, {} kg/m²", fabric.areal_density);
            assert!(if is_taut { velocity > 0.1 * speed } else { velocity.abs() < 0.2 * speed }, "{told}");
        }
    }
}

#[test]
fn the_ninth_ball_replaces_the_first() {
    let mut game = Game::new();
    let thrown: Vec<Entity> = (0..MOST).map(|_| game.throw(5.0)).collect();
    assert_eq!(game.balls(), thrown);
    let ninth = game.throw(5.0);
    assert_eq!(game.balls().len(), MOST);
    assert!(!game.balls().contains(&thrown[0]) && game.balls().contains(&ninth));
}

#[test]
fn a_selected_ball_is_deleted_by_the_key() {
    let mut game = Game::new();
    let [first, second] = [(); 2].map(|()| game.throw(5.0));
    assert!(game.app.world().get::<Selectable>(first).is_some());
    game.app.world_mut().resource_mut::<Selected>().0 = Some(first);
    game.press(KeyCode::Delete);
    assert_eq!(game.balls(), [second]);
    game.press(KeyCode::Delete);
    assert_eq!(game.balls(), [second], "nothing was selected");
}

#[test]
fn a_ball_that_is_put_elsewhere_falls_from_there() {
    let mut game = Game::new();
    let ball = game.throw(10.0);
    game.run(0.1);
    let there = Vec3::new(0.5, 2.0, 0.0);
    game.app.world_mut().get_mut::<Transform>(ball).unwrap().translation = there;
    game.run(0.5);
    let moved = game.place(ball) - there;
    assert!(moved.xz().length() < ROUNDING && moved.y < -0.9, "{moved}");
}

#[test]
fn it_flies_the_same_at_any_frame_rate() {
    let fly = |ticks: u32| {
        let mut game = Game::with_frames(ticks);
        game.spawn((ClothCollider::Ground, Transform::IDENTITY));
        let curtain = (Cloth::rectangle(2.0, 1.8).with_cells(20, 20), Pins::top(), Transform::from_xyz(0.0, 1.25, 0.0));
        game.spawn(curtain);
        game.run(0.0);
        game.app.world_mut().trigger(ThrowBall);
        game.app.world_mut().flush();
        (0..64 / ticks).for_each(|_| game.app.update());
        let ball = game.balls()[0];
        game.place(ball).to_array().map(f32::to_bits)
    };
    assert_eq!(fly(1), fly(4));
}
