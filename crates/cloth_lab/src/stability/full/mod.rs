//! Every scene of the stability plan that the solver alone can play, swept, in one table.

mod driven;
mod layers;
mod limits;
mod long;
mod meshes;
mod part;
mod rest;
mod sheet;
mod solids;
mod strike;
mod struck;
mod write;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use super::monkey;
use crate::report::Output;
use crate::{LabError, progress};

pub use part::Part;

/// What was seen of one trial.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Whether what must hold did.
    pub held: bool,
    /// What was measured, in words.
    pub measured: String,
    /// The plan of the monkey's trial, if it was one.
    pub episode: Option<Box<monkey::Episode>>,
}

impl Outcome {
    /// Of a trial that was not the monkey's.
    pub fn new(held: bool, measured: String) -> Self {
        Self { held, measured, episode: None }
    }
}

/// One trial of a scene.
pub struct Trial {
    /// The values of what is swept, in words.
    pub at: String,
    /// Where it is in the row's map: kind of the panel's row, and the value across.
    pub place: Option<(&'static str, f64)>,
    play: Box<dyn Fn() -> Outcome + Send + Sync>,
}

impl Trial {
    /// A trial at those values.
    pub fn new(at: impl Into<String>, play: impl Fn() -> Outcome + Send + Sync + 'static) -> Self {
        Self { at: at.into(), place: None, play: Box::new(play) }
    }

    /// The same, with a place in the row's map.
    pub fn placed(self, kind: &'static str, value: f64) -> Self {
        Self { place: Some((kind, value)), ..self }
    }
}

/// A scene of the plan and its trials.
pub struct Row {
    /// Its number in the plan.
    pub number: u32,
    /// What is played.
    pub scene: &'static str,
    /// What must hold.
    pub must: &'static str,
    /// The trials.
    pub trials: Vec<Trial>,
}

/// A row that was played.
#[derive(Clone, Debug)]
pub struct Played {
    /// Its number in the plan.
    pub number: u32,
    /// What was played.
    pub scene: &'static str,
    /// What must hold.
    pub must: &'static str,
    /// Values, place in the map, and outcome of each trial.
    pub trials: Vec<(String, Option<(&'static str, f64)>, Outcome)>,
    /// How long all trials together took to compute, s.
    pub time: f64,
}

impl Played {
    /// How many trials did not hold.
    pub fn failed(&self) -> usize {
        self.trials.iter().filter(|(_, _, outcome)| !outcome.held).count()
    }
}

/// The scenes of the plan that need the plugin, and where they are tested.
pub const ELSEWHERE: [(&str, &str); 4] = [
    ("14, NaN forces and transforms", "`tests/behaviour/recovery.rs`, `tests/behaviour/bad_collider.rs`"),
    ("17, frame rates", "`tests/behaviour/frame_rate.rs`, `tests/behaviour/clock.rs`"),
    ("21, spawning and despawning", "`tests/behaviour/despawn.rs`, `tests/behaviour/changes.rs`"),
    ("34 and 35, known answers", "[validate.md](validate.md)"),
];

/// All rows, in the order of the plan, with that part of their trials.
pub fn rows(part: Part, seed: u64) -> Vec<Row> {
    let mut rows = limits::rows(part);
    rows.extend(strike::rows(part, seed));
    rows.extend(solids::rows(part));
    rows.extend(layers::rows(part));
    rows.extend(meshes::rows());
    rows.extend(driven::rows(part));
    rows.extend(long::rows(part, seed));
    rows.extend(rest::rows(part, seed));
    rows.extend(struck::rows(part, seed));
    rows.sort_by_key(|row| row.number);
    rows
}

/// Plays all trials of `rows` on all cores.
pub fn play(rows: Vec<Row>) -> Vec<Played> {
    let trials: Vec<(usize, &Trial)> =
        rows.iter().enumerate().flat_map(|(row, of)| of.trials.iter().map(move |trial| (row, trial))).collect();
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let bar = progress::bar(trials.len() as u64);
    let work = || {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some((row, trial)) = trials.get(index) else { break };
            let began = Instant::now();
            let outcome = catch_unwind(AssertUnwindSafe(&trial.play));
            let outcome = outcome.unwrap_or_else(|_| Outcome::new(false, "panicked".into()));
            let time = began.elapsed().as_secs_f64();
            bar.inc(1);
            if bar.is_hidden() && index.is_multiple_of(200) {
                eprintln!("{index} of {} trials", trials.len());
            }
            if let Ok(mut found) = found.lock() {
                found.push((index, *row, outcome, time));
            }
        }
    };
    std::thread::scope(|scope| {
        (0..std::thread::available_parallelism().map_or(1, usize::from)).for_each(|_| {
            scope.spawn(work);
        });
    });
    bar.finish_and_clear();
    let mut found = found.into_inner().unwrap_or_default();
    found.sort_by_key(|(index, ..)| *index);
    let empty =
        |row: &Row| Played { number: row.number, scene: row.scene, must: row.must, trials: Vec::new(), time: 0.0 };
    let mut played: Vec<Played> = rows.iter().map(empty).collect();
    for (index, row, outcome, time) in found {
        let trial = trials[index].1;
        played[row].trials.push((trial.at.clone(), trial.place, outcome));
        played[row].time += time;
    }
    played
}

/// Plays everything, or the rows of `only` these numbers, writes `stability_full.md` with its map, and the monkey's plans that fail.
///
/// # Errors
/// Trials that do not hold, or a file that could not be written.
pub fn run(part: Part, seed: u64, only: &[u32], output: &Output) -> Result<(), LabError> {
    let began = Instant::now();
    let chosen = rows(part, seed).into_iter().filter(|row| only.is_empty() || only.contains(&row.number));
    let played = play(chosen.collect());
    write::write(&played, part, began.elapsed().as_secs_f64(), output)?;
    let episodes = played.iter().flat_map(|row| &row.trials).filter_map(|(_, _, outcome)| outcome.episode.as_deref());
    monkey::write_failed(episodes, output)?;
    let failed = played.iter().map(Played::failed).sum::<usize>();
    let all = played.iter().map(|row| row.trials.len()).sum::<usize>();
    println!("{} of {all} trials hold; results in {}", all - failed, output.out.display());
    if failed == 0 { Ok(()) } else { Err(LabError::Unstable { failed }) }
}

#[cfg(test)]
mod tests {
    use cloth_cases::cases;

