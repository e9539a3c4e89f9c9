//! The ladder: every cheaper model measured against the full one, and the cheapest that looks the same.

use std::time::{Duration, Instant};

use cloth_advice::Difference;
use cloth_scene::{Scene, SceneError};
use cloth_solver::Method;
use indicatif::ProgressBar;

use super::model::{self, Change, Lever, changed};
use super::play::{By, End, Recording, play};

/// Substeps of the full model, at least.
const GENEROUS_SUBSTEPS: u32 = 40;
/// Iterations of the full model, if its method iterates, at least.
const GENEROUS_ITERATIONS: u32 = 10;
/// How much longer a scene is played to let it come to rest, s.
const SETTLING: f32 = 10.0;
/// A budget is given up that takes so many times as long as the full one, and longer than [`IMPATIENCE`].
const PATIENCE: u32 = 4;
/// Computing time that every model is given.
const IMPATIENCE: Duration = Duration::from_secs(3);

/// How the search goes about.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Distance of material points up to which two pictures count as the same, m.
    pub tolerance: f64,
    /// Fewer tries, a less generous full model.
    pub quick: bool,
}

/// One model against the full one.
#[derive(Clone, Debug)]
pub struct Measured {
    /// What was changed.
    pub change: Change,
    /// How far the picture is from the full model's.
    pub difference: Difference,
    /// Median time of a tick, ms.
    pub median: f64,
    /// How it ended.
    pub end: End,
}

/// The model that all others are measured against, and how finely it can be told from itself.
#[derive(Clone, Debug)]
pub struct Full {
    /// The scene with a generous budget.
    pub scene: Scene,
    /// Its play.
    pub recording: Recording,
    /// What is compared.
    pub by: By,
    /// How far the full model is from itself with twice the substeps, over the whole path.
    pub path: Difference,
    /// The same, by what is compared.
    pub own: Difference,
    /// A change up to this many metres is none: the tolerance, or more where the full model does not know better.
    pub bar: f64,
}

/// The cheapest model within the bar.
#[derive(Clone, Debug)]
pub struct Cheapest {
    /// What differs from the full model.
    pub changes: Vec<Change>,
    /// The scene.
    pub scene: Scene,
    /// How far its picture is from the full model's.
    pub difference: Difference,
    /// Its play.
    pub recording: Recording,
}

/// The scene as the full model: the default method with a generous budget.
pub fn generous(scene: &Scene, quick: bool) -> Scene {
    let method = Method::default();
    let substeps = if quick { GENEROUS_SUBSTEPS / 2 } else { GENEROUS_SUBSTEPS };
    let iterations = if method.iterates() { scene.iterations.max(GENEROUS_ITERATIONS) } else { 1 };
    Scene { method, substeps: scene.substeps.max(substeps), iterations, ..scene.clone() }
}

impl Full {
    /// Plays the full model, and again with twice the substeps. Where the two differ by more than the tolerance the motion
    /// is not determined to that: then the settled end is compared, and where that differs too, or there is none, the
    /// mean.
    ///
    /// # Errors
    /// What in the scene is out of range.
    pub fn new(scene: &Scene, settings: Settings, bar: &ProgressBar) -> Result<Self, SceneError> {
        let twice = |scene: &Scene| Scene { substeps: scene.substeps * 2, ..scene.clone() };
        let mut scene = generous(scene, settings.quick);
        bar.set_message("the full model");
        let mut recording = play(&scene, Duration::MAX)?;
        bar.set_message("the full model with twice the substeps");
        let mut again = play(&twice(&scene), Duration::MAX)?;
        let path = recording.difference(&again, By::Path);
        let mut by = By::Path;
        if path.most > settings.tolerance {
            bar.set_message("the full model, until it rests");
            let longer = Scene { seconds: (scene.seconds + SETTLING).min(3600.0), ..scene.clone() };
            let (long, long_again) = (play(&longer, Duration::MAX)?, play(&twice(&longer), Duration::MAX)?);
            let settled = long.at_rest_from.is_some() && long_again.at_rest_from.is_some();
            if settled && long.difference(&long_again, By::End).most <= settings.tolerance {
                (scene, recording, again, by) = (longer, long, long_again, By::End);
            } else {
                by = By::Mean;
            }
        }
        let own = recording.difference(&again, by);
        let most = if own.most.is_finite() { own.most } else { 0.0 };
        Ok(Self { scene, recording, by, path, own, bar: settings.tolerance.max(most) })
    }

