//! A wearer that moves in every way a game may move it, and a cape on it.

use std::time::Duration;

use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_cloth::*;

use super::{TICK, get, run, with_transforms};

/// A sequence of numbers in 0..1 from a seed (Steele, Lea and Flood 2014: splitmix).
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1_u64 << 24) as f32
    }

    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.next()
    }
}

/// Moves on a path through the origin.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Mover {
    pub velocity: Vec3,
    pub turn: Vec3,
    /// Stands before this time, and from the other on, s.
    pub from: f32,
    pub to: f32,
}

impl Mover {
    pub fn step(&self, place: &mut Transform, time: &Time) {
        let now = time.elapsed_secs();
        if now > self.from && now <= self.to {
            place.translation += self.velocity * time.delta_secs();
            place.rotate(Quat::from_scaled_axis(self.turn * time.delta_secs()));
        }
    }
}

pub fn step(mut movers: Query<(&Mover, &mut Transform)>, time: Res<Time>) {
    for (mover, mut place) in &mut movers {
        mover.step(&mut place, &time);
    }
}

/// When the wearer is moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moved {
    InUpdate,
    InFixedUpdate,
    ByAnimation,
}

pub const MOVED: [Moved; 3] = [Moved::InUpdate, Moved::InFixedUpdate, Moved::ByAnimation];

/// What the top of the cape is pinned to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Worn {
    /// The cape's own entity, a child of the wearer.
    AsChild,
    /// A child of the wearer; the cape's entity stays where it is.
    ByEntity,
    /// Two children of the wearer, that move by themselves as well.
    ByTwo,
    /// The world, while the cape's entity moves.
    ToWorld,
}

pub const WORN: [Worn; 4] = [Worn::AsChild, Worn::ByEntity, Worn::ByTwo, Worn::ToWorld];

pub const CELLS: u32 = 6;

pub struct Scene {
    pub app: App,
    pub cape: Entity,
    /// What each vertex of the top row hangs on, and where in its frame that is.
    pub pins: Vec<(Option<Entity>, Vec3)>,
}

pub fn scene(worn: Worn, moved: Moved, mover: Mover, more: impl Bundle) -> Scene {
    let mut app = with_transforms();
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
    pub fn frame(&mut self, seconds: f32) {
        self.app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(seconds)));
        self.app.update();
    }

    /// The middle between both faces of each particle's vertex as drawn, in the entity's space.
    pub fn drawn_local(&self) -> Vec<Vec3> {
        let mesh = self.app.world().resource::<Assets<Mesh>>().get(&get::<Mesh3d>(&self.app, self.cape).0);
        let Some(VertexAttributeValues::Float32x3(at)) = mesh.expect("a mesh").attribute(Mesh::ATTRIBUTE_POSITION)
        else {
            panic!("no positions")
        };
        let (front, back) = at.split_at(at.len() / 2);
        front.iter().zip(back).map(|(a, b)| 0.5 * (Vec3::from_array(*a) + Vec3::from_array(*b))).collect()
    }

    pub fn drawn(&self) -> Vec<Vec3> {
        let place = get::<GlobalTransform>(&self.app, self.cape);
        self.drawn_local().into_iter().map(|at| place.transform_point(at)).collect()
    }

    /// The same, seen from the first thing that it hangs on.
    pub fn drawn_from_wearer(&self) -> Vec<Vec3> {
        let place =
            self.pins[0].0.map_or(GlobalTransform::IDENTITY, |entity| *get::<GlobalTransform>(&self.app, entity));
        let back = place.affine().inverse();
        self.drawn().into_iter().map(|at| back.transform_point3(at)).collect()
    }

    /// How far the farthest pinned vertex is drawn from its pin, m.
    pub fn lag(&self) -> f32 {
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
pub enum Frames {
    Hertz(f32),
    Irregular,
}

pub const FRAMES: [Frames; 6] = [
    Frames::Hertz(24.0),
    Frames::Hertz(30.0),
    Frames::Hertz(60.0),
    Frames::Hertz(144.0),
    Frames::Hertz(240.0),
    Frames::Irregular,
];

impl Frames {
    pub fn next(self, numbers: &mut Numbers) -> f32 {
        match self {
            Self::Hertz(hertz) => 1.0 / hertz,
            Self::Irregular => numbers.between(0.002, 0.06),
        }
    }
}

pub fn direction(numbers: &mut Numbers) -> Vec3 {
    let to = Vec3::from_array([(); 3].map(|()| numbers.between(-1.0, 1.0)));
    to.try_normalize().unwrap_or(Vec3::X)
}
