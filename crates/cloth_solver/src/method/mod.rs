//! Time-stepping methods, one file each, on the same fabric, topology and forces.

pub(crate) mod explicit;
pub mod xpbd;

#[cfg(feature = "ecs")]
use bevy_reflect::prelude::ReflectDefault;
use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch};

use crate::Particles;
use crate::cloth::Substep;
use crate::constraint::Constraints;
use crate::lanes::{LANES, LEVEL, load, splat, store};

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
    /// Small-steps XPBD, exact along the warp and weft lines of a rectangle, with its shear as a smoothed stress. The
    /// default. Any other mesh is swept.
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
        dispatch!(*LEVEL, simd => drop_next_to_nothing(simd, particles));
        constraints.nudge(particles);
        constraints.damp(particles, sub.h / (sub.end - sub.start));
    }
}

/// Coordinates nearer to 0 than this, m, and speeds, m/s, are 0: a thousandth of the size of an atom's nucleus. A swing never
/// quite ends, and where the squares of what is left of it are no normal numbers any more, a tick takes twice as long.
const NOTHING: f32 = 1e-17;

/// Once a tick, because nothing that grows so slowly could come back in one.
#[inline(always)]
fn drop_next_to_nothing<S: Simd>(simd: S, particles: &mut Particles) {
    let (zero, nothing) = (splat(simd, 0.0), splat(simd, NOTHING));
    let Particles { position, velocity, .. } = particles;
    for vectors in [position, velocity] {
        for numbers in [&mut vectors.x, &mut vectors.y, &mut vectors.z] {
            for at in (0..numbers.len()).step_by(LANES) {
                let number = load(simd, numbers, at);
                store(number.abs().simd_lt(nothing).select(zero, number), numbers, at);
            }
        }
    }
}