    use super::*;

    #[test]
    fn a_short_version_plays_every_row_and_says_which_trials_do_not_hold() {
        let out = std::env::temp_dir().join(format!("cloth_lab_full_{}", std::process::id()));
        let all: Vec<u32> = (1..=33).filter(|number| *number != 17).chain([36]).collect();
        let played = cases(vec![1, 10, 33], all);
        let outcome = run(Part::new(0.002).unwrap(), 1, &played, &Output { out: out.clone() });
        let text = std::fs::read_to_string(out.join("stability_full.md")).unwrap();
        for number in played {
            assert!(text.contains(&format!("\n| {number} ")), "row {number} is missing in\n{text}");
        }
        let fails = text.contains("## Not held");
        assert_eq!(matches!(outcome, Err(LabError::Unstable { .. })), fails, "{outcome:?}\n{text}");
        assert!(!text.contains("panicked"), "{text}");
        std::fs::remove_dir_all(out).unwrap();
    }

    #[test]
    fn a_trial_that_panics_or_fails_is_told_and_the_others_are_played() {
        let trials = vec![
            Trial::new("a", || panic!("on purpose")),
            Trial::new("b", || Outcome::new(false, "bad".into())),
            Trial::new("c", || Outcome::new(true, "good".into())),
        ];
        let played = play(vec![Row { number: 1, scene: "", must: "", trials }]);
        let told: Vec<_> = played[0].trials.iter().map(|(at, _, outcome)| (at.as_str(), outcome.held)).collect();
        assert_eq!(told, [("a", false), ("b", false), ("c", true)]);
        assert_eq!(played[0].failed(), 2);
        assert_eq!(played[0].trials[0].2.measured, "panicked");
    }
}
