//! Colliders against the particles, triangles and edges of a cloth: culling, push-out, friction.
//!
//! Each collider is met in its own frame: by all particles, and by those triangles and edges that are near its corners, edges or
//! axis. A plane meets particles alone; so does a ball or a capsule that is round for the cells, at a distance that covers what a
//! triangle sags between its corners.
//!
//! Contact comes last in a substep, after velocities are taken from the change of position: a push out of a collider
//! then never becomes velocity. What velocity there is into the surface is removed, and Coulomb friction takes from
//! the sliding as much as the removed part allows, in position and in velocity alike, so that cloth at rest does not
//! creep.

mod approach;
mod body;
mod cloth;
mod contact_points;
mod features;
mod furrow;
mod known_shape;
mod near;
mod near_mesh;
mod nearest;
mod patch;
mod respond;
mod shape;
mod surface;
mod touch;

pub(crate) use cloth::{Bounds, Hierarchy};
pub use cloth::{GroupContacts, SelfContact, SelfContacts, collide_self};
pub use contact_points::ContactPoint;
pub use known_shape::KnownShape;
pub(crate) use shape::segment;
pub use shape::{ConvexHull, Curved, Form, Shape, TriangleMesh};
pub use touch::Touch;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch};
use glam::Vec3;

use crate::body::Body;
use crate::lanes::{LANES, LEVEL, Vec3x8, splat};
use crate::tick::Substep;
use crate::{Fabric, Motion, Particles, Soa3, Topology, measure};
use approach::Arrival;
use body::Exchange;
use near::Near;
use patch::Patch;
use respond::Answer;
use surface::Surface;

/// A solid that cloth cannot enter, as it moves over one tick, in the cloth's frame.
#[derive(Clone, Debug)]
pub struct Collider {
    /// Its form, in its own frame.
    pub shape: Shape,
    /// Its pose at the start and at the end of the tick, in the cloth's frame.
    pub motion: Motion,
    /// Coulomb friction coefficient against this cloth, 0 or more, dimensionless.
    pub friction: f32,
}

/// What contact needs to know of a cloth, and what it found.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component))]
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// Distance kept between a particle and a collider's surface, m; see [`Contacts::offset_for`].
    pub offset: f32,
    /// Mean edge length of the cloth, m: see [`Contacts::least_substeps`]. 0 if not known.
    pub edge: f32,
    /// The colliders of this tick, in the cloth's frame.
    #[cfg_attr(feature = "save", serde(skip))]
    pub colliders: Vec<Collider>,
    /// The body that each of them is fixed to, among those of [`Constraints`](crate::constraint::Constraints::bodies): what cloth pushes.
    /// Others nothing moves.
    #[cfg_attr(feature = "save", serde(skip))]
    pub bodies: Vec<Option<u32>>,
    /// What each of them met in the last tick.
    pub touches: Vec<Touch>,
    /// Contacts of particles, triangles and edges with colliders in the last substep.
    pub touching: u32,
    /// How far the deepest point of the cloth was below the offset before it was pushed out in the last substep, m.
    pub deepest: f32,
    /// Square of the radius of the largest circle needed around a triangle of the cloth at rest, m².
    span: f32,
    /// Length of the longest edge at rest, m.
    longest: f32,
    near: Near,
    /// In the order of the colliders.
    arrivals: Vec<Arrival>,
    patch: Patch,
    /// 1 for slots that touched in this substep.
    touched: Vec<f32>,
    exchange: Exchange,
    /// While the cloth leaves a solid that it was deep inside of.
    leaving: Option<Leaving>,
}

/// A particle found inside a collider leaves it at this speed, m/s: one that was spawned inside, or that a collider was
/// put over. What enters during a substep is put back at once.
pub const DEPENETRATION_SPEED: f32 = 2.5;

/// How cloth leaves a solid that it was put into, or that was put over it.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug)]
struct Leaving {
    /// Kinetic energy at the end of the last substep, J.
    energy: f64,
    /// For how long it has gained no more than its weight gives it, s.
    calm: f32,
}

/// How long cloth that has left a solid must have gained nothing but what its weight gives it, s, until what it was pressed into on its
/// way has come apart.
const CALM: f32 = 0.1;

