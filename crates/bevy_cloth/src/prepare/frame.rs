//! Brings each cloth's frame, pins and hands up to this tick, and sets what acts on it.

use bevy::ecs::query::QueryData;
use bevy::prelude::*;
use cloth_solver::cloth::Constraints;
use cloth_solver::constraint::{Grab as SolverGrab, Pin};
use cloth_solver::contact::{Contacts, SelfContacts};
use cloth_solver::tick::{Effort, Pace};
use cloth_solver::{Fabric, Method, Motion, Particles, Pose, Soa3, Substep, Tick};

use super::placement::{Placement, Placements};
use super::{Anchors, Armature, Authored, Follow};
use crate::clock::ClothClock;
use crate::cloth::{ClothFrame, ClothHistory, ClothRejection, ClothTopology};
use crate::damage::{ClothFire, ClothPieces};
use crate::detail::{Level, Viewers};
use crate::events::{ClothRecovered, ClothReset, ResetCloth};
use crate::fault;
use crate::particle_pins::ParticlePins;
use crate::report::report;
use crate::settings::{Grab, Grabs, Gravity, Shared, Substeps};
use crate::sleep::{ClothAsleep, WakeCause, wake_up};
use crate::step::ClothTick;
use crate::teleport::{Teleport, TeleportPolicy};
use crate::weights::Loads;

/// What one cloth does in this tick.
#[derive(Component, Clone, Debug, Default)]
#[component(clone_behavior = Ignore)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct StepPlan {
    /// How many substeps it took, those that were repeated included; 0 if it stands in this tick.
    pub substeps: u32,
    /// The substep at hand; `None` for a cloth that has come to the end of the tick, or that has to repeat its substep.
    #[cfg_attr(feature = "serialize", serde(skip))]
    pub substep: Option<Substep>,
    /// The number of the group of cloths that it steps together with, if it does.
    pub group: Option<usize>,
    /// The least number of substeps that the group takes.
    pub at_least: f32,
    /// It has come to rest, and may fall asleep if its group has.
    pub at_rest: bool,
    #[cfg_attr(feature = "serialize", serde(skip))]
    tick: Option<Tick>,
    pace: Pace,
    /// What it was before the substep at hand was accepted.
    before: Pace,
    /// The substep at hand was too long.
    refused: bool,
    #[cfg_attr(feature = "serialize", serde(skip))]
    budget: Substeps,
    /// How much of it is computed.
    level: Level,
    /// Where each hand pulled to at the end of the last tick, in the world, and where it is on its way to.
    hands: Vec<(u32, Follow)>,
}

impl StepPlan {
    /// Lets the cloth take part in the tick.
    pub fn plan_substeps(&mut self, budget: &Substeps) {
        self.substeps = budget.count;
        self.budget = *budget;
    }

    /// How its ticks are divided at present.
    pub fn pace(&self) -> Pace {
        self.pace
    }

    /// Begins the tick.
    pub fn begin(&mut self, dt: f32, particles: &Particles, constraints: &Constraints, contacts: &Contacts) {
        self.tick = None;
        if self.substeps > 0 {
            let Substeps { count, max, iterations } = self.budget;
            let tick = constraints.adapt(particles, Tick { dt, substeps: count, most: max.max(count), iterations });
            self.pace.begin(&tick, contacts.least_substeps(particles).max(self.at_least));
            self.tick = Some(tick);
        }
    }

    /// Sees the hands before the first fixed step in a frame.
    pub fn look(&mut self, grabs: Option<&Grabs>, ticks: f32) {
        for grab in grabs.iter().flat_map(|grabs| &grabs.0) {
            if let Some((_, follow)) = self.hands.iter_mut().find(|(hand, _)| *hand == grab.hand) {
                follow.look(pulled_to(grab), ticks);
            }
        }
    }

    /// The hand of `grab`, as it was a tick ago if there was one.
    fn hand(&mut self, grab: &Grab) -> &mut Follow {
        let known = self.hands.iter().position(|(hand, _)| *hand == grab.hand);
        let index = known.unwrap_or_else(|| {
            self.hands.push((grab.hand, Follow::new(pulled_to(grab))));
            self.hands.len() - 1
        });
        &mut self.hands[index].1
    }

    /// How many substeps it asks for until the tick is over.
    pub fn left(&self) -> f32 {
        self.tick.as_ref().map_or(1.0, |tick| self.pace.left(tick))
    }

    /// Goes on to the next substep, if there is one, of so many that are `left`.
    pub fn next(&mut self, left: f32) -> bool {
        self.substep = self.tick.as_ref().and_then(|tick| self.pace.substep_of(tick, left));
        self.substep.is_some()
    }

