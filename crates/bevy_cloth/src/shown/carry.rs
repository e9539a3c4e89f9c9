//! How far what a cloth hangs on has moved on since the last two ticks.

use bevy::math::{Affine3A, Vec3A};
use bevy::prelude::*;
use cloth_solver::constraint::{Pin, SkinPoint};
use cloth_solver::{Motion, Pose};

use super::spread::Share;

/// What takes cloth that hangs on one frame of pins from the last two ticks to where that frame is drawn.
#[derive(Clone, Copy, Debug)]
struct Shift {
    /// From the shape one tick ago.
    before: Affine3A,
    /// From that of the last tick.
    last: Affine3A,
    /// Where the frame is drawn, seen from the cloth's frame.
    now: Pose,
}

/// The shifts of all frames of a cloth's pins.
#[derive(Debug, Default)]
pub(crate) struct Carry {
    /// For each frame its shift, `None` for one that stands where it stood in both ticks.
    shifts: Vec<Option<Shift>>,
    /// Where each frame is drawn, seen from the cloth's frame.
    now: Vec<Pose>,
}

impl Carry {
    /// Finds them from the motion of the frames in the last tick and where they are `now`.
    pub fn find(&mut self, frames: &[Motion], now: impl Iterator<Item = Pose>) {
        self.shifts.clear();
        self.now.clear();
        self.now.extend(now);
        self.shifts.extend(frames.iter().zip(&self.now).map(|(motion, now)| Shift::new(motion, *now)));
    }

    /// Whether nothing moved.
    pub fn is_still(&self) -> bool {
        self.shifts.iter().all(Option::is_none)
    }

    /// Where a particle is drawn that was at `from` and `to` in the last two ticks, `between` of the way.
    pub fn place(&self, share: Share, from: Vec3, to: Vec3, between: f32) -> Vec3 {
        let plain = from.lerp(to, between);
        let moved = share.iter().filter_map(|(frame, weight)| {
            let shift = self.shifts.get(frame as usize)?.as_ref()?;
            let [from, to] = [shift.before.transform_point3(from), shift.last.transform_point3(to)];
            Some((from.lerp(to, between) - plain) * weight)
        });
        plain + moved.sum::<Vec3>()
    }

    /// Where a pinned particle is drawn, if its frame moved.
    pub fn pinned(&self, pin: &Pin) -> Option<Vec3> {
        let shift = self.shifts.get(pin.frame as usize)?.as_ref()?;
        Some(shift.now.point(pin.local))
    }
}

impl Carry {
    /// Where a particle on a skin is drawn, if any of its frames moved.
    pub fn on_skin(&self, point: &SkinPoint) -> Option<Vec3> {
        let frames = point.frames.iter().zip(point.weights).filter(|(_, weight)| *weight > 0.0);
        let mut shifts = frames.map(|(frame, _)| self.shifts.get(*frame as usize));
        let moved = shifts.any(|shift| shift.is_some_and(Option::is_some));
        moved.then(|| point.point(|frame| self.now.get(frame as usize).copied().unwrap_or_default()))
    }
}

impl Shift {
    fn new(motion: &Motion, now: Pose) -> Option<Self> {
        let stands = motion.from == now && motion.to == now;
        (!stands && now.is_finite()).then(|| Self {
            before: carrying(&motion.from, &now),
            last: carrying(&motion.to, &now),
            now,
        })
    }
}

/// What takes everything that is fixed to a frame at `from` to where it is when the frame is at `to`.
fn carrying(from: &Pose, to: &Pose) -> Affine3A {
    let turn = (to.rotation * from.rotation.conjugate()).normalize();
    let translation = to.position - turn * from.position;
    Affine3A { matrix3: bevy::math::Mat3A::from_quat(turn), translation: Vec3A::from(translation) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_fixed_to_a_frame_stays_fixed_to_it() {
        let from = Pose::new(Vec3::new(1.0, 2.0, 3.0), Quat::from_rotation_y(0.4));
        let to = Pose::new(Vec3::new(-2.0, 0.5, 1.0), Quat::from_rotation_x(1.4));
        let at = Vec3::new(0.3, -0.2, 0.9);
        let carried = carrying(&from, &to).transform_point3(from.point(at));
        assert!(carried.distance(to.point(at)) < 1e-5, "{carried}");
    }
}
