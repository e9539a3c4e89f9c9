//! Cloth is drawn where what it hangs on is drawn, however that moves and however many frames there are in a second.

mod common;

use std::time::Duration;

use bevy::mesh::VertexAttributeValues;
use bevy::picking::backend::PointerHits;
use bevy::picking::pointer::PointerAction;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_cloth::*;
use common::*;

/// A sequence of numbers in 0..1 from a seed (Steele, Lea and Flood 2014: splitmix).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1_u64 << 24) as f32
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.next()
    }
}

/// Moves on a path through the origin.
#[derive(Component, Clone, Copy, Debug, Default)]
struct Mover {
    velocity: Vec3,
    turn: Vec3,
    /// Stands before this time, and from the other on, s.
    from: f32,
    to: f32,
}

impl Mover {
    fn step(&self, place: &mut Transform, time: &Time) {
        let now = time.elapsed_secs();
        if now > self.from && now <= self.to {
            place.translation += self.velocity * time.delta_secs();
            place.rotate(Quat::from_scaled_axis(self.turn * time.delta_secs()));
        }
    }
}

fn step(mut movers: Query<(&Mover, &mut Transform)>, time: Res<Time>) {
    for (mover, mut place) in &mut movers {
        mover.step(&mut place, &time);
    }
}

/// When the wearer is moved.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Moved {
    InUpdate,
    InFixedUpdate,
    ByAnimation,
}

const MOVED: [Moved; 3] = [Moved::InUpdate, Moved::InFixedUpdate, Moved::ByAnimation];

/// What the top of the cape is pinned to.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Worn {
    /// The cape's own entity, a child of the wearer.
    AsChild,
    /// A child of the wearer; the cape's entity stays where it is.
    ByEntity,
    /// Two children of the wearer, that move by themselves as well.
    ByTwo,
    /// The world, while the cape's entity moves.
    ToWorld,
}

const WORN: [Worn; 4] = [Worn::AsChild, Worn::ByEntity, Worn::ByTwo, Worn::ToWorld];

const CELLS: u32 = 6;

struct Scene {
    app: App,
    cape: Entity,
    /// What each vertex of the top row hangs on, and where in its frame that is.
    pins: Vec<(Option<Entity>, Vec3)>,
}

fn scene(worn: Worn, moved: Moved, mover: Mover, more: impl Bundle) -> Scene {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin::default(),
        bevy::mesh::MeshPlugin,
        ClothPlugin::default(),
    ));
    app.world_mut().resource_mut::<Time<Virtual>>().set_max_delta(Duration::from_secs(1));
    match moved {
        Moved::InUpdate => app.add_systems(Update, step),
        Moved::InFixedUpdate => app.add_systems(FixedUpdate, step),
        Moved::ByAnimation => app.add_systems(PostUpdate, step.before(TransformSystems::Propagate)),
    };
    app.insert_resource(TimeUpdateStrategy::ManualDuration(TICK));
    let world = app.world_mut();
    let at = Transform::from_xyz(0.0, 1.0, -0.2);
    let wearer = world.spawn((Transform::IDENTITY, mover)).id();
    let mut bone = |x, mover: Mover| world.spawn((Transform::from_xyz(x, 1.4, -0.1), mover, ChildOf(wearer))).id();
    // One of two hands goes down and turns.
    let lowered = Mover { velocity: Vec3::new(0.1, -0.4, 0.0), turn: Vec3::Z, from: 0.2, to: 0.8 };
    let (left, right) =
        (bone(-0.2, Mover::default()), bone(0.2, if worn == Worn::ByTwo { lowered } else { Mover::default() }));
    let half = |from, to| Pins::region(Vec3::new(from, 0.35, -0.1), Vec3::new(to, 0.45, 0.1));
    let pins = match worn {
        Worn::AsChild => Pins::top(),
        Worn::ByEntity => Pins::top().to_entity(left),
        Worn::ByTwo => half(-0.4, -0.01).to_entity(left).and(half(-0.01, 0.4).to_entity(right)),
        Worn::ToWorld => Pins::top().to_world(),
    };
    let cape = Cloth::rectangle(0.6, 0.8).with_cells(CELLS, 8);
    let cape =
        world.spawn((cape, pins, Teleport { policy: TeleportPolicy::CarryAlong, ..default() }, at)).insert(more).id();
    match worn {
        Worn::AsChild => _ = world.entity_mut(cape).insert(ChildOf(wearer)),
        Worn::ToWorld => _ = world.entity_mut(cape).insert(mover),
        _ => {}
    }
    run(&mut app, 4);
    let pins = (0..=CELLS).map(|i| {
        let rest = Vec3::new(0.6 * (i as f32 / CELLS as f32 - 0.5), 0.4, 0.0);
        match worn {
            Worn::AsChild => (Some(cape), rest),
            Worn::ByEntity => (Some(left), at.transform_point(rest) - Vec3::new(-0.2, 1.4, -0.1)),
            Worn::ByTwo if rest.x < -0.01 => (Some(left), at.transform_point(rest) - Vec3::new(-0.2, 1.4, -0.1)),
            Worn::ByTwo => (Some(right), at.transform_point(rest) - Vec3::new(0.2, 1.4, -0.1)),
            Worn::ToWorld => (None, at.transform_point(rest)),
        }
    });
    Scene { pins: pins.collect(), app, cape }
}

