//! Handles of the gizmo, and rings, dragged with the mouse.

use bevy::gizmos::transform_gizmo::{AXIS_START_OFFSET, VIEW_RING_MAJOR};
use bevy::prelude::*;
use bevy_cloth::*;

use crate::scenes::curtain_rod::{self, Ring};
use crate::select::Selectable;
use crate::test_game::Game;

impl Game {
    /// Selects an object, takes the middle of its handle along x, and drags it by so many pixels.
    fn drag_x(&mut self, entity: Entity, mode: KeyCode, pixels: Vec2) {
        self.select(entity);
        self.press(mode);
        self.run(0.1);
        let from = self.app.world().get::<GlobalTransform>(entity).unwrap().translation();
        // The handles are as long as a tenth of the distance to the camera.
        let length = 0.1 * from.distance(Vec3::new(0.0, 1.5, 4.0));
        let handle = self.pixel_of(from + Vec3::X * length * (1.0 + AXIS_START_OFFSET) / 2.0);
        self.point_at(handle);
        self.app.update();
        self.press_left();
        self.drag_to(handle + pixels);
        self.release_left();
        self.app.update();
    }

    /// A rod 2 m above the ground with a curtain of 1 m × 1 m on four rings, and the curtain.
    fn with_rod() -> (Self, Entity, Entity) {
        let mut game = Self::new();
        let curtain = (Cloth::rectangle(1.0, 1.0).with_cells(16, 16), Pins::rods(4), Selectable(1));
        let place = Transform::from_xyz(0.0, 2.0, 0.0);
        let curtain = game.app.world_mut().spawn(curtain).id();
        let rod = curtain_rod::hang(&mut game.app.world_mut().commands(), place, curtain, 1.0, false);
        game.app.world_mut().flush();
        game.app.world_mut().entity_mut(rod).insert(Selectable(2));
        game.run(0.2);
        let mut cloths = game.app.world_mut().query_filtered::<Entity, With<Cloth>>();
        let curtain = cloths.single(game.app.world()).unwrap();
        (game, rod, curtain)
    }

    fn ring(&mut self, number: u32) -> Entity {
        let mut rings = self.app.world_mut().query::<(Entity, &Ring)>();
        rings.iter(self.app.world()).find(|(_, ring)| ring.number == number).expect("a ring").0
    }
}

#[test]
fn a_handle_moves_the_object_along_its_axis_also_while_time_stands() {
    for paused in [false, true] {
        let mut game = Game::new();
        if paused {
            game.pause();
        }
        let at = Vec3::new(0.0, 1.5, 0.0);
        let ball = game.spawn((Selectable(1), ClothCollider::Sphere { radius: 0.1 }, Transform::from_translation(at)));
        game.drag_x(ball, KeyCode::KeyW, Vec2::new(100.0, 0.0));
        let moved = game.place(ball) - at;
        assert!(moved.x > 0.3 && moved.yz().length() < 1e-3, "paused: {paused}, moved by {moved}");
    }
}

#[test]
fn the_outer_ring_turns_the_object_about_the_view() {
    let mut game = Game::new();
    let at = Vec3::new(0.0, 1.5, 0.0);
    let box_ = (Selectable(1), ClothCollider::Cuboid { size: Vec3::splat(0.2) }, Transform::from_translation(at));
    let box_ = game.spawn(box_);
    game.select(box_);
    game.press(KeyCode::KeyE);
    game.run(0.1);
    let handle = game.pixel_of(at + Vec3::X * 0.4 * VIEW_RING_MAJOR);
    game.point_at(handle);
    game.app.update();
    game.press_left();
    game.drag_to(handle + Vec2::new(-10.0, -30.0));
    game.release_left();
    game.app.update();
    let (axis, angle) = game.get::<Transform>(box_).rotation.to_axis_angle();
    assert!(axis.z.abs() > 0.99 && angle > 0.2, "about {axis} by {angle}");
    assert_eq!(game.place(box_), at);
}

