//! Saved cloths go on, in the same world and in another one, as if nothing had been saved; what does not fit is refused.

use crate::common::sleep::{is_asleep, run_to_sleep};
use crate::common::*;
use bevy::asset::RenderAssetUsages;
use bevy::ecs::entity::{EntityHashMap, MapEntities};
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy_cloth::*;
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

/// A random world of cloths and of what happens to them, always the same from its seed.
struct Played {
    app: App,
    seed: u64,
    cloths: Vec<Entity>,
    /// A ball that moves through them, and what pins hang on.
    ball: Entity,
    hand: Entity,
}

/// A sheet whose cells are uneven, so that it is solved as a mesh.
fn uneven_mesh(random: &mut Xoshiro256PlusPlus, [columns, rows]: [u32; 2]) -> Mesh {
    let mut positions = Vec::new();
    for row in 0..=rows {
        for column in 0..=columns {
            let off = [(); 2].map(|()| random.random_range(-0.2..0.2));
            positions.push([0.05 * (column as f32 + off[0]), -0.05 * (row as f32 + off[1]), 0.0]);
        }
    }
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| row * (columns + 1) + column));
    let triangles = cells.flat_map(|a| [a, a + columns + 1, a + 1, a + 1, a + columns + 1, a + columns + 2]);
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_indices(Indices::U32(triangles.collect()))
}

impl Played {
    /// Everything authored, before the first tick.
    fn new(seed: u64) -> Self {
        let mut app = with_meshes();
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let world = app.world_mut();
        world.insert_resource(Shared(Wind(Vec3::new(random.random_range(-4.0..4.0), 0.0, 2.0))));
        world.insert_resource(Shared(Gusts { intensity: 0.3, ..default() }));
        let ball = world.spawn((ClothCollider::Sphere { radius: 0.08 }, ClothForce::default(), ContactEvents)).id();
        let hand = world.spawn(Transform::default()).id();
        world.spawn((Fan::default(), Transform::from_xyz(0.2, 0.0, 1.0)));
        world.spawn((ClothCollider::Cuboid { size: Vec3::new(0.2, 0.1, 0.3) }, Transform::from_xyz(0.0, -0.5, 0.0)));
        world.spawn((ClothCollider::Ground, Transform::from_xyz(0.0, -0.7, 0.0)));
        let is_crowded = random.random_bool(0.4);
        let cloths = (0..2).map(|index| {
            let cells = [(); 2].map(|()| random.random_range(4..13));
            let is_mesh = random.random_bool(0.4);
            let cloth = match is_mesh {
                true => Cloth::mesh(),
                false => {
                    Cloth::rectangle(0.05 * cells[0] as f32, 0.05 * cells[1] as f32).with_cells(cells[0], cells[1])
                }
            };
            let method = match random.random_range(0..6) {
                0 => Method::XpbdSweeps,
                1 => Method::Pbd,
                _ => Method::XpbdLines,
            };
            let pins = match random.random_range(0..3) {
                0 => Pins::corners(),
                1 => Pins::rods(3).to_entity(hand),
                _ => Pins::top().to_world(),
            };
            let (_, fabric) = Fabric::PRESETS[random.random_range(0..Fabric::PRESETS.len())];
            let place = Transform::from_xyz(0.15 * index as f32, 0.1, 0.03 * index as f32);
            let mut entity = app.world_mut().spawn((cloth, method, pins, fabric, place));
            if is_mesh {
                let mesh = uneven_mesh(&mut random, cells);
                let mesh = entity.world_scope(|world| world.resource_mut::<Assets<Mesh>>().add(mesh));
                entity.insert(Mesh3d(mesh));
            }
            if random.random_bool(0.6) {
                entity.insert(Air::default());
            }
            if random.random_bool(0.6) {
                entity.insert(Tearable { scale: 0.002, ..default() });
            }
            match random.random_range(0..3) {
                0 => entity.insert(Flammable::default()),
                1 => entity.insert(Flammable::Contagion(Contagion::default())),
                _ => &mut entity,
            };
            if is_crowded {
                entity.insert(SelfContact::default());
            }
            entity.id()
        });
        let cloths = cloths.collect();
        Self { cloths, app, seed, ball, hand }
    }

