//! Plays a cloth with and without each part, and compares.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use cloth_solver::Tick;

use crate::change::{Change, Lever};
use crate::sample::{Played, Sample};
use crate::shape::Difference;

/// Substeps that are tried.
const SUBSTEPS: [u32; 6] = [1, 2, 3, 5, 7, 14];
/// How many times fewer cells along each side are tried, the coarsest first.
const COARSER: [u32; 2] = [4, 2];
/// Tearing could go where nothing carries more than this part of its strength.
const SAFE_LOAD: f32 = 0.5;

/// How cloth is advised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Distance of a point of the cloth up to which two shapes count as the same, m.
    pub tolerance: f64,
    /// How long each play is, s.
    pub seconds: f32,
}

/// How far an [`advise`] has come, seen from another thread, and how it is stopped.
#[derive(Debug, Default)]
pub struct Progress {
    played: AtomicU32,
    plays: AtomicU32,
    stopped: AtomicBool,
}

impl Progress {
    /// The part that is done, 0..=1.
    pub fn part(&self) -> f32 {
        let plays = self.plays.load(Ordering::Relaxed).max(1);
        self.played.load(Ordering::Relaxed).min(plays) as f32 / plays as f32
    }

    /// Has it stop soon.
    pub fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }

    fn goes_on(&self) -> bool {
        !self.stopped.load(Ordering::Relaxed)
    }
}

/// What was found about one part.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// What was left out.
    pub change: Change,
    /// How far the cloth then is from where it is with all of it.
    pub difference: Difference,
    /// Part of the time of a tick that it saves; below 0 where it takes longer.
    pub saves: f64,
    /// Whether it could go: no point moved farther than the bar.
    pub can_go: bool,
    /// A number that belongs to it: of bending and shear the part of the elastic energy, of self-contact the places that touched, of
    /// tearing the largest load over strength, of substeps those that there are.
    pub figure: f64,
}

/// Everything that was found about a cloth.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// What was found, what could go and saves most first.
    pub advice: Vec<Advice>,
    /// Time of a tick with all of it, ms.
    pub time: f64,
    /// Whether mean shapes were compared. On its way a cloth that flutters comes elsewhere at every change, however small.
    pub by_mean: bool,
    /// Up to this distance two shapes count as the same, m: the tolerance, or more where twice the substeps move the cloth
    /// farther than that, so that it cannot be told.
    pub bar: f64,
    /// The tolerance that was asked for, m.
    pub tolerance: f64,
}

/// Plays `sample` with and without each part that it has. `None` if it was stopped.
pub fn advise(sample: &Sample, settings: Settings, progress: &Progress) -> Option<Report> {
    let mut sample = sample.clone();
    sample.stand();
    let ladder = ladder(&sample);
    progress.plays.store(2 + ladder.iter().map(Vec::len).sum::<usize>() as u32, Ordering::Relaxed);
    let play = |sample: Sample| {
        let played = sample.play(settings.seconds, || progress.goes_on());
        progress.played.fetch_add(1, Ordering::Relaxed);
        played
    };
    let full = play(sample.clone())?;
    let Tick { substeps, most, .. } = sample.tick;
    let tick = Tick { substeps: 2 * substeps, most: most.max(2 * substeps), ..sample.tick };
    let again = play(Sample { tick, ..sample.clone() })?;
    let by_mean = full.difference(&again, false).most > settings.tolerance;
    let own = full.difference(&again, by_mean).most;
    let bar = if own.is_finite() { settings.tolerance.max(own) } else { settings.tolerance };
    let mut report = Report { advice: Vec::new(), time: full.time, by_mean, bar, tolerance: settings.tolerance };
    for changes in ladder {
        for (tried, change) in changes.iter().enumerate() {
            let Some(without) = sample.with(change) else { continue };
            let played = play(without)?;
            let difference = full.difference(&played, by_mean);
            let can_go = difference.most <= bar && (*change != Change::NoTearing || full.load < SAFE_LOAD);
            let saves = 1.0 - played.time / full.time.max(1e-9);
            let figure = figure(&sample, &full, change);
            // Of several meshes or budgets the cheapest that is enough, or else the dearest.
            if can_go || tried + 1 == changes.len() {
                report.advice.push(Advice { change: change.clone(), difference, saves, can_go, figure });
                progress.played.fetch_add((changes.len() - tried - 1) as u32, Ordering::Relaxed);
                break;
            }
        }
    }
    report.advice.sort_by(|a, b| b.can_go.cmp(&a.can_go).then(b.saves.total_cmp(&a.saves)));
    Some(report)
}

