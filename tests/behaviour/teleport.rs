//! A cloth goes along with what it hangs on when that jumps, and is simulated when that moves.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;

/// A cape on the shoulders of a player who walks.
struct Walk {
    app: App,
    player: Entity,
    cape: Entity,
}

/// Where the cape begins.
const CAPE: Vec3 = Vec3::new(0.0, 1.0, -0.2);

/// What the top of the cape is pinned to.
#[derive(Clone, Copy, Debug)]
enum Worn {
    /// The cape's own entity, a child of the player.
    AsChild,
    /// One bone of the player; the cape's entity stays where it is.
    ByBone,
    /// Two shoulders, each of which holds half of it.
    ByShoulders,
}

const WAYS: [Worn; 3] = [Worn::AsChild, Worn::ByBone, Worn::ByShoulders];

impl Walk {
    fn new(worn: Worn, policy: TeleportPolicy) -> Self {
        let mut app = headless();
        let world = app.world_mut();
        let player = world.spawn(Transform::IDENTITY).id();
        let mut bone = |x| world.spawn((Transform::from_xyz(x, 1.4, -0.1), ChildOf(player))).id();
        let (left, right) = (bone(-0.2), bone(0.2));
        let half = |from, to| Pins::region(Vec3::new(from, 0.35, -0.1), Vec3::new(to, 0.45, 0.1));
        let pins = match worn {
            Worn::AsChild => Pins::top(),
            Worn::ByBone => Pins::top().to_entity(left),
            Worn::ByShoulders => half(-0.4, -0.01).to_entity(left).and(half(-0.01, 0.4).to_entity(right)),
        };
        let cape = Cloth::rectangle(0.6, 0.8).with_cells(6, 8);
        let teleport = Teleport { policy, ..default() };
        let cape = world.spawn((cape, pins, teleport, ClothStats::default(), Transform::from_translation(CAPE))).id();
        if matches!(worn, Worn::AsChild) {
            world.entity_mut(cape).insert(ChildOf(player));
        }
        // It is pinned before anybody walks.
        app.update();
        let mut walk = Self { app, player, cape };
        for _ in 0..64 {
            walk.go(Vec3::Z * 1.5 * TICK.as_secs_f32(), 0.0);
        }
        walk
    }

    /// Moves and turns the player within one tick.
    fn go(&mut self, by: Vec3, turn: f32) {
        let mut player = self.app.world_mut().get_mut::<Transform>(self.player).unwrap();
        player.translation += by;
        player.rotate_y(turn);
        self.app.update();
    }

    fn fastest(&self) -> f32 {
        let velocity = &get::<Particles>(&self.app, self.cape).velocity;
        let particles = get::<ClothTopology>(&self.app, self.cape).particles();
        particles.map(|slot| velocity.get(slot as usize).length()).fold(0.0, f32::max)
    }

    fn strain(&self) -> f32 {
        get::<ClothStats>(&self.app, self.cape).largest_strain
    }

    /// Where its particles are, seen by the player.
    fn seen_by_player(&self) -> Vec<Vec3> {
        let player = get::<Transform>(&self.app, self.player).to_matrix().inverse();
        world_positions(&self.app, self.cape).iter().map(|point| player.transform_point3(*point)).collect()
    }

    fn rest(&self) -> Vec<Vec3> {
        let topology = get::<ClothTopology>(&self.app, self.cape);
        topology.particles().map(|slot| topology.rest[slot as usize] + CAPE).collect()
    }
}

#[test]
fn a_cape_that_blinks_five_metres_keeps_its_shape_and_its_speed() {
    for worn in WAYS {
        for turn in [0.0, 2.0] {
            let mut walk = Walk::new(worn, TeleportPolicy::default());
            let (fastest, strain, shape) = (walk.fastest(), walk.strain(), walk.seen_by_player());
            walk.go(Vec3::new(3.0, 0.0, 4.0), turn);
            let what = format!("{worn:?}, {turn} radians");
            let moved = largest_move(&shape, &walk.seen_by_player());
            assert!(moved < 0.06, "{what}: {moved} m from the shape it had");
            assert!(walk.strain() < strain.max(0.02), "{what}: strain {} after {strain}", walk.strain());
            assert!(walk.fastest() < fastest + 1.0, "{what}: {} m/s after {fastest} m/s", walk.fastest());
            for _ in 0..32 {
                walk.go(Vec3::ZERO, 0.0);
                assert!(walk.strain() < 0.04, "{what}: strain {}", walk.strain());
            }
        }
    }
}

#[test]
fn a_cape_that_turns_round_at_once_goes_round_with_its_wearer() {
    for worn in WAYS {
        let mut walk = Walk::new(worn, TeleportPolicy::default());
        let shape = walk.seen_by_player();
        walk.go(Vec3::ZERO, std::f32::consts::PI);
        let moved = largest_move(&shape, &walk.seen_by_player());
        assert!(moved < 0.06, "{worn:?}: {moved} m from the shape it had");
    }
}

#[test]
fn a_blink_is_carried_whole_in_the_first_of_several_ticks() {
    let mut walk = Walk::new(Worn::ByBone, TeleportPolicy::default());
    walk.app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(TICK * 4));
    walk.go(Vec3::X * 10.0, 0.0);
    // It swings, since its wearer stopped. Spread over the ticks the blink would be a motion of 160 m/s.
    assert!(walk.strain() < 0.02 && walk.fastest() < 6.0, "{} and {} m/s", walk.strain(), walk.fastest());
}

