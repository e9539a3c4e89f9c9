//! Rigid bodies that cloth pushes and pulls, as one cloth sees them during one tick.
//!
//! Somebody else moves them: a physics engine. It says on which way a body is in a tick without cloth. Within the tick the body
//! leaves that way as the cloth pushes it, substep by substep; at the end the engine is told the velocity that it gained and the
//! distance that it is off. So a body meets the cloth in steps as short as those of the cloth, however long those of the engine are.

use glam::{Mat3, Quat, Vec3};

use crate::{Motion, Pose};

/// A rigid body that cloth moves, in the cloth's frame.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// 1/mass, 1/kg: takes an impulse (N·s) to a change of velocity (m/s). A matrix, since a body may be locked along some axes. 0 is a
    /// body that nothing moves.
    pub inverse_mass: Mat3,
    /// Inverse of the inertia about the centre of mass, 1/(kg m²): takes an angular impulse (N·m·s) to a change of spin (1/s).
    pub inverse_inertia: Mat3,
    /// Takes an angular impulse to a change of velocity, and turned over an impulse to a change of spin: 0 unless something is fixed to it.
    coupling: Mat3,
    /// Where its centre of mass is at the start and at the end of the tick without cloth, m.
    pub center: [Vec3; 2],
    /// The acceleration that its engine gave it evenly over the tick (gravity), times the square of the tick, m: without cloth its way is
    /// that of a thrown ball, and not the straight line between where the engine puts it. Default 0.
    pub bend: Vec3,
    /// What the cloth did to it since the tick began.
    pub push: Push,
    /// Where the push had taken it when the substep at hand began: shift (m) and turn.
    before: (Vec3, Quat),
}

/// What cloth did to a body in one tick.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Push {
    /// Velocity of the centre of mass that it gained, m/s.
    pub velocity: Vec3,
    /// Angular velocity that it gained, 1/s.
    pub spin: Vec3,
    /// How far its centre of mass is from where it would be, m.
    pub shift: Vec3,
    /// How it is turned against how it would be.
    pub turn: Quat,
    /// The impulse that it was given, N·s.
    pub impulse: Vec3,
    /// The angular impulse that it was given about its centre of mass, N·m·s.
    pub moment: Vec3,
    /// Whether the cloth touched or pulled it.
    pub touched: bool,
}

impl Body {
    /// A body whose centre of mass goes from one place to the other in this tick, m.
    pub fn new(inverse_mass: Mat3, inverse_inertia: Mat3, center: [Vec3; 2]) -> Self {
        let (coupling, push, before) = (Mat3::ZERO, Push::default(), (Vec3::ZERO, Quat::IDENTITY));
        Self { inverse_mass, inverse_inertia, coupling, center, bend: Vec3::ZERO, push, before }
    }

    /// A body of so much mass (kg) and so much inertia about its centre of mass (kg m²) that goes from one place to the other.
    pub fn of_mass(mass: f32, inertia: Mat3, center: [Vec3; 2]) -> Self {
        Self::new(Mat3::from_diagonal(Vec3::splat(1.0 / mass)), inertia.inverse(), center)
    }

    /// Fixes a further `mass` (kg) to it at `arm` (m) from its centre of mass: what moves with it and is no part of it.
    pub(crate) fn load(&mut self, mass: f32, arm: Vec3) {
        let cross = crossed(arm);
        let load = six_by_six([Mat3::IDENTITY, -cross, cross, -(cross * cross)].map(|block| block * mass));
        let mobility = self.mobility();
        let loaded = identity_plus_product(&mobility, &load);
        let columns: [Six; 6] = std::array::from_fn(|column| solve(loaded, mobility.map(|row| row[column])));
        let block = |row: usize, column: usize| {
            let part = |c: usize| Vec3::from_array(std::array::from_fn(|r| columns[column + c][row + r] as f32));
            Mat3::from_cols(part(0), part(1), part(2))
        };
        (self.inverse_mass, self.inverse_inertia, self.coupling) = (block(0, 0), block(3, 3), block(0, 3));
    }

    /// What takes an impulse and its moment about the centre of mass to a change of velocity and spin.
    pub(crate) fn mobility(&self) -> [Six; 6] {
        six_by_six([self.inverse_mass, self.coupling, self.coupling.transpose(), self.inverse_inertia])
    }

    /// Whether anything can move it.
    pub fn is_movable(&self) -> bool {
        self.inverse_mass != Mat3::ZERO || self.inverse_inertia != Mat3::ZERO
    }

    /// The least mass that it has at `arm` (m) from its centre of mass, in any direction, kg.
    pub fn mass_at(&self, arm: Vec3) -> f32 {
        let cross = crossed(arm);
        let turned = self.coupling * cross;
        let mobility = self.inverse_mass + turned + turned.transpose() - cross * self.inverse_inertia * cross;
        // The Frobenius norm of a symmetric matrix is no less than its largest eigenvalue.
        let norm = [mobility.x_axis, mobility.y_axis, mobility.z_axis].map(Vec3::length_squared).iter().sum::<f32>();
        let largest = largest_eigenvalue(mobility).min(norm.sqrt());
        1.0 / largest
    }