/// Cloth with a particle deeper inside a solid than that many mean edges is not where it can be: it was put there, or a solid over it.
const DEEP: f32 = 1.0;

/// What the longest edge may be stretched for that to hold.
const MOST_STRETCH: f32 = 1.5;

/// What a triangle may sag into a ball or a capsule for particles alone to meet it, in mean edges.
const MOST_SAG: f32 = 1.0 / 16.0;

impl Contacts {
    /// The distance to keep from colliders: half the fabric's thickness.
    pub fn offset_for(fabric: &Fabric) -> f32 {
        fabric.thickness / 2.0
    }

    /// Of a cloth of `fabric` over `topology`; no colliders.
    pub fn new(topology: &Topology, fabric: &Fabric) -> Self {
        let (edge, longest) = (mean_edge(topology), rest_lengths(topology).fold(0.0, f32::max));
        Self { offset: Self::offset_for(fabric), edge, span: span(topology), longest, ..Self::default() }
    }

    /// How far a triangle reaches into `shape` between its corners, if they are on it and that is too little to be seen: then
    /// particles stay off by so much more. `None` if the triangles and edges have to be met themselves.
    fn sag(&self, shape: &Shape) -> Option<f32> {
        let sag = self.span / (2.0 * shape.least_curvature_radius()?);
        Some(sag).filter(|sag| *sag <= MOST_SAG * self.edge)
    }

    /// Distance kept between a particle and the surface of `shape`, m.
    fn margin(&self, shape: &Shape) -> f32 {
        self.offset + self.sag(shape).unwrap_or(0.0)
    }

    /// The least number of substeps of a tick in which no collider near the particles moves farther than a quarter of an edge in
    /// one: what it strikes is then pulled along from edge to edge, and not torn out.
    pub fn least_substeps(&self, particles: &Particles) -> f32 {
        if self.edge <= 0.0 || self.colliders.iter().all(|collider| collider.motion.from == collider.motion.to) {
            return 1.0;
        }
        let (low, high) = dispatch!(*LEVEL, simd => bounds(simd, &particles.position));
        let moves = self.colliders.iter().map(|Collider { shape, motion: Motion { from, to }, .. }| {
            let radius = shape.bounding_radius();
            let turn = from.rotation.angle_between(to.rotation);
            // A plane turns about what of it is near the cloth.
            let arm = if radius.is_finite() { radius } else { from.position.distance(0.5 * (low + high)) };
            let distance = from.position.distance(to.position) + turn * arm;
            let away = from.position - from.position.clamp(low, high);
            if away.length() > radius + self.offset + distance { 0.0 } else { distance }
        });
        4.0 * moves.fold(0.0, f32::max) / self.edge
    }

    /// Whether the cloth is on its way out of a solid that it was deep inside of.
    pub const fn is_leaving(&self) -> bool {
        self.leaving.is_some()
    }

    /// Whether a particle at `point` touches a collider where that stands at the end of the tick: nearer than a tenth beyond the
    /// distance kept.
    pub fn touches(&self, point: Vec3) -> bool {
        self.normal_at(point).is_some()
    }

    /// The unit normal of the first collider that a particle at `point` touches, as [`Contacts::touches`] does.
    pub fn normal_at(&self, point: Vec3) -> Option<Vec3> {
        self.colliders.iter().find_map(|collider| {
            let (pose, most) = (collider.motion.to, 1.1 * self.margin(&collider.shape));
            let local = pose.inverse_point(point);
            // A plane has no bounding radius.
            if local.length_squared() > (collider.shape.bounding_radius() + most).powi(2) {
                return None;
            }
            let (distance, normal) = collider.shape.distance_and_normal(local);
            (distance < most).then(|| pose.rotation * normal)
        })
    }

    /// Replaces the colliders of this tick, keeping the allocation.
    pub fn set_colliders(&mut self, colliders: impl IntoIterator<Item = Collider>) {
        self.touches.clear();
        self.colliders.clear();
        self.colliders.extend(colliders);
        self.bodies.clear();
    }
}

fn mean_edge(topology: &Topology) -> f32 {
    rest_lengths(topology).sum::<f32>() / topology.edges.len().max(1) as f32
}

