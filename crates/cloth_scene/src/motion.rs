//! How a collider, or what holds a cloth, moves in the course of a scene.

use cloth_solver::{ClothError, Pose};
use serde::{Deserialize, Serialize};

use crate::ScenePlace;

/// Times and places. Between two keys it moves smoothly: speed is zero at each. Before the first and after the last it stands.
///
/// ```
/// let motion: cloth_scene::SceneMotion = ron::from_str("(keys: [(0, ()), (2, (at: (0, 0, 1)))])")?;
/// assert_eq!(motion.at(1.0).position.z, 0.5);
/// assert_eq!(motion.at(9.0).position.z, 1.0);
/// # Ok::<(), ron::error::SpannedError>(())
/// ```
#[derive(Serialize, Deserialize, Clone, Debug, Default, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct SceneMotion {
    /// Time, s, each later than the one before, 0..=3600; and the place then, in the frame of what moves: where nothing is
    /// said it stays at its own place.
    pub keys: Vec<(f32, ScenePlace)>,
    /// Whether it begins again after the last key. Default no.
    pub repeat: bool,
}

impl SceneMotion {
    /// The place at a time, s.
    pub fn at(&self, time: f64) -> Pose {
        let Some(((first, _), (last, end))) = self.keys.first().zip(self.keys.last()) else { return Pose::IDENTITY };
        let (first, last) = (f64::from(*first), f64::from(*last));
        let time = if self.repeat && last > first && time > first {
            first + (time - first).rem_euclid(last - first)
        } else {
            time
        };
        let after = self.keys.iter().position(|(key, _)| f64::from(*key) > time);
        let Some(after) = after else { return end.pose() };
        let (to_time, to) = &self.keys[after];
        let Some((from_time, from)) = after.checked_sub(1).map(|before| &self.keys[before]) else { return to.pose() };
        let part = ((time - f64::from(*from_time)) / f64::from(to_time - from_time)) as f32;
        let smooth = part * part * (3.0 - 2.0 * part);
        from.pose().interpolate(&to.pose(), smooth)
    }

    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        let (mut before, field, allowed) = (-1.0, "SceneMotion::keys", "0..=3600 s, each later than the one before");
        for (time, place) in &self.keys {
            ClothError::check(field, *time, 0.0..=3600.0, allowed)?;
            if *time <= before {
                return Err(ClothError::OutOfRange { field, value: *time, allowed });
            }
            before = *time;
            place.validate("SceneMotion::keys")?;
        }
        Ok(())
    }
}