    /// Where the centre of mass is at the part `t` of the tick, when the substep at hand began or at its end, m.
    pub fn center_at(&self, t: f32) -> Vec3 {
        let [from, to] = self.center;
        from.lerp(to, t) + self.off_line(t) + self.push.shift
    }

    /// How far a thrown ball is off the straight line at the part `t` of the tick, m.
    fn off_line(&self, t: f32) -> Vec3 {
        self.bend * (-0.5 * t * (1.0 - t))
    }

    /// Where something fixed to it is that would be at `pose` at the part `t` of the tick, as the push has taken it.
    pub fn carry(&self, pose: Pose, t: f32) -> Pose {
        self.carried(pose, t, (self.push.shift, self.push.turn))
    }

    fn carried(&self, pose: Pose, t: f32, (shift, turn): (Vec3, Quat)) -> Pose {
        let shift = shift + self.off_line(t);
        if shift == Vec3::ZERO && turn == Quat::IDENTITY {
            return pose;
        }
        let [from, to] = self.center;
        let center = from.lerp(to, t);
        Pose::new(center + shift + turn * (pose.position - center), (turn * pose.rotation).normalize())
    }

    /// Where something fixed to it is at the start and at the end of the substep that was just taken, which goes over this part of the
    /// tick.
    pub(crate) fn poses(&self, motion: &Motion, [start, end]: [f32; 2]) -> [Pose; 2] {
        [self.carried(motion.at(start), start, self.before), self.carry(motion.at(end), end)]
    }

    /// Where it is after a substep of `h` s if nothing pushes it any more.
    pub(crate) fn ahead(&self, h: f32) -> Self {
        let mut ahead = *self;
        ahead.advance(h);
        ahead
    }

    /// Moves on for `h` s with the velocity that it gained.
    pub(crate) fn advance(&mut self, h: f32) {
        let Push { velocity, spin, shift, turn, .. } = &mut self.push;
        self.before = (*shift, *turn);
        *shift += *velocity * h;
        if *spin != Vec3::ZERO {
            *turn = (Quat::from_scaled_axis(*spin * h) * *turn).normalize();
        }
    }

    /// Gives it an impulse (N·s) and an angular impulse about its centre of mass (N·m·s).
    pub(crate) fn give(&mut self, impulse: Vec3, moment: Vec3) {
        self.push.velocity += self.inverse_mass * impulse + self.coupling * moment;
        self.push.spin += self.coupling.transpose() * impulse + self.inverse_inertia * moment;
        self.push.impulse += impulse;
        self.push.moment += moment;
        self.push.touched = true;
    }
}

/// The matrix that takes a vector to its cross product with `v`, `v × _`.
pub(crate) fn crossed(v: Vec3) -> Mat3 {
    Mat3::from_cols(Vec3::new(0.0, v.z, -v.y), Vec3::new(-v.z, 0.0, v.x), Vec3::new(v.y, -v.x, 0.0))
}

/// The largest eigenvalue of a symmetric matrix (Smith 1961).
fn largest_eigenvalue(m: Mat3) -> f32 {
    let mean = (m.x_axis.x + m.y_axis.y + m.z_axis.z) / 3.0;
    let rest = m - Mat3::from_diagonal(Vec3::splat(mean));
    let squares = [rest.x_axis, rest.y_axis, rest.z_axis].map(Vec3::length_squared).iter().sum::<f32>();
    let p = (squares / 6.0).sqrt();
    if p <= 0.0 {
        return mean;
    }
    let half = ((rest * (1.0 / p)).determinant() / 2.0).clamp(-1.0, 1.0);
    mean + 2.0 * p * libm::cosf(libm::acosf(half) / 3.0)
}

/// Six numbers: of a velocity and a spin, or of an impulse and its moment.
pub(crate) type Six = [f64; 6];

/// A matrix by rows, of its blocks by rows.
fn six_by_six(blocks: [Mat3; 4]) -> [Six; 6] {
    std::array::from_fn(|row| {
        std::array::from_fn(|column| f64::from(blocks[row / 3 * 2 + column / 3].col(column % 3)[row % 3]))
    })
}

/// 1 + W A.
pub(crate) fn identity_plus_product(w: &[Six; 6], a: &[Six; 6]) -> [Six; 6] {
    std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            let product: f64 = (0..6).map(|k| w[row][k] * a[k][column]).sum();
            product + f64::from(u8::from(row == column))
        })
    })
}

/// Solves m x = v by elimination. `m` is 1 + W A with W and A positive semidefinite, and so has an inverse.
pub(crate) fn solve(mut m: [Six; 6], mut v: Six) -> Six {
    for column in 0..6 {
        let pivot = (column..6).max_by(|a, b| m[*a][column].abs().total_cmp(&m[*b][column].abs())).unwrap_or(column);
        m.swap(column, pivot);
        v.swap(column, pivot);
        for row in column + 1..6 {
            let factor = m[row][column] / m[column][column];
            for k in column..6 {
                m[row][k] -= factor * m[column][k];
            }
            v[row] -= factor * v[column];
        }
    }
    for row in (0..6).rev() {
        let sum: f64 = (row + 1..6).map(|k| m[row][k] * v[k]).sum();
        v[row] = (v[row] - sum) / m[row][row];
    }
    v
}
