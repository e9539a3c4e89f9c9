//! A seeded monkey: cuts, tears, pulls, blows at, lights and hits cloth at random, and what must hold all the time.

mod plan;
mod play;
mod shrink;

pub use plan::{Act, Due, Held, Plan, Tool};
pub use play::{FACTOR, Fault, STRENGTH, Seen, World, play};
pub use shrink::shrink;

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use crate::report::{Output, Table, number};
use crate::{LabError, progress};

/// Ticks for which one cloth is played, 10 s: after that little is left of most.
pub const EPISODE: u32 = 600;
/// Most plans that fail which are shrunk and written.
const SHOWN: usize = 12;

/// Ticks that a replay prints.
const TOLD: usize = 30;

/// A plan and what was seen of it.
#[derive(Clone, Debug)]
pub struct Episode {
    /// What it was drawn from.
    pub seed: u64,
    /// The plan.
    pub plan: Plan,
    /// What was seen.
    pub seen: Seen,
}

/// Plays as many plans of seeds from `seed` on as take `ticks`, on all cores.
pub fn play_all(ticks: u32, seed: u64, tools: &[Tool]) -> Vec<Episode> {
    let count = u64::from(ticks.div_ceil(EPISODE));
    let (next, found) = (AtomicU64::new(0), Mutex::new(Vec::new()));
    let bar = progress::bar(count);
    let work = || {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= count {
                break;
            }
            let seed = seed.wrapping_add(number);
            let last = ticks - (number as u32) * EPISODE;
            let plan = Plan::new(seed, last.min(EPISODE), tools);
            let seen = play(&plan);
            if let Ok(mut found) = found.lock() {
                found.push(Episode { seed, plan, seen });
            }
            bar.inc(1);
        }
    };
    std::thread::scope(|scope| {
        (0..std::thread::available_parallelism().map_or(1, usize::from)).for_each(|_| {
            scope.spawn(work);
        });
    });
    bar.finish_and_clear();
    let mut found = found.into_inner().unwrap_or_default();
    found.sort_by_key(|episode| episode.seed);
    found
}

/// Plays the plan in a file and prints its last ticks.
///
/// # Errors
/// A file that cannot be read or holds no plan, or a plan that fails.
pub fn replay(path: &Path) -> Result<(), LabError> {
    let told = |error| LabError::File { path: path.to_owned(), error };
    let text = std::fs::read_to_string(path).map_err(told)?;
    let plan: Plan = ron::from_str(&text).map_err(|error| told(std::io::Error::other(error)))?;
    let mut table = Table::new(["tick", "fastest, m/s", "of its drive", "largest strain", "substeps", "triangles"]);
    let seen = play::watch(&plan, |world, tick| {
        let [speed, ratio] = world.fastest();
        table.push([
            tick.to_string(),
            number(f64::from(speed), 3),
            number(f64::from(ratio), 3),
            number(f64::from(play::strain(&world.cloth)), 3),
            world.cloth.pace.taken().to_string(),
            world.cloth.topology.triangles.len().to_string(),
        ]);
    });
    let first = table.rows.len().saturating_sub(TOLD);
    table.rows.drain(..first);
    println!("{}", table.markdown());
    match seen.fault {
        Some((fault, tick)) => {
            println!("{fault:?} after tick {tick}");
            Err(LabError::Failed { failed: 1 })
        }
        None => Ok(()),
    }
}

/// Plays, shrinks what fails and tells.
///
/// # Errors
/// Plans that fail, or a file that could not be written.
pub fn run(ticks: u32, seed: u64, tools: &[Tool], output: &Output) -> Result<(), LabError> {
    let began = Instant::now();
    let episodes = play_all(ticks, seed, tools);
    let failed: Vec<&Episode> = episodes.iter().filter(|episode| episode.seen.fault.is_some()).collect();
    let fastest = episodes.iter().map(|episode| episode.seen.speed).fold(0.0, f32::max);
    let ratio = episodes.iter().map(|episode| episode.seen.ratio).fold(0.0, f32::max);
    println!(
        "{} of {} cloths hold for {ticks} ticks in all; fastest particle {fastest:.1} m/s, {ratio:.2} times what drives it; {:.0} s",
        episodes.len() - failed.len(),
        episodes.len(),
        began.elapsed().as_secs_f64()
    );
    write_failed(failed.iter().copied(), output)?;
    if failed.is_empty() { Ok(()) } else { Err(LabError::Failed { failed: failed.len() }) }
}

/// Shrinks the first plans that failed, prints what did not hold and writes each to a file.
///
/// # Errors
/// A file that could not be written.
pub fn write_failed<'a>(episodes: impl IntoIterator<Item = &'a Episode>, output: &Output) -> Result<(), LabError> {
    let failed = episodes.into_iter().filter(|episode| episode.seen.fault.is_some());
    for episode in failed.take(SHOWN) {
        let Episode { seed, plan, seen } = episode;
        let small = shrink(plan);
        let (fault, tick) = seen.fault.unwrap_or((Fault::Refused, 0));
        println!(
            "seed {seed}: {fault:?} after tick {tick}, {:.0} m/s, {:.1} times its drive ({}, {}, {} × {}, {:?}); shrunk to {} acts, {} × {}",
            seen.speed,
            seen.ratio,
            plan.fabric,
            if plan.mesh { "mesh" } else { "grid" },
            plan.cells.x,
            plan.cells.y,
            plan.held,
            small.acts.len(),
            small.cells.x,
            small.cells.y
        );
        let text = ron::ser::to_string_pretty(&small, ron::ser::PrettyConfig::default()).unwrap_or_default();
        output.write(&format!("monkey_{seed}.ron"), &text)?;
    }
    Ok(())
}
