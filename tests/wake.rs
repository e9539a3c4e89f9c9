//! Whatever could move a sleeping cloth wakes it at once; nothing else does.

mod common;

use bevy::prelude::*;
use bevy_cloth::*;
use common::sleep::*;
use common::*;
use rand::RngExt;

/// Does it to seeded random cloths that are asleep. Each must wake in the very next tick, for that cause.
fn assert_wakes(expected: WakeCause, prepare: impl Fn(&mut Bed), disturb: impl Fn(&mut Bed)) {
    for seed in 0..4 {
        let mut bed = Bed::hanging(seed);
        prepare(&mut bed);
        run_to_sleep(&mut bed.app, bed.cloth);
        run(&mut bed.app, 3);
        let before = bed.causes().len();
        disturb(&mut bed);
        bed.app.update();
        assert_eq!(bed.causes()[before..], [expected], "seed {seed}");
        assert!(!is_asleep(&bed.app, bed.cloth), "seed {seed}");
        assert!(get::<ClothStats>(&bed.app, bed.cloth).substeps > 0, "seed {seed}: it took no part in the tick");
    }
}

/// Does it to seeded random cloths that are asleep. None must wake within a second.
fn assert_sleeps_on(prepare: impl Fn(&mut Bed), disturb: impl Fn(&mut Bed)) {
    for seed in 0..4 {
        let mut bed = Bed::hanging(seed);
        prepare(&mut bed);
        run_to_sleep(&mut bed.app, bed.cloth);
        run(&mut bed.app, 3);
        let before = (bits(&bed.app, bed.cloth), bed.causes().len());
        for _ in 0..64 {
            disturb(&mut bed);
            bed.app.update();
        }
        assert_eq!(bed.causes()[before.1..], [], "seed {seed}");
        assert_eq!(bits(&bed.app, bed.cloth), before.0, "seed {seed}");
    }
}

fn nothing(_: &mut Bed) {}

/// Its own components are others, come or go.
mod a_change {
    use super::*;

    fn inserted(component: impl Bundle + Clone) {
        assert_wakes(WakeCause::Change, nothing, |bed| _ = bed.entity().insert(component.clone()));
    }

    fn removed<T: Component + Clone>(component: T) {
        let insert = |bed: &mut Bed| _ = bed.entity().insert(component.clone());
        assert_wakes(WakeCause::Change, insert, |bed| _ = bed.entity().remove::<T>());
    }

    #[test]
    fn of_shape_fabric_pins_or_weights_wakes() {
        inserted(Cloth::rectangle(0.5, 0.4).with_cells(3, 4));
        inserted(Fabric { thickness: 0.003, ..default() });
        inserted(Pins::rods(7));
        inserted(Weights::one(PinSelect::Corners, 0.1));
        removed(Pins::top());
        removed(Weights::one(PinSelect::Corners, 0.1));
    }

    #[test]
    fn of_its_settings_wakes() {
        inserted(Gravity(Vec3::NEG_Y));
        inserted(Substeps { count: 7, ..default() });
        inserted(Method::XpbdSweeps);
        inserted(Teleport { distance: 1.0, ..default() });
        inserted(ClothSleep { speed: 0.04, ..default() });
        inserted(ClothSleep::NEVER);
        removed(Gravity(Vec3::NEG_Y));
        removed(ClothSleep { speed: 0.04, ..default() });
    }

    #[test]
    fn of_air_or_damage_wakes() {
        inserted(Air { density: 2.0, ..default() });
        inserted(Wind(Vec3::X));
        inserted(Tearable::default());
        inserted(Flammable::default());
        removed(Air::default());
        removed(Tearable::default());
    }

    #[test]
    fn of_what_all_share_wakes() {
        let shared = |change: fn(&mut World)| assert_wakes(WakeCause::Change, nothing, |bed| change(bed.world()));
        shared(|world| world.resource_mut::<Shared<Gravity>>().0 = Gravity(Vec3::NEG_Y));
        shared(|world| world.resource_mut::<Shared<Substeps>>().count = 12);
        shared(|world| world.resource_mut::<Shared<Method>>().0 = Method::XpbdSweeps);
        shared(|world| world.resource_mut::<Shared<Teleport>>().angle = 2.0);
        shared(|world| world.resource_mut::<Shared<ClothSleep>>().time = 1.0);
    }

    #[test]
    fn of_what_others_share_wakes_none_that_has_its_own() {
        let own = |bed: &mut Bed| _ = bed.entity().insert((Gravity::default(), Method::default(), Wind::default()));
        assert_sleeps_on(own, |bed| {
            let x: f32 = bed.random.random();
            bed.world().resource_mut::<Shared<Gravity>>().0 = Gravity(Vec3::X * x);
            bed.world().resource_mut::<Shared<Wind>>().0 = Wind(Vec3::X * x);
            let method = Method::ALL[bed.random.random_range(0..7)];
            bed.world().resource_mut::<Shared<Method>>().0 = method;
        });
    }