#[test]
fn handles_scale_what_may_be_scaled_and_change_the_size_of_a_fan_and_of_a_curtain() {
    let mut game = Game::new();
    let at = Transform::from_xyz(0.0, 1.5, 0.0);
    let box_ = game.spawn((Selectable(1), ClothCollider::Cuboid { size: Vec3::splat(0.2) }, at));
    game.drag_x(box_, KeyCode::KeyS, Vec2::new(40.0, 0.0));
    let scale = game.get::<Transform>(box_).scale;
    assert!(scale.x > 1.2 && scale.yz() == Vec2::ONE, "{scale}");

    let capsule = game.spawn((Selectable(2), ClothCollider::Capsule { radius: 0.1, length: 0.2 }, at));
    game.drag_x(capsule, KeyCode::KeyS, Vec2::new(40.0, 0.0));
    let scale = game.get::<Transform>(capsule).scale;
    assert!(scale.x > 1.2 && scale == Vec3::splat(scale.x), "{scale}");

    let fan = game.spawn((Selectable(3), Fan::default(), at));
    game.drag_x(fan, KeyCode::KeyS, Vec2::new(40.0, 0.0));
    assert!(game.get::<Fan>(fan).diameter > 1.2 * Fan::default().diameter);
    assert_eq!(game.get::<Transform>(fan).scale, Vec3::ONE);

    let (mut game, rod, curtain) = Game::with_rod();
    game.drag_x(rod, KeyCode::KeyS, Vec2::new(40.0, 0.0));
    let ClothSource::Rectangle { size, .. } = game.get::<Cloth>(curtain).source else { panic!("no rectangle") };
    assert!(size.x > 1.2 && size.y == 1.0, "{size}");
    assert_eq!(game.get::<Transform>(rod).scale, Vec3::ONE);
}

#[test]
fn a_curtain_is_moved_by_its_rod_and_hangs_below_it_also_while_time_stands() {
    for paused in [false, true] {
        let (mut game, rod, curtain) = Game::with_rod();
        if paused {
            game.pause();
        }
        let middle = game.middle(curtain);
        let before = game.particle(curtain, middle);
        game.drag_x(rod, KeyCode::KeyW, Vec2::new(100.0, 0.0));
        game.run(0.1);
        let (rod, moved) = (game.place(rod).x, game.particle(curtain, middle).x - before.x);
        assert!(rod > 0.3 && moved > 0.15, "paused: {paused}, the rod by {rod} m, the curtain by {moved} m");
    }
}

#[test]
fn the_hand_slides_rings_and_what_hangs_on_them_follows() {
    for paused in [false, true] {
        let (mut game, rod, curtain) = Game::with_rod();
        if paused {
            game.pause();
        }
        let rings = [0, 1, 2, 3].map(|number| game.ring(number));
        let home = rings.map(|ring| game.place(ring));
        let particles = rings.map(|ring| game.get::<Ring>(ring).column).map(|column| column as usize);
        let particles = particles.map(|column| game.get::<ClothTopology>(curtain).vertex_particle[column]);
        let pinned = particles.map(|particle| game.particle(curtain, particle));
        let at = game.pixel_of(game.place(rod) + home[0] + 0.018 * Vec3::Z);
        game.point_at(at);
        game.press_left();
        game.drag_to(at + Vec2::new(90.0, 0.0));
        game.release_left();
        game.run(0.3);
        let moved = [0, 1, 2, 3].map(|i| game.place(rings[i]) - home[i]);
        assert!(moved[0].x > 0.4 && moved[1].x > 0.05 && moved[3] == Vec3::ZERO, "paused: {paused}, {moved:?}");
        assert!(game.place(rings[0]).x < game.place(rings[1]).x, "it does not pass its neighbour");
        for i in 0..4 {
            let followed = game.particle(curtain, particles[i]) - pinned[i];
            assert!(followed.distance(moved[i]) < 1e-3, "paused: {paused}, ring {i}: {followed} and not {}", moved[i]);
        }
        game.press(KeyCode::KeyR);
        game.run(0.1);
        for i in 0..4 {
            assert_eq!(game.place(rings[i]), home[i]);
            assert!(game.particle(curtain, particles[i]).distance(pinned[i]) < 1e-3);
        }
    }
}