#[test]
fn a_cape_that_is_reset_by_a_blink_is_in_its_rest_pose_on_its_wearer() {
    for worn in WAYS {
        let mut walk = Walk::new(worn, TeleportPolicy::Reset);
        assert!(largest_move(&walk.rest(), &walk.seen_by_player()) > 0.05, "{worn:?}: it was at rest before");
        walk.go(Vec3::new(3.0, 0.0, 4.0), 2.0);
        let away = largest_move(&walk.rest(), &walk.seen_by_player());
        assert!(away < 0.005, "{worn:?}: {away} m from its rest pose");
        assert!(walk.fastest() < 0.5, "{worn:?}: {} m/s", walk.fastest());
    }
}

#[test]
fn a_worn_cape_that_is_asked_to_reset_is_in_its_rest_pose_on_its_wearer() {
    for worn in WAYS {
        let mut walk = Walk::new(worn, TeleportPolicy::default());
        walk.app.world_mut().trigger(ResetCloth { entity: walk.cape });
        let away = largest_move(&walk.rest(), &walk.seen_by_player());
        assert!(away < 1e-4, "{worn:?}: {away} m from its rest pose");
    }
}

#[test]
fn a_cape_that_is_told_to_simulate_a_blink_is_dragged_along() {
    for worn in WAYS {
        let mut walk = Walk::new(worn, TeleportPolicy::Simulate);
        walk.go(Vec3::new(3.0, 0.0, 4.0), 0.0);
        assert!(walk.fastest() > 50.0, "{worn:?}: {} m/s", walk.fastest());
    }
}

/// Whether a cape does to the last bit what one does that knows no jumps.
fn is_simulated(worn: Worn, moves: impl Fn(&mut Walk)) -> bool {
    let [usual, simulated] = [TeleportPolicy::default(), TeleportPolicy::Simulate].map(|policy| {
        let mut walk = Walk::new(worn, policy);
        moves(&mut walk);
        bits(&walk.app, walk.cape)
    });
    usual == simulated
}

#[test]
fn running_sprinting_and_half_a_turn_in_a_tenth_of_a_second_are_motion() {
    let tick = TICK.as_secs_f32();
    for worn in WAYS {
        assert!(is_simulated(worn, |walk| (0..6).for_each(|_| walk.go(Vec3::ZERO, std::f32::consts::PI / 6.0))));
        assert!(is_simulated(worn, |walk| (0..6).for_each(|_| walk.go(Vec3::Z * 10.0 * tick, 0.0))));
        // At 20 m/s² up to 30 m/s.
        assert!(is_simulated(worn, |walk| {
            (0..96).for_each(|i| walk.go(Vec3::Z * 20.0 * i as f32 * tick * tick, 0.0));
        }));
    }
}

#[test]
fn a_metre_in_one_tick_is_a_jump() {
    for worn in WAYS {
        assert!(!is_simulated(worn, |walk| walk.go(Vec3::Z, 0.0)), "{worn:?}");
    }
}

#[test]
fn where_only_one_of_two_shoulders_jumps_that_is_motion() {
    assert!(is_simulated(Worn::ByShoulders, |walk| {
        let children: Vec<_> = get::<Children>(&walk.app, walk.player).iter().collect();
        walk.app.world_mut().get_mut::<Transform>(children[0]).unwrap().translation.x -= 0.9;
        walk.app.update();
    }));
}

#[test]
fn the_own_entity_of_a_cloth_that_hangs_on_others_jumps_without_it() {
    let mut walk = Walk::new(Worn::ByBone, TeleportPolicy::default());
    let before = world_positions(&walk.app, walk.cape);
    walk.app.world_mut().get_mut::<Transform>(walk.cape).unwrap().translation.x += 100.0;
    walk.app.update();
    let moved = largest_move(&before, &world_positions(&walk.app, walk.cape));
    assert!(moved < 0.06, "it moved {moved} m");
}

#[test]
fn a_ball_that_jumps_through_a_curtain_pushes_nothing() {
    let run_with = |ball: Option<Vec3>| {
        let mut app = headless();
        let curtain = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(8, 8), Pins::top())).id();
        let at = Transform::from_xyz(0.0, 0.0, 1.0);
        let entity = app.world_mut().spawn((ClothCollider::Sphere { radius: 0.3 }, at)).id();
        run(&mut app, 8);
        if let Some(to) = ball {
            app.world_mut().get_mut::<Transform>(entity).unwrap().translation = to;
        }
        run(&mut app, 8);
        world_positions(&app, curtain)
    };
    let moved = largest_move(&run_with(None), &run_with(Some(Vec3::new(0.0, 0.0, -1.0))));
    assert!(moved < 1e-4, "the curtain moved {moved} m");
}

#[test]
fn a_threshold_out_of_range_is_refused_by_name() {
    let mut app = headless();
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.5, 0.5).with_cells(4, 4), Pins::top())).id();
    for (teleport, field) in [
        (Teleport { distance: f32::NAN, ..default() }, "Teleport::distance"),
        (Teleport { distance: -1.0, ..default() }, "Teleport::distance"),
        (Teleport { angle: 11.0, ..default() }, "Teleport::angle"),
    ] {
        app.world_mut().entity_mut(cloth).insert(teleport);
        app.update();
        let error = get::<ClothRejection>(&app, cloth).error().to_string();
        assert!(error.contains(field), "{error}");
        app.world_mut().entity_mut(cloth).remove::<Teleport>();
        app.update();
        assert!(app.world().get::<ClothRejection>(cloth).is_none());
    }
}
