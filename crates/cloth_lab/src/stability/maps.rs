//! The maps: what is varied across and up.

use cloth_solver::Method;
use glam::{UVec2, Vec2};
use indicatif::ProgressBar;

use super::trial::{Subject, limit};
use super::verdict::{Seen, play};
use crate::chart::extras;

/// Stretch stiffness where it is not varied, N/m: cotton poplin's.
const STRETCH: f32 = 5500.0;
/// Most steps of a run over single steps: enough for an instability to show.
const STEPS: u64 = 2000;
/// Ticks of a run over ticks.
const TICKS: u64 = 90;

/// What a map varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Step length across, stretch stiffness up.
    Stiffness,
    /// Mass of a weight on a free corner across, substeps up.
    MassRatio,
    /// Cells along a side of a sheet across, substeps up.
    Sheet,
    /// Links of a strip one cell wide across, substeps up.
    Chain,
}

impl Kind {
    /// All.
    pub const ALL: [Self; 4] = [Self::Stiffness, Self::MassRatio, Self::Sheet, Self::Chain];

    /// Part of file names.
    pub const fn file(self) -> &'static str {
        match self {
            Self::Stiffness => "stiffness",
            Self::MassRatio => "mass_ratio",
            Self::Sheet => "sheet",
            Self::Chain => "chain",
        }
    }

    /// What it is, in a sentence.
    pub const fn about(self) -> &'static str {
        match self {
            Self::Stiffness => "Step length and stretch stiffness: an undamped sheet by its top edge, let go at 5°.",
            Self::MassRatio => "Weight on a free corner of a sheet hung by its upper corners, 60 ticks a second.",
            Self::Sheet => "Cells along a side of an undamped square metre by its top edge, let go at 5°.",
            Self::Chain => "Links of an undamped strip of 1 m, one cell wide, by its end, let go at 5°.",
        }
    }

    /// Titles of the axes.
    pub const fn axes(self) -> [&'static str; 2] {
        match self {
            Self::Stiffness => ["step, s", "stretch stiffness, N/m"],
            Self::MassRatio => ["weight, particle masses", "substeps"],
            Self::Sheet => ["cells a side", "substeps"],
            Self::Chain => ["links", "substeps"],
        }
    }

    /// The values across and up.
    pub fn values(self, quick: bool) -> [Vec<f64>; 2] {
        let powers = |base: f64, from: i32, to: i32| (from..=to).map(|i| base.powi(i)).collect::<Vec<_>>();
        let (steps, substeps) = if quick { (6, powers(4.0, 0, 4)) } else { (13, powers(2.0, 0, 9)) };
        let thin = |values: &[f64]| if quick { values.iter().copied().step_by(2).collect() } else { values.to_vec() };
        match self {
            Self::Stiffness => {
                let across = (0..steps).map(|i| 1e-5 * 3000_f64.powf(f64::from(i) / f64::from(steps - 1))).collect();
                [across, thin(&powers(10.0, 2, 8))]
            }
            Self::MassRatio => [thin(&powers(10.0, 0, 4)), substeps],
            Self::Sheet => [thin(&[10.0, 18.0, 32.0, 56.0, 100.0]), substeps],
            Self::Chain => [thin(&[10.0, 32.0, 100.0, 316.0, 1000.0]), substeps],
        }
    }

    fn subject(self, value: f64, quick: bool) -> Subject {
        let cells = if quick { 8 } else { 12 };
        let count = value as u32;
        match self {
            Self::Stiffness => Subject::swing(Vec2::ONE, UVec2::splat(cells), value as f32),
            Self::MassRatio => Subject::weighted(cells, value as f32),
            Self::Sheet => Subject::swing(Vec2::ONE, UVec2::splat(count), STRETCH),
            Self::Chain => Subject::swing(Vec2::new(1.0 / value as f32, 1.0), UVec2::new(1, count), STRETCH),
        }
    }
}

/// One cell of a map.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The map.
    pub kind: Kind,
    /// The method.
    pub method: Method,
    /// Value across.
    pub x: f64,
    /// Value up.
    pub y: f64,
    /// What was seen.
    pub seen: Seen,
}

/// Theory's edge of a map for a method: points in data units.
#[derive(Clone, Debug)]
pub struct Edge {
    /// The map.
    pub kind: Kind,
    /// The method.
    pub method: Method,
    /// The points.
    pub points: Vec<(f64, f64)>,
}

/// Tries every method on every cell of a map, each run at most `wall` seconds long.
pub fn map(kind: Kind, methods: &[Method], quick: bool, wall: f64, bar: &ProgressBar) -> (Vec<Entry>, Vec<Edge>) {
    let [across, up] = kind.values(quick);
    let mut entries = Vec::new();
    let mut edges: Vec<Edge> =
        methods.iter().map(|method| Edge { kind, method: *method, points: Vec::new() }).collect();
    let of_subject = if kind == Kind::Stiffness { &up } else { &across };
    for value in of_subject {
        let subject = kind.subject(*value, quick);
        for (method, edge) in methods.iter().zip(&mut edges) {
            bar.set_message(format!("{}, {}", kind.file(), method.name()));
            let iterations = extras::setting(*method).iterations;
            let others = if kind == Kind::Stiffness { &across } else { &up };
            for other in others {
                let (x, y, trial) = if kind == Kind::Stiffness {
                    (*other, *value, subject.steps_of(*method, iterations, *other, STEPS))
                } else {
                    (*value, *other, subject.substeps(*method, iterations, *other as u32, TICKS))
                };
                entries.push(Entry { kind, method: *method, x, y, seen: play(&trial, wall) });
                bar.inc(1);
            }
            edge.points.extend(point(kind, *method, *value, subject.frequency));
        }
    }
    edges.retain(|edge| !edge.points.is_empty());
    (entries, edges)
}

/// Where theory puts the edge on the line of `value`, for a highest frequency in rad/s.
fn point(kind: Kind, method: Method, value: f64, frequency: f64) -> Option<(f64, f64)> {
    if kind == Kind::Stiffness {
        return limit(method, STEPS).map(|limit| (limit / frequency, value));
    }
    if method == Method::ExplicitEuler {
        // More substeps are more steps as well: ω²h² n/2 = ln 10⁷ with h = 1/(60 s), n = 60 s · T.
        let seconds = TICKS as f64 / 60.0;
        return Some((value, frequency * frequency * seconds / (2.0 * 60.0 * 1e7_f64.ln())));
    }
    limit(method, STEPS).map(|limit| (value, frequency / (60.0 * limit)))
}

/// Number of runs of all maps.
pub fn count(methods: usize, quick: bool) -> u64 {
    let of = |kind: &Kind| kind.values(quick).iter().map(Vec::len).product::<usize>() * methods;
    Kind::ALL.iter().map(of).sum::<usize>() as u64
}
