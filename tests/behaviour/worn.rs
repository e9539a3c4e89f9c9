//! Cloth is drawn where what it hangs on is drawn, however that moves and however many frames there are in a second.

use std::time::Duration;

use crate::common::wearer::*;
use crate::common::*;
use bevy::picking::backend::PointerHits;
use bevy::picking::pointer::PointerAction;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_cloth::*;

#[test]
fn pinned_vertices_are_drawn_on_their_pins_whatever_moves_the_wearer_and_at_any_frame_rate() {
    let mut numbers = Numbers(7);
    let mut worst = 0.0_f32;
    for worn in WORN {
        for moved in MOVED {
            for frames in FRAMES.into_iter().step_by(cases(4, 1)) {
                let velocity = direction(&mut numbers) * numbers.between(1.0, 50.0);
                let turn = direction(&mut numbers) * numbers.between(1.0, 20.0);
                let mut scene = scene(worn, moved, Mover { velocity, turn, from: 0.1, to: 0.6 }, ());
                let mut time = 0.0;
                while time < 0.7 {
                    let seconds = frames.next(&mut numbers);
                    scene.frame(seconds);
                    time += seconds;
                    let lag = scene.lag();
                    worst = worst.max(lag);
                    assert!(
                        lag < 1e-4,
                        "{worn:?} {moved:?} {frames:?} {velocity} m/s {turn} rad/s: {} mm at {time} s",
                        1e3 * lag
                    );
                }
            }
        }
    }
    println!("largest lag {} mm", 1e3 * worst);
}

/// Where each particle was at the end of each tick, seen from the first thing that it hangs on.
#[derive(Resource, Default)]
struct Ticks(Vec<Vec<Vec3>>);

fn note(cloths: Query<(&Particles, &cloth_solver::cloth::Constraints, &ClothTopology)>, mut ticks: ResMut<Ticks>) {
    for (particles, constraints, topology) in &cloths {
        let wearer = constraints.pins().frames[0].to;
        let position = &particles.position;
        ticks.0.push(topology.particles().map(|slot| wearer.inverse_point(position.get(slot as usize))).collect());
    }
}

/// The farthest that any particle went from one of these to the next, m.
fn largest_step(shapes: &[Vec<Vec3>]) -> f32 {
    shapes.windows(2).map(|pair| largest_move(&pair[0], &pair[1])).fold(0.0, f32::max)
}

#[test]
fn seen_from_its_wearer_no_frame_moves_the_cloth_faster_than_the_ticks_do() {
    let mut numbers = Numbers(11);
    for worn in [Worn::AsChild, Worn::ByEntity] {
        for moved in MOVED {
            for frames in FRAMES.into_iter().step_by(cases(4, 1)) {
                let velocity = direction(&mut numbers) * numbers.between(1.0, 20.0);
                let turn = direction(&mut numbers) * numbers.between(1.0, 10.0);
                // It starts and stops within.
                let mut scene = scene(worn, moved, Mover { velocity, turn, from: 0.1, to: 0.5 }, ());
                scene.app.init_resource::<Ticks>();
                scene.app.add_systems(ClothSchedule, note.after(ClothSystems::Writeback));
                let mut shapes = vec![];
                let mut time = 0.0;
                let mut lengths = vec![];
                while time < 0.8 {
                    let seconds = frames.next(&mut numbers);
                    scene.frame(seconds);
                    shapes.push(scene.drawn_from_wearer());
                    lengths.push(seconds);
                    time += seconds;
                }
                let tick = largest_step(&scene.app.world().resource::<Ticks>().0) / TICK.as_secs_f32();
                for (pair, seconds) in shapes.windows(2).zip(&lengths[1..]) {
                    let speed = largest_move(&pair[0], &pair[1]) / seconds;
                    assert!(
                        speed < 1.01 * tick + 0.01,
                        "{worn:?} {moved:?} {frames:?}: {speed} m/s, in ticks {tick} m/s"
                    );
                }
            }
        }
    }
}

