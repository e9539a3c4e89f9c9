//! Methods that solve the whole cloth at once: projective dynamics with a constant, prefactored matrix, and implicit Euler
//! with Newton's method.
//!
//! Both look for the positions at the end of the substep where `M (x − x̃)/h² = f(x)`, x̃ the free prediction, f the elastic
//! forces. Newton factors the matrix `M/h² − ∂f/∂x` anew in every iteration. Projective dynamics (Bouaziz et al. 2014) keeps
//! one: as Liu, Bouaziz, Kavan 2017 show, its local and global step are together the quasi-Newton step with the constant
//! matrix `M/h² + L`, L the stiffness at rest without directions, the same for x, y and z.

use faer::Mat;
use faer::Side;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};
use glam::{Mat3, Vec3};

use crate::cloth::Substep;
use crate::constraint::Constraints;
use crate::{Particles, Soa3};

/// Working memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Factored {
    /// Inertia of each slot and substep the factor was made for.
    inertia: Vec<f32>,
    h: f32,
    /// Free particles.
    slots: Vec<usize>,
    factor: Option<Llt<usize, f32>>,
    symbolic: Option<SymbolicLlt<usize>>,
    predicted: Soa3,
    now: Soa3,
    force: Soa3,
}

impl Factored {
    fn fit(&mut self, particles: &Particles, h: f32) -> bool {
        let inertia = |w: &f32| if *w > 0.0 { 1.0 / w } else { 0.0 };
        let same = self.h == h
            && self.inertia.len() == particles.slots()
            && self.inertia.iter().zip(&particles.inverse_mass).all(|(m, w)| *m == inertia(w));
        if !same {
            self.h = h;
            self.inertia = particles.inverse_mass.iter().map(inertia).collect();
            self.slots = (0..particles.slots()).filter(|i| self.inertia[*i] > 0.0).collect();
            (self.factor, self.symbolic) = (None, None);
        }
        if self.force.len() != particles.slots() {
            for array in [&mut self.predicted, &mut self.now, &mut self.force] {
                *array = Soa3::zeros(particles.slots());
            }
        }
        same
    }

    /// `M (x̃ − x)/h² + f(x)` of each free particle.
    fn residual(&mut self, particles: &Particles, constraints: &Constraints) -> Mat<f32> {
        for i in 0..particles.slots() {
            self.now.set(i, particles.position.get(i) + particles.moved.get(i));
        }
        self.force.fill(Vec3::ZERO);
        constraints.add_forces(&self.now, &mut self.force);
        let mut right = Mat::zeros(self.slots.len(), 3);
        for (row, &i) in self.slots.iter().enumerate() {
            let inertia = self.inertia[i] / (self.h * self.h);
            let r = (self.predicted.get(i) - particles.moved.get(i)) * inertia + self.force.get(i);
            for axis in 0..3 {
                right[(row, axis)] = r[axis];
            }
        }
        right
    }

    fn row_of(&self, slots: usize) -> Vec<usize> {
        let mut row_of = vec![usize::MAX; slots];
        for (row, &i) in self.slots.iter().enumerate() {
            row_of[i] = row;
        }
        row_of
    }

    /// One iteration of projective dynamics.
    fn project(&mut self, particles: &mut Particles, constraints: &Constraints) {
        if self.factor.is_none() {
            let row_of = self.row_of(particles.slots());
            let mut entries: Vec<Triplet<usize, usize, f32>> = Vec::new();
            for (row, &i) in self.slots.iter().enumerate() {
                entries.push(Triplet::new(row, row, self.inertia[i] / (self.h * self.h)));
            }
            constraints.stiffness_at_rest(&mut |a, b, k| {
                let (a, b) = (row_of[a], row_of[b]);
                if a != usize::MAX && b != usize::MAX && a >= b {
                    entries.push(Triplet::new(a, b, k));
                }
            });
            let n = self.slots.len();
            self.factor = SparseColMat::try_new_from_triplets(n, n, &entries).ok().and_then(|matrix| {
                let symbolic = SymbolicLlt::try_new(matrix.symbolic(), Side::Lower).ok()?;
                Llt::try_new_with_symbolic(symbolic, matrix.as_ref(), Side::Lower).ok()
            });
        }
        let mut step = self.residual(particles, constraints);
        let Some(factor) = &self.factor else { return };
        factor.solve_in_place(step.as_mut());
        for (row, &i) in self.slots.iter().enumerate() {
            let by = Vec3::new(step[(row, 0)], step[(row, 1)], step[(row, 2)]);
            particles.moved.set(i, particles.moved.get(i) + by);
        }
    }

    /// One iteration of Newton's method.
    fn newton(&mut self, particles: &mut Particles, constraints: &Constraints) {
        let right = self.residual(particles, constraints);
        let row_of = self.row_of(particles.slots());
        let n = 3 * self.slots.len();
        let mut entries: Vec<Triplet<usize, usize, f32>> = Vec::new();
        for (row, &i) in self.slots.iter().enumerate() {
            for axis in 0..3 {
                entries.push(Triplet::new(3 * row + axis, 3 * row + axis, self.inertia[i] / (self.h * self.h)));
            }
        }
        constraints.stiffness_now(&self.now, &mut |a, b, k: Mat3| {
            let (a, b) = (row_of[a], row_of[b]);
            if a == usize::MAX || b == usize::MAX || a < b {
                return;
            }
            for column in 0..3 {
                for row in 0..3 {
                    if a > b || row >= column {
                        entries.push(Triplet::new(3 * a + row, 3 * b + column, k.col(column)[row]));
                    }
                }
            }
        });
        let mut step = Mat::from_fn(n, 1, |row, _| right[(row / 3, row % 3)]);
        let Ok(matrix) = SparseColMat::try_new_from_triplets(n, n, &entries) else { return };
        if self.symbolic.is_none() {
            self.symbolic = SymbolicLlt::try_new(matrix.symbolic(), Side::Lower).ok();
        }
        let factor = self
            .symbolic
            .clone()
            .and_then(|symbolic| Llt::try_new_with_symbolic(symbolic, matrix.as_ref(), Side::Lower).ok());
        let Some(factor) = factor else { return };
        factor.solve_in_place(step.as_mut());
        for (row, &i) in self.slots.iter().enumerate() {
            let by = Vec3::new(step[(3 * row, 0)], step[(3 * row + 1, 0)], step[(3 * row + 2, 0)]);
            particles.moved.set(i, particles.moved.get(i) + by);
        }
    }
}

/// The constraints of one substep.
pub(super) fn solve(particles: &mut Particles, constraints: &mut Constraints, sub: &Substep) {
    let mut work = std::mem::take(&mut constraints.factored);
    work.fit(particles, sub.h);
    work.predicted.copy_from(&particles.moved);
    for _ in 0..sub.iterations {
        match constraints.method() {
            super::Method::ImplicitEuler => work.newton(particles, constraints),
            _ => work.project(particles, constraints),
        }
    }
    constraints.factored = work;
    for grab in &constraints.grabs {
        grab.apply(particles, sub);
    }
}
