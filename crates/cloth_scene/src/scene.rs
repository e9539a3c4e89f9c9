//! What a scene file says.

use cloth_solver::contact::SelfContact;
use cloth_solver::forces::{Air, Gusts};
use cloth_solver::method::Method;
use cloth_solver::{ClothError, Fabric, Pose};
use glam::{EulerRot, Quat, UVec2, Vec2, Vec3};
use serde::{Deserialize, Serialize};

use crate::{
    Finish, SceneError, SceneFan, SceneFigure, SceneFire, SceneLook, SceneMotion, ScenePins, SceneProp, SceneShape,
    SceneView, SceneWorn, SceneWrap, SceneZone,
};

/// A scene: cloths, colliders, gravity, air and what moves it, and how it is advanced. Every field may be left out, none may be unknown.
///
/// Units are SI, y is up. `Some(…)` may be left out around the value of an optional field.
///
/// ```
/// let scene = cloth_scene::Scene::from_ron(
///     r#"(
///         title: "A towel in the wind",
///         seconds: 4,
///         wind: (3, 0, 1), gusts: (intensity: 0.15),
///         air: (),                                    // dry air at sea level; left out, no air acts
///         cloths: [(
///             size: (0.5, 1), cells: (10, 20),
///             fabric: Preset("terry towel"),
///             pins: [Corners],
///             weights: [(at: (1, 1), mass: 0.05)],    // 50 g on the lower right corner
///             place: (at: (0, 1.6, 0), turn: (0, 30, 0)),
///         )],
///         fans: [(fan: (speed: 4), place: (at: (0, 1.6, 2)))],
///         colliders: [(name: "post", shape: Capsule(radius: 0.05, length: 2), place: (at: (0.6, 1, 0)))],
///     )"#,
/// )?;
/// assert_eq!(scene.cloths[0].fabric().unwrap().areal_density, 0.45);
/// assert_eq!(scene.substeps, 10);
/// # Ok::<(), cloth_scene::SceneError>(())
/// ```
#[derive(Serialize, Deserialize, Clone, Debug, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct Scene {
    /// What it is called.
    pub title: String,
    /// What it shows, in a sentence.
    pub about: String,
    /// How long it is worth watching, s; 0.01..=3600. Default 5.
    pub seconds: f32,
    /// Gravity, m/s². Default (0, −9.81, 0).
    pub gravity: Vec3,
    /// The air around. Default none: no air acts.
    pub air: Option<Air>,
    /// Velocity of the air, m/s. Default 0.
    pub wind: Vec3,
    /// How gusty it is. Default: not at all.
    pub gusts: Gusts,
    /// Regions with a wind of their own, on top of it.
    pub zones: Vec<SceneZone>,
    /// Fans, on top of it.
    pub fans: Vec<SceneFan>,
    /// Length of a tick, as ticks per second, Hz; 1..=10000. Default 60.
    pub rate: f32,
    /// The method. Default [`Method::default`].
    pub method: Method,
    /// Substeps in a tick, 1..=10000. Default 10.
    pub substeps: u32,
    /// Iterations in a substep, 1..=1000; only of methods that iterate. Default 1.
    pub iterations: u32,
    /// The cloths.
    pub cloths: Vec<SceneCloth>,
    /// What they meet.
    pub colliders: Vec<SceneCollider>,
    /// Mannequins that walk. Cloth cannot enter them, and they may wear it.
    pub figures: Vec<SceneFigure>,
    /// What is only seen.
    pub props: Vec<SceneProp>,
    /// How it is shown.
    pub view: SceneView,
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            title: String::new(),
            about: String::new(),
            seconds: 5.0,
            gravity: Vec3::new(0.0, -9.81, 0.0),
            air: None,
            wind: Vec3::ZERO,
            gusts: Gusts::default(),
            zones: Vec::new(),
            fans: Vec::new(),
            rate: 60.0,
            method: Method::default(),
            substeps: 10,
            iterations: 1,
            cloths: Vec::new(),
            colliders: Vec::new(),
            figures: Vec::new(),
            props: Vec::new(),
            view: SceneView::default(),
        }
    }
}

