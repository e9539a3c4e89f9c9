//! One run of a stability map.

use std::sync::Arc;

use cloth_scene::{Scene, SceneCloth, SceneFabric, ScenePins, SceneWeight};
use cloth_solver::{Fabric, Method};
use glam::{DVec3, UVec2, Vec2, Vec3};

use crate::reference::{Sheet, highest_frequency, rest};

/// By how much gravity is turned out of the plane of a sheet that is to swing, rad: 5°.
const TILT: f32 = 0.087;
/// Internal friction of what is to settle, 1/s.
const SETTLING: f32 = 5.0;
/// Height through which what is to settle may fall while it finds its rest, m: what its energy is measured by.
const FALL: f64 = 0.05;
/// How far out of its plane a sheet that may fold starts towards rest, m.
const BULGE: f64 = 0.01;

/// A cloth at rest, as the reference has it, on which methods are tried.
#[derive(Clone, Debug)]
pub struct Subject {
    scene: Scene,
    start: Arc<Vec<DVec3>>,
    strain: f64,
    energy: f64,
    /// Its highest angular frequency, rad/s.
    pub frequency: f64,
}

/// One run: a cloth, how it is advanced, how long, and what it should come to.
#[derive(Clone, Debug)]
pub struct Trial {
    /// What is played.
    pub scene: Scene,
    /// Where it starts, at rest, row by row, m.
    pub start: Arc<Vec<DVec3>>,
    /// The reference's largest strain.
    pub strain: f64,
    /// The energy that there is to begin with, J.
    pub energy: f64,
    /// Ticks.
    pub ticks: u64,
}

impl Subject {
    /// An undamped sheet (`size` in m) of cotton poplin with stretch stiffness `stretch`, N/m, by its top edge, let go 5°
    /// out of its plane.
    pub fn swing(size: Vec2, cells: UVec2, stretch: f32) -> Self {
        Self::swing_of(size, cells, Fabric { stretch_warp: stretch, stretch_weft: stretch, ..Fabric::COTTON_POPLIN })
    }

    /// The same of another fabric, whose internal friction is left out.
    pub fn swing_of(size: Vec2, cells: UVec2, fabric: Fabric) -> Self {
        let fabric = Fabric { damping: 0.0, ..fabric };
        let cloth = SceneCloth {
            size,
            cells,
            fabric: SceneFabric::Custom(fabric),
            pins: vec![ScenePins::Top],
            ..SceneCloth::default()
        };
        let mut subject = Self::at_rest(Scene { cloths: vec![cloth], ..Scene::default() }, false);
        let gravity = subject.scene.gravity;
        subject.scene.gravity = Vec3::new(0.0, gravity.y * TILT.cos(), -gravity.y * TILT.sin());
        subject.energy *= 0.5 * f64::from(size.y) * (1.0 - f64::from(TILT).cos());
        subject
    }

    /// A square metre of cotton poplin by its upper corners, with `ratio` particle masses on a lower one.
    pub fn weighted(cells: u32, ratio: f32) -> Self {
        let mass = ratio * Fabric::COTTON_POPLIN.areal_density / (cells * cells) as f32;
        let cloth = SceneCloth {
            cells: UVec2::splat(cells),
            damping: Some(SETTLING),
            pins: vec![ScenePins::Corners],
            weights: vec![SceneWeight { at: Vec2::ONE, mass, body: None }],
            ..SceneCloth::default()
        };
        let mut subject = Self::at_rest(Scene { cloths: vec![cloth], ..Scene::default() }, true);
        subject.energy *= FALL;
        subject
    }

    /// At rest; its energy is its weight yet, N.
    fn at_rest(scene: Scene, folds: bool) -> Self {
        let Some(sheet) = Sheet::from_scene(&scene, 0.0) else {
            return Self { scene, start: Arc::default(), strain: f64::NAN, energy: f64::NAN, frequency: f64::NAN };
        };
        let bulge = if folds { BULGE } else { 0.0 };
        let from = sheet.flat.iter().map(|p| *p + DVec3::Z * bulge * (3.1 * p.x).cos() * (0.5 - p.y)).collect();
        let x = rest(&sheet, from).x;
        let (strain, frequency) = (sheet.largest_strain(&x), highest_frequency(&sheet, &x));
        Self { scene, start: Arc::new(x), strain, energy: sheet.weight(), frequency }
    }

    /// Steps of `h` seconds for a second, but for 60 steps at least and for `most` at most.
    pub fn steps_of(&self, method: Method, iterations: u32, h: f64, most: u64) -> Trial {
        let scene = Scene { rate: (1.0 / h) as f32, substeps: 1, method, iterations, ..self.scene.clone() };
        self.trial(scene, ((1.0 / h) as u64).clamp(60, most.max(60)))
    }

    /// Ticks of 1/60 s with `substeps` each, for `ticks` of them.
    pub fn substeps(&self, method: Method, iterations: u32, substeps: u32, ticks: u64) -> Trial {
        self.trial(Scene { substeps, method, iterations, ..self.scene.clone() }, ticks)
    }

    fn trial(&self, scene: Scene, ticks: u64) -> Trial {
        Trial { scene, start: self.start.clone(), strain: self.strain, energy: self.energy, ticks }
    }
}

/// The step length above which theory says that a method fails on a highest frequency of 1 rad/s, in seconds; `None`
/// for methods without such a limit. For explicit Euler, which gains energy at any step, the length at which rounding
/// errors grow to the size of the motion (by 10⁷) within `steps` steps.
pub fn limit(method: Method, steps: u64) -> Option<f64> {
    match method {
        // Amplitude grows by √(1 + ω²h²) a step.
        Method::ExplicitEuler => Some((2.0 * 1e7_f64.ln() / steps as f64).exp_m1().sqrt()),
        Method::SymplecticEuler | Method::StormerVerlet => Some(2.0),
        Method::RungeKutta4 => Some(2.828),
        _ => None,
    }
}
