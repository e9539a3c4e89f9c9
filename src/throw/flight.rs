//! How a thrown ball flies: gravity, the push of cloth, and bounces off every other solid.

use std::time::Duration;

use bevy::prelude::*;
use bevy_cloth::cloth_solver::contact::Shape;
use bevy_cloth::{ClothClock, ClothCollider, ClothForce, ColliderShapes, Gravity, Shared};

use crate::tools::Dragged;

/// Mass of a ball, kg: that of a football.
pub const MASS: f32 = 0.43;
/// Part of its speed that a ball keeps when it bounces.
const RESTITUTION: f32 = 0.6;
/// What hits a solid more slowly than this stays on it, m/s.
const SLOWEST_BOUNCE: f32 = 0.4;
/// Part of the push of a solid that brakes the ball along its surface: the resistance to rolling.
const ROLLING: f32 = 0.05;
/// The farthest a ball moves between two looks at the solids, in its radii: none is thinner.
const STRIDE: f32 = 0.5;

/// A thrown ball.
#[derive(Component, Clone, Copy, Debug)]
pub struct Ball {
    /// The how-manyth it is.
    pub number: u32,
    /// Velocity, m/s.
    pub velocity: Vec3,
    /// Mass, kg.
    pub mass: f32,
    /// Where it was one tick ago, m.
    before: Vec3,
    /// Where the last tick left it, m.
    now: Vec3,
    /// The mean push of cloth in the tick before the last one, N.
    push: Vec3,
}

impl Ball {
    /// A ball that begins to fly at `at` (m) with `velocity` (m/s).
    pub fn new(number: u32, at: Vec3, velocity: Vec3) -> Self {
        Self { number, velocity, mass: MASS, before: at, now: at, push: Vec3::ZERO }
    }

    /// The same ball with another mass, kg.
    pub fn of_mass(self, mass: f32) -> Self {
        Self { mass, ..self }
    }

    /// The same ball under another number.
    pub fn renumbered(self, number: u32) -> Self {
        Self { number, ..self }
    }

    /// Where it is drawn at this part of the way from the tick before to the last one, m. One that was moved by hand is at
    /// `place`.
    pub fn shown_at(&self, place: Vec3, part: f32) -> Vec3 {
        if place == self.now { self.before.lerp(self.now, part) } else { place }
    }
}

/// A ball during a tick.
struct Flyer {
    entity: Entity,
    number: u32,
    radius: f32,
    mass: f32,
    at: Vec3,
    velocity: Vec3,
    flies: bool,
    push: Vec3,
}

/// A solid that a ball bounces off.
struct Solid<'a> {
    shape: &'a Shape,
    place: Vec3,
    rotation: Quat,
}

/// Moves every ball by one tick. A ball that is moved by hand stands there until it is let go.
pub fn fly(
    mut balls: Query<(Entity, &mut Ball, &mut Transform, &ClothForce)>,
    solids: Query<(Entity, &GlobalTransform), (With<ClothCollider>, Without<Ball>)>,
    shapes: ColliderShapes,
    (time, gravity): (Res<Time<ClothClock>>, Res<Shared<Gravity>>),
    dragged: Option<Res<Dragged>>,
    mut last: Local<Duration>,
) {
    // While the clock is paused and a hand pulls a cloth, ticks come in which no time passes.
    if std::mem::replace(&mut *last, time.elapsed()) == time.elapsed() || balls.is_empty() {
        return;
    }
    let dt = time.delta_secs();
    let solids = solids.iter().filter_map(|(entity, place)| Some(Solid::new(shapes.get(entity)?, place)));
    let solids: Vec<Solid> = solids.collect();
    let dragged = dragged.and_then(|dragged| dragged.0);
    let mut flyers: Vec<Flyer> = (balls.iter())
        .filter_map(|(entity, ball, place, cloth)| {
            let radius = shapes.get(entity)?.bounding_radius();
            let flies = dragged != Some(entity) && place.translation == ball.now && radius.is_finite();
            // The push between two ticks, half a tick after the mean of the last one: without this, pushes come too late, and
            // a bounce off taut cloth gains a quarter of the ball's energy.
            let push = 1.5 * cloth.force - 0.5 * ball.push;
            let velocity = if flies { ball.velocity + push / ball.mass * dt } else { Vec3::ZERO };
            Some(Flyer {
                entity,
                number: ball.number,
                radius,
                mass: ball.mass,
                at: place.translation,
                velocity,
                flies,
                push: cloth.force,
            })
        })
        .collect();
    flyers.sort_unstable_by_key(|flyer| flyer.number);
    for index in 0..flyers.len() {
        if flyers[index].flies {
            advance(&mut flyers, index, &solids, gravity.0.0, dt);
        }
    }
    for flyer in flyers {
        if let Ok((_, mut ball, mut place, _)) = balls.get_mut(flyer.entity) {
            (ball.before, ball.now, ball.velocity) = (place.translation, flyer.at, flyer.velocity);
            ball.push = flyer.push;
            if place.translation != flyer.at {
                place.translation = flyer.at;
            }
        }
    }
}

