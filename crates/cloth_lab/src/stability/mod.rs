//! Maps of where methods fail: step length and stiffness, substeps and mass ratio, substeps and mesh size; and which of
//! random cloths come to rest. Everything together, on all scenes of the stability plan.

pub mod full;
mod maps;
pub mod monkey;
pub mod random;
mod trial;
mod verdict;
mod write;

use clap::Args as ClapArgs;
use cloth_solver::{Fabric, Method};
use glam::{UVec2, Vec2};

use crate::report::Output;
use crate::{LabError, chart, progress};

pub use maps::{Edge, Entry, Kind, map};
pub use trial::{Subject, Trial, limit};
pub use verdict::{Seen, Verdict, play};

/// Parts of the theoretical limit at which the edge is checked.
const PARTS: [f64; 2] = [0.95, 1.05];

/// Arguments.
#[derive(ClapArgs, Debug)]
pub struct Args {
    /// Takes less than two minutes: coarser maps, smaller meshes, at most 0.04 s for a run.
    #[arg(long)]
    pub quick: bool,
    #[command(flatten)]
    output: Output,
    /// Methods to map, separated by commas. Default: all.
    #[arg(long, value_delimiter = ',', value_parser = chart::method, value_name = "LIST")]
    pub methods: Vec<Method>,
    /// Maps to draw, separated by commas. Default: all.
    #[arg(long, value_delimiter = ',', value_parser = kind, value_name = "LIST")]
    pub scenes: Vec<Kind>,
    /// In place of the maps: plays this many random cloths and tells which of them come to rest.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub random: Option<u32>,
    /// In place of the maps: lets a monkey loose on cloths of 600 ticks each, for so many ticks in all.
    #[arg(long, value_name = "TICKS", conflicts_with = "random", value_parser = clap::value_parser!(u32).range(1..))]
    pub monkey: Option<u32>,
    /// In place of the maps: plays a plan of the monkey that was written to this file.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["random", "monkey"])]
    pub replay: Option<std::path::PathBuf>,
    /// In place of the maps: plays every scene of the stability plan, swept, with an hour's soak and 100,000 ticks of the monkey.
    #[arg(long, conflicts_with_all = ["random", "monkey", "replay"])]
    pub full: bool,
    /// How much of `--full` is played: its part of the random trials, above 0, up to 1. Below 0.1 the soak, the monkey and the
    /// sweeps are shorter, too: 0.002 takes a minute.
    #[arg(long, default_value = "1", value_name = "PART", requires = "full")]
    pub size: full::Part,
    /// Rows of the stability plan that `--full` plays, separated by commas. Default: all.
    #[arg(long, value_delimiter = ',', requires = "full", value_name = "LIST")]
    pub rows: Vec<u32>,
    /// What the monkey has at hand, separated by commas. Default: all.
    #[arg(long, value_delimiter = ',', value_parser = tool, value_name = "LIST")]
    pub tools: Vec<monkey::Tool>,
    /// Seed of the first random cloth, or of the monkey's first; the others have those after it.
    #[arg(long, default_value_t = 1, value_name = "S")]
    pub seed: u64,
}

/// The map of that name.
fn kind(name: &str) -> Result<Kind, String> {
    Kind::ALL
        .into_iter()
        .find(|kind| kind.file() == name)
        .ok_or_else(|| format!("no such map; there are {}", Kind::ALL.map(Kind::file).join(", ")))
}

/// The monkey's tool of that name.
fn tool(name: &str) -> Result<monkey::Tool, String> {
    let all = monkey::Tool::ALL;
    let found = all.into_iter().find(|tool| tool.name() == name);
    found.ok_or_else(|| format!("no such tool; there are {}", all.map(monkey::Tool::name).join(", ")))
}

/// A method with a limit, just below it and just above.
#[derive(Clone, Debug)]
pub struct Check {
    /// The method.
    pub method: Method,
    /// What swings.
    pub subject: &'static str,
    /// The limit, s.
    pub limit: f64,
    /// How it held at 0.95 and at 1.05 of it.
    pub verdicts: [Verdict; 2],
}

/// Tries every method that has a limit at 0.95 and 1.05 of it: on a single spring of about 1 Hz and on a sheet.
pub fn checks(methods: &[Method]) -> Vec<Check> {
    // One cell is two springs side by side, each of ½ Y w/l with a quarter of the mass: ω² = 2 Y / (σ l²).
    let stretch = 0.5 * Fabric::COTTON_POPLIN.areal_density * std::f32::consts::TAU.powi(2);
    let spring = Fabric { stretch_warp: stretch, stretch_weft: 0.1 * stretch, shear: 0.0, ..Fabric::COTTON_POPLIN };
    let subjects = [
        ("a spring of 1 Hz", Subject::swing_of(Vec2::ONE, UVec2::ONE, spring)),
        ("8 × 8 cells", Subject::swing(Vec2::ONE, UVec2::splat(8), Fabric::COTTON_POPLIN.stretch_warp)),
    ];
    let with_limit = methods.iter().filter(|method| **method != Method::ExplicitEuler);
    with_limit
        .flat_map(|method| subjects.iter().map(move |subject| (method, subject)))
        .filter_map(|(method, (name, subject))| {
            let limit = limit(*method, 1)? / subject.frequency;
            let held = |part: f64| play(&subject.steps_of(*method, 1, part * limit, 3000), 10.0).verdict();
            Some(Check { method: *method, subject: name, limit, verdicts: PARTS.map(held) })
        })
        .collect()
}

/// Runs the command.
///
/// # Errors
/// A file that could not be written.
pub fn run(args: &Args) -> Result<(), LabError> {
    if args.full {
        return full::run(args.size, args.seed, &args.rows, &args.output);
    }
    if let Some(count) = args.random {
        return random::run(count, args.seed, &args.output);
    }
    if let Some(path) = &args.replay {
        return monkey::replay(path);
    }
    if let Some(ticks) = args.monkey {
        let tools = if args.tools.is_empty() { monkey::Tool::ALL.to_vec() } else { args.tools.clone() };
        return monkey::run(ticks, args.seed, &tools, &args.output);
    }
    let methods = chart::methods(&args.methods);
    let wall = if args.quick { 0.04 } else { 0.6 };
    let kinds: Vec<Kind> = if args.scenes.is_empty() { Kind::ALL.to_vec() } else { args.scenes.clone() };
    let bar = progress::bar(maps::count(methods.len(), args.quick));
    let (mut entries, mut edges) = (Vec::new(), Vec::new());
    for kind in &kinds {
        let (of_map, of_theory) = map(*kind, &methods, args.quick, wall, &bar);
        entries.extend(of_map);
        edges.extend(of_theory);
    }
    bar.finish_and_clear();
    let found = write::Found { kinds: &kinds, methods: &methods, entries: &entries, edges: &edges };
    write::write(&found, &checks(&methods), args.quick, &args.output)?;
    println!("{} runs; results in {}", entries.len(), args.output.out.display());
    Ok(())
}
