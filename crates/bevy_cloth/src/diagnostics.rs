//! Time per phase and totals, as Bevy diagnostics.

use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::ecs::schedule::ScheduleConfigs;
use bevy::ecs::system::ScheduleSystem;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use cloth_solver::cloth::Constraints;
use cloth_solver::contact::Contacts;
use cloth_solver::{Particles, measure};

use crate::cloth::ClothTopology;
use crate::schedule::{ClothSchedule, ClothSystems};
use crate::sleep::ClothAsleep;
use crate::substeps::SubstepTimes;

/// Measures, once a frame, how long each phase of the ticks of that frame took, and counts particles, constraints and
/// contacts of all clothes. Not part of [`ClothPlugin`](crate::ClothPlugin): without it nothing is measured.
///
/// A frame without a tick adds nothing to the times.
#[derive(Clone, Copy, Debug, Default)]
pub struct ClothDiagnosticsPlugin;

impl ClothDiagnosticsPlugin {
    /// Time in [`ClothSystems::Prepare`], ms per frame.
    pub const PREPARE: DiagnosticPath = DiagnosticPath::const_new("cloth/prepare_ms");
    /// Time in [`ClothSystems::Forces`], ms per frame.
    pub const FORCES: DiagnosticPath = DiagnosticPath::const_new("cloth/forces_ms");
    /// Time in [`ClothSystems::Substep`], ms per frame: the next three and the loop around them.
    pub const SUBSTEP: DiagnosticPath = DiagnosticPath::const_new("cloth/substep_ms");
    /// Time in the plugin's part of [`ClothSystems::Integrate`], ms per frame. Where cloths take their substeps on several threads at once
    /// this and the next two are shares of the time that passed.
    pub const INTEGRATE: DiagnosticPath = DiagnosticPath::const_new("cloth/integrate_ms");
    /// Time in the plugin's part of [`ClothSystems::Solve`], ms per frame.
    pub const SOLVE: DiagnosticPath = DiagnosticPath::const_new("cloth/solve_ms");
    /// Time in the plugin's part of [`ClothSystems::Collide`], ms per frame.
    pub const COLLIDE: DiagnosticPath = DiagnosticPath::const_new("cloth/collide_ms");
    /// Time in [`ClothSystems::Tear`], ms per frame.
    pub const TEAR: DiagnosticPath = DiagnosticPath::const_new("cloth/tear_ms");
    /// Time in [`ClothSystems::Burn`], ms per frame.
    pub const BURN: DiagnosticPath = DiagnosticPath::const_new("cloth/burn_ms");
    /// Time in [`ClothSystems::Writeback`], ms per frame.
    pub const WRITEBACK: DiagnosticPath = DiagnosticPath::const_new("cloth/writeback_ms");
    /// Time in [`ClothSystems::Draw`], ms per frame. Other systems of [`PostUpdate`] that run at the same time on the same threads
    /// count, too.
    pub const DRAW: DiagnosticPath = DiagnosticPath::const_new("cloth/draw_ms");
    /// Particles of all clothes.
    pub const PARTICLES: DiagnosticPath = DiagnosticPath::const_new("cloth/particles");
    /// Constraints of all clothes, solved in each substep.
    pub const CONSTRAINTS: DiagnosticPath = DiagnosticPath::const_new("cloth/constraints");
    /// Particles that touched a collider in the last substep.
    pub const CONTACTS: DiagnosticPath = DiagnosticPath::const_new("cloth/contacts");
    /// Cloths that are asleep, see [`ClothSleep`](crate::ClothSleep).
    pub const ASLEEP: DiagnosticPath = DiagnosticPath::const_new("cloth/asleep");
    /// Largest strain of any cloth, %.
    pub const LARGEST_STRAIN: DiagnosticPath = DiagnosticPath::const_new("cloth/largest_strain");
}

/// The phases of a tick, and the diagnostic of each.
const TICK: [(ClothSystems, &DiagnosticPath); 6] = [
    (ClothSystems::Prepare, &ClothDiagnosticsPlugin::PREPARE),
    (ClothSystems::Forces, &ClothDiagnosticsPlugin::FORCES),
    (ClothSystems::Substep, &ClothDiagnosticsPlugin::SUBSTEP),
    (ClothSystems::Tear, &ClothDiagnosticsPlugin::TEAR),
    (ClothSystems::Burn, &ClothDiagnosticsPlugin::BURN),
    (ClothSystems::Writeback, &ClothDiagnosticsPlugin::WRITEBACK),
];
/// The diagnostics of the phases of a substep.
const SUBSTEP: [&DiagnosticPath; 3] =
    [&ClothDiagnosticsPlugin::INTEGRATE, &ClothDiagnosticsPlugin::SOLVE, &ClothDiagnosticsPlugin::COLLIDE];

/// A stopwatch over the phases of one schedule: laps between them, summed over a frame.
struct Stopwatch<const PHASES: usize> {
    lap: Option<Instant>,
    seconds: [f64; PHASES],
}

