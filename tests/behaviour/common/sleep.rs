//! Random cloths that sleep.

use bevy::prelude::*;
use bevy_cloth::*;
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

use super::*;

/// Longest time in which a cloth must have come to rest, s.
pub const LONG: f32 = 30.0;

/// So many ticks are that long.
pub fn ticks(seconds: f32) -> usize {
    (seconds / TICK.as_secs_f32()).round() as usize
}

pub fn is_asleep(app: &App, cloth: Entity) -> bool {
    app.world().entity(cloth).contains::<ClothAsleep>()
}

/// Runs until the cloth is asleep, and tells how many ticks that took.
pub fn run_to_sleep(app: &mut App, cloth: Entity) -> usize {
    for tick in 0..ticks(LONG) {
        if is_asleep(app, cloth) {
            return tick;
        }
        app.update();
    }
    let speed = &get::<Particles>(app, cloth).velocity;
    let fastest = (0..speed.len()).map(|slot| speed.get(slot).length()).fold(0.0, f32::max);
    panic!("awake after {LONG} s; its fastest particle goes at {fastest} m/s")
}

/// A cloth somewhere in the world.
pub struct Bed {
    pub app: App,
    pub cloth: Entity,
    /// Where it hangs, or its parent if it has one.
    pub place: Entity,
    pub random: Xoshiro256PlusPlus,
}

impl Bed {
    /// A random cloth in still air that swings down by some of its upper edge, from its own entity or from its parent's.
    pub fn swinging(seed: u64) -> Self {
        Self::tilted(seed, 1.5)
    }

    /// The same, but upright from the beginning.
    pub fn hanging(seed: u64) -> Self {
        Self::tilted(seed, 0.01)
    }

    fn tilted(seed: u64, tilt: f32) -> Self {
        let mut app = headless();
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let size = Vec2::new(random.random_range(0.2..0.8), random.random_range(0.2..0.8));
        let cells = [(); 2].map(|()| random.random_range(3..9));
        let (_, fabric) = Fabric::PRESETS[random.random_range(0..Fabric::PRESETS.len())];
        let pins = match random.random_range(0..3) {
            0 => Pins::top(),
            1 => Pins::corners(),
            _ => Pins::rods(random.random_range(2..5)),
        };
        let cloth = Cloth::rectangle(size.x, size.y).with_cells(cells[0], cells[1]);
        let place = Vec3::from_array([(); 3].map(|()| random.random_range(-50.0..50.0)));
        let turn = Quat::from_rotation_y(random.random_range(-3.0..3.0));
        let turn = turn * Quat::from_rotation_x(random.random_range(0.0..tilt));
        let place = Transform::from_translation(place).with_rotation(turn);
        let world = app.world_mut();
        let cloth = world.spawn((cloth, pins, fabric, Air::default(), ClothStats::default())).id();
        let place = if random.random() {
            world.entity_mut(cloth).insert(Transform::from_xyz(0.1, 0.0, 0.0));
            world.spawn(place).add_child(cloth).id()
        } else {
            world.entity_mut(cloth).insert(place).id()
        };
        app.update();
        note_events::<ClothFellAsleep>(&mut app);
        note_events::<ClothWoke>(&mut app);
        Self { app, cloth, place, random }
    }

    /// One that hangs, asleep.
    pub fn asleep(seed: u64) -> Self {
        let mut bed = Self::hanging(seed);
        run_to_sleep(&mut bed.app, bed.cloth);
        bed
    }

    pub fn entity(&mut self) -> EntityWorldMut<'_> {
        self.app.world_mut().entity_mut(self.cloth)
    }

    pub fn world(&mut self) -> &mut World {
        self.app.world_mut()
    }

    /// Where one of its particles is, in the world, m.
    pub fn particle(&mut self) -> Vec3 {
        let positions = world_positions(&self.app, self.cloth);
        positions[self.random.random_range(0..positions.len())]
    }

    /// Why it woke, as often as it did.
    pub fn causes(&self) -> Vec<WakeCause> {
        seen::<ClothWoke>(&self.app).iter().map(|woke| woke.cause).collect()
    }
}

/// Does it to seeded random cloths that are asleep. Each must wake in the very next tick, for that cause.
pub fn assert_wakes(expected: WakeCause, prepare: impl Fn(&mut Bed), disturb: impl Fn(&mut Bed)) {
    for seed in 0..cases(1, 4) {
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
pub fn assert_sleeps_on(prepare: impl Fn(&mut Bed), disturb: impl Fn(&mut Bed)) {
    for seed in 0..cases(1, 4) {
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

/// Leaves it as it is.
pub fn nothing(_: &mut Bed) {}