/// What of `sample` could go, lever by lever; of one lever the cheapest first.
fn ladder(sample: &Sample) -> Vec<Vec<Change>> {
    let fabric = &sample.fabric;
    let (method, iterations) = (sample.cloth.constraints.method(), sample.tick.iterations);
    let has = [
        (fabric.bend_warp + fabric.bend_weft > 0.0, Change::NoBending),
        (fabric.shear > 0.0, Change::NoShear),
        (sample.cloth.air.is_some(), Change::NoAir),
        (sample.cloth.self_contacts.is_some(), Change::NoSelfContact),
        (sample.tearing.is_some(), Change::NoTearing),
    ];
    let mut ladder: Vec<_> = has.into_iter().filter_map(|(has, change)| has.then(|| vec![change])).collect();
    ladder.push(COARSER.into_iter().map(Change::Coarser).filter(|change| sample.with(change).is_some()).collect());
    let fewer = SUBSTEPS.into_iter().filter(|substeps| *substeps < sample.tick.substeps);
    ladder.push(fewer.map(|substeps| Change::Budget { method, substeps, iterations }).collect());
    ladder
}

fn figure(sample: &Sample, full: &Played, change: &Change) -> f64 {
    match (change, change.lever()) {
        (Change::NoBending | Change::NoShear, _) => sample.energy_share(change),
        (Change::NoSelfContact, _) => f64::from(full.touching),
        (Change::NoTearing, _) => f64::from(full.load),
        (_, Lever::Budget) => f64::from(sample.tick.substeps),
        _ => 0.0,
    }
}