impl<const PHASES: usize> Stopwatch<PHASES> {
    const NEW: Self = Self { lap: None, seconds: [0.0; PHASES] };

    fn start(&mut self) {
        self.lap = Some(Instant::now());
    }

    /// The seconds of each phase; counts from zero again.
    fn take(&mut self) -> [f64; PHASES] {
        self.lap = None;
        std::mem::replace(&mut self.seconds, [0.0; PHASES])
    }

    /// Ends the phase `index` and begins the next.
    fn lap(&mut self, index: usize) {
        let now = Instant::now();
        if let Some(began) = self.lap.replace(now) {
            self.seconds[index] += (now - began).as_secs_f64();
        }
    }
}

#[derive(Resource)]
struct TickWatch(Stopwatch<{ TICK.len() }>);

#[derive(Resource)]
struct DrawWatch(Stopwatch<1>);

/// Orders the laps of one schedule among themselves.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Lap(usize);

impl Plugin for ClothDiagnosticsPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(TickWatch(Stopwatch::NEW))
            .init_resource::<SubstepTimes>()
            .insert_resource(DrawWatch(Stopwatch::NEW))
            .register_diagnostic(Diagnostic::new(Self::DRAW).with_suffix(" ms"))
            .add_systems(ClothSchedule, (|mut watch: ResMut<TickWatch>| watch.0.start()).before(TICK[0].0))
            .add_systems(
                PostUpdate,
                (
                    (|mut watch: ResMut<DrawWatch>| watch.0.start())
                        .after(TransformSystems::Propagate)
                        .before(ClothSystems::Draw),
                    (|mut watch: ResMut<DrawWatch>| watch.0.lap(0)).after(ClothSystems::Draw),
                ),
            )
            .add_systems(Last, tell);
        for (index, (phase, path)) in TICK.into_iter().enumerate() {
            app.register_diagnostic(Diagnostic::new(path.clone()).with_suffix(" ms"));
            let lap = (move |mut watch: ResMut<TickWatch>| watch.0.lap(index)).in_set(Lap(index)).after(phase);
            app.add_systems(ClothSchedule, before_next(lap, index));
        }
        for path in SUBSTEP {
            app.register_diagnostic(Diagnostic::new(path.clone()).with_suffix(" ms"));
        }
        for path in [Self::PARTICLES, Self::CONSTRAINTS, Self::CONTACTS, Self::ASLEEP] {
            app.register_diagnostic(Diagnostic::new(path).with_smoothing_factor(0.0));
        }
        app.register_diagnostic(Diagnostic::new(Self::LARGEST_STRAIN).with_suffix(" %"));
    }
}

/// Puts the lap that ends phase `index` before the next phase, and before the lap that ends that one.
fn before_next(lap: ScheduleConfigs<ScheduleSystem>, index: usize) -> ScheduleConfigs<ScheduleSystem> {
    match TICK.get(index + 1) {
        Some((next, _)) => lap.before(*next).before(Lap(index + 1)),
        None => lap,
    }
}

/// Tells the times and totals of this frame.
fn tell(
    mut diagnostics: Diagnostics,
    mut tick: ResMut<TickWatch>,
    mut substep: ResMut<SubstepTimes>,
    mut draw: ResMut<DrawWatch>,
    cloths: Query<(&ClothTopology, &Particles, &Constraints, &Contacts)>,
    asleep: Query<(), With<ClothAsleep>>,
) {
    if tick.0.lap.is_some() {
        let seconds = tick.0.take().into_iter().chain(std::mem::take(&mut substep.0));
        for (path, seconds) in TICK.iter().map(|(_, path)| *path).chain(SUBSTEP).zip(seconds) {
            diagnostics.add_measurement(path, || seconds * 1000.0);
        }
    }
    let [drawing] = draw.0.take();
    diagnostics.add_measurement(&ClothDiagnosticsPlugin::DRAW, || drawing * 1000.0);
    let sum = |count: fn(&ClothTopology, &Constraints, &Contacts) -> usize| {
        cloths.iter().map(|(topology, _, constraints, contacts)| count(topology, constraints, contacts)).sum::<usize>()
    };
    diagnostics.add_measurement(&ClothDiagnosticsPlugin::PARTICLES, || sum(|t, _, _| t.particle_count()) as f64);
    diagnostics.add_measurement(&ClothDiagnosticsPlugin::CONSTRAINTS, || sum(|_, c, _| c.count()) as f64);
    diagnostics.add_measurement(&ClothDiagnosticsPlugin::CONTACTS, || sum(|_, _, c| c.touching as usize) as f64);
    diagnostics.add_measurement(&ClothDiagnosticsPlugin::ASLEEP, || asleep.iter().count() as f64);
    diagnostics.add_measurement(&ClothDiagnosticsPlugin::LARGEST_STRAIN, || {
        let strains = cloths.iter().map(|(topology, particles, ..)| measure::largest_strain(topology, particles));
        f64::from(strains.fold(0.0, f32::max)) * 100.0
    });
}
