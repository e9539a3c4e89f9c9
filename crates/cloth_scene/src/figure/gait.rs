//! How a mannequin walks: where its feet are, and from that the angles of all joints.
//!
//! A foot stands still in the world from heel strike to toe-off, at any steady speed and on any circle; legs follow by the two lengths of
//! thigh and shank. So nothing slides. At 1.4 m/s thighs swing from −12° to 35° and knees bend from 13° to 59°, about as far as those of
//! people (Winter, Biomechanics and Motor Control of Human Movement, 2009: some 40° and 60°). A leg stands for 62 % of a stride of
//! walking and for some 36 % of one of running (Novacheck, The biomechanics of running, Gait and Posture 7, 1998). People change over at
//! 2 m/s, a Froude number of about ½ (Alexander, 1989). While speed changes, stride and feet change with it, and feet may slide.

use core::f32::consts::{PI, TAU};

use cloth_solver::Pose;
use glam::{Quat, Vec2, Vec3};

use super::body::{Body, FigurePart};

/// Length of a stride at 1 m/s of a body of 1.75 m, m; it grows with this power of the speed (after Grieve, 1968). At 1.4 m/s that is
/// 1.41 m and 119 steps a minute.
const STRIDE: (f32, f32) = (1.15, 0.6);
/// Speeds between which walking becomes running, m/s.
const RUNS: (f32, f32) = (1.9, 2.7);
/// Part of a stride in which a foot stands, walking and running at most.
const STANCE: (f32, f32) = (0.62, 0.36);
/// From this speed on joints move with their full amplitude, m/s.
const FULL: f32 = 1.4;
/// The largest acceleration, m/s², and the time in which a difference of speed shrinks to a third, s.
const ACCELERATION: (f32, f32) = (4.0, 0.35);
/// Below this speed it stands, m/s.
const STANDS: f32 = 2e-3;
/// The most it leans into its circle, radians.
const MOST_LEAN: f32 = 0.6;
/// A leg is never straighter than this part of its length.
const STRAIGHT: f32 = 0.997;

/// How far feet are turned out, radians.
const TOES_OUT: f32 = 0.1;

/// How far it has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Walk {
    /// How fast it is, m/s.
    pub speed: f32,
    /// Part of a stride since the left heel struck, 0..1.
    pub phase: f32,
    /// How far along the circle, m; it begins anew after each round.
    pub way: f32,
}

/// What the gait of a mannequin depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gait {
    body: Body,
    /// Radius of its circle, m.
    radius: f32,
}

/// What one speed gives.
#[derive(Clone, Copy, Debug)]
struct Style {
    /// Length of a stride, m.
    stride: f32,
    /// Part of a stride in which a foot stands.
    stance: f32,
    /// How far joints move, 0 at rest to 1.
    strength: f32,
    /// 0 walking, 1 running.
    run: f32,
}

/// Where a foot is, of a leg that the body is above.
#[derive(Clone, Copy, Debug)]
struct Step {
    /// How far the place where it stands, or flies, is in front of the body, m.
    forward: f32,
    /// The ankle as seen from that place on the ground: forward and up, m.
    ankle: Vec2,
    /// How far the toes are turned up, radians.
    pitch: f32,
}

fn smooth(part: f32) -> f32 {
    let part = part.clamp(0.0, 1.0);
    part * part * (3.0 - 2.0 * part)
}

fn mix(from: f32, to: f32, part: f32) -> f32 {
    from + (to - from) * part
}

impl Gait {
    /// Of a body of that height on a circle of that radius, m.
    pub fn new(height: f32, radius: f32) -> Self {
        Self { body: Body::new(height), radius }
    }

    /// Length of a stride at a speed, m.
    pub fn stride(&self, speed: f32) -> f32 {
        self.style(speed).stride
    }

    /// Lets `seconds` pass, in which it wants to walk at `wanted` m/s.
    pub fn advance(&self, walk: &mut Walk, wanted: f32, seconds: f32) {
        let (most, time) = ACCELERATION;
        let change = (wanted - walk.speed) * (1.0 - (-seconds / time).exp());
        walk.speed += change.clamp(-most * seconds, most * seconds);
        if walk.speed < STANDS && wanted < STANDS {
            walk.speed = 0.0;
        }
        if walk.speed > 0.0 {
            walk.phase = (walk.phase + walk.speed * seconds / self.stride(walk.speed)).fract();
            walk.way = (walk.way + walk.speed * seconds).rem_euclid(TAU * self.radius);
        }
    }

    fn style(&self, speed: f32) -> Style {
        let alike = speed.max(1e-6) / self.body.scale.sqrt();
        let run = smooth((alike - RUNS.0) / (RUNS.1 - RUNS.0));
        Style {
            stride: self.body.scale * STRIDE.0 * alike.powf(STRIDE.1),
            stance: mix(STANCE.0, STANCE.1, run),
            strength: if speed > 0.0 { (alike / FULL).min(1.0).powf(STRIDE.1) } else { 0.0 },
            run,
        }
    }

