//! A wooden mannequin that walks in a circle, and what it wears.

mod body;
mod gait;

use cloth_solver::{ClothError, Pose};
use serde::{Deserialize, Serialize};

use crate::{Finish, ScenePlace};

pub use body::{Body, FigurePart};
pub use gait::{Gait, Walk};

/// A mannequin that walks in a circle, to the left. At first it stands, on the +x side of the circle, and faces −z.
///
/// It walks in the demo; in a world played without an engine it stands in this pose.
#[derive(Serialize, Deserialize, Clone, Debug, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct SceneFigure {
    /// What it is called.
    pub name: String,
    /// Height of its body, m, 0.5..=3. Default 1.75.
    pub height: f32,
    /// How fast it walks, or above some 2 m/s runs, m/s, 0..=4. At 0 it stands. Default 1.4.
    pub speed: f32,
    /// Radius of the circle, m, 1..=100. Default 2.5.
    pub radius: f32,
    /// Surface of its limbs. Default [`Finish::Wood`].
    pub finish: Finish,
    /// Surface of its joints. Default [`Finish::Walnut`].
    pub joints: Finish,
    /// Where the middle of the circle is, on the ground, and how the circle is turned.
    pub place: ScenePlace,
}

impl Default for SceneFigure {
    fn default() -> Self {
        Self {
            name: String::new(),
            height: 1.75,
            speed: 1.4,
            radius: 2.5,
            finish: Finish::Wood,
            joints: Finish::Walnut,
            place: ScenePlace::default(),
        }
    }
}

/// What wears a cloth: its [`place`](crate::SceneCloth::place) is then seen from a part of a mannequin, and goes with it.
#[derive(Serialize, Deserialize, Clone, Copy, Debug, Default, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct SceneWorn {
    /// Which of the scene's [`figures`](crate::Scene::figures), from 0. Default 0.
    pub figure: u32,
    /// The part that it goes with. Default [`FigurePart::Pelvis`].
    pub part: FigurePart,
}

impl SceneFigure {
    /// The largest speed, m/s.
    pub const MOST_SPEED: f32 = 4.0;

    /// Where its parts are, as seen from the middle of the circle.
    pub fn poses(&self, walk: &Walk) -> [Pose; FigurePart::COUNT] {
        Gait::new(self.height, self.radius).poses(walk)
    }

    /// Where a part is in the world while it stands at its start.
    pub fn standing(&self, part: FigurePart) -> Pose {
        let (place, local) = (self.place.pose(), self.poses(&Walk::default())[part as usize]);
        Pose::new(place.point(local.position), (place.rotation * local.rotation).normalize())
    }

    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        self.place.validate("SceneFigure::place")?;
        ClothError::check("SceneFigure::height", self.height, 0.5..=3.0, "0.5..=3 m")?;
        ClothError::check("SceneFigure::speed", self.speed, 0.0..=Self::MOST_SPEED, "0..=4 m/s")?;
        ClothError::check("SceneFigure::radius", self.radius, 1.0..=100.0, "1..=100 m")?;
        self.finish.validate().and_then(|()| self.joints.validate())
    }
}