    /// Does what happens before the tick of that number, and takes the tick.
    fn tick(&mut self, tick: u64) {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(self.seed ^ tick.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let time = tick as f32 / 64.0;
        let mut at = || Vec3::from_array([(); 3].map(|()| random.random_range(-0.2..0.2)));
        let (position, pull) = (at(), at());
        let world = self.app.world_mut();
        let ball = Vec3::new((3.0 * time).sin() * 0.3, -0.1, (2.0 * time).cos() * 0.2);
        *world.get_mut::<Transform>(self.ball).unwrap() = Transform::from_translation(ball);
        *world.get_mut::<Transform>(self.hand).unwrap() = Transform::from_xyz(0.1 * (4.0 * time).sin(), 0.0, 0.0);
        let entity = self.cloths[random.random_range(0..self.cloths.len())];
        match random.random_range(0..24) {
            0 => {
                let ray = |through: Vec3| Ray3d::new(through + Vec3::Z, Dir3::NEG_Z);
                world.trigger(CutCloth { entity, from: ray(position), to: ray(position + pull), reach: 2.0 });
            }
            1 => world.trigger(TearCloth { entity, position, pull: cloth_solver::damage::Direction::Warp }),
            2..=4 => world.trigger(IgniteCloth { entity, position, radius: 0.05 }),
            5 => world.trigger(WetCloth { entity, position, radius: 0.1, water: 0.2 }),
            6 => world.trigger(UnpinParticle { entity, particle: random.random_range(0..12) }),
            7 => world.trigger(PinParticle { entity, particle: random.random_range(0..40), to: PinTarget::World }),
            _ => {}
        }
        // A hand for a third of a second in each.
        let held = self.cloths[0];
        let triangles = world.get::<ClothTopology>(held).map_or(0, |topology| topology.triangles.len() as u32);
        if tick % 64 < 21 && triangles > 0 {
            let grab = Grab { hand: 1, triangle: 7 % triangles, target: 0.2 * pull.normalize_or_zero(), ..default() };
            world.entity_mut(held).insert(Grabs(vec![grab]));
        } else {
            world.entity_mut(held).remove::<Grabs>();
        }
        self.app.update();
    }

    /// Every bit of the cloths that can be seen.
    fn look(&self) -> Vec<(Bits, usize, Vec<u32>, bool)> {
        let look = |cloth: &Entity| {
            let fire = self.app.world().get::<ClothFire>(*cloth);
            let heat = fire.map_or_else(Vec::new, |fire| fire.temperature().iter().map(|t| t.to_bits()).collect());
            let triangles = get::<ClothTopology>(&self.app, *cloth).triangles.len();
            (bits(&self.app, *cloth), triangles, heat, self.app.world().entity(*cloth).contains::<ClothAsleep>())
        };
        self.cloths.iter().map(look).collect()
    }

    fn save(&self) -> SavedCloths {
        SavedCloths::take(self.app.world())
    }

    /// What is what in another world of the same seed.
    fn mapped(&self, mut saved: SavedCloths, from: &Self) -> SavedCloths {
        let pairs = |played: &Self| [vec![played.ball, played.hand], played.cloths.clone()].concat();
        let mut map: EntityHashMap<Entity> = pairs(from).into_iter().zip(pairs(self)).collect();
        saved.map_entities(&mut map);
        saved
    }
}

/// The same bits, tick after tick.
fn assert_same(
    played: &mut Played,
    ticks: std::ops::Range<u64>,
    expected: &[Vec<(Bits, usize, Vec<u32>, bool)>],
    how: &str,
) {
    for (tick, expected) in ticks.zip(expected) {
        played.tick(tick);
        assert_eq!(&played.look(), expected, "seed {}, {how}, tick {tick}", played.seed);
    }
}

/// What was seen to happen to saved cloths.
#[derive(Debug, Default)]
struct Happened {
    torn: u32,
    burning: u32,
    released: u32,
    held: u32,
    crowded: u32,
    meshes: u32,
}

impl Happened {
    fn see(&mut self, played: &Played) {
        for cloth in &played.cloths {
            let cloth = played.app.world().entity(*cloth);
            self.torn += u32::from(cloth.contains::<ClothPieces>());
            self.burning += u32::from(cloth.get::<ClothFire>().is_some_and(|fire| fire.is_warm()));
            self.released += u32::from(cloth.contains::<ParticlePins>());
            self.held += u32::from(cloth.contains::<Grabs>());
            self.crowded += u32::from(cloth.contains::<cloth_solver::contact::SelfContacts>());
            self.meshes += u32::from(cloth.get::<ClothTopology>().is_some_and(|topology| topology.grid.is_none()));
        }
    }
}

fn goes_on(seed: u64, happened: &mut Happened) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(!seed);
    let (before, after) = (random.random_range(2..80), 30);
    let mut played = Played::new(seed);
    let mut untouched = Played::new(seed);
    for tick in 0..before {
        played.tick(tick);
        untouched.tick(tick);
    }
    let saved = played.save();
    let bytes = saved.to_bytes();
    happened.see(&played);
    let expected: Vec<_> = (before..before + after)
        .map(|tick| {
            untouched.tick(tick);
            untouched.look()
        })
        .collect();
    assert_same(&mut played, before..before + after, &expected, "saved and gone on");
    saved.restore(played.app.world_mut()).expect("it fits");
    assert_same(&mut played, before..before + after, &expected, "rolled back");
    let read = SavedCloths::from_bytes(&bytes).expect("they are whole");
    read.restore(played.app.world_mut()).expect("it fits");
    assert_same(&mut played, before..before + after, &expected, "rolled back from bytes");
    for earlier in [0, 3] {
        let mut other = Played::new(seed);
        // What is moved to where pins are made belongs to what is authored.
        (0..earlier).for_each(|tick| other.tick(tick));
        let mapped = other.mapped(read.clone(), &played);
        mapped.restore(other.app.world_mut()).expect("it fits");
        assert_same(&mut other, before..before + after, &expected, "restored in another world");
    }
}

