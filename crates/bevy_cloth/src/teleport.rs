//! What counts as a jump of a cloth, and what becomes of the cloth then.

use bevy::prelude::*;
use cloth_solver::ClothError;

/// When a move is a jump (a blink, a respawn, a shift of the world's origin) and no motion, and what the cloth does then.
///
/// A cloth jumps when what it hangs on jumps: farther or further round in one tick than is said here. It hangs on what its
/// pins follow; without pins, on its own entity. Where it has several pins all of what they follow must jump, and all alike;
/// the cloth then goes along with the mean of them, each counted by its pins. If only a part jumps, that is motion.
///
/// A move that is made once a frame, with several ticks in that frame, counts by its share of one tick.
///
/// A component on a cloth overrides the resource [`Shared<Teleport>`](crate::Shared).
///
/// ```
/// # use bevy_cloth::{Teleport, TeleportPolicy};
/// // A flag on a rocket: nothing below 6,000 m/s is a jump.
/// let teleport = Teleport { distance: 100.0, ..Teleport::default() };
/// assert_eq!(teleport.policy, TeleportPolicy::CarryAlong);
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct Teleport {
    /// What goes farther than this in one tick jumps, m; 0 to 1,000,000. Default 0.75: at 60 ticks a second all below 45 m/s
    /// is motion.
    pub distance: f32,
    /// What turns further than this in one tick jumps, radians; 0 to 10. Default 1: half a turn in a tenth of a second is motion,
    /// half a turn at once is none. Above π no turn is a jump.
    pub angle: f32,
    /// What the cloth does when it jumps.
    pub policy: TeleportPolicy,
}

/// What a cloth does when what it hangs on jumps, see [`Teleport`].
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Clone, Debug, PartialEq)]
pub enum TeleportPolicy {
    /// Nothing but what it does in any motion: pins drag it there within one tick. There are no jumps.
    Simulate,
    /// It goes along as one piece: shape and speed turn with what it hangs on.
    #[default]
    CarryAlong,
    /// It is there in its rest shape, without speed. What is torn or burnt stays so.
    Reset,
}

impl Teleport {
    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        ClothError::check("Teleport::distance", self.distance, 0.0..=1e6, "0..=1,000,000 m")?;
        ClothError::check("Teleport::angle", self.angle, 0.0..=10.0, "0..=10 rad")
    }
}

impl Default for Teleport {
    fn default() -> Self {
        Self { distance: 0.75, angle: 1.0, policy: TeleportPolicy::default() }
    }
}
