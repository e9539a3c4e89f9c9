//! The shape that is drawn: between the last two ticks, and where the things it hangs on are drawn.

mod carry;
mod spread;

use std::sync::Arc;

use bevy::prelude::*;
use cloth_solver::cloth::Constraints;
use cloth_solver::topology::Change;
use cloth_solver::{Particles, Pose, Topology};

use self::carry::Carry;
use self::spread::{Hung, Spread};
use crate::clock::{self, ClothClock, ClothTime};
use crate::cloth::{ClothFrame, ClothHistory, ClothTopology};
use crate::prepare::{Anchors, Armature, Placements};
use crate::schedule::ClothSystems;
use crate::sleep::ClothAsleep;

/// How long the shape drawn takes to settle when pins are made or released, or a piece comes off, s.
const SETTLE: f32 = 0.25;

/// Where the particles of a running cloth are drawn in this frame. Read-only.
///
/// It lies between the last two ticks, seen from what the cloth hangs on, and is placed where that is drawn: a cape does not
/// lag behind its wearer, whatever the frame rate. Pinned particles are exactly on their pins. The motion of several things
/// that a cloth hangs on is spread along the cloth between them. A piece that hangs on nothing is drawn between the last two ticks in the
/// world.
///
/// It is found in [`ClothSystems::Draw`](crate::ClothSystems::Draw), where there are mesh assets; without them it stays
/// empty. Simulated positions are in [`Particles`].
#[derive(Component, Clone, Debug, Default)]
#[component(clone_behavior = Ignore)]
pub struct ShownShape {
    /// The cloth's frame in the world.
    pose: Pose,
    /// Where each slot is drawn, cloth frame, m.
    position: Vec<Vec3>,
    /// How far from the shape between the last two ticks in the world each slot is drawn, along the world's axes, m. Empty if nowhere.
    ahead: Vec<Vec3>,
    /// How far each slot was from where it is to be when that jumped, along the world's axes, m. Empty if nowhere.
    slide: Vec<Vec3>,
    /// Time since then, s.
    slid: f32,
    /// How what moves it is spread over the cloth, and for what cloth that was found.
    spread: Spread,
    hung: Vec<Hung>,
    topology: Option<Arc<Topology>>,
    /// It was asleep when it was last drawn, and so is what is drawn.
    stands: bool,
}

impl ShownShape {
    /// Where each slot is drawn, in the cloth's own frame ([`ClothFrame`]), m. Empty if nothing is drawn yet.
    pub fn positions(&self) -> &[Vec3] {
        &self.position
    }

    /// Where a particle is drawn, in the world, m. `None` if nothing is drawn yet, or there is no such particle.
    pub fn in_world(&self, particle: u32) -> Option<Vec3> {
        self.position.get(particle as usize).map(|at| self.pose.point(*at))
    }

    /// Takes over what was torn, cut or burnt.
    pub(crate) fn follow(&mut self, change: &Change) {
        for points in [&mut self.position, &mut self.ahead, &mut self.slide] {
            if points.is_empty() {
                continue;
            }
            let last = points.last().copied().unwrap_or_default();
            points.resize(change.slots, last);
            for born in &change.born {
                points[born.slot as usize] = born.blend(|slot| points[slot]);
            }
        }
        self.spread.follow(change);
    }

    /// Forgets how motion is spread if what it hangs on or topology are others than before; gives what was known of it.
    fn look(&mut self, topology: &Arc<Topology>, constraints: &Constraints) -> Option<Spread> {
        // What is held within limits is taken along as what is pinned.
        let limits = constraints.skin().map_or(&[][..], |skin| &skin.limits).iter();
        let limited =
            limits.filter(|limit| limit.distance.is_finite()).map(|limit| (limit.particle, limit.point.frames[0]));
        let hung = constraints.pins().pins.iter().map(|pin| (pin.particle, pin.frame)).chain(limited);
        if hung.clone().eq(self.hung.iter().copied())
            && self.topology.as_ref().is_some_and(|known| Arc::ptr_eq(known, topology))
        {
            return None;
        }
        self.hung = hung.collect();
        self.topology = Some(topology.clone());
        Some(std::mem::take(&mut self.spread)).filter(|old| *old != Spread::Unknown)
    }

