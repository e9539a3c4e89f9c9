//! The scenes of the chart.

use cloth_scene::{Scene, SceneCloth, SceneCollider, SceneFabric, ScenePins, ScenePlace, SceneShape, SceneWeight};
use cloth_solver::Fabric;
use cloth_solver::forces::Air;
use glam::{UVec2, Vec2, Vec3};

/// Internal friction where only rest is looked at, 1/s: high, so that it comes soon. Rest does not depend on it.
const SETTLING: f32 = 5.0;
/// Mass of the weights, in masses of an inner particle.
const WEIGHT: f32 = 1000.0;
/// Radius of the ball, m.
const BALL: f32 = 0.25;

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judged {
    /// Rest, from the reference's rest on: largest strain over the last half second, shape at the end.
    Rest,
    /// A motion: largest strain and shape for as long as the reference is sure of itself. Wrinkles grow from rounding to
    /// centimetres within tenths of a second; beyond, no two runs agree.
    Motion,
    /// A motion that soon is chaos: shape for as long as the reference is sure of itself, and the largest strain that is passed in
    /// a twentieth of all ticks of the run.
    Wind,
    /// A motion whose energy is compared, too.
    Whip,
    /// A small swing: its energy, its period and what is left of its amplitude too.
    Swing,
}

impl Judged {
    /// Whether energies are compared.
    pub const fn by_energy(self) -> bool {
        matches!(self, Self::Whip | Self::Swing)
    }
}

/// A scene of the chart and what is compared in it.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its name on the command line and in the tables.
    pub name: &'static str,
    /// What is played. One cloth, a rectangle: of 1 × 1 m, but for the ribbon.
    pub scene: Scene,
    /// What is compared.
    pub judged: Judged,
}

/// The names of all cases, in their order.
pub const NAMES: [&str; 10] = [
    "top-hung",
    "corner-hung",
    "swing",
    "drape",
    "weight",
    "flag",
    "small-swing",
    "weight-corners",
    "flag-at-rest",
    "ribbon",
];

/// All cases, on `cells` × `cells` cells at 60 Hz:
///
/// - `top-hung`: cotton poplin by its whole top edge, at rest;
/// - `corner-hung`: by its two upper corners, at rest;
/// - `swing`: by its top edge, with cotton's own internal friction, let go horizontally, 2 s;
/// - `drape`: laid on a ball of 25 cm, a little off its middle, 0.6 s;
/// - `weight`: `top-hung` with 1000 particle masses on a free corner, at rest;
/// - `flag`: a flag of knitted polyester by its left edge in a wind of 6 m/s, 8 s;
/// - `small-swing`: by its top edge, undamped, let go at 5°, 5 s;
/// - `weight-corners`: `corner-hung` with the weight of `weight`;
/// - `flag-at-rest`: the flag by its left edge, without wind, at rest;
/// - `ribbon`: a strip of cotton poplin of 1 m, 4 columns × 60 rows of square cells, by its top edge, at rest.
pub fn cases(cells: u32) -> Vec<Case> {
    NAMES.iter().map(|name| case(name, cells)).collect()
}

fn case(name: &'static str, cells: u32) -> Case {
    let mass = Fabric::COTTON_POPLIN.areal_density / (cells * cells) as f32;
    let weight = vec![SceneWeight { at: Vec2::ONE, mass: WEIGHT * mass, body: None }];
    let cloth = SceneCloth { name: name.into(), cells: UVec2::splat(cells), ..SceneCloth::default() };
    let hung = |pins| SceneCloth { pins: vec![pins], damping: Some(SETTLING), ..cloth.clone() };
    let turned = |degrees| ScenePlace { turn: Vec3::X * degrees, ..ScenePlace::default() };
    let flag = SceneCloth {
        fabric: SceneFabric::Preset("Flag, knitted polyester".into()),
        pins: vec![ScenePins::Left],
        ..cloth.clone()
    };
    let swung = |degrees| SceneCloth { place: turned(degrees), damping: Some(0.0), ..hung(ScenePins::Top) };
    let scene = |cloth, seconds| Scene { title: name.into(), seconds, cloths: vec![cloth], ..Scene::default() };
    let (scene, judged) = match name {
        "corner-hung" => (scene(hung(ScenePins::Corners), 3.0), Judged::Rest),
        "swing" => (scene(SceneCloth { damping: None, ..swung(90.0) }, 2.0), Judged::Whip),
        "drape" => {
            // Just above it, and not so even that any fold is as good as its mirror image.
            let at = Vec3::new(0.03, -BALL - 0.012, 0.02);
            let place = ScenePlace { at, ..ScenePlace::default() };
            let shape = SceneShape::Sphere { radius: BALL };
            let ball = SceneCollider::new("ball", shape, place);
            let lying = SceneCloth { place: turned(-90.0), ..cloth.clone() };
            (Scene { colliders: vec![ball], ..scene(lying, 0.6) }, Judged::Motion)
        }
        "weight" => (scene(SceneCloth { weights: weight, ..hung(ScenePins::Top) }, 3.0), Judged::Rest),
        "flag" => {
            let wind = Vec3::new(6.0, 0.0, 0.5);
            (Scene { air: Some(Air::default()), wind, ..scene(flag, 8.0) }, Judged::Wind)
        }
        "small-swing" => (scene(swung(5.0), 5.0), Judged::Swing),
        "weight-corners" => (scene(SceneCloth { weights: weight, ..hung(ScenePins::Corners) }, 3.0), Judged::Rest),
        "flag-at-rest" => (scene(SceneCloth { damping: Some(SETTLING), ..flag }, 3.0), Judged::Rest),
        "ribbon" => {
            let cells = UVec2::new(4, 60);
            (scene(SceneCloth { cells, size: Vec2::new(4.0 / 60.0, 1.0), ..hung(ScenePins::Top) }, 3.0), Judged::Rest)
        }
        _ => (scene(hung(ScenePins::Top), 3.0), Judged::Rest),
    };
    Case { name, scene, judged }
}

impl Case {
    /// Number of ticks.
    pub fn ticks(&self) -> usize {
        (self.scene.seconds * self.scene.rate).round().max(1.0) as usize
    }

    /// Distance the cloth keeps from colliders, m.
    pub fn offset(&self) -> f64 {
        let world = cloth_scene::World::new(&self.scene).ok();
        world.and_then(|world| world.cloths.first().map(|cloth| f64::from(cloth.contacts.offset))).unwrap_or(0.0)
    }
}
