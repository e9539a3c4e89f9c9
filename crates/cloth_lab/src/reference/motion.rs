//! Motion of the reference: velocity Verlet in steps far below the stability limit (Swope et al. 1982).

use glam::{DMat3, DVec3};

use super::Sheet;

/// Steps between two strokes of internal friction: it is slow against them.
const STROKE: u32 = 8;

/// A sheet in motion.
#[derive(Clone, Debug)]
pub struct Motion<'a> {
    /// The sheet.
    pub sheet: &'a Sheet,
    /// Positions, m.
    pub x: Vec<DVec3>,
    /// Velocities, m/s.
    pub v: Vec<DVec3>,
    force: Vec<DVec3>,
    steps: u32,
}

impl<'a> Motion<'a> {
    /// From positions `x` (m) and velocities `v` (m/s), one for each particle.
    pub fn new(sheet: &'a Sheet, x: Vec<DVec3>, v: Vec<DVec3>) -> Self {
        let mut motion = Self { sheet, force: vec![DVec3::ZERO; x.len()], x, v, steps: 0 };
        motion.pull();
        motion
    }

    fn pull(&mut self) {
        self.sheet.forces(&self.x, &mut self.force);
        self.sheet.blow(&self.x, &self.v, &mut self.force);
    }

    /// Advances by `time` in equal steps of at most `h`, s.
    pub fn advance(&mut self, time: f64, h: f64) {
        let steps = (time / h).ceil().max(1.0) as u32;
        let h = time / f64::from(steps);
        for _ in 0..steps {
            self.kick(0.5 * h);
            for i in 0..self.x.len() {
                self.x[i] += self.v[i] * h;
            }
            self.touch();
            self.pull();
            self.kick(0.5 * h);
            self.steps += 1;
            if self.sheet.damping > 0.0 && self.steps.is_multiple_of(STROKE) {
                self.rub(f64::from(STROKE) * h);
            }
        }
    }

    fn kick(&mut self, h: f64) {
        let sheet = self.sheet;
        for i in 0..self.v.len() {
            self.v[i] = if sheet.pinned[i] { DVec3::ZERO } else { self.v[i] + self.force[i] * (h / sheet.mass[i]) };
        }
    }

    /// Puts what entered a ball back on its surface; takes its velocity inwards, and by Coulomb's law of the sliding.
    fn touch(&mut self) {
        for ball in &self.sheet.balls {
            for i in 0..self.x.len() {
                let out = self.x[i] - ball.centre;
                let distance = out.length();
                if distance >= ball.reach || self.sheet.pinned[i] {
                    continue;
                }
                let normal = out / distance;
                self.x[i] = ball.centre + normal * ball.reach;
                let inwards = (-self.v[i].dot(normal)).max(0.0);
                self.v[i] += normal * inwards;
                let sliding = self.v[i] - normal * self.v[i].dot(normal);
                let stopped = (ball.friction * inwards / sliding.length().max(f64::MIN_POSITIVE)).min(1.0);
                self.v[i] -= sliding * stopped;
            }
        }
    }

    /// Internal friction: fades what is not rigid motion of the free particles (Müller et al. 2007, §3.5).
    fn rub(&mut self, time: f64) {
        let sheet = self.sheet;
        let free = |i: &usize| !sheet.pinned[*i];
        let (mut mass, mut centre, mut drift) = (0.0, DVec3::ZERO, DVec3::ZERO);
        for i in (0..self.x.len()).filter(free) {
            mass += sheet.mass[i];
            centre += self.x[i] * sheet.mass[i];
            drift += self.v[i] * sheet.mass[i];
        }
        (centre, drift) = (centre / mass, drift / mass);
        let (mut inertia, mut spin) = (DMat3::ZERO, DVec3::ZERO);
        for i in (0..self.x.len()).filter(free) {
            let arm = self.x[i] - centre;
            spin += arm.cross(self.v[i]) * sheet.mass[i];
            let outer = DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
            inertia += (DMat3::from_diagonal(DVec3::splat(arm.length_squared())) - outer) * sheet.mass[i];
        }
        let turn = inertia.inverse() * spin;
        let turn = if turn.is_finite() { turn } else { DVec3::ZERO };
        let kept = (-sheet.damping * time).exp();
        for i in (0..self.x.len()).filter(free) {
            let rigid = drift + turn.cross(self.x[i] - centre);
            self.v[i] = rigid + (self.v[i] - rigid) * kept;
        }
    }

    /// Kinetic energy, J.
    pub fn kinetic_energy(&self) -> f64 {
        self.v.iter().zip(&self.sheet.mass).map(|(v, mass)| 0.5 * mass * v.length_squared()).sum()
    }

    /// Kinetic, elastic and gravitational energy, J.
    pub fn energy(&self) -> f64 {
        self.kinetic_energy() + self.sheet.potential_energy(&self.x)
    }
}