/// A rectangle of fabric, or a piece cut out of one.
#[derive(Serialize, Deserialize, Clone, Debug, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct SceneCloth {
    /// What it is called.
    pub name: String,
    /// Width (weft, x) and height (warp, y), m. Default (1, 1).
    pub size: Vec2,
    /// Cells along width and height. Default (40, 40).
    pub cells: UVec2,
    /// What it is made of. Default cotton poplin.
    pub fabric: SceneFabric,
    /// Internal friction in place of the fabric's, 1/s; 0..=1000. Default none: the fabric's own.
    pub damping: Option<f32>,
    /// What holds it.
    pub pins: Vec<ScenePins>,
    /// Weights that hang on it.
    pub weights: Vec<SceneWeight>,
    /// How it keeps off itself; `()` for the fabric's own thickness and friction. Default none: it passes through itself.
    pub self_contact: Option<SelfContact>,
    /// How it burns, and where it is lit. Default none: it does not burn.
    pub fire: Option<SceneFire>,
    /// How easily it tears. Default none: it only can be cut. A world played without an engine tears nothing.
    pub tearing: Option<SceneTearing>,
    /// The outline of a piece that is cut out of the rectangle, as parts of width (from the left) and height (from the top),
    /// 0..=1: whole cells whose middle lies within it. Default the whole rectangle. At most 1,000 corners.
    pub outline: Vec<Vec2>,
    /// How it goes around something. Its size is then that of the wrap, and `size` says nothing. Default: it is flat.
    pub wrap: Option<SceneWrap>,
    /// What wears it. Default none.
    pub worn: Option<SceneWorn>,
    /// The method, in place of the scene's. Default none.
    pub method: Option<Method>,
    /// Substeps in a tick, in place of the scene's, 1..=10000. Default none.
    pub substeps: Option<u32>,
    /// How what holds it moves. Default none: it stands.
    pub motion: Option<SceneMotion>,
    /// To which part of its width the pins of a cloth held by its top are drawn together in the first second, 0.05..=1: then it
    /// hangs in folds. Default 1.
    pub gather: f32,
    /// How it looks. Default: a colour that the demo chooses.
    pub look: Option<SceneLook>,
    /// What is seen where it is held. Default [`Hardware::Auto`].
    pub hardware: Hardware,
    /// Where the middle of the rectangle is and how it is turned; unturned it stands upright and faces +z. Of one that is worn: as seen
    /// from the part that it goes with.
    pub place: ScenePlace,
}

impl Default for SceneCloth {
    fn default() -> Self {
        Self {
            name: String::new(),
            size: Vec2::ONE,
            cells: UVec2::splat(40),
            fabric: SceneFabric::default(),
            damping: None,
            pins: Vec::new(),
            weights: Vec::new(),
            self_contact: None,
            fire: None,
            tearing: None,
            outline: Vec::new(),
            wrap: None,
            worn: None,
            method: None,
            substeps: None,
            motion: None,
            gather: 1.0,
            look: None,
            hardware: Hardware::default(),
            place: ScenePlace::default(),
        }
    }
}

/// How easily a cloth tears.
#[derive(Serialize, Deserialize, Clone, Copy, Debug, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct SceneTearing {
    /// Factor on the fabric's strength, above 0, up to 1000. Default 0.02: real fabric is too strong for a hand that drags it.
    pub scale: f32,
}

impl Default for SceneTearing {
    fn default() -> Self {
        Self { scale: 0.02 }
    }
}

/// What is seen where a cloth is held.
#[derive(Serialize, Deserialize, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hardware {
    /// A curtain rod with rings if it is held by [`ScenePins::Rods`] alone, else nothing.
    #[default]
    Auto,
    /// Nothing.
    None,
    /// A curtain rod whose rings slide along it.
    SlidingRod,
    /// A clothes peg at each pin.
    Pegs,
    /// A ring at each pin, around a pole.
    Rings,
}

/// A fabric by name, or with all its values.
#[derive(Serialize, Deserialize, Clone, Debug, PartialEq)]
pub enum SceneFabric {
    /// The name of a preset, as in [`Fabric::PRESETS`], in any case, e.g. `Preset("cotton poplin")`.
    Preset(String),
    /// Its values; those left out are cotton poplin's.
    Custom(Fabric),
}

impl Default for SceneFabric {
    fn default() -> Self {
        Self::Preset("cotton poplin".into())
    }
}

/// A weight on one particle.
#[derive(Serialize, Deserialize, Clone, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct SceneWeight {
    /// Where, as parts of width (from the left) and height (from the top): (1, 1) is the lower right corner.
    pub at: Vec2,
    /// How heavy, kg; 0..=1e6. It comes on top of the fabric's own mass.
    pub mass: f32,
    /// What it looks like: form and surface. It stands on the cloth there and is only seen. Default: it is not seen.
    #[serde(default)]
    pub body: Option<(SceneShape, Finish)>,
}

/// Where something is.
#[derive(Serialize, Deserialize, Clone, Copy, Debug, Default, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct ScenePlace {
    /// Translation, m; −1e6..=1e6 on each axis.
    pub at: Vec3,
    /// Turns about x, then y, then z, degrees; −1e6..=1e6.
    pub turn: Vec3,
}