    /// Takes over the shape between the last two ticks; whether it is another one than before.
    fn update(
        &mut self,
        (topology, armature): (&Topology, Option<&Armature>),
        ticks: &Ticks,
        carry: &Carry,
        old: Option<Spread>,
        seconds: f32,
    ) -> bool {
        let (slots, turn) = (topology.slots(), ticks.pose.rotation);
        let first = self.position.len() != slots;
        self.position.resize(slots, Vec3::ZERO);
        let before = std::mem::take(&mut self.ahead);
        if self.spread == Spread::Unknown && !(carry.is_still() && old.is_none()) {
            self.spread = Spread::find(topology, &self.hung, armature);
        }
        if !carry.is_still() {
            self.ahead.resize(slots, Vec3::ZERO);
        }
        if let Some(old) = old.filter(|_| !first) {
            let left = self.left();
            self.slide.resize(slots, Vec3::ZERO);
            for slot in 0..slots {
                let (from, to) = ticks.at(slot);
                let place = |share| carry.place(share, from, to, ticks.between);
                let now = self.spread.of(slot);
                // What hangs on nothing now was as far ahead as in the last frame: what it hung on may be gone.
                let jump = match now.is_none() {
                    true => before.get(slot).copied().unwrap_or_default(),
                    false => turn * (place(old.of(slot)) - place(now)),
                };
                self.slide[slot] = self.slide[slot] * left + jump;
            }
            self.slid = 0.0;
        }
        let left = self.left();
        let mut moved = first;
        for slot in 0..slots {
            let (from, to) = ticks.at(slot);
            let mut now = from.lerp(to, ticks.between);
            if let Some(ahead) = self.ahead.get_mut(slot) {
                let plain = now;
                now = carry.place(self.spread.of(slot), from, to, ticks.between);
                *ahead = turn * (now - plain);
            }
            if let Some(slide) = self.slide.get(slot) {
                now += turn.conjugate() * *slide * left;
            }
            moved |= self.position[slot] != now;
            self.position[slot] = now;
        }
        let pinned = ticks.constraints.pins().pins.iter().map(|pin| (pin.particle, carry.pinned(pin)));
        let skin = ticks.constraints.skin().map_or(&[][..], |skin| &skin.pins).iter();
        let on_skin = skin.filter(|(particle, _)| ticks.particles.inverse_mass[*particle as usize] <= 0.0);
        let on_skin = on_skin.map(|(particle, point)| (*particle, carry.on_skin(point)));
        for (particle, at) in pinned.chain(on_skin) {
            if let (Some(at), Some(shown)) = (at, self.position.get_mut(particle as usize)) {
                moved |= *shown != at;
                *shown = at;
            }
        }
        self.slid += seconds;
        if left == 0.0 {
            self.slide.clear();
        }
        moved
    }

    /// What is left of a slide, 1 to 0.
    fn left(&self) -> f32 {
        let left = (1.0 - self.slid / SETTLE).max(0.0);
        left * left * (3.0 - 2.0 * left)
    }
}

/// The last two ticks of a cloth.
struct Ticks<'a> {
    pose: Pose,
    history: &'a ClothHistory,
    particles: &'a Particles,
    constraints: &'a Constraints,
    /// How far from the one to the other, 0..=1.
    between: f32,
}

impl Ticks<'_> {
    /// Where a particle was.
    fn at(&self, slot: usize) -> (Vec3, Vec3) {
        (self.history.position.get(slot), self.particles.position.get(slot))
    }
}

/// Finds where every cloth is drawn.
pub(crate) fn show(
    mut cloths: Query<(
        Entity,
        (&ClothTopology, &ClothFrame, &ClothHistory),
        (Ref<Particles>, &Constraints, &Anchors, Option<&Armature>),
        Has<ClothAsleep>,
        &mut ShownShape,
    )>,
    clock: Res<Time<ClothClock>>,
    time: Option<Res<Time>>,
    placements: Placements,
    mut carry: Local<Carry>,
) {
    let seconds = time.map_or(0.0, |time| time.delta_secs());
    for (entity, (topology, frame, history), (particles, constraints, anchors, armature), asleep, mut shape) in
        &mut cloths
    {
        let shown = shape.bypass_change_detection();
        carry.find(&constraints.pins().frames, anchors.now(entity, frame, &placements));
        let old = shown.look(&topology.0, constraints);
        // Between two equal positions rounding depends on the place: what sleeps is drawn once more, where it is.
        let stands = asleep && carry.is_still() && shown.slide.is_empty();
        let stood = std::mem::replace(&mut shown.stands, stands) && stands && !particles.is_changed();
        let between = if asleep { 1.0 } else { clock.interpolation() };
        shown.pose = frame.pose;
        let ticks = Ticks { pose: frame.pose, history, particles: &particles, constraints, between };
        if !stood && shown.update((&topology.0, armature), &ticks, &carry, old, seconds) {
            shape.set_changed();
        }
    }
}

/// Adds the system of this folder.
pub(crate) fn plugin(app: &mut App) {
    let has_meshes = resource_exists::<Assets<Mesh>>;
    app.add_systems(PostUpdate, show.run_if(has_meshes).after(clock::interpolate).in_set(ClothSystems::Draw));
}
