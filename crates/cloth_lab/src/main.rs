//! The lab's command line: `cargo run --release -p cloth_lab -- --help`.

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Charts speed against accuracy, maps where methods fail, checks known answers, compares engines, advises on scenes.
#[derive(Parser)]
#[command(name = "cloth_lab", version)]
struct Lab {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Work-precision diagrams: time against error for every method, scene by scene.
    Chart(cloth_lab::chart::Args),
    /// Maps of step length, stiffness, mass ratio and mesh size: survived, inaccurate, exploded.
    Stability(cloth_lab::stability::Args),
    /// Known answers against what the methods give.
    Validate(cloth_lab::validate::Args),
    /// The chart's scenes on other engines, in the same run.
    Compare(cloth_lab::compare::Args),
    /// Which parts of a scene's model could be left out, and what each costs.
    Advise(cloth_lab::advise::Args),
}

fn main() -> ExitCode {
    let outcome = match Lab::parse().command {
        Command::Chart(args) => cloth_lab::chart::run(&args),
        Command::Stability(args) => cloth_lab::stability::run(&args),
        Command::Validate(args) => cloth_lab::validate::run(&args),
        Command::Compare(args) => cloth_lab::compare::run(&args),
        Command::Advise(args) => cloth_lab::advise::run(&args),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
