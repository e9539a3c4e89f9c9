//! Colliders and air that could move a sleeping cloth wake it at once; others do not.

use crate::common::sleep::*;
use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;
use rand::RngExt;

/// Colliders.
mod a_collider {
    use super::*;

    #[derive(Component)]
    struct Ball;

    const RADIUS: f32 = 0.1;

    /// A ball whose surface is so far from a particle.
    fn spawn(bed: &mut Bed, gap: f32) {
        // Straight out of the plane that it hangs in, or nearly so.
        let normal = get::<ClothFrame>(&bed.app, bed.cloth).pose.rotation * Vec3::Z;
        let at = bed.particle() + normal.with_y(0.0).normalize_or(Vec3::X) * (RADIUS + gap);
        let ball = (ClothCollider::Sphere { radius: RADIUS }, Ball, Transform::from_translation(at));
        bed.world().spawn(ball);
    }

    fn change(bed: &mut Bed, change: impl Fn(EntityWorldMut)) {
        let mut balls = bed.world().query_filtered::<Entity, With<Ball>>();
        let ball = balls.single(bed.app.world()).unwrap();
        change(bed.app.world_mut().entity_mut(ball));
    }

    fn by(shift: f32) -> impl Fn(EntityWorldMut) {
        move |mut ball| ball.get_mut::<Transform>().unwrap().translation.y += shift
    }

    /// Spawns a ball near the sleeping cloth, and waits until it sleeps beside it.
    fn beside(gap: f32, then: impl Fn(EntityWorldMut)) -> impl Fn(&mut Bed) {
        move |bed| {
            spawn(bed, gap);
            bed.app.update();
            run_to_sleep(&mut bed.app, bed.cloth);
            let woke = bed.causes().len();
            change(bed, &then);
            bed.app.update();
            assert_eq!(bed.causes()[woke..], [WakeCause::Collider]);
            // To the caller this is one waking.
            bed.world().resource_mut::<Seen<ClothWoke>>().0.truncate(woke);
        }
    }

    fn assert_each(disturb: impl Fn(&mut Bed)) {
        for seed in 0..cases(1, 4) {
            disturb(&mut Bed::asleep(seed));
        }
    }

    #[test]
    fn that_comes_moves_changes_or_goes_near_it_wakes_it() {
        assert_wakes(WakeCause::Collider, nothing, |bed| spawn(bed, 0.0));
        assert_each(beside(0.0, by(1e-3)));
        assert_each(beside(0.0, |mut ball| _ = ball.insert(ColliderFriction(0.9))));
        assert_each(beside(0.0, |mut ball| _ = ball.insert(ClothCollider::Sphere { radius: 0.11 })));
        assert_each(beside(0.0, |mut ball| _ = ball.remove::<ClothCollider>()));
        assert_each(beside(0.0, |ball| ball.despawn()));
        assert_each(beside(0.0, |mut ball| ball.get_mut::<Transform>().unwrap().translation.x += 40.0));
    }

    #[test]
    fn that_flies_through_it_within_one_tick_wakes_it() {
        let far = |bed: &mut Bed| {
            let normal = get::<ClothFrame>(&bed.app, bed.cloth).pose.rotation * Vec3::Z;
            let at = centre(&bed.app, bed.cloth) + normal * 0.36;
            bed.world().spawn((ClothCollider::Sphere { radius: 0.01 }, Ball, Transform::from_translation(at)));
        };
        assert_each(|bed| {
            far(bed);
            bed.app.update();
            run_to_sleep(&mut bed.app, bed.cloth);
            let (woke, cloth) = (bed.causes().len(), bed.cloth);
            let normal = get::<ClothFrame>(&bed.app, cloth).pose.rotation * Vec3::Z;
            change(bed, |mut ball| ball.get_mut::<Transform>().unwrap().translation -= normal * 0.72);
            bed.app.update();
            assert_eq!(bed.causes()[woke..], [WakeCause::Collider]);
        });
    }

    #[test]
    fn far_away_leaves_it_asleep_whatever_it_does() {
        let far = |bed: &mut Bed| spawn(bed, 0.5);
        assert_sleeps_on(nothing, |bed| {
            let mut balls = bed.world().query_filtered::<Entity, With<Ball>>();
            match balls.single(bed.app.world()) {
                Ok(ball) if bed.random.random_bool(0.2) => bed.world().entity_mut(ball).despawn(),
                Ok(_) => change(bed, by(1e-3)),
                Err(_) => far(bed),
            }
        });
    }

    #[test]
    fn taken_from_under_it_lets_it_fall() {
        let mut app = headless();
        let flat = Transform::from_xyz(0.0, 0.6, 0.0).with_rotation(Quat::from_rotation_x(-1.5));
        let cloth = app.world_mut().spawn((Cloth::rectangle(0.5, 0.5).with_cells(10, 10), flat, Air::default())).id();
        let table = (ClothCollider::Cuboid { size: Vec3::new(1.0, 0.1, 1.0) }, Transform::from_xyz(0.0, 0.5, 0.0));
        let table = app.world_mut().spawn(table).id();
        run_to_sleep(&mut app, cloth);
        app.world_mut().despawn(table);
        run(&mut app, 16);
        assert!(centre(&app, cloth).y < 0.45, "it hangs in the air at {} m", centre(&app, cloth).y);
    }