#[test]
fn nothing_is_drawn_more_stretched_than_it_was_in_one_of_the_last_two_ticks() {
    let mut numbers = Numbers(13);
    for frames in FRAMES.into_iter().step_by(cases(4, 1)) {
        let (velocity, turn) = (direction(&mut numbers) * 20.0, direction(&mut numbers) * 15.0);
        let mut scene = scene(Worn::ByEntity, Moved::InUpdate, Mover { velocity, turn, from: 0.1, to: 0.5 }, ());
        scene.app.init_resource::<Ticks>();
        scene.app.add_systems(ClothSchedule, note.after(ClothSystems::Writeback));
        let edges: Vec<[usize; 2]> = {
            let topology = get::<ClothTopology>(&scene.app, scene.cape);
            let order: Vec<u32> = topology.particles().collect();
            let index = |slot: u32| order.iter().position(|known| *known == slot).expect("a particle");
            topology.edges.iter().map(|edge| edge.map(index)).collect()
        };
        let mut time = 0.0;
        while time < 0.8 {
            let seconds = frames.next(&mut numbers);
            scene.frame(seconds);
            time += seconds;
            let ticks = &scene.app.world().resource::<Ticks>().0;
            let [.., before, last] = &ticks[..] else { continue };
            let drawn = scene.drawn();
            for [a, b] in &edges {
                let length = drawn[*a].distance(drawn[*b]);
                let longest = before[*a].distance(before[*b]).max(last[*a].distance(last[*b]));
                assert!(length < longest + 2e-5, "{frames:?}: {length} m of {longest} m");
            }
        }
    }
}

/// The fastest that anything is drawn to move in the world from one frame to the next, m/s, while `change` is done to a cape worn
/// at 10 m/s.
fn fastest_drawn(change: impl Fn(&mut Scene)) -> f32 {
    let mover = Mover { velocity: Vec3::X * 10.0, from: 0.0, to: 9.0, ..default() };
    let fabric = Fabric { damping: 5.0, ..Fabric::default() };
    let mut scene = scene(Worn::ByEntity, Moved::InUpdate, mover, fabric);
    let seconds = 1.0 / 128.0;
    for _ in 0..256 {
        scene.frame(seconds);
    }
    let mut shapes = vec![scene.drawn()];
    change(&mut scene);
    for _ in 0..40 {
        scene.frame(seconds);
        let count = shapes[0].len();
        shapes.push(scene.drawn()[..count].to_vec());
    }
    largest_step(&shapes) / seconds
}

#[test]
fn what_is_let_go_or_cut_off_a_wearer_does_not_jump() {
    let usual = fastest_drawn(|_| {});
    let let_go = fastest_drawn(|scene| {
        scene.app.world_mut().entity_mut(scene.cape).remove::<Pins>();
    });
    let cut = fastest_drawn(|scene| {
        let at = scene.drawn();
        let height = at[2 * CELLS as usize].y - 0.05;
        let ray = |x: f32| Ray3d { origin: Vec3::new(at[0].x + x, height, 5.0), direction: Dir3::NEG_Z };
        let entity = scene.cape;
        scene.app.world_mut().trigger(CutCloth { entity, from: ray(-5.0), to: ray(5.0), reach: 20.0 });
        scene.app.world_mut().flush();
        assert!(get::<ClothPieces>(&scene.app, entity).pieces.len() > 1, "it is in one piece");
    });
    assert!(let_go < 1.5 * usual && cut < 1.5 * usual, "let go {let_go}, cut {cut}, usually {usual} m/s");
}

#[test]
fn the_motion_is_the_same_to_the_last_bit_whether_it_is_drawn_or_not() {
    let simulated = |drawn: bool| {
        let mut app = if drawn { with_meshes() } else { headless() };
        app.add_systems(FixedUpdate, step);
        let mover = Mover { velocity: Vec3::new(7.0, 0.5, 1.0), turn: Vec3::Y * 3.0, from: 0.0, to: 0.4 };
        let wearer = app.world_mut().spawn((Transform::IDENTITY, mover)).id();
        let cape = Cloth::rectangle(0.6, 0.8).with_cells(6, 8);
        let cape = app.world_mut().spawn((cape, Pins::top(), ChildOf(wearer))).id();
        run(&mut app, 48);
        bits(&app, cape)
    };
    assert_eq!(simulated(true), simulated(false));
}

#[test]
fn particles_are_shown_where_the_mesh_is_also_where_it_is_subdivided() {
    let mover = Mover { velocity: Vec3::new(6.0, 1.0, 0.0), turn: Vec3::Y * 4.0, from: 0.0, to: 9.0 };
    for subdivision in ClothSubdivision::ALL {
        let mut scene = scene(Worn::ByTwo, Moved::InUpdate, mover, subdivision);
        for _ in 0..30 {
            scene.frame(0.011);
        }
        assert!(scene.lag() < 1e-4, "{subdivision:?}: {} m", scene.lag());
        let (drawn, topology) = (scene.drawn(), get::<ClothTopology>(&scene.app, scene.cape));
        let shown = get::<ShownShape>(&scene.app, scene.cape);
        for (vertex, slot) in topology.vertex_particle.iter().enumerate() {
            let off = drawn[vertex].distance(shown.in_world(*slot).expect("it is drawn"));
            assert!(off < 1e-4, "{subdivision:?}, vertex {vertex}: {off} m");
        }
    }
}