impl ScenePlace {
    /// Where `pose` is, to a tenth of a millimetre and a thousandth of a degree.
    pub fn of(pose: &Pose) -> Self {
        let (z, y, x) = pose.rotation.to_euler(EulerRot::ZYX);
        let round = |number: f32, parts: f32| (number * parts).round() / parts;
        // Not −0.
        let rounded = |numbers: [f32; 3], parts| Vec3::from(numbers.map(|number| round(number, parts) + 0.0));
        Self { at: rounded(pose.position.to_array(), 1e4), turn: rounded([x, y, z].map(f32::to_degrees), 1e3) }
    }

    /// The same as a pose.
    pub fn pose(&self) -> Pose {
        let turn = self.turn * (core::f32::consts::PI / 180.0);
        Pose::new(self.at, Quat::from_euler(EulerRot::ZYX, turn.z, turn.y, turn.x))
    }

    pub(crate) fn validate(&self, field: &'static str) -> Result<(), ClothError> {
        self.at.to_array().into_iter().chain(self.turn.to_array()).try_for_each(|number| {
            ClothError::check(field, number, -1e6..=1e6, "-1,000,000..=1,000,000 m or degrees on each axis")
        })
    }
}

/// Something cloth cannot enter.
#[derive(Serialize, Deserialize, Clone, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct SceneCollider {
    /// What it is called.
    #[serde(default)]
    pub name: String,
    /// Its form.
    pub shape: SceneShape,
    /// Where it is.
    #[serde(default)]
    pub place: ScenePlace,
    /// Coulomb friction against cloth in place of the fabric's own, dimensionless, 0..=10.
    #[serde(default)]
    pub friction: Option<f32>,
    /// How it moves. Default: it stands.
    #[serde(default)]
    pub motion: Option<SceneMotion>,
    /// Mass of one that falls and is pushed by cloth, kg, 0.001..=1000; only of spheres. It moves in the demo; a world played
    /// without an engine leaves it out. Default none: it is held.
    #[serde(default)]
    pub mass: Option<f32>,
    /// How its surface looks. Default: a colour that the demo chooses.
    #[serde(default)]
    pub finish: Option<Finish>,
}

impl Scene {
    /// Reads a scene from RON.
    ///
    /// # Errors
    /// Where the text is not a scene, or what in it is out of range.
    pub fn from_ron(text: &str) -> Result<Self, SceneError> {
        let scene: Self = ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
            .from_str(text)
            .map_err(|error| SceneError::Syntax {
                line: error.span.start.line,
                column: error.span.start.col,
                message: error.code.to_string(),
            })?;
        scene.validate()?;
        Ok(scene)
    }

    /// Checks every value against its range.
    ///
    /// # Errors
    /// The first that is out of range.
    pub fn validate(&self) -> Result<(), SceneError> {
        ClothError::check("Scene::seconds", self.seconds, 0.01..=3600.0, "0.01..=3600 s")?;
        ClothError::check("Scene::rate", self.rate, 1.0..=1e4, "1..=10,000 Hz")?;
        ClothError::check("Scene::substeps", self.substeps as f32, 1.0..=1e4, "1..=10,000")?;
        ClothError::check("Scene::iterations", self.iterations as f32, 1.0..=1e3, "1..=1,000")?;
        for axis in self.gravity.to_array() {
            ClothError::check("Scene::gravity", axis, -1e4..=1e4, "-10,000..=10,000 m/s² on each axis")?;
        }
        for axis in self.wind.to_array() {
            ClothError::check("Scene::wind", axis, -1e6..=1e6, "-1,000,000..=1,000,000 m/s on each axis")?;
        }
        if let Some(air) = &self.air {
            air.validate()?;
        }
        self.gusts.validate()?;
        for (zone, spec) in self.zones.iter().enumerate() {
            let of_zone = |error| SceneError::Zone { zone, error };
            spec.zone.validate().and_then(|()| spec.place.validate("SceneZone::place")).map_err(of_zone)?;
        }
        for (fan, spec) in self.fans.iter().enumerate() {
            let of_fan = |error| SceneError::Fan { fan, error };
            spec.fan.validate().and_then(|()| spec.place.validate("SceneFan::place")).map_err(of_fan)?;
        }
        for (cloth, spec) in self.cloths.iter().enumerate() {
            spec.validate().map_err(|error| SceneError::Cloth { cloth, error })?;
        }
        for (figure, spec) in self.figures.iter().enumerate() {
            spec.validate().map_err(|error| SceneError::Figure { figure, error })?;
        }
        for (cloth, spec) in self.cloths.iter().enumerate() {
            let Some(worn) = spec.worn else { continue };
            if worn.figure as usize >= self.figures.len() {
                let allowed = "the number of one of the scene's `figures`, from 0";
                let error = ClothError::OutOfRange { field: "SceneWorn::figure", value: worn.figure as f32, allowed };
                return Err(SceneError::Cloth { cloth, error });
            }
        }
        for (prop, spec) in self.props.iter().enumerate() {
            let of_prop = |error| SceneError::Prop { prop, error };
            spec.place.validate("SceneProp::place").and_then(|()| spec.finish.validate()).map_err(of_prop)?;
        }
        self.view.validate()?;
        for (collider, spec) in self.colliders.iter().enumerate() {
            let of_collider = |error| SceneError::Collider { collider, error };
            spec.validate().map_err(of_collider)?;
            // Seen from no cloth in particular: a scene may have none.
            crate::world::solid(spec, &Pose::IDENTITY, &Fabric::default()).map_err(of_collider)?;
        }
        // What a cloth is made of is checked by building it.
        crate::World::new(self).map(drop)
    }
}

