//! A pointer takes hold of a cloth, pulls it and lets go, as the player's left button does.

use crate::common::*;
use bevy::camera::primitives::Aabb;
use bevy::camera::{NormalizedRenderTarget, RenderTarget, RenderTargetInfo};
use bevy::picking::backend::PointerHits;
use bevy::picking::events::{Pointer, Press};
use bevy::picking::pointer::{Location, PointerAction, PointerButton, PointerId, PointerInput};
use bevy::picking::{InteractionPlugin, PickingPlugin};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::window::PrimaryWindow;
use bevy_cloth::*;

const SIZE: UVec2 = UVec2::new(800, 600);
/// The pixel in the middle, which the camera sees the cloth's centre at.
const MIDDLE: Vec2 = Vec2::new(400.0, 300.0);

/// A cloth of 1 m × 1 m hung by its top edge around the origin, seen from 2 m before it, and a pointer.
struct Stage {
    app: App,
    cloth: Entity,
    pointer: Entity,
    at: Vec2,
}

impl Stage {
    fn new() -> Self {
        Self::with(|_| {})
    }

    /// With more in the app before anything is spawned.
    fn with(more: impl FnOnce(&mut App)) -> Self {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin, PickingPlugin, InteractionPlugin, ClothPlugin::default()));
        more(&mut app);
        app.insert_resource(TimeUpdateStrategy::ManualDuration(TICK));
        // Where a game without a window has a pointer it still has a primary window, if an unseen one.
        app.world_mut().spawn((Window::default(), PrimaryWindow));
        let mut camera = Camera::default();
        camera.computed.target_info = Some(RenderTargetInfo { physical_size: SIZE, scale_factor: 1.0 });
        let lens = PerspectiveProjection { aspect_ratio: SIZE.x as f32 / SIZE.y as f32, ..default() };
        camera.computed.clip_from_view = bevy::camera::CameraProjection::get_clip_from_view(&lens);
        let at = Transform::from_xyz(0.0, 0.0, 2.0);
        app.world_mut().spawn((camera, RenderTarget::None { size: SIZE }, at));
        let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(16, 16), Pins::top())).id();
        let pointer = app.world_mut().spawn(PointerId::Mouse).id();
        run(&mut app, 4);
        let mut stage = Self { app, cloth, pointer, at: MIDDLE };
        stage.point_at(MIDDLE);
        stage.app.update();
        stage
    }

    fn send(&mut self, action: PointerAction) {
        let target = NormalizedRenderTarget::None { width: SIZE.x, height: SIZE.y };
        let location = Location { target, position: self.at };
        self.app.world_mut().write_message(PointerInput::new(PointerId::Mouse, location, action));
        self.app.update();
    }

    fn point_at(&mut self, at: Vec2) {
        let delta = at - self.at;
        self.at = at;
        self.send(PointerAction::Move { delta });
    }

    /// Moves the pointer in many small steps, one each tick.
    fn drag_to(&mut self, at: Vec2) {
        let from = self.at;
        for step in 1..=20 {
            self.point_at(from.lerp(at, step as f32 / 20.0));
        }
    }

    fn press(&mut self, button: PointerButton) {
        self.send(PointerAction::Press(button));
    }

    fn release(&mut self, button: PointerButton) {
        self.send(PointerAction::Release(button));
    }

    fn held(&self) -> usize {
        self.app.world().get::<Grabs>(self.cloth).map_or(0, |grabs| grabs.0.len())
    }

    /// Where the particle in the middle of the cloth is.
    fn middle(&self) -> Vec3 {
        let grid = get::<ClothTopology>(&self.app, self.cloth).grid.expect("a rectangle has a grid");
        get::<Particles>(&self.app, self.cloth).position.get(grid.slot(8, 8) as usize)
    }
}

#[test]
fn a_pressed_pointer_pulls_the_cloth_and_a_released_one_lets_go() {
    let mut stage = Stage::new();
    let before = stage.middle();
    stage.press(PointerButton::Primary);
    assert_eq!(stage.held(), 1);
    stage.drag_to(MIDDLE + Vec2::new(150.0, 0.0));
    run(&mut stage.app, 64);
    let pulled = stage.middle() - before;
    // At 2 m, 150 of 600 pixels are 0.41 m; held by its whole top edge the cloth gives way by half of that.
    assert!(pulled.x > 0.1, "pulled by {pulled}");
    stage.release(PointerButton::Primary);
    assert_eq!(stage.held(), 0);
    run(&mut stage.app, 5 * 64);
    let left = stage.middle() - before;
    assert!(left.length() < 0.1, "still {left} away five seconds after it was let go");
}

