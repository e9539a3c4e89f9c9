//! Brings each cloth's frame, pins and hands up to this tick, and sets what acts on it.

use bevy::ecs::query::QueryData;
use bevy::prelude::*;
use cloth_solver::cloth::Constraints;
use cloth_solver::constraint::Grab as SolverGrab;
use cloth_solver::contact::Contacts;
use cloth_solver::tick::{Effort, Pace};
use cloth_solver::{Fabric, Method, Particles, Pose, Soa3, Substep, Tick};

use super::placement::{Placement, Placements};
use super::{Anchors, Authored};
use crate::cloth::{ClothFrame, ClothHistory, ClothRejection, ClothTopology};
use crate::damage::{ClothFire, ClothPieces};
use crate::events::{ClothRecovered, ClothReset, ResetCloth};
use crate::fault;
use crate::report::report;
use crate::settings::{Grabs, Gravity, Shared, Substeps};
use crate::step::ClothTick;
use crate::weights::Loads;

/// A cloth whose frame goes farther than this in one tick, m, is taken along in the shape it has. At 640 m/s and more
/// nothing could be simulated that anybody sees; it is a jump of the player or of the world's origin.
const TELEPORT: f32 = 10.0;

/// What one cloth does in this tick.
#[derive(Component, Clone, Debug, Default)]
#[component(clone_behavior = Ignore)]
pub(crate) struct StepPlan {
    /// How many substeps it took, those that were repeated included; 0 if it stands in this tick.
    pub substeps: u32,
    /// The substep at hand; `None` for a cloth that has come to the end of the tick, or that has to repeat its substep.
    pub substep: Option<Substep>,
    tick: Option<Tick>,
    pace: Pace,
    budget: Substeps,
    /// Where each hand pulled to at the end of the last tick, in the world.
    hands: Vec<(u32, Vec3)>,
}

impl StepPlan {
    fn plan_substeps(&mut self, budget: &Substeps) {
        self.substeps = budget.count;
        self.budget = *budget;
    }

    /// Begins the tick.
    pub fn begin(&mut self, dt: f32, particles: &Particles, constraints: &Constraints, contacts: &Contacts) {
        self.tick = None;
        if self.substeps > 0 {
            let Substeps { count, max, iterations } = self.budget;
            let tick = constraints.adapt(particles, Tick { dt, substeps: count, most: max.max(count), iterations });
            self.pace.begin(&tick, contacts.least_substeps(particles));
            self.tick = Some(tick);
        }
    }

    /// Goes on to the next substep, if there is one.
    pub fn next(&mut self) -> bool {
        self.substep = self.tick.as_ref().and_then(|tick| self.pace.substep(tick));
        self.substep.is_some()
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
    loads: &'static Loads,
    plan: &'static mut StepPlan,
    grabs: Option<&'static Grabs>,
    substeps: Option<&'static Substeps>,
    method: Option<&'static Method>,
}

/// Moves frames, pins and hands, keeps the shape for drawing between ticks, and plans the substeps.
pub(crate) fn advance(
    mut cloths: Query<Ticking, Without<ClothRejection>>,
    mut rejected: Query<&mut StepPlan, With<ClothRejection>>,
    placements: Placements,
    substeps: Res<Shared<Substeps>>,
    method: Res<Shared<Method>>,
    tick: Res<ClothTick>,
    mut commands: Commands,
) {
    for mut plan in &mut rejected {
        plan.substeps = 0;
    }
    for mut cloth in &mut cloths {
        let held = cloth.grabs.is_some_and(|grabs| !grabs.0.is_empty());
        if tick.still && !held {
            cloth.plan.substeps = 0;
            continue;
        }
        let lost = cloth.frame.lost;
        cloth.move_frame(placements.get(cloth.entity));
        if !fault::is_finite(&cloth.particles) {
            cloth.recover();
            report(&mut commands, ClothRecovered { entity: cloth.entity });
        } else if cloth.frame.lost && !lost {
            report(&mut commands, ClothRecovered { entity: cloth.entity });
        }
        cloth.history.position.copy_from(&cloth.particles.position);
        let frame = *cloth.frame;
        cloth.anchors.advance(&frame, &placements, cloth.constraints.pin_frames_mut());
        cloth.move_hands(&frame);
        cloth.set_method(cloth.method.copied().unwrap_or(method.0));
        cloth.plan.plan_substeps(cloth.substeps.unwrap_or(&substeps));
    }
}

impl TickingItem<'_, '_> {
    /// Moves the frame to where the entity stands now. Everything that is not pinned keeps its place in the world,
    /// unless the frame jumps.
    fn move_frame(&mut self, placement: Option<Placement>) {
        let frame = &mut *self.frame;
        let finite = placement.filter(Placement::is_finite);
        frame.lost = placement.is_some() && finite.is_none();
        frame.before = frame.pose;
        frame.pose = finite.map_or(frame.pose, |placement| placement.pose);
        if frame.pose.position.distance(frame.before.position) > TELEPORT {
            frame.before = frame.pose;
        }
        if frame.pose != frame.before {
            let step = frame.step();
            let particles = &mut *self.particles;
            express(&mut particles.position, &step);
            express(&mut particles.previous, &step);
            express(&mut self.history.position, &step);
            express(&mut particles.velocity, &Pose::new(Vec3::ZERO, step.rotation));
        }
    }