impl Played {
    /// How far `other` is from this play, on the mean or at the worst of its moments.
    fn difference(&self, other: &Self, by_mean: bool) -> Difference {
        if by_mean {
            return self.mean.difference(&other.mean);
        }
        Difference::worst(self.shapes.iter().zip(&other.shapes).map(|(a, b)| a.difference(b)))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use cloth_solver::constraint::{Pin, Pins};
    use cloth_solver::contact::SelfContact;
    use cloth_solver::damage::{Tear, Tearing};
    use cloth_solver::forces::Air;
    use cloth_solver::topology::Resolution;
    use cloth_solver::{Cloth, Fabric, Motion, Topology};
    use glam::{UVec2, Vec2, Vec3};

    use super::*;

    const SETTINGS: Settings = Settings { tolerance: 0.005, seconds: 0.5 };

    /// A sheet that lies level and is held by its left edge.
    fn ledge(fabric: Fabric) -> Sample {
        let topology = Topology::rectangle(Vec2::new(0.2, 0.1), Resolution::Cells(UVec2::new(8, 4))).unwrap();
        let mut cloth = Cloth::new(Arc::new(topology), &fabric).unwrap();
        let grid = cloth.topology.grid.unwrap();
        let pin = |particle: u32| Pin { particle, frame: 0, local: cloth.topology.rest[particle as usize] };
        let pins = (0..grid.rows).flat_map(|row| [grid.slot(row, 0), grid.slot(row, 1)]).map(pin).collect();
        let pins = Pins { frames: vec![Motion::default()], pins };
        cloth.constraints.set_pins(&mut cloth.particles, pins).unwrap();
        let gravity = Vec3::NEG_Z * 9.81;
        Sample { cloth, fabric, gravity, tick: Tick::new(1.0 / 60.0), tearing: None }
    }

    fn found(report: &Report, is: impl Fn(&Change) -> bool) -> &Advice {
        let mut all = report.advice.iter();
        all.find(|advice| is(&advice.change)).unwrap_or_else(|| panic!("{report:?}"))
    }

    fn advised(sample: &Sample) -> Report {
        advise(sample, SETTINGS, &Progress::default()).unwrap()
    }

    #[test]
    fn what_holds_a_stiff_sheet_up_is_needed_and_in_still_heavy_cloth_air_is_not() {
        let felt = Fabric::PRESETS.iter().find(|(name, _)| name.to_lowercase().starts_with("felt")).unwrap().1;
        let mut sample = ledge(felt);
        sample.cloth.air = Some(Air { density: 1e-6, ..Air::default() });
        sample.cloth.set_self_contact(&felt, &SelfContact::default()).unwrap();
        let report = advised(&sample);
        let bending = found(&report, |change| *change == Change::NoBending);
        assert!(!bending.can_go && bending.difference.most > 0.01, "{bending:?}");
        assert!(found(&report, |change| *change == Change::NoAir).can_go);
        assert!(found(&report, |change| *change == Change::NoSelfContact).can_go);
        let needed = report.advice.iter().position(|advice| !advice.can_go).unwrap();
        assert!(report.advice[needed..].iter().all(|advice| !advice.can_go), "what can go comes first: {report:?}");
    }

    #[test]
    fn tearing_can_go_where_nothing_carries_much_and_not_where_it_is_about_to_tear() {
        for (strength, expected) in [(1e5, true), (0.05, false)] {
            let mut sample = ledge(Fabric::COTTON_POPLIN);
            sample.tearing = Some((Tear::new(&sample.cloth.topology, Vec::new()), Tearing::at(strength)));
            let report = advised(&sample);
            let tearing = found(&report, |change| *change == Change::NoTearing);
            assert_eq!(tearing.can_go, expected, "{tearing:?}");
        }
    }

    #[test]
    fn a_coarser_mesh_hangs_where_the_fine_one_does_and_keeps_pins_and_weights() {
        let mut sample = ledge(Fabric::COTTON_POPLIN);
        let corner = sample.cloth.topology.grid.unwrap().slot(0, 8) as usize;
        sample.cloth.particles.add_mass(corner, 0.02).unwrap();
        let coarse = sample.with(&Change::Coarser(2)).unwrap();
        assert_eq!(coarse.cloth.constraints.pins().pins.len(), 3 + 3);
        let total = |sample: &Sample| sample.cloth.particles.mass.iter().sum::<f32>();
        assert!((total(&sample) - total(&coarse)).abs() < 1e-4 * total(&sample));
        assert!(sample.with(&Change::Coarser(4)).is_none(), "one cell is too few");
    }

    #[test]
    fn a_cloth_that_flutters_is_compared_by_its_mean_shape() {
        let mut sample = ledge(Fabric { damping: 0.0, ..Fabric::COTTON_POPLIN });
        let report = advise(&sample, Settings { tolerance: 1.0, seconds: 0.2 }, &Progress::default()).unwrap();
        assert!(!report.by_mean && report.bar == 1.0);
        sample.tick = Tick::fixed(sample.tick.dt, 2);
        let report = advise(&sample, Settings { tolerance: 1e-9, seconds: 0.2 }, &Progress::default()).unwrap();
        assert!(report.by_mean && report.bar > 1e-9, "{report:?}");
    }

    #[test]
    fn a_stopped_advice_ends_without_a_report() {
        let progress = Progress::default();
        progress.stop();
        assert_eq!(advise(&ledge(Fabric::COTTON_POPLIN), SETTINGS, &progress), None);
    }
}