    /// Whether a change of the picture is one.
    pub fn within(&self, difference: Difference) -> bool {
        difference.most <= self.bar
    }

    /// Plays `scene` and compares.
    fn compare(&self, scene: &Scene) -> Result<(Difference, Recording), SceneError> {
        let ticks = self.scene.seconds * self.scene.rate;
        let patience = Duration::from_secs_f64(1e-3 * self.recording.median * f64::from(ticks)) * PATIENCE;
        // A part that is left out takes no longer; what looks so is the machine's doing.
        let patience = if scene.substeps == self.scene.substeps { Duration::MAX } else { patience.max(IMPATIENCE) };
        let recording = play(scene, patience)?;
        Ok((self.recording.difference(&recording, self.by), recording))
    }

    fn measure(&self, change: Change, bar: &ProgressBar) -> Result<Measured, SceneError> {
        bar.set_message(change.name());
        let (difference, recording) = self.compare(&changed(&self.scene, &change))?;
        bar.inc(1);
        Ok(Measured { change, difference, median: recording.median, end: recording.end })
    }

    /// Every part, mesh and budget by itself. Of another method's budgets those up to the first within the bar.
    ///
    /// # Errors
    /// What in a changed scene is out of range.
    pub fn ladder(&self, settings: Settings, bar: &ProgressBar) -> Result<Vec<Measured>, SceneError> {
        let parts = model::parts(&self.scene, &self.recording.touched);
        let (meshes, substeps) = (model::meshes(&self.scene), model::substeps(&self.scene));
        let others: Vec<Vec<Change>> = (Method::ALL.into_iter())
            .filter(|method| *method != self.scene.method)
            .map(|method| model::budgets(method, &self.scene, settings.quick))
            .collect();
        bar.set_length((parts.len() + meshes.len() + substeps.len() + others.iter().flatten().count()) as u64);
        let mut ladder = Vec::new();
        for change in parts.into_iter().chain(meshes).chain(substeps) {
            ladder.push(self.measure(change, bar)?);
        }
        for budgets in others {
            for (tried, change) in budgets.iter().enumerate() {
                let measured = self.measure(change.clone(), bar)?;
                let found = self.within(measured.difference);
                ladder.push(measured);
                if found {
                    bar.inc((budgets.len() - tried - 1) as u64);
                    break;
                }
            }
        }
        Ok(ladder)
    }