#[test]
fn random_cloths_that_are_torn_cut_burnt_and_pulled_go_on_to_the_last_bit() {
    let mut happened = Happened::default();
    (0..cases(4, 14)).for_each(|seed| goes_on(seed, &mut happened));
    let Happened { torn, burning, released, held, crowded, meshes } = happened;
    let least = [torn, burning, released, held, crowded, meshes].into_iter().min();
    assert!(least >= Some(cases(0, 2)), "{happened:?}");
}

/// A curtain that was cut and has come to rest.
fn resting() -> (App, Entity) {
    let mut app = headless();
    let curtain = (Cloth::rectangle(0.3, 0.3).with_cells(8, 8), Pins::top(), Air::default(), SelfContact::default());
    let cloth = app.world_mut().spawn(curtain).id();
    app.world_mut().spawn((ClothCollider::Sphere { radius: 0.05 }, Transform::from_xyz(0.05, -0.1, 0.0)));
    run(&mut app, 2);
    let ray = |x: f32| Ray3d::new(Vec3::new(x, 0.0, 1.0), Dir3::NEG_Z);
    app.world_mut().trigger(CutCloth { entity: cloth, from: ray(-0.2), to: ray(-0.05), reach: 2.0 });
    run_to_sleep(&mut app, cloth);
    (app, cloth)
}

#[test]
fn a_cloth_that_sleeps_sleeps_on_where_it_is_restored() {
    let (mut app, cloth) = resting();
    let (saved, asleep) = (SavedCloths::take(app.world()), bits(&app, cloth));
    let read = SavedCloths::from_bytes(&saved.to_bytes()).expect("they are whole");
    app.world_mut().entity_mut(cloth).insert(Transform::from_xyz(0.2, 0.0, 0.0));
    run(&mut app, 10);
    assert_ne!(bits(&app, cloth), asleep);
    for saved in [saved, read] {
        app.world_mut().entity_mut(cloth).insert(Transform::default());
        note_events::<ClothWoke>(&mut app);
        saved.restore(app.world_mut()).expect("it fits");
        run(&mut app, 20);
        assert!(is_asleep(&app, cloth) && seen::<ClothWoke>(&app).is_empty());
        assert_eq!(bits(&app, cloth), asleep);
        app.world_mut().trigger(WakeCloth { entity: cloth });
        run(&mut app, 1);
        assert!(!is_asleep(&app, cloth));
    }
}

#[test]
fn damaged_bytes_are_told_wherever_they_are_damaged() {
    let (app, _) = resting();
    let bytes = SavedCloths::take(app.world()).to_bytes();
    assert!(SavedCloths::from_bytes(&bytes).is_ok());
    let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
    for _ in 0..300 {
        let length = random.random_range(0..bytes.len());
        assert!(SavedCloths::from_bytes(&bytes[..length]).is_err(), "of {} bytes {length}", bytes.len());
        let mut other = bytes.clone();
        let at = random.random_range(0..bytes.len());
        other[at] ^= 1 << random.random_range(0..8);
        assert!(SavedCloths::from_bytes(&other).is_err(), "byte {at}");
    }
    (0..40).for_each(|length| assert!(SavedCloths::from_bytes(&bytes[..length]).is_err(), "{length}"));
    assert!(SavedCloths::from_bytes(&[&bytes[..], &[0]].concat()).is_err());
    assert_eq!(SavedCloths::from_bytes(b"(scene: 5)").err(), Some(RestoreError::NotSaved));
}

