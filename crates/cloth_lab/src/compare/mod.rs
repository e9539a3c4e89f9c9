//! The same scenes on this project's methods and on the cloth of other engines, in the same run.

pub mod ours;
pub mod play;
#[cfg(feature = "engines")]
mod rapier;
#[cfg(feature = "engines")]
mod rapier_cloth;
pub mod scenes;
mod tell;
mod truth;

use clap::Args as ClapArgs;
use cloth_solver::{ClothError, Method};

use crate::report::Output;
use crate::{LabError, progress};
use ours::Ours;
use play::{Outcome, Played, play};
use scenes::Setup;

/// Arguments.
#[derive(ClapArgs, Debug)]
pub struct Args {
    /// Takes less than two minutes: sheets of 24 × 24 particles, fewer settings.
    #[arg(long)]
    pub quick: bool,
    /// Only scenes whose name contains this.
    #[arg(long, value_name = "TEXT")]
    pub scene: Option<String>,
    /// Where the results go.
    #[command(flatten)]
    pub output: Output,
}

/// Who simulates the cloth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contestant {
    /// One of this project's methods.
    Ours(Method),
    /// rapier3d's soft-body cloth.
    Rapier,
    /// rapier-cloth-core with the fabric's compliance.
    RapierCloth,
    /// rapier-cloth-core with compliance 0, which turns its tethers on.
    RapierClothRigid,
}

impl Contestant {
    /// What it is called in tables and plots.
    pub fn name(self) -> String {
        match self {
            Self::Ours(method) => method.name().into(),
            Self::Rapier => "rapier3d 0.36".into(),
            Self::RapierCloth => "rapier-cloth-core".into(),
            Self::RapierClothRigid => "r.-cloth-core, rigid".into(),
        }
    }

    /// Whether it is another engine.
    pub fn is_foreign(self) -> bool {
        !matches!(self, Self::Ours(_))
    }

    fn play(self, setup: &Setup, substeps: u32, iterations: u32) -> Result<Played, ClothError> {
        match self {
            Self::Ours(method) => play(setup, &mut Ours::new(setup, method, substeps, iterations)?),
            #[cfg(feature = "engines")]
            Self::Rapier => play(setup, &mut rapier::Rapier::new(setup, substeps, iterations)?),
            #[cfg(feature = "engines")]
            Self::RapierCloth | Self::RapierClothRigid => {
                let rigid = self == Self::RapierClothRigid;
                match rapier_cloth::RapierCloth::new(setup, substeps, iterations, rigid) {
                    Ok(mut engine) => play(setup, &mut engine),
                    Err(reason) => Ok(Played::unsupported(reason)),
                }
            }
            #[cfg(not(feature = "engines"))]
            _ => Ok(Played::unsupported("built without the feature `engines`")),
        }
    }

    /// The (substeps, iterations) it is tried at.
    fn settings(self, quick: bool) -> Vec<(u32, u32)> {
        let substeps: &[u32] = if quick { &[1, 4, 10, 20] } else { &[1, 2, 4, 10, 20, 40] };
        let with = |iterations: u32| substeps.iter().map(move |substeps| (*substeps, iterations));
        match self {
            Self::Ours(Method::XpbdSweeps) => with(1).chain([(1, 20), (80, 1)]).collect(),
            Self::Ours(method) if method.iterates() => with(1).chain(with(2)).chain([(1, 5), (1, 20)]).collect(),
            Self::Ours(_) => with(1).chain([(80, 1)]).collect(),
            Self::Rapier => with(4).chain([(10, 1), (10, 10)]).collect(),
            Self::RapierCloth | Self::RapierClothRigid => with(1).chain([(1, 20), (10, 2), (10, 4)]).collect(),
        }
    }
}

/// One run of one scene.
#[derive(Clone, Debug)]
pub struct Run {
    /// The scene's name.
    pub scene: &'static str,
    /// Who simulated it.
    pub by: Contestant,
    /// Substeps of a tick of 1/60 s.
    pub substeps: u32,
    /// Iterations of a substep.
    pub iterations: u32,
    /// What came of it.
    pub played: Played,
    /// Distance of its largest strain from the reference's, dimensionless; not finite where there is none.
    pub error: f64,
}

/// What the largest strains of a scene are held against.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The scene's name.
    pub scene: &'static str,
    /// Its largest strain, dimensionless.
    pub largest: f64,
    /// How sure it is, in words.
    pub convergence: String,
}

/// Plays every scene on every engine and writes `compare.md`, `.csv`, `.svg` and `.png`.
///
/// # Errors
/// What could not be written.
pub fn run(args: &Args) -> Result<(), LabError> {
    let (side, seconds) = if args.quick { (24, 2.0) } else { (64, 3.0) };
    let wanted = |setup: &Setup| args.scene.as_ref().is_none_or(|text| setup.name.contains(text.as_str()));
    let mut setups: Vec<Setup> = Setup::all(side, seconds).into_iter().filter(wanted).collect();
    let mut contestants = vec![Contestant::Ours(Method::default())];
    if Method::default() != Method::XpbdSweeps {
        contestants.push(Contestant::Ours(Method::XpbdSweeps));
    }
    if cfg!(feature = "engines") {
        contestants.extend([Contestant::Rapier, Contestant::RapierCloth, Contestant::RapierClothRigid]);
    } else {
        println!("Built without the feature `engines`: no other engine is compared.");
    }
    let per_scene: usize = contestants.iter().map(|by| by.settings(args.quick).len()).sum();
    let bar = progress::bar((setups.len() * (per_scene + 1)) as u64);
    let (mut references, mut runs) = (Vec::new(), Vec::new());
    for setup in &mut setups {
        bar.set_message(format!("{}: reference", setup.name));
        let offset = setup.cloth(Method::default()).map_or(0.0, |cloth| f64::from(cloth.contacts.offset));
        let truth = truth::truth(setup, offset);
        if let Some(rest) = &truth.rest {
            // Let go from rest: what an engine does not hold, sags.
            setup.start = rest.iter().map(|p| p.as_vec3()).collect();
        }
        bar.inc(1);
        for by in &contestants {
            for (substeps, iterations) in by.settings(args.quick) {
                bar.set_message(format!("{}: {}, {substeps} × {iterations}", setup.name, by.name()));
                let played = told(by.play(setup, substeps, iterations));
                let error = (played.largest - truth.largest).abs();
                runs.push(Run { scene: setup.name, by: *by, substeps, iterations, played, error });
                bar.inc(1);
            }
        }
        references.push(Reference { scene: setup.name, largest: truth.largest, convergence: truth.convergence });
    }
    bar.finish_and_clear();
    let text = tell::report(args, side, &references, &runs);
    println!("{text}");
    args.output.write("compare.md", &text)?;
    args.output.write("compare.csv", &tell::table(&runs).csv())?;
    tell::figure(&runs).write(&args.output.picture("compare")?)
}

/// A scene that this project refuses is a run that did not take place.
fn told(played: Result<Played, ClothError>) -> Played {
    played
        .unwrap_or_else(|error| Played { outcome: Outcome::Unsupported(error.to_string()), ..Played::unsupported("") })
}
