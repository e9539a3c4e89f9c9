//! What is worn stays on, at any speed and any frame rate, and does not go through what wears it.

use std::time::Duration;

use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_cloth::cloth_solver::cloth::Constraints;
use bevy_cloth::cloth_solver::measure;
use bevy_cloth::{Cloth, ClothClock, ClothCollider, ClothFrame, ClothTime, ClothTopology, Particles, ShownShape};
use cloth_cases::cases;
use cloth_scene::{FigurePart, Scene, Walk};

use super::{Mannequin, MannequinPlugin, Part};
use crate::camera::Viewpoint;
use crate::look::View;
use crate::scenes::finish::Grains;
use crate::scenes::{OpenScene, Opened, Present, open, open_scene, reopen};
use crate::test_game::Game;
use crate::tools::{ReopenScene, ResetScene};

/// How far a pinned particle may be drawn from its place, m.
const OFF: f32 = 1e-4;
/// The largest strain along a thread. Of all that is played here it is 0.29, in single triangles beside the yoke of a runner.
const STRAIN: f32 = 0.4;
/// How deep a particle may be in a leg that walks steadily, m: it is 0.3 mm.
const WALKING: f32 = 2e-3;
/// And in one whose speed jumps between standing and running, m: it is 5.5 mm.
const JUMPING: f32 = 1e-2;

/// A sequence of numbers in 0..1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u64 << 24) as f32
    }
}

/// The worst that was seen of what is worn.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    /// How far a pinned particle was drawn from its place, m.
    off: f32,
    strain: f32,
    /// How deep a particle was in a leg, m.
    deep: f32,
    /// m/s.
    speed: f32,
}

impl Worst {
    fn and(self, other: Self) -> Self {
        Self {
            off: self.off.max(other.off),
            strain: self.strain.max(other.strain),
            deep: self.deep.max(other.deep),
            speed: self.speed.max(other.speed),
        }
    }
}

fn opened() -> Game {
    let mut game = Game::new();
    let grains = Grains { oak: default(), stone: default() };
    game.app.init_resource::<Opened>().init_resource::<View>().init_resource::<Viewpoint>();
    game.app.insert_resource(grains).add_observer(open_scene).add_observer(reopen).add_plugins(MannequinPlugin);
    game.app.world_mut().trigger(OpenScene(open("mannequin").expect("there")));
    game.run(0.05);
    game
}

fn walk_at(game: &mut Game, speed: f32) {
    let world = game.app.world_mut();
    world.query::<&mut Mannequin>().iter_mut(world).for_each(|mut mannequin| mannequin.figure.speed = speed);
}

fn frames_of(game: &mut Game, seconds: f32) {
    game.app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(seconds)));
}

fn seen(game: &mut Game) -> Worst {
    let world = game.app.world_mut();
    let mut worst = Worst::default();
    let mut legs = world.query::<(&ClothCollider, &GlobalTransform, &ChildOf)>();
    let mut parts = world.query::<&Part>();
    use FigurePart::*;
    let legs: Vec<(f32, f32, GlobalTransform)> = (legs.iter(world))
        .filter_map(|(collider, place, parent)| match (collider.clone(), parts.get(world, parent.parent()).ok()?.0) {
            (ClothCollider::Capsule { radius, length }, LeftThigh | LeftShank | RightThigh | RightShank) => {
                Some((radius, length, *place))
            }
            _ => None,
        })
        .collect();
    assert_eq!(legs.len(), 4);
    let mut cloths = world.query_filtered::<(&ClothTopology, &Particles, &ClothFrame, &ShownShape, &Constraints, &GlobalTransform), With<Cloth>>();
    let mut count = 0;
    for (topology, particles, frame, shown, constraints, place) in cloths.iter(world) {
        count += 1;
        assert!(particles.is_finite());
        for pin in &constraints.pins().pins {
            let simulated = || frame.to_world(particles.position.get(pin.particle as usize));
            let drawn = shown.in_world(pin.particle).unwrap_or_else(simulated);
            worst.off = worst.off.max(drawn.distance(place.transform_point(pin.local)));
        }
        worst.strain = worst.strain.max(measure::largest_strain(topology, particles));
        worst.speed = worst.speed.max(measure::rms_speed(topology, particles));
        for slot in topology.particles() {
            let at = frame.to_world(particles.position.get(slot as usize));
            for (radius, length, place) in &legs {
                let at = place.affine().inverse().transform_point3(at);
                let away = (at - Vec3::Y * at.y.clamp(-length / 2.0, length / 2.0)).length();
                worst.deep = worst.deep.max(radius - away);
            }
        }
    }
    assert_eq!(count, 2);
    worst
}