fn rest_lengths(topology: &Topology) -> impl Iterator<Item = f32> {
    topology.edges.iter().map(|&[a, b]| topology.rest[a as usize].distance(topology.rest[b as usize]))
}

/// Of the smallest circle around each triangle at rest the largest square of the radius, m².
fn span(topology: &Topology) -> f32 {
    let square = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|slot| topology.rest[slot as usize]);
        let sides = [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)];
        let longest = sides.into_iter().fold(0.0, f32::max);
        if 2.0 * longest >= sides.iter().sum() {
            return 0.25 * longest;
        }
        sides.iter().product::<f32>() / (4.0 * (b - a).cross(c - a).length_squared())
    };
    topology.triangles.iter().map(square).fold(0.0, f32::max)
}

/// One substep's worth of contact of a cloth over `topology` with every collider, in their order. Nothing moves those.
pub fn collide(topology: &Topology, particles: &mut Particles, contacts: &mut Contacts, sub: &Substep) {
    collide_with(topology, particles, contacts, &mut [], sub);
}

/// The same; colliders that are fixed to one of the `bodies` ([`Contacts::bodies`]) are pushed.
pub fn collide_with(
    topology: &Topology,
    particles: &mut Particles,
    contacts: &mut Contacts,
    bodies: &mut [Body],
    sub: &Substep,
) {
    (contacts.touching, contacts.deepest) = (0, 0.0);
    if contacts.colliders.is_empty() {
        contacts.leaving = None;
        return;
    }
    if sub.start <= 0.0 {
        contacts.touches.clear();
    }
    contacts.touches.resize(contacts.colliders.len(), Touch::default());
    let bound = contacts.leaving.map(|leaving| leaving.bound(particles, sub.h));
    let mut near = std::mem::take(&mut contacts.near);
    let mut patch = std::mem::take(&mut contacts.patch);
    let mut touched = std::mem::take(&mut contacts.touched);
    let mut arrivals = std::mem::take(&mut contacts.arrivals);
    touched.resize(particles.slots(), 0.0);
    arrivals.resize_with(contacts.colliders.len(), Arrival::default);
    let mut exchange = std::mem::take(&mut contacts.exchange);
    let mut arrives = false;
    let edge = contacts.edge;
    near.advance(particles, contacts.colliders.len());
    for (which, collider) in contacts.colliders.iter().enumerate() {
        let (shape, motion) = (&collider.shape, &collider.motion);
        let body = contacts.bodies.get(which).copied().flatten().and_then(|body| bodies.get_mut(body as usize));
        let mut poses = match &body {
            Some(body) => body.poses(motion, [sub.start, sub.end]),
            None if motion.from == motion.to => [motion.to; 2],
            None => [sub.start, sub.end].map(|time| motion.at(time)),
        };
        let arrival = &mut arrivals[which];
        let mut is_new = arrival.begin(shape, poses, edge);
        let sag = contacts.sag(shape);
        let margin = contacts.offset + sag.unwrap_or(0.0);
        is_new &= !near.is_far(shape, poses, margin);
        arrives |= is_new && arrival.yield_to((topology, particles), shape, [margin, edge]);
        let offsets = arrival.advance(sub.h);
        for (pose, offset) in poses.iter_mut().zip(offsets) {
            pose.position += offset;
        }
        arrives |= offsets[0] != Vec3::ZERO;
        if near.is_far(shape, poses, margin)
            || near.is_clear((topology, particles), which, shape, poses, [margin, edge])
        {
            continue;
        }
        let is_sharp = sag.is_none_or(|sag| {
            sag > 0.0 && near.is_stretched((topology, particles), edge, MOST_STRETCH * contacts.longest)
        });
        let is_slow = bound.is_some() && shape.mesh().is_none();
        let answer = Answer::new(collider, margin, offsets[1] - offsets[0], is_slow, sub.h);
        if body.is_some() {
            exchange.begin(particles);
        }
        let mut found;
        if shape.mesh().is_some() || near.relative(particles, shape, poses, edge) > patch::longest_stage(shape) {
            let part = near.part((topology, particles), which, shape, poses, [margin, edge], is_sharp);
            found = patch.collide((particles, &mut touched), part, shape, poses, &answer, sub.h);
        } else {
            found = dispatch!(*LEVEL, simd => respond::respond(simd, particles, &mut touched, shape, poses, &answer, sub.h));
            let longest = if is_sharp { near.longest((topology, particles), edge) } else { 0.0 };
            let gap = found.nearest - longest;
            if gap > margin {
                near.note((topology, particles), which, poses[1], [gap, edge]);
            }
            if is_sharp && gap < margin {
                let part = near.part((topology, particles), which, shape, poses, [margin, edge], is_sharp);
                let also = patch.touch((particles, &mut touched), part, shape, poses, &answer, sub.h);
                found.touch.join(&also.touch);
                found.deepest = found.deepest.max(also.deepest);
            }
        }
        if let Some(body) = body.filter(|_| found.touch.touching > 0) {
            exchange.settle(particles, body, sub.end, poses[1].position, &mut found.touch);
        }
        contacts.touches[which].add(&found.touch);
        contacts.touching += found.touch.touching;
        contacts.deepest = contacts.deepest.max(found.deepest);
        arrives |= found.buried > DEEP * edge;
        arrives |= arrival.is_buried_at_once(shape, [found.buried, edge])
            && arrival.yield_to((topology, particles), shape, [margin, edge]);
    }
    near.take_touched(&mut touched);
    (contacts.near, contacts.patch, contacts.touched, contacts.arrivals) = (near, patch, touched, arrivals);
    contacts.exchange = exchange;
    let calm = contacts.leaving.zip(bound).map(|(leaving, bound)| leaving.calm_after(particles, bound, sub.h));
    let calm = if arrives { Some(0.0) } else { calm.filter(|calm| *calm < CALM) };
    contacts.leaving = calm.map(|calm| Leaving { energy: measure::kinetic_energy(particles), calm });
}

