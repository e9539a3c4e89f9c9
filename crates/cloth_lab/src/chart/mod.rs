//! Work–precision diagrams: time against error for every method, scene by scene.

pub mod case;
pub mod extras;
pub mod fit;
pub mod record;
pub mod run;
pub mod settle;
pub mod truth;
mod write;

use clap::Args as ClapArgs;
use cloth_solver::Method;

use crate::report::Output;
use crate::{LabError, progress};

/// Arguments.
#[derive(ClapArgs, Debug)]
pub struct Args {
    /// Takes less than two minutes: 24 × 24 cells, every second setting, at most 0.6 s for a point.
    #[arg(long)]
    pub quick: bool,
    #[command(flatten)]
    output: Output,
    /// Methods to chart, separated by commas. Default: all.
    #[arg(long, value_delimiter = ',', value_parser = method, value_name = "LIST")]
    pub methods: Vec<Method>,
    /// Scenes to chart, separated by commas. Default: all.
    #[arg(long, value_delimiter = ',', value_parser = clap::builder::PossibleValuesParser::new(case::NAMES), value_name = "LIST")]
    pub scenes: Vec<String>,
    /// Cells along each side of the sheet, 4 to 255. Default: 63 (64 × 64 particles), 24 with --quick.
    #[arg(long, value_parser = clap::value_parser!(u32).range(4..256))]
    pub cells: Option<u32>,
    /// A run that would take longer than this many seconds is given up. Default: 12, 0.6 with --quick.
    #[arg(long, value_name = "SECONDS")]
    pub limit: Option<f64>,
}

/// The method of that name.
///
/// # Errors
/// All names, if there is none.
pub fn method(name: &str) -> Result<Method, String> {
    Method::ALL
        .into_iter()
        .find(|method| method.name() == name)
        .ok_or_else(|| format!("no such method; there are {}", Method::ALL.map(Method::name).join(", ")))
}

/// Those asked for, or all.
pub(crate) fn methods(asked: &[Method]) -> Vec<Method> {
    if asked.is_empty() { Method::ALL.to_vec() } else { asked.to_vec() }
}

/// Runs the command.
///
/// # Errors
/// A file that could not be written.
pub fn run(args: &Args) -> Result<(), LabError> {
    let cells = args.cells.unwrap_or(if args.quick { 24 } else { 63 });
    let limit = args.limit.unwrap_or(if args.quick { 0.6 } else { 12.0 });
    let wanted = |case: &case::Case| args.scenes.is_empty() || args.scenes.iter().any(|name| name == case.name);
    let cases: Vec<case::Case> = case::cases(cells).into_iter().filter(wanted).collect();
    let methods = methods(&args.methods);

    let bar = progress::bar(cases.len() as u64);
    bar.set_message("references");
    let truths = truth::truths(&cases, &bar);
    bar.finish_and_clear();

    let jobs: Vec<_> = (cases.iter().zip(&truths))
        .flat_map(|(case, truth)| methods.iter().map(move |method| (case, truth, *method)))
        .flat_map(|(case, truth, method)| {
            run::settings(method, args.quick).into_iter().map(move |setting| (case, truth, method, setting))
        })
        .collect();
    let bar = progress::bar(jobs.len() as u64);
    let mut points = Vec::with_capacity(jobs.len());
    for (case, truth, method, setting) in jobs {
        bar.set_message(format!("{}, {} {setting}", case.name, method.name()));
        if let Some(truth) = truth {
            points.push(run::run(case, truth, method, setting, limit));
        }
        bar.inc(1);
    }
    bar.finish_and_clear();

    let mut costs = Vec::new();
    let quiet = cases.iter().zip(&truths).find(|(case, _)| case.name == "top-hung");
    if let Some((case, Some(truth))) = quiet {
        costs = methods.iter().flat_map(|method| extras::costs(case, truth, *method)).collect();
    }
    let settled = settled(&cases, &truths, &methods, limit);
    let found = write::Found {
        cases: &cases,
        truths: &truths,
        points: &points,
        costs: &costs,
        settled: &settled,
        methods: &methods,
    };
    write::write(&found, &args.output)?;
    println!("{} points; results in {}", points.len(), args.output.out.display());
    Ok(())
}

/// From flat to rest, in the cases that are judged at rest, by the methods that hold cloth at the budget of a game.
fn settled(
    cases: &[case::Case],
    truths: &[Option<truth::Truth>],
    methods: &[Method],
    limit: f64,
) -> Vec<settle::Settled> {
    let rests = cases.iter().zip(truths).filter(|(case, _)| case.judged == case::Judged::Rest);
    let jobs: Vec<_> = rests
        .filter_map(|(case, truth)| Some((case, truth.as_ref()?)))
        .flat_map(|job| methods.iter().filter(|method| !method.steps_forces()).map(move |method| (job, *method)))
        .flat_map(|(job, method)| settle::SUBSTEPS.map(|substeps| (job, method, substeps)))
        .collect();
    let bar = progress::bar(jobs.len() as u64);
    let settled = jobs.into_iter().filter_map(|((case, truth), method, substeps)| {
        bar.set_message(format!("{} from flat, {}", case.name, method.name()));
        bar.inc(1);
        settle::settle(case, truth, method, substeps, limit)
    });
    let settled = settled.collect();
    bar.finish_and_clear();
    settled
}