    /// Takes note of what the substep at hand was like, of a cloth that steps together with others.
    pub fn judge(&mut self, effort: &Effort) {
        self.before = self.pace;
        let (Some(tick), Some(sub)) = (&self.tick, self.substep) else { return };
        self.refused = !self.pace.accept(tick, &sub, effort);
        self.substeps = self.pace.taken();
    }

    /// Whether the substep that was judged was too long.
    pub fn is_refused(&self) -> bool {
        self.substep.is_some() && self.refused
    }

    /// Has the substep at hand repeated, shorter.
    pub fn repeat(&mut self) {
        self.pace.repeat(self.before);
        self.substep = None;
    }

    /// Whether the substep at hand, having been like that, is taken; if not it is none any more.
    pub fn accepts(&mut self, effort: &Effort) -> bool {
        let (Some(tick), Some(sub)) = (&self.tick, self.substep) else { return false };
        let accepted = self.pace.accept(tick, &sub, effort);
        self.substeps = self.pace.taken();
        if !accepted {
            self.substep = None;
        }
        accepted
    }
}

/// Whatever moves takes what is frozen along.
const FROZEN: Teleport = Teleport { distance: 0.0, angle: 0.0, policy: TeleportPolicy::CarryAlong };

/// Whether something was moved that a cloth hangs on. In a pause it is carried along as by a hand.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub(crate) struct MovedInPause(pub bool);

/// Keeps [`MovedInPause`].
pub(crate) fn look_in_pause(
    cloths: Query<(Entity, &ClothFrame, &Anchors), Without<ClothRejection>>,
    placements: Placements,
    clock: Res<Time<ClothClock>>,
    mut moved: ResMut<MovedInPause>,
) {
    let stands = clock.context().stands();
    moved.0 = stands && cloths.iter().any(|(entity, frame, anchors)| has_moved(entity, frame, anchors, &placements));
}

/// Whether the entity of a cloth, or one that its pins hang on, is elsewhere than in the last tick.
fn has_moved(entity: Entity, frame: &ClothFrame, anchors: &Anchors, placements: &Placements) -> bool {
    let now = placements.get(entity).filter(Placement::is_finite);
    now.is_some_and(|now| now.pose != frame.pose) || anchors.have_moved(placements)
}

/// The runtime state of one cloth that takes part in this tick.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Ticking {
    entity: Entity,
    topology: &'static ClothTopology,
    fabric: Option<&'static Fabric>,
    frame: &'static mut ClothFrame,
    particles: &'static mut Particles,
    constraints: &'static mut Constraints,
    history: &'static mut ClothHistory,
    anchors: &'static mut Anchors,
    armature: Option<&'static Armature>,
    loads: &'static Loads,
    plan: &'static mut StepPlan,
    grabs: Option<&'static Grabs>,
    substeps: Option<&'static Substeps>,
    method: Option<&'static Method>,
    teleport: Option<&'static Teleport>,
}

/// Moves frames, pins and hands, keeps the shape for drawing between ticks, and plans the substeps.
pub(crate) fn advance(
    mut cloths: Query<Ticking, (Without<ClothRejection>, Without<ClothAsleep>)>,
    mut rejected: Query<&mut StepPlan, With<ClothRejection>>,
    placements: Placements,
    (substeps, method): (Res<Shared<Substeps>>, Res<Shared<Method>>),
    teleport: Res<Shared<Teleport>>,
    viewers: Viewers,
    tick: Res<ClothTick>,
    mut commands: Commands,
) {
    for mut plan in &mut rejected {
        plan.substeps = 0;
    }
    let seen_from = viewers.places(&placements);
    for mut cloth in &mut cloths {
        let held = cloth.grabs.is_some_and(|grabs| !grabs.0.is_empty());
        if tick.still && !held && !has_moved(cloth.entity, &cloth.frame, &cloth.anchors, &placements) {
            cloth.plan.substeps = 0;
            continue;
        }
        let (level, fewer) = viewers.level(cloth.entity, cloth.frame.pose.position, &seen_from, cloth.plan.level);
        let frozen_before = std::mem::replace(&mut cloth.plan.level, level) == Level::Frozen;
        if level == Level::Frozen && !tick.still {
            cloth.freeze(&placements, &tick, frozen_before);
            continue;
        }
        let lost = cloth.frame.lost;
        let teleport = *cloth.teleport.unwrap_or(&teleport);
        cloth.move_frame(&placements, &tick, &teleport);
        if !fault::is_finite(&cloth.particles) {
            cloth.recover();
            report(&mut commands, ClothRecovered { entity: cloth.entity });
        } else if cloth.frame.lost && !lost {
            report(&mut commands, ClothRecovered { entity: cloth.entity });
        }
        cloth.history.position.copy_from(&cloth.particles.position);
        let frame = *cloth.frame;
        cloth.anchors.advance(&frame, cloth.constraints.pin_frames_mut());
        if frame.carried && teleport.policy == TeleportPolicy::Reset {
            cloth.put_to_rest();
        }
        cloth.move_hands(&frame, &tick);
        cloth.set_method(cloth.method.copied().unwrap_or(method.0));
        let budget = *cloth.substeps.unwrap_or(&substeps);
        cloth.plan.plan_substeps(&fewer.map_or(budget, |fewer| budget.least(fewer)));
    }
}