    /// Combines what can go, lever by lever, the one that saves most first, and keeps what stays within the bar when
    /// played together. A budget is only taken where it is faster.
    ///
    /// # Errors
    /// What in a changed scene is out of range.
    pub fn cheapest(&self, ladder: &[Measured], bar: &ProgressBar) -> Result<Cheapest, SceneError> {
        let begin = Instant::now();
        let mut cheapest = Cheapest {
            changes: Vec::new(),
            scene: self.scene.clone(),
            difference: Difference::default(),
            recording: self.recording.clone(),
        };
        let mut passing: Vec<&Measured> = ladder
            .iter()
            .filter(|measured| self.within(measured.difference) && measured.change != Change::Inextensible)
            .collect();
        passing.sort_by(|a, b| a.median.total_cmp(&b.median));
        let mut pulled: Vec<Lever> = Vec::new();
        for measured in passing {
            let lever = measured.change.lever();
            if pulled.contains(&lever) {
                continue;
            }
            bar.set_message(format!("together, {:.0} s: {}", begin.elapsed().as_secs_f32(), measured.change.name()));
            let scene = changed(&cheapest.scene, &measured.change);
            let (difference, recording) = self.compare(&scene)?;
            let faster = recording.median < cheapest.recording.median;
            if self.within(difference) && (faster || matches!(lever, Lever::Part(_))) {
                pulled.push(lever);
                cheapest.changes.push(measured.change.clone());
                cheapest = Cheapest { scene, difference, recording, ..cheapest };
            }
        }
        Ok(cheapest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn searched(text: &str, tolerance: f64) -> (Full, Vec<Measured>, Cheapest) {
        let (settings, bar) = (Settings { tolerance, quick: true }, ProgressBar::hidden());
        let full = Full::new(&Scene::from_ron(text).unwrap(), settings, &bar).unwrap();
        let ladder = full.ladder(settings, &bar).unwrap();
        let cheapest = full.cheapest(&ladder, &bar).unwrap();
        (full, ladder, cheapest)
    }

    fn can_go(full: &Full, ladder: &[Measured], change: &Change) -> bool {
        full.within(ladder.iter().find(|m| m.change == *change).unwrap_or_else(|| panic!("{change:?}")).difference)
    }

    /// A sheet of paper that juts out from its clamped edge, over ground it never touches.
    const PAPER: &str = "(seconds: 1.5, air: (), cloths: [(size: (0.2, 0.1), cells: (8, 4), damping: 5, pins: [Left],
        fabric: Preset(\"felt, 1 mm\"), place: (at: (0, 5, 0), turn: (-90, 0, 0)))], colliders: [(shape: Ground)])";

    #[test]
    fn what_holds_a_stiff_sheet_up_is_needed_and_ground_far_below_is_not() {
        let (full, ladder, cheapest) = searched(PAPER, 0.005);
        assert!(!can_go(&full, &ladder, &Change::NoBending));
        assert!(can_go(&full, &ladder, &Change::NoColliders(vec![0])));
        assert!(can_go(&full, &ladder, &Change::NoFriction));
        assert!(can_go(&full, &ladder, &Change::Inextensible));
        assert!(cheapest.changes.contains(&Change::NoColliders(vec![0])));
        assert!(!cheapest.changes.contains(&Change::NoBending));
        assert!(full.within(cheapest.difference));
    }

    #[test]
    fn whatever_looks_the_same_to_a_blind_eye_goes() {
        let (full, ladder, cheapest) = searched(PAPER, 1e3);
        assert_eq!(full.by, By::Path);
        assert!(ladder.iter().all(|measured| full.within(measured.difference) || measured.end != End::Finished));
        for change in [Change::NoBending, Change::NoShear, Change::NoAir, Change::NoFriction] {
            assert!(cheapest.changes.contains(&change), "{change:?}: {:?}", cheapest.changes);
        }
        let levers: Vec<Lever> = cheapest.changes.iter().map(Change::lever).collect();
        assert!(levers.iter().enumerate().all(|(index, lever)| !levers[..index].contains(lever)), "{levers:?}");
        assert_eq!(cheapest.scene.air, None);
    }

    #[test]
    fn the_cheapest_model_is_the_scene_with_its_changes_and_nothing_more() {
        let (full, _, cheapest) = searched(PAPER, 0.02);
        let scene = cheapest.changes.iter().fold(full.scene.clone(), |scene, change| changed(&scene, change));
        assert_eq!(scene, cheapest.scene);
    }

    #[test]
    fn a_flag_that_flaps_is_compared_by_its_mean_and_no_finer_than_it_knows_itself() {
        let flag = "(seconds: 2, air: (), wind: (8, 0, 2), cloths: [(size: (0.6, 0.4), cells: (12, 8), pins: [Left],
            fabric: Preset(\"silk charmeuse\"), damping: 0)])";
        let (settings, bar) = (Settings { tolerance: 1e-7, quick: true }, ProgressBar::hidden());
        let full = Full::new(&Scene::from_ron(flag).unwrap(), settings, &bar).unwrap();
        assert_eq!(full.by, By::Mean);
        assert!(full.path.most > settings.tolerance && full.bar == full.own.most.max(settings.tolerance));
        assert!(full.within(full.own));
    }

    #[test]
    fn a_scene_that_comes_to_the_same_rest_on_another_way_is_compared_there() {
        // Two ways down differ by a hair in the air and end in the same plumb line.
        let swing = "(seconds: 0.5, air: (density: 50), cloths: [(size: (0.2, 0.2), cells: (4, 4), pins: [Top],
            damping: 50, place: (turn: (-90, 0, 0)))])";
        let (settings, bar) = (Settings { tolerance: 2e-5, quick: true }, ProgressBar::hidden());
        let full = Full::new(&Scene::from_ron(swing).unwrap(), settings, &bar).unwrap();
        assert_eq!(full.by, By::End, "{:?} {:?}", full.path, full.own);
        assert!(full.scene.seconds > 10.0);
    }
}
