//! Whatever could move a sleeping cloth wakes it at once; nothing else does.

use crate::common::sleep::*;
use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;
use rand::RngExt;

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
    fn of_air_self_contact_or_damage_wakes() {
        inserted(Air { density: 2.0, ..default() });
        inserted(Wind(Vec3::X));
        inserted(Tearable::default());
        inserted(Flammable::default());
        inserted(SelfContact::default());
        removed(SelfContact::default());
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