    #[test]
    fn to_the_same_value_wakes_none() {
        assert_sleeps_on(nothing, |bed| {
            let fabric = *bed.entity().get::<Fabric>().unwrap();
            let pins = bed.entity().get::<Pins>().unwrap().clone();
            let transform = *bed.entity().get::<Transform>().unwrap();
            bed.entity().insert((fabric, pins, transform, Air::default(), Grabs::default()));
            bed.entity().get_mut::<Cloth>().unwrap().set_changed();
            bed.world().resource_mut::<Shared<Gravity>>().set_changed();
            bed.world().resource_mut::<Shared<Wind>>().0 = Wind::default();
            let place = bed.place;
            bed.world().get_mut::<Transform>(place).unwrap().set_changed();
        });
    }
}

/// What it hangs on.
mod its_frame {
    use super::*;

    #[test]
    fn wakes_it_however_little_it_moves_or_turns() {
        for change in [
            |place: &mut Transform| place.translation.y += 1e-4,
            |place: &mut Transform| place.rotate_y(1e-3),
            |place: &mut Transform| place.translation.x += 100.0,
        ] {
            assert_wakes(WakeCause::Frame, nothing, |bed| {
                let place = bed.place;
                change(&mut bed.world().get_mut::<Transform>(place).unwrap());
            });
        }
    }

    #[test]
    fn wakes_it_where_the_pins_follow_another_entity() {
        let hang = |bed: &mut Bed| {
            let pole = bed.world().spawn((Name::new("pole"), Transform::from_xyz(1.0, 2.0, 3.0))).id();
            let pins = bed.entity().get::<Pins>().unwrap().clone().to_entity(pole);
            bed.entity().insert(pins);
        };
        assert_wakes(WakeCause::Frame, hang, |bed| {
            let mut poles = bed.world().query_filtered::<&mut Transform, With<Name>>();
            poles.single_mut(bed.app.world_mut()).unwrap().translation.z += 0.01;
        });
    }

    #[test]
    fn keeps_it_awake_while_it_creeps() {
        let mut bed = Bed::asleep(1);
        let woke = seen::<ClothFellAsleep>(&bed.app).len();
        for _ in 0..256 {
            let place = bed.place;
            bed.world().get_mut::<Transform>(place).unwrap().translation.x += 1e-4;
            bed.app.update();
        }
        assert_eq!((bed.causes().len(), seen::<ClothFellAsleep>(&bed.app).len()), (1, woke));
        run_to_sleep(&mut bed.app, bed.cloth);
    }

