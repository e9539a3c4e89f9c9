//! What could be left out of a model or be had cheaper.

use cloth_solver::{Fabric, Method};

/// A change that makes a model of cloth simpler or cheaper.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// No bending stiffness, twist included.
    NoBending,
    /// No shear stiffness.
    NoShear,
    /// Threads a hundred times as stiff.
    Inextensible,
    /// No air, and so no wind.
    NoAir,
    /// No friction.
    NoFriction,
    /// It passes through itself.
    NoSelfContact,
    /// It does not tear.
    NoTearing,
    /// Without these colliders (indices, ascending).
    NoColliders(Vec<usize>),
    /// So many times fewer cells along each side.
    Coarser(u32),
    /// Another way of advancing.
    Budget {
        /// The method.
        method: Method,
        /// Substeps in a tick.
        substeps: u32,
        /// Iterations in a substep.
        iterations: u32,
    },
}

/// Changes that exclude each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lever {
    /// What holds the fabric's shape, and what acts on it: each a lever of its own.
    Part(&'static str),
    /// The number of cells.
    Mesh,
    /// Method, substeps, iterations.
    Budget,
}

impl Change {
    /// What it is called.
    pub fn name(&self) -> String {
        match self {
            Self::NoBending => "bending and twist".into(),
            Self::NoShear => "shear".into(),
            Self::Inextensible => "stretch of the threads".into(),
            Self::NoAir => "air".into(),
            Self::NoFriction => "friction".into(),
            Self::NoSelfContact => "self-contact".into(),
            Self::NoTearing => "tearing".into(),
            Self::NoColliders(which) => format!("{} collider(s) never touched", which.len()),
            Self::Coarser(times) => format!("mesh, 1/{times} of the cells along each side"),
            Self::Budget { method, substeps, iterations } if method.iterates() => {
                format!("{}, {substeps} substeps × {iterations}", method.name())
            }
            Self::Budget { method, substeps, .. } => format!("{}, {substeps} substeps", method.name()),
        }
    }

    /// The lever it pulls.
    pub fn lever(&self) -> Lever {
        match self {
            Self::NoBending => Lever::Part("bending"),
            Self::NoShear => Lever::Part("shear"),
            Self::Inextensible => Lever::Part("stretch"),
            Self::NoAir => Lever::Part("air"),
            Self::NoFriction => Lever::Part("friction"),
            Self::NoSelfContact => Lever::Part("self-contact"),
            Self::NoTearing => Lever::Part("tearing"),
            Self::NoColliders(_) => Lever::Part("colliders"),
            Self::Coarser(_) => Lever::Mesh,
            Self::Budget { .. } => Lever::Budget,
        }
    }

    /// What it does to a fabric; nothing where it is about something else.
    pub fn change_fabric(&self, fabric: &mut Fabric) {
        match self {
            Self::NoBending => (fabric.bend_warp, fabric.bend_weft) = (0.0, 0.0),
            Self::NoShear => fabric.shear = 0.0,
            Self::NoFriction => fabric.friction = 0.0,
            Self::Inextensible => {
                fabric.stretch_warp = (100.0 * fabric.stretch_warp).min(1e9);
                fabric.stretch_weft = (100.0 * fabric.stretch_weft).min(1e9);
            }
            _ => {}
        }
    }
}