/// Moves one of the balls by `dt` (s), in strides that pass nothing.
fn advance(flyers: &mut [Flyer], index: usize, solids: &[Solid], gravity: Vec3, dt: f32) {
    let ball = &mut flyers[index];
    ball.velocity += 0.5 * gravity * dt;
    let strides = (ball.velocity.length() * dt / (STRIDE * ball.radius)).ceil().max(1.0);
    let h = dt / strides;
    for _ in 0..strides as u32 {
        let ball = &mut flyers[index];
        ball.at += ball.velocity * h;
        for solid in solids {
            ball.meet(solid);
        }
        for other in (0..flyers.len()).filter(|other| *other != index) {
            if let Ok([ball, other]) = flyers.get_disjoint_mut([index, other]) {
                ball.meet_ball(other);
            }
        }
    }
    flyers[index].velocity += 0.5 * gravity * dt;
}

impl Flyer {
    fn meet(&mut self, solid: &Solid) {
        let (distance, normal) = solid.distance_and_normal(self.at);
        if distance < self.radius {
            self.at += normal * (self.radius - distance);
            self.velocity += bounce(self.velocity, normal);
        }
    }

    /// Two balls share the bounce, each as much as the other is heavy.
    fn meet_ball(&mut self, other: &mut Self) {
        let apart = self.at - other.at;
        let (distance, normal) = (apart.length(), apart.normalize_or(Vec3::Y));
        if distance < self.radius + other.radius {
            self.at += normal * (self.radius + other.radius - distance);
            let change = bounce(self.velocity - other.velocity, normal) / (self.mass + other.mass);
            self.velocity += other.mass * change;
            if other.flies {
                other.velocity -= self.mass * change;
            }
        }
    }
}

/// What a bounce off a surface with that normal adds to a velocity, m/s.
fn bounce(velocity: Vec3, normal: Vec3) -> Vec3 {
    let approach = -velocity.dot(normal);
    if approach <= 0.0 {
        return Vec3::ZERO;
    }
    let kept = if approach > SLOWEST_BOUNCE { RESTITUTION } else { 0.0 };
    let push = (1.0 + kept) * approach;
    let along = velocity + approach * normal;
    push * normal - along.clamp_length_max(ROLLING * push)
}

impl<'a> Solid<'a> {
    fn new(shape: &'a Shape, place: &GlobalTransform) -> Self {
        let (_, rotation, place) = place.to_scale_rotation_translation();
        Self { shape, place, rotation }
    }

    fn distance_and_normal(&self, at: Vec3) -> (f32, Vec3) {
        let (distance, normal) = self.shape.distance_and_normal(self.rotation.inverse() * (at - self.place));
        (distance, self.rotation * normal)
    }
}