impl Scene {
    /// Where a cloth of the scene is at first, in the world.
    pub fn frame(&self, cloth: &SceneCloth) -> Pose {
        let (place, worn) = (cloth.place.pose(), cloth.worn);
        match worn.and_then(|worn| Some(self.figures.get(worn.figure as usize)?.standing(worn.part))) {
            Some(part) => Pose::new(part.point(place.position), (part.rotation * place.rotation).normalize()),
            None => place,
        }
    }
}

impl SceneWeight {
    /// Row (from the top) and column (from the left) of the particle it hangs on, among `cells` of the cloth.
    pub fn row_and_column(&self, cells: UVec2) -> UVec2 {
        let nearest = (self.at.clamp(Vec2::ZERO, Vec2::ONE) * cells.as_vec2()).round().as_uvec2();
        UVec2::new(nearest.y, nearest.x)
    }
}

impl SceneCollider {
    /// One that stands.
    pub fn new(name: &str, shape: SceneShape, place: ScenePlace) -> Self {
        Self { name: name.into(), shape, place, friction: None, motion: None, mass: None, finish: None }
    }

    fn validate(&self) -> Result<(), ClothError> {
        self.place.validate("SceneCollider::place")?;
        if let Some(mass) = self.mass {
            let (least, most) = if matches!(self.shape, SceneShape::Sphere { .. }) { (1e-3, 1e3) } else { (0.0, 0.0) };
            ClothError::check("SceneCollider::mass", mass, least..=most, "0.001..=1000 kg, of a sphere only")?;
        }
        self.motion.as_ref().map_or(Ok(()), SceneMotion::validate)?;
        self.finish.as_ref().map_or(Ok(()), Finish::validate)
    }
}

impl SceneCloth {
    fn validate(&self) -> Result<(), ClothError> {
        self.place.validate("SceneCloth::place")?;
        if let Some(substeps) = self.substeps {
            ClothError::check("SceneCloth::substeps", substeps as f32, 1.0..=1e4, "1..=10,000")?;
        }
        if let Some(tearing) = self.tearing {
            ClothError::check("SceneTearing::scale", tearing.scale, f32::MIN_POSITIVE..=1e3, "above 0, up to 1000")?;
        }
        ClothError::check("SceneCloth::gather", self.gather, 0.05..=1.0, "0.05..=1")?;
        ClothError::check("SceneCloth::outline", self.outline.len() as f32, 0.0..=1e3, "at most 1,000 corners")?;
        for corner in &self.outline {
            for part in corner.to_array() {
                ClothError::check("SceneCloth::outline", part, 0.0..=1.0, "0..=1, parts of width and height")?;
            }
        }
        self.wrap.as_ref().map_or(Ok(()), SceneWrap::validate)?;
        self.motion.as_ref().map_or(Ok(()), SceneMotion::validate)?;
        self.look.as_ref().map_or(Ok(()), SceneLook::validate)
    }

    /// Where a pin that is held at `local` (m, in the cloth's own frame) at rest is moved to at a time, s.
    pub fn held(&self, local: Vec3, time: f64) -> Pose {
        let pose = self.motion.as_ref().map_or(Pose::IDENTITY, |motion| motion.at(time));
        let part = time.clamp(0.0, 1.0) as f32;
        let drawn = (self.gather - 1.0) * part * part * (3.0 - 2.0 * part) * local.x;
        Pose::new(pose.point(Vec3::X * drawn), pose.rotation)
    }

    /// The fabric, with the damping of this cloth.
    ///
    /// # Errors
    /// The name, if there is no such preset.
    pub fn fabric(&self) -> Result<Fabric, String> {
        let fabric = match &self.fabric {
            SceneFabric::Preset(name) => Fabric::PRESETS
                .iter()
                .find(|(preset, _)| preset.eq_ignore_ascii_case(name))
                .map(|(_, fabric)| *fabric)
                .ok_or_else(|| name.clone())?,
            SceneFabric::Custom(fabric) => *fabric,
        };
        Ok(Fabric { damping: self.damping.unwrap_or(fabric.damping), ..fabric })
    }
}