impl Leaving {
    /// Takes from the speed of all particles what they have gained more than their weight gave them in the last `h` s: what is pushed
    /// out of a solid pushes the rest of the cloth along, through links that know nothing of it, and that is no speed either. Tells the
    /// energy that is allowed, J, and what part is left of what there was.
    fn bound(self, particles: &mut Particles, h: f32) -> [f64; 2] {
        let (gravity, mass) =
            (particles.acceleration.as_dvec3(), particles.mass.iter().map(|m| f64::from(*m)).sum::<f64>());
        let weight = measure::linear_momentum(particles).dot(gravity) * f64::from(h);
        // From rest it may fall, whatever else moves it.
        let fall = 0.5 * mass * gravity.length_squared() * f64::from(h).powi(2);
        let allowed = (self.energy + weight).max(fall);
        let now = measure::kinetic_energy(particles);
        if now <= allowed {
            return [allowed, 1.0];
        }
        let part = (allowed / now).sqrt() as f32;
        let Soa3 { x, y, z } = &mut particles.velocity;
        x.iter_mut().chain(y).chain(z).for_each(|v| *v *= part);
        [allowed, allowed / now]
    }

    /// For how long there has been no gain but what contact takes again, s: what lies on a solid with a load on it is drawn in and
    /// put back in every substep.
    fn calm_after(self, particles: &Particles, [allowed, part]: [f64; 2], h: f32) -> f32 {
        if measure::kinetic_energy(particles) <= allowed * part { self.calm + h } else { 0.0 }
    }
}

/// The box around all slots.
#[inline(always)]
fn bounds<S: Simd>(simd: S, position: &Soa3) -> (Vec3, Vec3) {
    let infinity = splat(simd, f32::INFINITY);
    let mut low = Vec3x8 { x: infinity, y: infinity, z: infinity };
    let mut high = Vec3x8 { x: -infinity, y: -infinity, z: -infinity };
    for group in 0..position.len() / LANES {
        let x = Vec3x8::load(simd, position, group * LANES);
        low = Vec3x8 { x: low.x.min(x.x), y: low.y.min(x.y), z: low.z.min(x.z) };
        high = Vec3x8 { x: high.x.max(x.x), y: high.y.max(x.y), z: high.z.max(x.z) };
    }
    (
        Vec3::new(low.x.reduce_min(), low.y.reduce_min(), low.z.reduce_min()),
        Vec3::new(high.x.reduce_max(), high.y.reduce_max(), high.z.reduce_max()),
    )
}