    fn recover(&mut self) {
        let fabric = self.fabric.copied().unwrap_or_default();
        let Self { topology, loads, particles, constraints, history, .. } = self;
        fault::recover(&topology.0, &fabric, loads, particles, constraints, history);
    }

    /// Goes on with `method` in the shape and at the speed it has.
    fn set_method(&mut self, method: Method) {
        if self.constraints.method() != method {
            self.constraints.set_method(&self.topology.0, method);
        }
    }

    /// Hands the grabs over to the solver in the cloth's frame, moving from where they pulled a tick ago.
    fn move_hands(&mut self, frame: &ClothFrame) {
        let (solver, plan) = (&mut self.constraints.grabs, &mut *self.plan);
        solver.clear();
        let Some(grabs) = self.grabs else {
            plan.hands.clear();
            return;
        };
        for grab in &grabs.0 {
            let Some(&particles) = self.topology.triangles.get(grab.triangle as usize) else { continue };
            let before = plan.hands.iter().find(|(hand, _)| *hand == grab.hand).map_or(grab.target, |(_, at)| *at);
            solver.push(SolverGrab {
                particles,
                weights: grab.weights.to_array(),
                from: frame.to_local(before),
                to: frame.to_local(grab.target),
                stiffness: grab.stiffness,
                max_force: grab.max_force,
            });
        }
        plan.hands.clear();
        plan.hands.extend(grabs.0.iter().map(|grab| (grab.hand, grab.target)));
    }
}

/// Takes every point from the frame that `step` places to the frame it is placed in.
fn express(points: &mut Soa3, step: &Pose) {
    for i in 0..points.len() {
        points.set(i, step.point(points.get(i)));
    }
}

/// Sets gravity, in the cloth's frame.
pub(crate) fn weigh(
    mut cloths: Query<(&mut Particles, &ClothFrame, Option<&Gravity>, &StepPlan)>,
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

/// Puts a cloth back to its rest pose, pinned particles to where their pins are.
pub(crate) fn reset(particles: &mut Particles, history: &mut ClothHistory, rest: &[Vec3], constraints: &Constraints) {
    for (slot, rest) in rest.iter().enumerate() {
        particles.position.set(slot, *rest);
    }
    let pins = constraints.pins();
    for pin in &pins.pins {
        if let Some(motion) = pins.frames.get(pin.frame as usize) {
            particles.position.set(pin.particle as usize, motion.to.point(pin.local));
        }
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
    constraints: &'static Constraints,
    topology: &'static ClothTopology,
    authored: &'static mut Authored,
    is_damaged: Has<ClothPieces>,
    fire: Option<&'static ClothFire>,
}

/// Answers [`ResetCloth`]. A cloth that was taken apart is built anew.
pub(crate) fn on_reset(asked: On<ResetCloth>, mut cloths: Query<Resettable>, mut commands: Commands) {
    if let Ok(mut cloth) = cloths.get_mut(asked.entity) {
        reset(&mut cloth.particles, &mut cloth.history, &cloth.topology.rest, cloth.constraints);
        (cloth.contacts.touching, cloth.contacts.deepest) = (0, 0.0);
        if cloth.is_damaged || cloth.fire.is_some_and(|fire| fire.scarred || fire.is_warm()) {
            cloth.authored.forget_shape();
        }
        report(&mut commands, ClothReset { entity: asked.entity });
    }
}
