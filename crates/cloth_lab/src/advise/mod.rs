//! Which parts of a scene's model could be left out, and what each costs.
//!
//! The scene is played by the full model (the default method with a generous budget) and by a ladder of cheaper ones: parts
//! left out, coarser meshes, fewer substeps, other methods. What moves no material point by more than the tolerance can
//! go; what can go is then left out together, as far as the picture stays.

mod laws;
mod model;
mod play;
mod search;
mod told;

use std::path::PathBuf;

use clap::Args as ClapArgs;
use cloth_scene::Scene;

use crate::{LabError, progress};
use search::{Full, Settings};

/// Arguments.
#[derive(ClapArgs, Debug)]
pub struct Args {
    /// The scene's file (.ron), as the demo game loads it.
    #[arg(value_name = "SCENE.ron")]
    pub scene: PathBuf,

    /// Distance of a material point up to which two pictures count as the same, m.
    #[arg(long, value_name = "METRES", default_value_t = 0.01, value_parser = tolerance)]
    pub tolerance: f64,

    /// Takes less than two minutes: a less generous full model, fewer budgets of the other methods, at most 3 s of motion.
    #[arg(long)]
    pub quick: bool,

    /// How long the scene is played, s; in place of what its file says.
    #[arg(long)]
    pub seconds: Option<f32>,

    /// Also write the advice to this file (.md).
    #[arg(long, value_name = "FILE.md")]
    pub out: Option<PathBuf>,
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(metres) if (1e-9..=1e3).contains(&metres) => Ok(metres),
        Ok(metres) => Err(format!("{metres} m is out of range, allowed is 1e-9..=1000 m")),
        Err(_) => Err("expected a number of metres".into()),
    }
}

/// Longest motion played with `--quick`, s.
const QUICK_SECONDS: f32 = 3.0;

/// Prints the advice on a scene.
///
/// # Errors
/// A file that cannot be read or written, or is no scene.
pub fn run(args: &Args) -> Result<(), LabError> {
    let text = advice(args)?;
    println!("{text}");
    match &args.out {
        Some(path) => std::fs::write(path, text).map_err(|error| LabError::File { path: path.clone(), error }),
        None => Ok(()),
    }
}

fn advice(args: &Args) -> Result<String, LabError> {
    let path = &args.scene;
    let refused = |error| LabError::Scene { path: path.clone(), error };
    let text = std::fs::read_to_string(path).map_err(|error| LabError::File { path: path.clone(), error })?;
    let mut scene = Scene::from_ron(&text).map_err(refused)?;
    scene.seconds = args.seconds.unwrap_or(scene.seconds);
    scene.validate().map_err(refused)?;
    if args.quick {
        scene.seconds = scene.seconds.min(QUICK_SECONDS);
    }
    let settings = Settings { tolerance: args.tolerance, quick: args.quick };
    let bar = progress::bar(1);
    let full = Full::new(&scene, settings, &bar).map_err(refused)?;
    let predictions = laws::predictions(&full.scene, &full.recording);
    let ladder = full.ladder(settings, &bar).map_err(refused)?;
    let cheapest = full.cheapest(&ladder, &bar).map_err(refused)?;
    bar.finish_and_clear();
    let (full, ladder, cheapest, predictions) = (&full, &ladder[..], &cheapest, &predictions[..]);
    Ok(told::Found { file: path, scene: &scene, settings, full, ladder, cheapest, predictions }.markdown())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn args(name: &str, text: &str) -> Args {
        let scene = std::env::temp_dir().join(format!("{}-{name}.ron", std::process::id()));
        std::fs::write(&scene, text).unwrap();
        Args { scene, tolerance: 0.01, quick: true, seconds: Some(0.5), out: None }
    }

    #[test]
    fn the_advice_names_every_part_with_a_verdict_and_the_cheapest_model() {
        let args = args(
            "advised",
            "(about: \"A rag.\", cloths: [(size: (0.2, 0.2), cells: (6, 6), pins: [Top])], colliders: [(shape: Ground, place: (at: (0, -9, 0)))])",
        );
        let text = advice(&args).unwrap();
        for expected in [
            "A rag.",
            "no bending and twist",
            "no shear",
            "no friction",
            "1 collider(s)",
            "self-contact",
            "1/2 of the cells",
            "1 substeps",
            "Played together",
            "can go",
        ] {
            assert!(text.contains(expected), "{expected} is missing in\n{text}");
        }
        assert!(!text.contains("no air"), "there is no air to leave out:\n{text}");
        std::fs::remove_file(args.scene).unwrap();
    }

    #[test]
    fn a_file_that_is_missing_or_no_scene_is_named_with_the_reason() {
        let missing = Args { scene: "no/such/scene.ron".into(), ..args("missing", "()") };
        assert!(advice(&missing).unwrap_err().to_string().starts_with("no/such/scene.ron: "));
        let wrong = args("wrong", "(\n wnid: 3)");
        assert!(advice(&wrong).unwrap_err().to_string().contains("wrong.ron: line 2, column "));
        let endless = Args { seconds: Some(f32::NAN), ..args("endless", "()") };
        assert!(advice(&endless).unwrap_err().to_string().contains("Scene::seconds"));
    }
}