#[test]
fn the_point_taken_is_pulled_to_the_pointer_in_the_plane_that_faces_the_view() {
    let mut stage = Stage::new();
    stage.press(PointerButton::Primary);
    let taken = get::<Grabs>(&stage.app, stage.cloth).0[0].target;
    stage.drag_to(MIDDLE + Vec2::new(0.0, -100.0));
    let target = get::<Grabs>(&stage.app, stage.cloth).0[0].target;
    // The field of view is 45° over 600 pixels.
    let expected = 100.0 / 300.0 * (std::f32::consts::PI / 8.0).tan() * (2.0 - taken.z);
    assert!((target - taken - expected * Vec3::Y).length() < 1e-4, "{} instead of {expected}", target - taken);
}

#[test]
fn a_cloth_follows_the_hand_while_the_clock_is_paused_and_time_stands() {
    let mut stage = Stage::new();
    stage.app.world_mut().resource_mut::<Time<ClothClock>>().pause();
    let (cloth, before) = (stage.cloth, stage.middle());
    let time = stage.app.world().resource::<Time<ClothClock>>().elapsed();
    stage.press(PointerButton::Primary);
    stage.drag_to(MIDDLE + Vec2::new(150.0, 0.0));
    run(&mut stage.app, 64);
    let pulled = stage.middle() - before;
    assert!(pulled.x > 0.1, "pulled by {pulled}");
    assert_eq!(stage.app.world().resource::<Time<ClothClock>>().elapsed(), time);
    assert!(get::<Particles>(&stage.app, cloth).velocity.x.iter().all(|v| *v == 0.0), "time stands, and it has speed");
    stage.release(PointerButton::Primary);
    let bits_then = bits(&stage.app, cloth);
    run(&mut stage.app, 8);
    assert_eq!(bits(&stage.app, cloth), bits_then, "nothing holds it, time stands, and it moves");
}

#[test]
fn a_cloth_that_is_not_held_stays_still_while_another_is_held_in_a_pause() {
    let mut stage = Stage::new();
    let other = (Cloth::rectangle(1.0, 1.0), Transform::from_xyz(50.0, 0.0, 0.0));
    let other = stage.app.world_mut().spawn(other).id();
    run(&mut stage.app, 4);
    stage.app.world_mut().resource_mut::<Time<ClothClock>>().pause();
    let before = bits(&stage.app, other);
    stage.press(PointerButton::Primary);
    stage.drag_to(MIDDLE + Vec2::new(50.0, 0.0));
    assert_eq!(stage.held(), 1);
    assert_eq!(bits(&stage.app, other), before);
}

#[test]
fn the_button_may_go_up_anywhere() {
    let mut stage = Stage::new();
    stage.press(PointerButton::Primary);
    stage.point_at(Vec2::new(5.0, 5.0));
    stage.release(PointerButton::Primary);
    assert_eq!(stage.held(), 0);
}

#[test]
fn a_cancelled_or_vanished_pointer_lets_go() {
    let mut stage = Stage::new();
    stage.press(PointerButton::Primary);
    stage.send(PointerAction::Cancel);
    assert_eq!(stage.held(), 0);

    let mut stage = Stage::new();
    stage.press(PointerButton::Primary);
    stage.app.world_mut().despawn(stage.pointer);
    run(&mut stage.app, 2);
    assert_eq!(stage.held(), 0);
}

#[test]
fn another_button_does_not_grab_and_does_not_let_go() {
    let mut stage = Stage::new();
    stage.press(PointerButton::Secondary);
    assert_eq!(stage.held(), 0);
    stage.press(PointerButton::Primary);
    stage.release(PointerButton::Secondary);
    assert_eq!(stage.held(), 1);
}

#[test]
fn a_pointer_beside_the_cloth_grabs_nothing() {
    let mut stage = Stage::new();
    stage.point_at(Vec2::new(30.0, 30.0));
    stage.press(PointerButton::Primary);
    assert_eq!(stage.held(), 0);
}

#[test]
fn picking_that_is_switched_off_grabs_nothing_and_lets_go() {
    let mut stage = Stage::new();
    stage.press(PointerButton::Primary);
    stage.app.world_mut().resource_mut::<ClothPicking>().enabled = false;
    run(&mut stage.app, 2);
    assert_eq!(stage.held(), 0);
    stage.release(PointerButton::Primary);
    stage.press(PointerButton::Primary);
    assert_eq!(stage.held(), 0);
}

