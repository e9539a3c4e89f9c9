//! Time-stepping methods, one file each, on the same fabric, topology and forces.

pub(crate) mod explicit;
pub mod xpbd;

#[cfg(feature = "ecs")]
use bevy_reflect::prelude::ReflectDefault;

use crate::Particles;
use crate::constraint::Constraints;
use crate::tick::{Effort, Substep};

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
    /// other mesh exact along strips of triangles. Bending and shear are forces, filtered where they are too stiff. The default.
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

    /// Whether it takes as many substeps as load and motion ask for, and not as many as it is told.
    pub const fn adapts(self) -> bool {
        matches!(self, Self::XpbdLines)
    }

    /// Whether more than one iteration in a substep changes the result.
    pub const fn iterates(self) -> bool {
        matches!(self, Self::Pbd)
    }
}

/// First part of a substep: predicts how the particles move from velocities and forces, and moves pinned ones along their frames.
pub fn integrate(particles: &mut Particles, constraints: &Constraints, sub: &Substep) {
    if constraints.method().steps_forces() {
        explicit::begin(particles, constraints, sub);
    } else {
        xpbd::integrate(particles, constraints, sub);
    }
}

/// Second part: the forces inside the cloth, and what the substep took. Nothing has moved yet: a substep that was too long is
/// taken again, shorter, from [`integrate`] on.
pub fn solve(particles: &mut Particles, constraints: &mut Constraints, sub: &Substep) -> Effort {
    if constraints.method().steps_forces() { Effort::default() } else { constraints.solve(particles, sub) }
}

/// Third part: positions and velocities at the end of the substep.
pub fn accept(particles: &mut Particles, constraints: &mut Constraints, sub: &Substep) {
    constraints.move_bodies(particles, sub);
    if constraints.method().steps_forces() {
        explicit::step(particles, constraints, sub);
    } else {
        xpbd::accept(particles, sub);
    }
    constraints.accept(particles, sub);
    if sub.is_last() {
        constraints.nudge(particles);
        constraints.damp(particles, sub.h / (sub.end - sub.start));
    }
}
