//! Known answers against what the methods give.

mod air;
mod cantilever;
pub mod closed;
mod conserved;
mod contact;
mod damage;
mod fan;
pub mod finding;
mod fire;
pub mod hang;
mod motion;
mod plane;
pub mod rig;
mod tell;
mod time;
mod waves;

use clap::Args as ClapArgs;
use cloth_solver::{ClothError, Method};

use crate::report::Output;
use crate::{LabError, progress};
use finding::{Bench, Bound, Finding, Verdict};

/// Arguments.
#[derive(ClapArgs, Debug)]
pub struct Args {
    /// Takes less than two minutes: fewer points, shorter runs.
    #[arg(long)]
    pub quick: bool,
    /// Only this method, by its name; all if left out.
    #[arg(long, value_name = "NAME")]
    pub method: Option<String>,
    /// Only checks whose name contains this.
    #[arg(long, value_name = "TEXT")]
    pub check: Option<String>,
    /// Where the results go.
    #[command(flatten)]
    pub output: Output,
}

/// A check: what it is called, and what it does.
type Check = (&'static str, fn(&mut Bench) -> Result<(), ClothError>);

const CHECKS: &[Check] = &[
    ("order of the method", time::order),
    ("numerical damping", time::damping),
    ("stability limit", time::stability),
    ("pendulum", time::pendulum),
    ("hanging strip", hang::strip),
    ("catenary", hang::chain),
    ("cantilever", cantilever::elastica),
    ("stiffness in the plane", plane::pulls),
    ("membrane", waves::membrane),
    ("swings of a hung sheet", waves::hung),
    ("friction", contact::friction),
    ("contact depth", contact::depth),
    ("air: fall", air::fall),
    ("air: wind", air::wind),
    ("tearing", damage::tearing),
    ("cutting", damage::cutting),
    ("fire: spread", fire::spread),
    ("fire: slope, mass and tick", fire::slope),
    ("fire: ignition", fire::ignition),
    ("fan: jet", fan::jet),
    ("fan: panel", fan::panel),
    ("gusts", fan::gusts),
    ("conservation", motion::conservation),
    ("crumpled: momentum", conserved::momentum),
    ("swing: energy", conserved::swing),
    ("falling flag: energy", conserved::flag),
    ("free fall", motion::fall),
    ("mesh and step independence", hang::refined),
];

/// Checks every known answer and writes `validate.md`, `.csv` and the pictures.
///
/// # Errors
/// What could not be written, or how many checks of the default method failed.
pub fn run(args: &Args) -> Result<(), LabError> {
    let wanted = |method: &Method| args.method.as_ref().is_none_or(|name| name == method.name());
    let methods = Method::ALL.into_iter().filter(wanted).collect();
    let mut bench = Bench { quick: args.quick, methods, findings: Vec::new(), figures: Vec::new() };
    let checks = CHECKS.iter().filter(|(name, _)| args.check.as_ref().is_none_or(|text| name.contains(text.as_str())));
    let checks: Vec<&Check> = checks.collect();
    let bar = progress::bar(checks.len() as u64);
    for (name, check) in checks {
        bar.set_message(*name);
        if let Err(error) = check(&mut bench) {
            // A cloth that was refused: the check failed, whatever else it found.
            bench.findings.push(Finding {
                check: name,
                quantity: error.to_string(),
                method: None,
                value: f64::NAN,
                expected: f64::NAN,
                bound: Bound::AtMost,
                claimed: true,
            });
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    let text = tell::report(&bench);
    println!("{text}");
    args.output.write("validate.md", &text)?;
    args.output.write("validate.csv", &tell::table(&bench).csv())?;
    for (stem, figure) in &bench.figures {
        figure.write(&args.output.picture(stem)?)?;
    }
    match tell::of_default(&bench, Verdict::Fail) {
        0 => Ok(()),
        failed => Err(LabError::Failed { failed }),
    }
}
