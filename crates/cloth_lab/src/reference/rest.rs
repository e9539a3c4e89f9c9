//! Rest of the reference: a minimum of the potential energy.

use faer::prelude::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{Pair, SparseColMat, SymbolicSparseColMat};
use faer::{Mat, Side};
use glam::DVec3;

use super::Sheet;

/// Residual at which a sheet is at rest: norm of all forces over the weight.
const RESIDUAL: f64 = 1e-8;
/// Most Newton steps.
const STEPS: usize = 1500;
/// Longest way of a particle in a Newton step, in spacings.
const REACH: f64 = 0.5;

/// Where a sheet rests.
#[derive(Clone, Debug)]
pub struct Rest {
    /// Positions, m.
    pub x: Vec<DVec3>,
    /// Norm of the forces left on free particles over the weight.
    pub residual: f64,
    /// Newton steps taken.
    pub steps: usize,
}

/// Looks for rest from positions `x` (m) on: implicit Euler steps without inertia from one to the next, which grow until
/// they are plain Newton steps (pseudo-transient continuation, Kelley & Keyes 1998). The full stiffness matrix is used
/// wherever it is positive definite, as it is at a stable rest. Air and contact do not act.
pub fn rest(sheet: &Sheet, mut x: Vec<DVec3>) -> Rest {
    let mut force = vec![DVec3::ZERO; x.len()];
    let Some(mut system) = System::new(sheet, &x) else { return Rest { x, residual: f64::NAN, steps: 0 } };
    let weight = sheet.weight();
    let mut h = 1e-3;
    let mut energy = sheet.potential_energy(&x);
    let mut residual = system.residual(sheet, &x, &mut force) / weight;
    for step in 0..STEPS {
        if residual < RESIDUAL {
            return Rest { x, residual, steps: step };
        }
        let Some((way, exact)) = system.solve(sheet, &x, &force, h) else {
            h *= 0.25;
            continue;
        };
        let longest = way.iter().map(|way| way.length()).fold(0.0, f64::max);
        let mut part = (REACH * sheet.spacing.min_element() / longest.max(f64::MIN_POSITIVE)).min(1.0);
        let mut accepted = false;
        for _ in 0..8 {
            let there: Vec<DVec3> = x.iter().zip(&way).map(|(x, way)| *x + *way * part).collect();
            let (new_energy, new_residual) =
                (sheet.potential_energy(&there), system.residual(sheet, &there, &mut force) / weight);
            // Near rest the energy no longer tells better from worse: its last digits are rounding.
            if new_energy < energy || (new_residual < residual && new_energy < energy + 1e-12 * energy.abs()) {
                (x, energy, residual, accepted) = (there, new_energy, new_residual, true);
                break;
            }
            part *= 0.4;
        }
        h = if accepted && part > 0.3 && exact {
            (h * 2.0).min(1e6)
        } else if accepted {
            h
        } else {
            h * 0.2
        };
        if !accepted {
            residual = system.residual(sheet, &x, &mut force) / weight;
        }
    }
    Rest { x, residual, steps: STEPS }
}

/// Newton's system over the free particles, with a sparsity found once.
struct System {
    /// First row of each particle; `None` if pinned.
    first: Vec<Option<usize>>,
    size: usize,
    pattern: SymbolicSparseColMat<usize>,
    order: faer::sparse::Argsort<usize>,
    symbolic: SymbolicLlt<usize>,
    values: Vec<f64>,
}

impl System {
    fn new(sheet: &Sheet, x: &[DVec3]) -> Option<Self> {
        let mut size = 0;
        let first: Vec<Option<usize>> = (sheet.pinned.iter())
            .map(|pinned| {
                let row = size;
                size += if *pinned { 0 } else { 3 };
                (!pinned).then_some(row)
            })
            .collect();
        let mut indices = Vec::new();
        lower(sheet, x, &first, false, |row, col, _| indices.push(Pair { row, col }));
        (0..size).for_each(|i| indices.push(Pair { row: i, col: i }));
        let (pattern, order) = SymbolicSparseColMat::try_new_from_indices(size, size, &indices).ok()?;
        let symbolic = SymbolicLlt::try_new(pattern.as_ref(), Side::Lower).ok()?;
        Some(Self { first, size, pattern, order, symbolic, values: Vec::with_capacity(indices.len()) })
    }

    /// Fills `force` and returns its norm over the free particles, N.
    fn residual(&self, sheet: &Sheet, x: &[DVec3], force: &mut [DVec3]) -> f64 {
        sheet.forces(x, force);
        let free = force.iter().zip(&sheet.pinned).filter(|(_, pinned)| !**pinned);
        free.map(|(force, _)| force.length_squared()).sum::<f64>().sqrt()
    }

    /// The way `(M/h² + K) dx = f`, and whether `K` was the full stiffness. `None` where there is no factor.
    fn solve(&mut self, sheet: &Sheet, x: &[DVec3], force: &[DVec3], h: f64) -> Option<(Vec<DVec3>, bool)> {
        [true, false].into_iter().find_map(|exact| {
            self.values.clear();
            lower(sheet, x, &self.first, exact, |_, _, value| self.values.push(value));
            for (mass, first) in sheet.mass.iter().zip(&self.first) {
                if first.is_some() {
                    self.values.extend([mass / (h * h); 3]);
                }
            }
            let matrix = SparseColMat::new_from_argsort(self.pattern.clone(), &self.order, &self.values).ok()?;
            let factor = Llt::try_new_with_symbolic(self.symbolic.clone(), matrix.as_ref(), Side::Lower).ok()?;
            let mut right = Mat::<f64>::zeros(self.size, 1);
            for (force, first) in force.iter().zip(&self.first) {
                if let Some(first) = *first {
                    (0..3).for_each(|axis| right[(first + axis, 0)] = force[axis]);
                }
            }
            factor.solve_in_place(right.as_mut());
            let way = |first: &Option<usize>| {
                first.map_or(DVec3::ZERO, |i| DVec3::new(right[(i, 0)], right[(i + 1, 0)], right[(i + 2, 0)]))
            };
            let way: Vec<DVec3> = self.first.iter().map(way).collect();
            way.iter().all(|way| way.is_finite()).then_some((way, exact))
        })
    }
}

/// The entries of the stiffness matrix on and below the diagonal, among free particles.
fn lower(sheet: &Sheet, x: &[DVec3], first: &[Option<usize>], exact: bool, mut add: impl FnMut(usize, usize, f64)) {
    sheet.stiffness(x, exact, |i, j, block| {
        if let (Some(row), Some(col)) = (first[i], first[j]) {
            for across in 0..3 {
                for down in 0..3 {
                    if row + down >= col + across {
                        add(row + down, col + across, block.col(across)[down]);
                    }
                }
            }
        }
    });
}