    /// Where a point is that lies `forward` along the circle, to the `left` of it and `up`, m, as seen from its middle.
    fn at(&self, forward: f32, left: f32, up: f32) -> Vec3 {
        let (sine, cosine) = (forward / self.radius).sin_cos();
        (self.radius - left) * Vec3::new(cosine, 0.0, -sine) + up * Vec3::Y
    }

    /// Where the foot of a leg is that is at `phase` of its own stride.
    fn step(&self, style: &Style, phase: f32) -> Step {
        let Style { stride, stance, strength, run } = *style;
        let (strike, off) = (strength * mix(0.33, 0.08, run), strength * mix(0.95, 1.05, run));
        let reach = stride * stance / 2.0;
        let (forward, lift, pitch) = if phase < stance {
            let part = phase / stance;
            let pitch = strike * (1.0 - smooth(part / 0.16)) - off * smooth((part - 0.5) / 0.5).powf(1.2);
            (reach - stride * phase, 0.0, pitch)
        } else {
            let part = (phase - stance) / (1.0 - stance);
            // It leaves the ground, and comes down on it, with no speed over it.
            let slope = -stride * (1.0 - stance);
            let (square, cube) = (part * part, part * part * part);
            let forward = -reach * (2.0 * cube - 3.0 * square + 1.0)
                + slope * (cube - 2.0 * square + part)
                + reach * (3.0 * square - 2.0 * cube)
                + slope * (cube - square);
            let lift = strength * mix(0.055, 0.26, run) * (PI * part.powf(mix(0.9, 0.75, run))).sin().powi(2);
            (forward, lift * self.body.scale, mix(-off, strike, smooth(part / 0.85)))
        };
        // The ankle rolls forward over the ball in the second half: the place of the whole foot is behind by half of that.
        let forward = forward - 0.075 * strength * self.body.scale;
        // It rolls over heel and ball.
        let pivot = if pitch > 0.0 { -self.body.heel } else { self.body.ball };
        let rolled = Vec2::from_angle(pitch).rotate(Vec2::new(-pivot, self.body.ankle));
        Step { forward, ankle: Vec2::new(pivot + rolled.x, lift + rolled.y), pitch }
    }

    /// Height of the hips at a phase, m, but for what legs are too short for.
    fn hips(&self, style: &Style, phase: f32) -> f32 {
        let Style { stance, strength, run, .. } = *style;
        let scale = self.body.scale;
        let leg = self.body.thigh + self.body.shank;
        // Highest over the leg that stands, of a runner lowest.
        let swing = strength * scale * mix(0.016, -0.035, run) * (2.0 * TAU * (phase - stance / 2.0)).cos();
        self.body.ankle + leg * STRAIGHT - scale * strength * mix(0.022, 0.055, run) + swing
    }

    /// By how much the hips sink so that no standing leg is too short, m.
    fn sinks(&self, style: &Style) -> f32 {
        let leg = (self.body.thigh + self.body.shank) * STRAIGHT;
        let count = 24;
        let over = (0..=count).map(|step| {
            let phase = style.stance * step as f32 / count as f32;
            let Step { forward, ankle, .. } = self.step(style, phase);
            let away = forward + ankle.x;
            let highest = ankle.y + (leg * leg - away * away).max(0.0).sqrt();
            self.hips(style, phase) - highest
        });
        over.fold(0.0, f32::max)
    }

