//! Placeholder.

use clap::Args as ClapArgs;

use crate::LabError;

/// Arguments.
#[derive(ClapArgs, Debug)]
pub struct Args {
    /// Takes less than two minutes: fewer points, smaller meshes.
    #[arg(long)]
    pub quick: bool,
}

/// Runs the command.
pub fn run(_: &Args) -> Result<(), LabError> {
    Ok(())
}