impl TickingItem<'_, '_> {
    /// Moves the frame to where the entity stands now, or on its way there. Everything that is not pinned keeps its place in
    /// the world, unless what the cloth hangs on jumps.
    fn move_frame(&mut self, placements: &Placements, tick: &ClothTick, teleport: &Teleport) {
        let placement = placements.get(self.entity);
        let frame = &mut *self.frame;
        let finite = placement.filter(Placement::is_finite);
        frame.lost = placement.is_some() && finite.is_none();
        frame.follow.aim(finite.map_or(frame.follow.target, |placement| placement.pose), tick);
        self.anchors.aim(placements, tick);
        let carried = match teleport.policy {
            TeleportPolicy::Simulate => None,
            _ => self.anchors.carried(frame, &self.constraints.pins().pins, teleport),
        };
        if let Some(to) = carried {
            self.anchors.carry(&frame.pose, &to, teleport);
            if frame.follow.jumps(teleport) {
                frame.follow.carry(to);
            }
        }
        frame.carried = carried.is_some();
        frame.before = carried.unwrap_or(frame.pose);
        frame.pose = frame.follow.advance();
        if frame.pose != frame.before {
            let step = frame.step();
            let particles = &mut *self.particles;
            express(&mut particles.position, &step);
            express(&mut particles.previous, &step);
            express(&mut self.history.position, &step);
            express(&mut particles.velocity, &Pose::new(Vec3::ZERO, step.rotation));
        }
    }

    /// Lets it go along with what it hangs on, as it is.
    fn freeze(&mut self, placements: &Placements, tick: &ClothTick, was_frozen: bool) {
        self.plan.substeps = 0;
        self.move_frame(placements, tick, &FROZEN);
        let frame = *self.frame;
        self.anchors.advance(&frame, self.constraints.pin_frames_mut());
        if !was_frozen || frame.pose != frame.before {
            self.history.position.copy_from(&self.particles.position);
        }
        if !was_frozen {
            self.particles.velocity.fill(Vec3::ZERO);
        }
    }

    fn recover(&mut self) {
        let fabric = self.fabric.copied().unwrap_or_default();
        let Self { topology, loads, particles, constraints, history, .. } = self;
        fault::recover(&topology.0, &fabric, loads, particles, constraints, history);
    }

    /// Puts it in its rest shape where its pins end this tick. They stand in it.
    fn put_to_rest(&mut self) {
        let Self { topology, frame, particles, constraints, history, anchors, armature, .. } = self;
        for motion in constraints.pin_frames_mut() {
            motion.from = motion.to;
        }
        let place = anchors.home(frame);
        reset(particles, history, &topology.rest, constraints, &constraints.pins().pins, *armature, &place);
    }

    /// Goes on with `method` in the shape and at the speed it has.
    fn set_method(&mut self, method: Method) {
        if self.constraints.method() != method {
            self.constraints.set_method(&self.topology.0, method);
        }
    }

    /// Hands the grabs over to the solver in the cloth's frame, moving from where they pulled a tick ago.
    fn move_hands(&mut self, frame: &ClothFrame, tick: &ClothTick) {
        let (solver, plan) = (&mut self.constraints.grabs, &mut *self.plan);
        solver.clear();
        let Some(grabs) = self.grabs else {
            plan.hands.clear();
            return;
        };
        plan.hands.retain(|(hand, _)| grabs.0.iter().any(|grab| grab.hand == *hand));
        for grab in &grabs.0 {
            let hand = plan.hand(grab);
            hand.aim(pulled_to(grab), tick);
            let [from, to] = [hand.pose, hand.advance()].map(|pose| frame.to_local(pose.position));
            let Some(&particles) = self.topology.triangles.get(grab.triangle as usize) else { continue };
            solver.push(SolverGrab {
                particles,
                weights: grab.weights.to_array(),
                from,
                to,
                stiffness: grab.stiffness,
                max_force: grab.max_force,
            });
        }
    }
}