    /// Where all parts are, as seen from the middle of the circle.
    pub fn poses(&self, walk: &Walk) -> [Pose; FigurePart::COUNT] {
        let body = &self.body;
        let style = self.style(walk.speed);
        let Style { stance, strength, run, .. } = style;
        let (scale, turn) = (body.scale, TAU * walk.phase);
        let lean = (walk.speed * walk.speed / (9.81 * self.radius)).atan().min(MOST_LEAN);
        let up = self.hips(&style, walk.phase) - self.sinks(&style);
        let heading = Quat::from_rotation_y(walk.way / self.radius);
        // About the ground below it, to the left.
        let leaning = heading * Quat::from_rotation_z(lean);
        let sway = strength * scale * mix(0.018, 0.008, run) * (turn - PI * stance).cos();
        let foot = self.at(walk.way, sway, 0.0);
        let hips = foot + leaning * (Vec3::Y * up);
        // The hip of the leg in front goes along, and that of the leg that swings hangs.
        let yaw = -strength * mix(0.09, 0.16, run) * turn.cos();
        let list = strength * 0.05 * (turn - PI * stance).cos();
        let pelvis = leaning
            * Quat::from_rotation_y(yaw)
            * Quat::from_rotation_z(list)
            * Quat::from_rotation_x(-strength * mix(0.04, 0.14, run));
        let twist = strength * mix(0.11, 0.20, run) * turn.cos();
        let chest = leaning * Quat::from_rotation_y(twist) * Quat::from_rotation_x(-strength * mix(0.03, 0.16, run));
        let waist = hips + pelvis * (Vec3::Y * body.waist);
        let mut poses = [Pose::IDENTITY; FigurePart::COUNT];
        poses[FigurePart::Pelvis as usize] = Pose::new(hips, pelvis);
        poses[FigurePart::Chest as usize] = Pose::new(waist, chest);
        let head = heading * Quat::from_rotation_z(0.5 * lean);
        poses[FigurePart::Head as usize] = Pose::new(waist + chest * (Vec3::Y * body.neck), head);
        for (side, first, phase) in [
            (-1.0, FigurePart::LeftUpperArm as usize, walk.phase),
            (1.0, FigurePart::RightUpperArm as usize, (walk.phase + 0.5).fract()),
        ] {
            let shoulder = waist + chest * Vec3::new(side * body.shoulder, body.shoulders, 0.0);
            poses[first..first + 3].copy_from_slice(&self.arm(&style, side, phase, Pose::new(shoulder, chest)));
            let hip = hips + pelvis * Vec3::new(side * body.hip, 0.0, 0.0);
            poses[first + 3..first + 6].copy_from_slice(&self.leg(&style, walk.way, side, phase, hip));
        }
        poses
    }

    /// Upper arm, forearm and hand; `phase` is that of the leg of the same side.
    fn arm(&self, style: &Style, side: f32, phase: f32, shoulder: Pose) -> [Pose; 3] {
        let Style { strength, run, .. } = *style;
        // Back while its leg is in front.
        let swing = -(TAU * phase).cos();
        let forward = strength * (mix(0.34, 0.62, run) * swing - mix(0.0, 0.12, run));
        let bend = mix(0.16, 0.30, strength) + strength * (mix(0.16, 0.12, run) * (swing + 0.5) + 1.05 * run);
        let out = mix(0.17, 0.22, strength);
        let upper = shoulder.rotation * Quat::from_rotation_z(side * out) * Quat::from_rotation_x(forward);
        let lower = upper * Quat::from_rotation_z(-side * 0.5 * out * (1.0 - 0.6 * run)) * Quat::from_rotation_x(bend);
        let elbow = shoulder.position + upper * (Vec3::NEG_Y * self.body.upper_arm);
        let wrist = elbow + lower * (Vec3::NEG_Y * self.body.forearm);
        let hand = lower * Quat::from_rotation_x(0.12);
        [Pose::new(shoulder.position, upper), Pose::new(elbow, lower), Pose::new(wrist, hand)]
    }

    /// Thigh, shank and foot of a leg whose hip is there.
    fn leg(&self, style: &Style, way: f32, side: f32, phase: f32, hip: Vec3) -> [Pose; 3] {
        let body = &self.body;
        let Step { forward, ankle, pitch } = self.step(style, phase);
        // Far enough for cloth to hang between the legs as they pass each other.
        let apart = -side * body.scale * mix(0.088, mix(0.068, 0.062, style.run), style.strength);
        // What is planted stays where it is, and so keeps its own heading.
        let heading = Quat::from_rotation_y((way + forward) / self.radius - side * TOES_OUT);
        let wanted = self.at(way + forward, apart, 0.0) + heading * Vec3::new(0.0, ankle.y, -ankle.x);
        let (thigh, shank) = (body.thigh, body.shank);
        let most = (thigh + shank) * (0.5 + 0.5 * STRAIGHT);
        let line = wanted - hip;
        let length = line.length().clamp(0.2 * most, most);
        let line = line.normalize_or(Vec3::NEG_Y);
        let forward = heading * Vec3::NEG_Z;
        let knee_out = forward.reject_from_normalized(line).normalize_or(forward);
        let near = (thigh * thigh - shank * shank + length * length) / (2.0 * length);
        let knee = hip + line * near + knee_out * (thigh * thigh - near * near).max(0.0).sqrt();
        let ankle = hip + line * length;
        let limb = |from: Vec3, to: Vec3| {
            let y = (from - to).normalize_or(Vec3::Y);
            let z = (-knee_out).reject_from_normalized(y).normalize_or(Vec3::Z);
            Quat::from_mat3(&glam::Mat3::from_cols(y.cross(z), y, z)).normalize()
        };
        let toes = heading * Quat::from_rotation_x(pitch);
        [Pose::new(hip, limb(hip, knee)), Pose::new(knee, limb(knee, ankle)), Pose::new(ankle, toes)]
    }
}