/// Plays so many frames and tells the worst of them.
fn play(game: &mut Game, frames: u32) -> Worst {
    (0..frames).fold(Worst::default(), |worst, _| {
        game.app.update();
        worst.and(seen(game))
    })
}

fn holds(worst: Worst, deep: f32, what: &str) {
    println!("{what}: {worst:?}");
    assert!(worst.off < OFF && worst.strain < STRAIN && worst.deep < deep, "{what}: {worst:?}");
}

#[test]
fn cape_and_skirt_stay_on_at_any_steady_speed() {
    for speed in [0.0, 1.4, 4.0].into_iter().skip(cases(2, 0)) {
        let mut game = opened();
        walk_at(&mut game, speed);
        holds(play(&mut game, 64 * cases(1, 2)), WALKING, &format!("{speed} m/s"));
    }
}

#[test]
fn cape_and_skirt_stay_on_while_speed_and_frame_rate_change_at_random() {
    for seed in 0..cases(1, 2) {
        let (mut game, mut numbers) = (opened(), Numbers(seed));
        for _ in 0..cases(1, 3) {
            walk_at(&mut game, 4.0 * numbers.next());
            let rate = 3.0 * 40.0_f32.powf(numbers.next());
            frames_of(&mut game, 1.0 / rate);
            let worst = play(&mut game, (0.8 * rate) as u32 + 1);
            holds(worst, JUMPING, &format!("seed {seed}, {rate:.0} frames a second"));
        }
    }
}

#[test]
fn a_slider_thrown_from_standing_to_running_and_back_tears_nothing_off() {
    for rate in [3.0, 60.0].into_iter().skip(cases(1, 0)) {
        let mut game = opened();
        frames_of(&mut game, 1.0 / rate);
        for speed in [4.0, 0.0] {
            walk_at(&mut game, speed);
            holds(
                play(&mut game, (1.0 * rate) as u32 + 1),
                JUMPING,
                &format!("to {speed} m/s at {rate} frames a second"),
            );
        }
    }
}

#[test]
fn a_reset_takes_the_walk_back_to_its_start() {
    let mut game = opened();
    walk_at(&mut game, 3.0);
    play(&mut game, cases(40, 100));
    game.app.world_mut().trigger(ResetScene);
    holds(play(&mut game, 30), JUMPING, "after a reset");
    let world = game.app.world_mut();
    let way = world.query::<&Mannequin>().single(world).expect("one").walk.way;
    assert!(way < 0.6, "{way} m");
    game.app.world_mut().trigger(ReopenScene);
    game.run(0.05);
    holds(play(&mut game, 30), JUMPING, "opened anew");
    let world = game.app.world_mut();
    let mannequin = world.query::<&Mannequin>().single(world).expect("one, the old one is gone");
    assert_eq!(mannequin.figure.speed, open("mannequin").expect("there").figures[0].speed);
}

#[test]
fn a_mannequin_stands_while_the_clock_is_paused_and_goes_on_by_single_steps() {
    let mut game = opened();
    play(&mut game, 60);
    game.pause();
    let walk = |game: &mut Game| {
        let world = game.app.world_mut();
        world.query::<&Mannequin>().single(world).expect("one").walk
    };
    let before: Walk = walk(&mut game);
    holds(play(&mut game, 10), JUMPING, "paused");
    assert_eq!(walk(&mut game), before);
    for _ in 0..20 {
        game.app.world_mut().resource_mut::<Time<ClothClock>>().step_once();
        holds(play(&mut game, 2), JUMPING, "a step");
    }
    assert_ne!(walk(&mut game).way, before.way);
}

#[test]
fn a_mannequin_that_was_moved_and_set_to_run_is_saved_so_with_what_it_wears() {
    let mut game = opened();
    walk_at(&mut game, 3.0);
    let world = game.app.world_mut();
    let mut roots = world.query_filtered::<&mut Transform, With<Mannequin>>();
    roots.single_mut(world).expect("one").translation = Vec3::new(4.0, 0.0, 1.0);
    game.run(0.5);
    let saved = game.app.world_mut().run_system_once(|present: Present| present.scene()).expect("it runs");
    let file = open("mannequin").expect("there");
    assert_eq!(saved.figures.len(), 1);
    assert_eq!((saved.figures[0].speed, saved.figures[0].place.at), (3.0, Vec3::new(4.0, 0.0, 1.0)));
    for (saved, said) in saved.cloths.iter().zip(&file.cloths) {
        assert_eq!(
            (saved.place, saved.worn, &saved.wrap, &saved.pins),
            (said.place, said.worn, &said.wrap, &said.pins)
        );
    }
    assert_eq!(Scene::from_ron(&saved.to_ron()).expect("it opens"), saved);
}