/// A hand has no orientation.
fn pulled_to(grab: &Grab) -> Pose {
    Pose::new(grab.target, Quat::IDENTITY)
}

/// Takes every point from the frame that `step` places to the frame it is placed in.
fn express(points: &mut Soa3, step: &Pose) {
    for i in 0..points.len() {
        points.set(i, step.point(points.get(i)));
    }
}

/// Sets gravity, in the cloth's frame.
pub(crate) fn weigh(
    mut cloths: Query<(&mut Particles, &ClothFrame, Option<&Gravity>, &StepPlan), Without<ClothAsleep>>,
    shared: Res<Shared<Gravity>>,
    tick: Res<ClothTick>,
) {
    for (mut particles, frame, gravity, plan) in &mut cloths {
        if plan.substeps > 0 {
            let gravity = if tick.still { Vec3::ZERO } else { gravity.unwrap_or(&shared).0 };
            particles.acceleration = frame.pose.rotation.conjugate() * gravity;
        }
    }
}

/// Puts a cloth back to its rest pose at `place`, the particles of `pins` to where those are.
fn reset(
    particles: &mut Particles,
    history: &mut ClothHistory,
    rest: &[Vec3],
    constraints: &Constraints,
    pins: &[Pin],
    armature: Option<&Armature>,
    place: &Pose,
) {
    let frames: &[Motion] = &constraints.pins().frames;
    match armature.and_then(|armature| armature.place(frames)) {
        Some(worn) => particles.position = Soa3::from_slice(&worn),
        None => (rest.iter().enumerate()).for_each(|(slot, rest)| particles.position.set(slot, place.point(*rest))),
    }
    for pin in pins {
        if let Some(motion) = frames.get(pin.frame as usize) {
            particles.position.set(pin.particle as usize, motion.to.point(pin.local));
        }
    }
    for (particle, point) in constraints.skin().iter().flat_map(|skin| &skin.pins) {
        particles.position.set(*particle as usize, point.point(|frame| frames[frame as usize].to));
    }
    particles.previous.copy_from(&particles.position);
    history.position.copy_from(&particles.position);
    particles.velocity.fill(Vec3::ZERO);
}

/// What of a cloth is put back.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Resettable {
    particles: &'static mut Particles,
    history: &'static mut ClothHistory,
    contacts: &'static mut Contacts,
    constraints: &'static mut Constraints,
    topology: &'static ClothTopology,
    frame: &'static mut ClothFrame,
    anchors: &'static mut Anchors,
    armature: Option<&'static Armature>,
    authored: &'static mut Authored,
    own: Option<&'static mut SelfContacts>,
    is_damaged: Has<ClothPieces>,
    fire: Option<&'static ClothFire>,
}

/// Answers [`ResetCloth`]. A cloth that was taken apart is built anew.
pub(crate) fn on_reset(
    asked: On<ResetCloth>,
    mut cloths: Query<Resettable>,
    placements: Placements,
    mut commands: Commands,
) {
    if let Ok(mut cloth) = cloths.get_mut(asked.entity) {
        if let Some(placement) = placements.get(asked.entity).filter(Placement::is_finite) {
            let pose = placement.pose;
            (cloth.frame.pose, cloth.frame.before, cloth.frame.follow) = (pose, pose, Follow::new(pose));
        }
        cloth.anchors.stand_still(&cloth.frame, cloth.constraints.pin_frames_mut(), &placements);
        let place = cloth.anchors.home(&cloth.frame);
        let (pins, armature) = (cloth.anchors.authored(), cloth.armature);
        let rest = &cloth.topology.rest;
        reset(&mut cloth.particles, &mut cloth.history, rest, &cloth.constraints, pins, armature, &place);
        commands.entity(asked.entity).try_remove::<ParticlePins>();
        (cloth.contacts.touching, cloth.contacts.deepest) = (0, 0.0);
        if let Some(own) = &mut cloth.own {
            own.reset(cloth.topology);
        }
        if cloth.is_damaged || cloth.fire.is_some_and(|fire| fire.scarred || fire.is_warm()) {
            cloth.authored.forget_shape();
        }
        wake_up(&mut commands, asked.entity, WakeCause::Particles);
        report(&mut commands, ClothReset { entity: asked.entity });
    }
}