    #[test]
    fn that_carries_it_slowly_keeps_it_awake() {
        let mut app = headless();
        note_events::<ClothWoke>(&mut app);
        let flat = Transform::from_xyz(0.0, 0.6, 0.0).with_rotation(Quat::from_rotation_x(-1.5));
        let cloth = app.world_mut().spawn((Cloth::rectangle(0.5, 0.5).with_cells(10, 10), flat, Air::default())).id();
        let table = (ClothCollider::Cuboid { size: Vec3::new(2.0, 0.1, 2.0) }, Transform::from_xyz(0.0, 0.5, 0.0));
        let table = app.world_mut().spawn(table).id();
        run_to_sleep(&mut app, cloth);
        let before = centre(&app, cloth);
        for _ in 0..256 {
            app.world_mut().get_mut::<Transform>(table).unwrap().translation.x += 2e-4;
            app.update();
        }
        assert_eq!(seen::<ClothWoke>(&app).len(), 1);
        let moved = centre(&app, cloth).x - before.x;
        assert!((moved - 0.0512).abs() < 0.003, "carried by {moved} m");
        run_to_sleep(&mut app, cloth);
    }
}

/// Air that moves.
mod a_wind {
    use super::*;

    #[test]
    fn that_rises_wakes_it() {
        assert_wakes(WakeCause::Wind, nothing, |bed| {
            bed.world().resource_mut::<Shared<Wind>>().0 = Wind(Vec3::X);
        });
    }

    /// A fan that blows at the cloth from so far away, m.
    fn fan(bed: &mut Bed, distance: f32, fan: Fan) -> Entity {
        let (at, pose) = (bed.particle(), get::<ClothFrame>(&bed.app, bed.cloth).pose);
        let from = at + (pose.rotation * Vec3::Z) * distance;
        let up = pose.rotation * Vec3::Y;
        bed.world().spawn((fan, Transform::from_translation(from).looking_at(at, up))).id()
    }

    #[test]
    fn that_a_fan_or_a_zone_brings_wakes_it() {
        assert_wakes(WakeCause::Wind, nothing, |bed| _ = fan(bed, 1.0, Fan::default()));
        assert_wakes(WakeCause::Wind, nothing, |bed| {
            let at = bed.particle();
            bed.world().spawn((WindZone::default(), Transform::from_translation(at)));
        });
    }

    #[test]
    fn that_is_switched_on_or_turned_to_it_wakes_it() {
        let off = |bed: &mut Bed| _ = fan(bed, 1.0, Fan { on: false, ..default() });
        assert_wakes(WakeCause::Wind, off, |bed| {
            let mut fans = bed.world().query::<&mut Fan>();
            fans.single_mut(bed.app.world_mut()).unwrap().on = true;
        });
        let elsewhere = |bed: &mut Bed| {
            let fan = fan(bed, 3.0, Fan::default());
            bed.world().get_mut::<Transform>(fan).unwrap().rotate_local_y(1.5);
        };
        assert_wakes(WakeCause::Wind, elsewhere, |bed| {
            let mut fans = bed.world().query_filtered::<&mut Transform, With<Fan>>();
            fans.single_mut(bed.app.world_mut()).unwrap().rotate_local_y(-1.5);
        });
    }

    #[test]
    fn that_a_collider_kept_off_wakes_it_once_that_is_gone() {
        #[derive(Component)]
        struct Wall;
        let behind_a_wall = |bed: &mut Bed| {
            let fan = fan(bed, 2.0, Fan { diameter: 0.1, spread: 0.1, ..default() });
            let place = get::<Transform>(&bed.app, fan).mul_transform(Transform::from_xyz(0.0, 0.0, -0.3));
            bed.world().spawn((ClothCollider::Cuboid { size: Vec3::new(2.0, 2.0, 0.1) }, place, Wall));
        };
        assert_wakes(WakeCause::Wind, behind_a_wall, |bed| {
            let mut walls = bed.world().query_filtered::<Entity, With<Wall>>();
            let wall = walls.single(bed.app.world()).unwrap();
            bed.world().despawn(wall);
        });
    }

    #[test]
    fn that_it_does_not_feel_leaves_it_asleep() {
        let change = |bed: &mut Bed| {
            let speed = bed.random.random_range(1.0..9.0);
            bed.world().resource_mut::<Shared<Wind>>().0 = Wind(Vec3::X * speed);
        };
        for seed in 0..cases(1, 4) {
            // Without air.
            let mut bed = Bed::hanging(seed);
            bed.entity().insert((Fabric::CANVAS, Pins::top())).remove::<Air>();
            run_to_sleep(&mut bed.app, bed.cloth);
            for _ in 0..64 {
                change(&mut bed);
                bed.app.update();
            }
            assert_eq!(bed.causes(), [], "seed {seed}");
        }
        // Blown elsewhere, and ever elsewhere.
        let oscillation = Some(Oscillation { angle: 0.3, rate: 60.0 });
        assert_sleeps_on(nothing, |bed| {
            if bed.world().query::<&Fan>().iter(bed.app.world()).count() == 0 {
                let fan = fan(bed, 20.0, Fan { oscillation, ..default() });
                bed.world().get_mut::<Transform>(fan).unwrap().rotate_local_y(1.5);
            }
        });
    }
}