#[test]
fn a_hit_names_the_place_the_triangle_and_the_particle() {
    let mut stage = Stage::new();
    note_events::<Pointer<Press>>(&mut stage.app);
    stage.press(PointerButton::Primary);
    let press = &seen::<Pointer<Press>>(&stage.app)[0];
    let hit = *press.hit.extra_as::<ClothHit>().expect("the hit names a triangle");
    let topology = get::<ClothTopology>(&stage.app, stage.cloth);
    let corners = topology.triangles[hit.triangle as usize];
    assert!(corners.contains(&hit.particle));
    let position = press.hit.position.expect("the hit has a place");
    let rest = corners.map(|slot| topology.rest[slot as usize]);
    let named = (0..3).map(|corner| rest[corner] * hit.weights[corner]).sum::<Vec3>();
    assert!(named.distance(position) < 0.05, "weights say {named}, the place is {position}");
    assert!(position.xy().length() < 1e-3 && press.hit.normal.is_some_and(|normal| normal.z > 0.9));
    assert!((press.hit.depth - (2.0 - 0.1 - position.z)).abs() < 0.02, "depth {}", press.hit.depth);
}

#[test]
fn mesh_picking_leaves_clothes_alone_and_nothing_else() {
    let mut stage = Stage::with(|app| {
        app.add_plugins((AssetPlugin::default(), bevy::mesh::MeshPlugin, MeshPickingPlugin));
        // Without a renderer nothing is ever visible in a view.
        app.world_mut().resource_mut::<MeshPickingSettings>().ray_cast_visibility = RayCastVisibility::Any;
    });
    let ball = stage.app.world_mut().resource_mut::<Assets<Mesh>>().add(Sphere::new(0.2));
    let bounds = Aabb::from_min_max(Vec3::splat(-0.2), Vec3::splat(0.2));
    let ball = (Mesh3d(ball), bounds, Visibility::default(), Transform::from_xyz(0.0, 0.0, -1.0));
    let ball = stage.app.world_mut().spawn(ball).id();
    run(&mut stage.app, 2);
    take_messages::<PointerHits>(&mut stage.app);
    stage.app.update();
    let hits = take_messages::<PointerHits>(&mut stage.app);
    let picks: Vec<_> = hits.iter().flat_map(|hits| &hits.picks).collect();
    let of = |entity| picks.iter().filter(move |(pick, _)| *pick == entity);
    assert_eq!(of(ball).count(), 1, "the ball behind the cloth is a mesh as any other");
    assert_eq!(of(stage.cloth).count(), 1);
    assert!(of(stage.cloth).all(|(_, hit)| hit.extra_as::<ClothHit>().is_some()));
}

#[test]
fn a_hidden_cloth_is_not_hit() {
    let mut stage = Stage::new();
    stage.app.world_mut().entity_mut(stage.cloth).insert(Visibility::Hidden);
    take_messages::<PointerHits>(&mut stage.app);
    stage.app.update();
    assert!(take_messages::<PointerHits>(&mut stage.app).is_empty());
    stage.app.world_mut().entity_mut(stage.cloth).insert(Visibility::Inherited);
    stage.app.update();
    assert_eq!(take_messages::<PointerHits>(&mut stage.app).len(), 1);
}

#[test]
fn a_held_cloth_may_vanish_or_be_built_anew() {
    let mut stage = Stage::new();
    stage.press(PointerButton::Primary);
    stage.app.world_mut().entity_mut(stage.cloth).insert(Cloth::rectangle(1.0, 1.0).with_cells(3, 3));
    run(&mut stage.app, 4);
    assert_eq!(stage.held(), 0, "what was held is no more");
    stage.release(PointerButton::Primary);
    stage.press(PointerButton::Primary);
    assert_eq!(stage.held(), 1);
    stage.app.world_mut().despawn(stage.cloth);
    run(&mut stage.app, 2);
    stage.release(PointerButton::Primary);
}

#[test]
fn a_grab_set_by_code_pulls_as_well() {
    let mut app = headless();
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(8, 8), Pins::top())).id();
    run(&mut app, 2);
    let before = centre(&app, cloth);
    let grab = Grab { triangle: 70, target: Vec3::new(0.0, 0.0, 0.6), ..default() };
    app.world_mut().entity_mut(cloth).insert(Grabs(vec![grab]));
    run(&mut app, 64);
    assert!(centre(&app, cloth).z - before.z > 0.05, "moved to {}", centre(&app, cloth));
}