#[test]
fn bytes_of_another_version_say_so() {
    let (app, _) = resting();
    let mut bytes = SavedCloths::take(app.world()).to_bytes();
    // Behind the magic word and the length.
    bytes[9] = b'7';
    let error = SavedCloths::from_bytes(&bytes).expect_err("another version");
    assert!(matches!(&error, RestoreError::Version { found, .. } if found.starts_with('7')), "{error}");
}

#[test]
fn serde_writes_and_reads_them() {
    let (mut app, cloth) = resting();
    let before = bits(&app, cloth);
    let text = ron::to_string(&SavedCloths::take(app.world())).expect("it can be written");
    app.world_mut().trigger(ResetCloth { entity: cloth });
    run(&mut app, 5);
    let read: SavedCloths = ron::from_str(&text).expect("it can be read");
    assert_eq!(read.entities().collect::<Vec<_>>(), [cloth]);
    read.restore(app.world_mut()).expect("it fits");
    assert_eq!(bits(&app, cloth), before);
    assert!(ron::from_str::<SavedCloths>(&text[..text.len() / 2]).is_err());
    assert!(ron::from_str::<SavedCloths>("b\"BevCloth\"").is_err());
}

/// Why the saved cloth is not put back while it has `other` in place of `usual`. Nothing must change then.
fn refusal<T: Component>(app: &mut App, saved: &SavedCloths, cloth: Entity, [other, usual]: [T; 2]) -> RestoreError {
    app.world_mut().entity_mut(cloth).insert(other);
    run(app, 1);
    let before = bits(app, cloth);
    let error = saved.restore(app.world_mut()).expect_err("it does not fit");
    assert_eq!(bits(app, cloth), before);
    app.world_mut().entity_mut(cloth).insert(usual);
    run(app, 2);
    error
}

#[test]
fn what_does_not_fit_is_refused_and_nothing_changes() {
    let (mut app, cloth) = resting();
    let saved = SavedCloths::take(app.world());
    let (app, saved) = (&mut app, &saved);
    let cells = [9, 8].map(|cells| Cloth::rectangle(0.3, 0.3).with_cells(cells, 8));
    assert_eq!(refusal(app, saved, cloth, cells), RestoreError::OtherShape(cloth));
    let scales = [2.0, 1.0].map(|scale| Transform::from_scale(Vec3::splat(scale)));
    assert_eq!(refusal(app, saved, cloth, scales), RestoreError::OtherShape(cloth));
    let other = |component| RestoreError::OtherComponent { entity: cloth, component };
    let fabrics = [Fabric::CANVAS, Fabric::default()];
    assert_eq!(refusal(app, saved, cloth, fabrics), other("Fabric"));
    assert_eq!(refusal(app, saved, cloth, [Pins::corners(), Pins::top()]), other("Pins"));
    let contacts = [0.5, 0.1].map(|friction| SelfContact { friction: Some(friction), ..default() });
    assert_eq!(refusal(app, saved, cloth, contacts), other("SelfContact"));
    app.world_mut().entity_mut(cloth).insert(SelfContact::default());
    let refused = [Fabric { areal_density: -1.0, ..default() }, Fabric::default()];
    assert_eq!(refusal(app, saved, cloth, refused), RestoreError::NoCloth(cloth));
    saved.restore(app.world_mut()).expect("it fits again");
    app.world_mut().despawn(cloth);
    assert_eq!(saved.restore(app.world_mut()), Err(RestoreError::NoCloth(cloth)));
    assert_eq!(saved.restore(&mut World::new()), Err(RestoreError::NoCloth(cloth)));
}

#[test]
fn cloths_that_were_not_saved_are_left_as_they_are() {
    let (mut app, first) = resting();
    let saved = SavedCloths::take(app.world());
    let second = app.world_mut().spawn((Cloth::rectangle(0.3, 0.3).with_cells(5, 5), Pins::top())).id();
    run(&mut app, 10);
    let (before, first_before) = (bits(&app, second), bits(&app, first));
    saved.restore(app.world_mut()).expect("it fits");
    assert_eq!((bits(&app, second), bits(&app, first)), (before.clone(), first_before));
    run(&mut app, 3);
    assert_ne!(bits(&app, second), before);
}
