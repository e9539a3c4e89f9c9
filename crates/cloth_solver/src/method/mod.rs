//! Time-stepping methods, one file each, on the same fabric, topology and forces.

pub(crate) mod explicit;
pub mod xpbd;

#[cfg(feature = "ecs")]
use bevy_reflect::prelude::ReflectDefault;

use crate::Particles;
use crate::cloth::Substep;
use crate::constraint::Constraints;

/// How a cloth is advanced in time.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component, bevy_reflect::Reflect))]
#[cfg_attr(feature = "ecs", reflect(Default))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// Explicit (forward) Euler: first order, gains energy at every step length.
    ExplicitEuler,
    /// Symplectic (semi-implicit) Euler: `v += h a(x)`, `x += h v`. Stable for `h < 2/ω`.
    SymplecticEuler,
    /// Störmer–Verlet in velocity form: second order, symplectic. Stable for `h < 2/ω`.
    StormerVerlet,
    /// The classical Runge–Kutta method of fourth order: four evaluations of the forces. Stable for `h < 2.83/ω`.
    RungeKutta4,
    /// Position-based dynamics (Müller et al. 2007): Verlet and projection, no compliance: stiffness depends on step and
    /// iterations.
    Pbd,
    /// Small-steps XPBD (Macklin et al. 2019), constraints swept one after the other, in colours.
    XpbdSweeps,
    /// Small-steps XPBD, exact along the warp and weft lines of a rectangle, with its shear as a smoothed stress; on any
    /// other mesh exact along strips of triangles, with implicit bending. The default.
    #[default]
    XpbdLines,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 7] = [
        Self::ExplicitEuler,
        Self::SymplecticEuler,
        Self::StormerVerlet,
        Self::RungeKutta4,
        Self::Pbd,
        Self::XpbdSweeps,
        Self::XpbdLines,
    ];

    /// Its name in lower case with hyphens, as on a command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ExplicitEuler => "explicit-euler",
            Self::SymplecticEuler => "symplectic-euler",
            Self::StormerVerlet => "stormer-verlet",
            Self::RungeKutta4 => "rk4",
            Self::Pbd => "pbd",
            Self::XpbdSweeps => "xpbd-sweeps",
            Self::XpbdLines => "xpbd-lines",
        }
    }

    /// Whether it steps forces and therefore needs substeps shorter than the fabric's fastest vibration allows.
    pub const fn steps_forces(self) -> bool {
        matches!(self, Self::ExplicitEuler | Self::SymplecticEuler | Self::StormerVerlet | Self::RungeKutta4)
    }

    /// Whether more than one iteration in a substep changes the result.
    pub const fn iterates(self) -> bool {
        matches!(self, Self::Pbd)
    }
}

/// First half of a substep: predicts positions from velocities and forces, and moves pinned particles along their frames.
pub fn integrate(particles: &mut Particles, constraints: &Constraints, sub: &Substep) {
    if constraints.method().steps_forces() {
        explicit::begin(particles, constraints, sub);
    } else {
        xpbd::integrate(particles, constraints, sub);
    }
}

/// Second half of a substep: the forces inside the cloth, and the velocities at its end.
pub fn solve(particles: &mut Particles, constraints: &mut Constraints, sub: &Substep) {
    if constraints.method().steps_forces() {
        explicit::step(particles, constraints, sub);
    } else {
        xpbd::solve(particles, constraints, sub);
    }
    if sub.end == 1.0 {
        constraints.nudge(particles);
        constraints.damp(particles, sub.h / (sub.end - sub.start));
    }
}