impl Scene {
    fn frame(&mut self, seconds: f32) {
        self.app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(seconds)));
        self.app.update();
    }

    /// The middle between both faces of each particle's vertex as drawn, in the entity's space.
    fn drawn_local(&self) -> Vec<Vec3> {
        let mesh = self.app.world().resource::<Assets<Mesh>>().get(&get::<Mesh3d>(&self.app, self.cape).0);
        let Some(VertexAttributeValues::Float32x3(at)) = mesh.expect("a mesh").attribute(Mesh::ATTRIBUTE_POSITION)
        else {
            panic!("no positions")
        };
        let (front, back) = at.split_at(at.len() / 2);
        front.iter().zip(back).map(|(a, b)| 0.5 * (Vec3::from_array(*a) + Vec3::from_array(*b))).collect()
    }

    fn drawn(&self) -> Vec<Vec3> {
        let place = get::<GlobalTransform>(&self.app, self.cape);
        self.drawn_local().into_iter().map(|at| place.transform_point(at)).collect()
    }

    /// The same, seen from the first thing that it hangs on.
    fn drawn_from_wearer(&self) -> Vec<Vec3> {
        let place =
            self.pins[0].0.map_or(GlobalTransform::IDENTITY, |entity| *get::<GlobalTransform>(&self.app, entity));
        let back = place.affine().inverse();
        self.drawn().into_iter().map(|at| back.transform_point3(at)).collect()
    }

    /// How far the farthest pinned vertex is drawn from its pin, m.
    fn lag(&self) -> f32 {
        let drawn = self.drawn();
        let off = self.pins.iter().enumerate().map(|(i, (entity, at))| {
            let wanted = entity.map_or(*at, |entity| get::<GlobalTransform>(&self.app, entity).transform_point(*at));
            drawn[i].distance(wanted)
        });
        off.fold(0.0, f32::max)
    }
}

/// Lengths of frames, s.
#[derive(Clone, Copy, Debug)]
enum Frames {
    Hertz(f32),
    Irregular,
}

const FRAMES: [Frames; 6] = [
    Frames::Hertz(24.0),
    Frames::Hertz(30.0),
    Frames::Hertz(60.0),
    Frames::Hertz(144.0),
    Frames::Hertz(240.0),
    Frames::Irregular,
];

impl Frames {
    fn next(self, numbers: &mut Numbers) -> f32 {
        match self {
            Self::Hertz(hertz) => 1.0 / hertz,
            Self::Irregular => numbers.between(0.002, 0.06),
        }
    }
}

fn direction(numbers: &mut Numbers) -> Vec3 {
    let to = Vec3::from_array([(); 3].map(|()| numbers.between(-1.0, 1.0)));
    to.try_normalize().unwrap_or(Vec3::X)
}

#[test]
fn pinned_vertices_are_drawn_on_their_pins_whatever_moves_the_wearer_and_at_any_frame_rate() {
    let mut numbers = Numbers(7);
    let mut worst = 0.0_f32;
    for worn in WORN {
        for moved in MOVED {
            for frames in FRAMES {
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
            for frames in FRAMES {
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
    for frames in FRAMES {
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
    for hertz in [24.0, 30.0, 50.0, 60.0, 75.0, 144.0] {
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