#[test]
fn cloth_worn_at_a_constant_speed_stands_still_seen_from_a_wearer_moved_once_a_frame() {
    for hertz in [24.0, 30.0, 50.0, 60.0, 75.0, 144.0].into_iter().step_by(cases(3, 1)) {
        let mover = Mover { velocity: Vec3::X * 10.0, from: 0.1, to: 99.0, ..default() };
        let fabric = Fabric { damping: 10.0, ..Fabric::default() };
        let mut scene = scene(Worn::AsChild, Moved::InUpdate, mover, fabric);
        let mut shapes = vec![];
        for frame in 0..(4.0 * hertz) as u32 {
            scene.frame(1.0 / hertz);
            if frame as f32 > 3.5 * hertz {
                shapes.push(scene.drawn_from_wearer());
            }
        }
        let speed = largest_step(&shapes) * hertz;
        assert!(speed < 0.1, "{hertz} Hz: {speed} m/s");
    }
}

#[test]
fn a_pointer_meets_the_cloth_where_it_is_drawn() {
    let mut app = with_pointer();
    app.add_plugins((AssetPlugin::default(), bevy::mesh::MeshPlugin)).add_systems(Update, step);
    let mover = Mover { velocity: Vec3::X * 2.0, from: 0.0, to: 9.0, ..default() };
    let wearer = app.world_mut().spawn((Transform::from_xyz(-0.5, 0.0, 0.0), mover)).id();
    let cape = Cloth::rectangle(0.6, 0.8).with_cells(12, 16);
    let cape = app.world_mut().spawn((cape, Pins::top(), ChildOf(wearer))).id();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(1.0 / 144.0)));
    run(&mut app, 8);
    // The first ray only makes what later ones are cast against.
    send(&mut app, [400.0, 300.0], PointerAction::Move { delta: Vec2::ONE });
    app.update();
    let triangle = get::<ClothTopology>(&app, cape).triangles[200];
    let mut cameras = app.world_mut().query::<(&Camera, &GlobalTransform)>();
    for _ in 0..60 {
        let shown = get::<ShownShape>(&app, cape);
        let drawn = triangle.map(|slot| shown.in_world(slot).expect("it is drawn")).iter().sum::<Vec3>() / 3.0;
        let (camera, place) = cameras.single(app.world()).expect("one camera");
        let at = camera.world_to_viewport(place, drawn).expect("it is seen");
        take_messages::<PointerHits>(&mut app);
        send(&mut app, at.to_array(), PointerAction::Move { delta: Vec2::ONE });
        app.update();
        let hits = take_messages::<PointerHits>(&mut app);
        let hit = hits.iter().flat_map(|hits| &hits.picks).find(|(entity, _)| *entity == cape).expect("a hit");
        let off = hit.1.position.expect("a place").distance(drawn);
        assert!(off < 0.002, "{off} m from where it is drawn");
    }
}

#[test]
fn a_blink_at_any_frame_rate_is_seen_by_nobody_who_blinks_along() {
    for worn in [Worn::AsChild, Worn::ByEntity] {
        for hertz in [24.0, 30.0, 60.0, 75.0, 144.0].into_iter().step_by(cases(4, 1)) {
            let mover = Mover { velocity: Vec3::X * 1.5, turn: Vec3::Y, from: 0.1, to: 99.0 };
            let fabric = Fabric { damping: 5.0, ..Fabric::default() };
            let mut scene = scene(worn, Moved::InUpdate, mover, (fabric, ClothStats::default()));
            let mut movers = scene.app.world_mut().query_filtered::<Entity, (With<Mover>, Without<ChildOf>)>();
            let wearer = movers.single(scene.app.world()).expect("one wearer");
            let mut before = vec![];
            for frame in 0..(3.0 * hertz) as u32 {
                if frame as f32 > hertz && frame % 11 == 0 {
                    let mut place = scene.app.world_mut().get_mut::<Transform>(wearer).unwrap();
                    place.translation += Vec3::new(0.0, 2.5, 0.4 * (frame % 7) as f32);
                }
                scene.frame(1.0 / hertz);
                let (strain, now) =
                    (get::<ClothStats>(&scene.app, scene.cape).largest_strain, scene.drawn_from_wearer());
                let what = format!("{worn:?}, {hertz} Hz, frame {frame}");
                if frame as f32 > hertz {
                    assert!(strain < 0.03, "{what}: strain {strain}");
                    // Its wearer, at 1.5 m/s, stands for the rest of that frame, and catches up in the next.
                    let step = largest_move(&before, &now);
                    assert!(step < 0.03 + 2.0 * 1.5 / hertz, "{what}: it moved {step} m");
                }
                before = now;
            }
        }
    }
}