    #[test]
    fn moved_once_in_a_frame_moves_it_as_if_it_had_been_awake() {
        let moved = |sleep: ClothSleep| {
            let mut bed = Bed::hanging(9);
            bed.entity().insert(sleep);
            run(&mut bed.app, ticks(LONG));
            bed.app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(TICK * 4));
            bed.app.update();
            let place = bed.place;
            bed.world().get_mut::<Transform>(place).unwrap().translation.x += 0.2;
            bed.app.update();
            world_positions(&bed.app, bed.cloth)
        };
        let apart = largest_move(&moved(ClothSleep::default()), &moved(ClothSleep::NEVER));
        assert!(apart < 2e-3, "{apart} m apart");
    }
}

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
        for seed in 0..4 {
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
        for seed in 0..4 {
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

/// A hand.
#[test]
fn a_hand_wakes_it_and_lets_it_sleep_again_once_it_is_gone() {
    let grab = |bed: &mut Bed| {
        let target = bed.particle();
        bed.entity().insert(Grabs(vec![Grab { target, ..default() }]));
    };
    assert_wakes(WakeCause::Hand, nothing, grab);
    let mut bed = Bed::asleep(3);
    grab(&mut bed);
    run(&mut bed.app, ticks(4.0));
    assert!(!is_asleep(&bed.app, bed.cloth));
    bed.entity().remove::<Grabs>();
    run_to_sleep(&mut bed.app, bed.cloth);
}

/// What is done to its particles.
mod damage {
    use super::*;

    #[test]
    fn wakes_it() {
        assert_wakes(WakeCause::Particles, nothing, |bed| {
            let (entity, position) = (bed.cloth, centre(&bed.app, bed.cloth));
            bed.world().trigger(TearCloth { entity, position, pull: Direction::Weft });
        });
        assert_wakes(WakeCause::Particles, nothing, |bed| {
            let pose = get::<ClothFrame>(&bed.app, bed.cloth).pose;
            let normal = pose.rotation * Vec3::Z;
            let (middle, down) = (centre(&bed.app, bed.cloth), Vec3::NEG_Y);
            let ray = |at: Vec3| Ray3d::new(at + normal * 2.0, Dir3::new(-normal).unwrap());
            let entity = bed.cloth;
            bed.world().trigger(CutCloth { entity, from: ray(middle), to: ray(middle + down), reach: 5.0 });
        });
        assert_wakes(WakeCause::Particles, nothing, |bed| {
            let entity = bed.cloth;
            bed.world().trigger(ResetCloth { entity });
        });
    }

    #[test]
    fn by_fire_or_water_wakes_it_and_fire_keeps_it_awake() {
        let flammable = |bed: &mut Bed| _ = bed.entity().insert(Flammable::default());
        let wet = |bed: &mut Bed| {
            let (entity, position) = (bed.cloth, bed.particle());
            bed.world().trigger(WetCloth { entity, position, radius: 0.1, water: 0.3 });
        };
        assert_wakes(WakeCause::Particles, flammable, wet);
        assert_wakes(WakeCause::Particles, flammable, |bed| {
            let (entity, position) = (bed.cloth, bed.particle());
            bed.world().trigger(IgniteCloth { entity, position, radius: 0.02 });
            run(&mut bed.app, 2);
            assert!(get::<ClothFire>(&bed.app, entity).is_warm());
        });
    }
}

#[test]
fn a_system_that_pushes_it_wakes_it_and_the_push_counts_in_full_in_that_very_tick() {
    #[derive(Resource)]
    struct Push(u32);
    let pushed = |sleep: ClothSleep| {
        let mut app = headless();
        let cloth = (Cloth::rectangle(0.2, 0.2).with_cells(4, 4), Gravity(Vec3::ZERO), sleep);
        let cloth = app.world_mut().spawn(cloth).id();
        run(&mut app, 64);
        assert_eq!(is_asleep(&app, cloth), sleep.enabled);
        app.insert_resource(Push(1));
        let push = move |mut cloths: Query<(&mut Particles, &ClothTopology)>, mut push: ResMut<Push>| {
            for (mut particles, topology) in cloths.iter_mut().filter(|_| push.0 > 0) {
                for slot in topology.particles() {
                    let mass = particles.mass[slot as usize];
                    particles.add_force(slot as usize, Vec3::Z * 60.0 * mass);
                }
            }
            push.0 = push.0.saturating_sub(1);
        };
        app.add_systems(ClothSchedule, push.in_set(ClothSystems::Forces));
        run(&mut app, 8);
        world_positions(&app, cloth)
    };
    let (woken, awake) = (pushed(ClothSleep::default()), pushed(ClothSleep::NEVER));
    assert_eq!(woken, awake);
    assert!(woken[0].z > 0.05, "pushed by {} m", woken[0].z);
}

#[test]
fn a_system_that_writes_to_its_particles_wakes_it() {
    assert_wakes(WakeCause::Particles, nothing, |bed| {
        bed.entity().get_mut::<Particles>().unwrap().velocity.fill(Vec3::X);
    });
}

#[test]
fn it_wakes_when_asked_to_and_falls_asleep_again() {
    let ask = |bed: &mut Bed| {
        let entity = bed.cloth;
        bed.world().trigger(WakeCloth { entity });
    };
    assert_wakes(WakeCause::Request, nothing, ask);
    let mut bed = Bed::asleep(2);
    let before = world_positions(&bed.app, bed.cloth);
    ask(&mut bed);
    run(&mut bed.app, 2);
    run_to_sleep(&mut bed.app, bed.cloth);
    let moved = largest_move(&before, &world_positions(&bed.app, bed.cloth));
    assert!(moved < 0.02, "it moved by {moved} m");
}

#[test]
fn asking_one_that_is_awake_or_none_at_all_does_nothing() {
    let mut bed = Bed::hanging(2);
    let (cloth, other) = (bed.cloth, bed.world().spawn_empty().id());
    for entity in [cloth, other] {
        bed.world().trigger(WakeCloth { entity });
        bed.app.update();
    }
    assert_eq!(bed.causes(), []);
}

#[test]
fn a_part_of_its_state_that_someone_removes_is_made_anew() {
    assert_wakes(WakeCause::Change, nothing, |bed| _ = bed.entity().remove::<Particles>());
}

#[test]
fn a_mesh_that_changes_wakes_the_cloth_made_from_it() {
    let mut app = with_meshes();
    note_events::<ClothWoke>(&mut app);
    let sheet = || Plane3d::new(Vec3::Z, Vec2::splat(0.2)).mesh().subdivisions(4);
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(sheet());
    let cloth = (Cloth::mesh(), Mesh3d(mesh.clone()), Pins::top(), Air::default());
    let cloth = app.world_mut().spawn(cloth).id();
    run_to_sleep(&mut app, cloth);
    app.world_mut().resource_mut::<Assets<Mesh>>().insert(&mesh, sheet().subdivisions(2).build()).unwrap();
    run(&mut app, 3);
    assert_eq!(seen::<ClothWoke>(&app), [ClothWoke { entity: cloth, cause: WakeCause::Change }]);
    assert_eq!(get::<ClothTopology>(&app, cloth).particle_count(), 16);
}
