//! The body of a mannequin: its parts, how long they are, and the solids that cloth meets.

use core::f32::consts::FRAC_PI_2;

use cloth_solver::Pose;
use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};

use crate::SceneShape;

/// A part of a mannequin. Its frame lies in the joint that it turns about, y up while it stands, and faces −z; left is −x.
#[derive(Serialize, Deserialize, Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FigurePart {
    /// The hips. Its frame lies between the hip joints.
    #[default]
    Pelvis,
    /// Belly, chest and shoulders. Its frame lies at the waist.
    Chest,
    /// Neck and head. Its frame lies at the base of the neck.
    Head,
    /// From the left shoulder to the elbow.
    LeftUpperArm,
    /// From the left elbow to the wrist.
    LeftForearm,
    /// From the left wrist to the fingertips.
    LeftHand,
    /// From the left hip to the knee.
    LeftThigh,
    /// From the left knee to the ankle.
    LeftShank,
    /// The left foot. Its frame lies in the ankle.
    LeftFoot,
    /// From the right shoulder to the elbow.
    RightUpperArm,
    /// From the right elbow to the wrist.
    RightForearm,
    /// From the right wrist to the fingertips.
    RightHand,
    /// From the right hip to the knee.
    RightThigh,
    /// From the right knee to the ankle.
    RightShank,
    /// The right foot. Its frame lies in the ankle.
    RightFoot,
}

impl FigurePart {
    /// How many there are.
    pub const COUNT: usize = 15;

    /// All parts, in order.
    pub const ALL: [Self; Self::COUNT] = [
        Self::Pelvis,
        Self::Chest,
        Self::Head,
        Self::LeftUpperArm,
        Self::LeftForearm,
        Self::LeftHand,
        Self::LeftThigh,
        Self::LeftShank,
        Self::LeftFoot,
        Self::RightUpperArm,
        Self::RightForearm,
        Self::RightHand,
        Self::RightThigh,
        Self::RightShank,
        Self::RightFoot,
    ];
}

/// Height of the body that the lengths below belong to, m. They are those of an artist's mannequin: those of people (Winter,
/// Biomechanics and Motor Control of Human Movement, 2009, figure 4.1), with slim limbs.
const HEIGHT: f32 = 1.75;

/// Lengths of a mannequin, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// By how much it is larger than one of 1.75 m.
    pub scale: f32,
    /// From the hip to the knee.
    pub thigh: f32,
    /// From the knee to the ankle.
    pub shank: f32,
    /// From the ankle down to the sole.
    pub ankle: f32,
    /// From the ankle back to the heel.
    pub heel: f32,
    /// From the ankle forward to the ball of the foot.
    pub ball: f32,
    /// Half the distance of the hip joints.
    pub hip: f32,
    /// From between the hip joints up to the waist.
    pub waist: f32,
    /// From the waist up to the shoulders.
    pub shoulders: f32,
    /// Half the distance of the shoulders.
    pub shoulder: f32,
    /// From the waist up to the base of the neck.
    pub neck: f32,
    /// From the shoulder to the elbow.
    pub upper_arm: f32,
    /// From the elbow to the wrist.
    pub forearm: f32,
}

impl Body {
    /// A body of that height, m.
    pub fn new(height: f32) -> Self {
        let scale = height / HEIGHT;
        Self {
            scale,
            thigh: 0.43 * scale,
            shank: 0.42 * scale,
            ankle: 0.075 * scale,
            heel: 0.05 * scale,
            ball: 0.13 * scale,
            hip: 0.088 * scale,
            waist: 0.13 * scale,
            shoulders: 0.36 * scale,
            shoulder: 0.18 * scale,
            neck: 0.40 * scale,
            upper_arm: 0.29 * scale,
            forearm: 0.25 * scale,
        }
    }

    /// The solids that cloth cannot enter: the part that each belongs to, its form, and its place as seen from that part.
    pub fn solids(&self) -> Vec<(FigurePart, SceneShape, Pose)> {
        use FigurePart::*;
        let k = self.scale;
        let at = |x: f32, y: f32, z: f32| Pose::new(k * Vec3::new(x, y, z), Quat::IDENTITY);
        let down = |radius: f32, length: f32| {
            (SceneShape::Capsule { radius: k * radius, length }, Pose::new(Vec3::NEG_Y * length / 2.0, Quat::IDENTITY))
        };
        // Capsules alone: of all solids they cost least, and their surfaces are round.
        let across = |y: f32, radius: f32, length: f32| {
            let place = Pose::new(Vec3::Y * y * k, Quat::from_rotation_z(FRAC_PI_2));
            (SceneShape::Capsule { radius: radius * k, length: length * k }, place)
        };
        let mut solids: Vec<_> = [
            (Pelvis, across(-0.01, 0.112, 0.09)),
            (Chest, across(0.0, 0.090, 0.04)),
            (Chest, across(0.11, 0.110, 0.09)),
            (Chest, across(0.19, 0.110, 0.09)),
            (Chest, across(0.27, 0.110, 0.09)),
            (Chest, across(0.36, 0.062, 0.36)),
            (Head, (SceneShape::Capsule { radius: 0.045 * k, length: 0.08 * k }, at(0.0, 0.03, 0.0))),
            (Head, (SceneShape::Capsule { radius: 0.084 * k, length: 0.077 * k }, at(0.0, 0.174, -0.006))),
        ]
        .map(|(part, (shape, place))| (part, shape, place))
        .into();
        let sides = [
            [LeftUpperArm, LeftForearm, LeftHand, LeftThigh, LeftShank, LeftFoot],
            [RightUpperArm, RightForearm, RightHand, RightThigh, RightShank, RightFoot],
        ];
        for [upper_arm, forearm, hand, thigh, shank, foot] in sides {
            let limbs = [
                (upper_arm, down(0.046, self.upper_arm)),
                (forearm, down(0.040, self.forearm)),
                (hand, down(0.034, 0.11 * k)),
                (thigh, down(0.073, self.thigh)),
                (shank, down(0.051, self.shank)),
            ];
            solids.extend(limbs.map(|(part, (shape, place))| (part, shape, place)));
            let sole = Pose::new(k * Vec3::new(0.0, -0.037, -0.05), Quat::from_rotation_x(FRAC_PI_2));
            solids.push((foot, SceneShape::Capsule { radius: 0.038 * k, length: 0.15 * k }, sole));
        }
        solids
    }
}
