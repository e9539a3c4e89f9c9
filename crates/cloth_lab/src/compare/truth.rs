//! What the largest strain of a scene should be, by the independent reference.

use core::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::ours::GRAVITY;
use super::play::RATE;
use super::scenes::{Judged, Setup};
use crate::reference::{Ball, Motion, Sheet, highest_frequency, rest};

/// How far out of its plane a sheet that may fold starts towards rest, m: flat, it would stay flat.
const BULGE: f64 = 0.01;

/// The part of the stability limit that the reference's steps are.
const PART: f64 = 0.25;

/// The reference's answer.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Largest strain along warp and weft.
    pub largest: f64,
    /// Where the sheet rests, for scenes that are judged at rest.
    pub rest: Option<Vec<DVec3>>,
    /// How sure it is, in words.
    pub convergence: String,
}

/// Looks for the rest of the sheet, or plays its motion in steps far below the stability limit; `offset` is the distance
/// (m) that cloth keeps from the ball.
pub fn truth(setup: &Setup, offset: f64) -> Truth {
    let cells = setup.side - 1;
    let mut sheet = Sheet::new(DVec2::ONE, [cells, cells], &setup.fabric);
    sheet.gravity = GRAVITY.as_dvec3();
    for pin in &setup.pins {
        sheet.pinned[*pin] = true;
    }
    if let Some((particle, mass)) = setup.weight {
        sheet.mass[particle] += f64::from(mass);
    }
    if let Some(ball) = setup.ball {
        let reach = f64::from(ball.radius) + offset;
        sheet.balls.push(Ball { centre: ball.centre.as_dvec3(), reach, friction: f64::from(ball.friction) });
    }
    let start: Vec<DVec3> = setup.start.iter().map(|p| p.as_dvec3()).collect();
    match setup.judged {
        Judged::AtRest => at_rest(setup, &sheet, start),
        Judged::Throughout => in_motion(setup, &sheet, start),
    }
}

fn at_rest(setup: &Setup, sheet: &Sheet, start: Vec<DVec3>) -> Truth {
    let may_fold = setup.pins.len() < setup.side || setup.weight.is_some();
    let bulge = |p: DVec3| if may_fold { p + DVec3::Z * BULGE * (PI * p.x).cos() * (0.5 - p.y) } else { p };
    let found = rest(sheet, start.into_iter().map(bulge).collect());
    Truth {
        largest: sheet.largest_strain(&found.x),
        convergence: format!("rest by {} Newton steps, residual {:.1e} of the weight", found.steps, found.residual),
        rest: Some(found.x),
    }
}

fn in_motion(setup: &Setup, sheet: &Sheet, start: Vec<DVec3>) -> Truth {
    let h = PART * 2.0 / highest_frequency(sheet, &sheet.flat);
    let still = vec![DVec3::ZERO; start.len()];
    let mut motion = Motion::new(sheet, start, still);
    let mut largest = 0.0;
    for _ in 0..(setup.seconds * RATE).round() as u32 {
        motion.advance(1.0 / f64::from(RATE), h);
        largest = f64::max(largest, sheet.largest_strain(&motion.x));
    }
    Truth { largest, rest: None, convergence: format!("velocity Verlet in steps of {h:.1e} s") }
}
