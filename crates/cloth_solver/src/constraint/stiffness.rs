//! The stiffness matrices of a rectangle, for methods that solve the whole of it at once.

use glam::{Mat3, Vec3};

use super::grid::GridConstraints;
use crate::Soa3;

/// Adds `k` to the entry of two slots, both halves of the symmetric matrix.
type Scalars<'a> = &'a mut dyn FnMut(usize, usize, f32);
/// The same of 3 × 3 blocks.
type Blocks<'a> = &'a mut dyn FnMut(usize, usize, Mat3);

/// The quadratic form `½ k |Σ c_i x_i|²`.
fn square(slots: &[usize], weights: &[f32], k: f32, add: Scalars) {
    for (i, a) in slots.iter().enumerate() {
        for (j, b) in slots.iter().enumerate() {
            add(*a, *b, k * weights[i] * weights[j]);
        }
    }
}

/// The energy `½ k |Σ c_i x_i|²`, of a spring `½ k (|x_1 − x_0| − length)²`.
struct Term {
    slots: Vec<usize>,
    weights: &'static [f32],
    k: f32,
    length: Option<f32>,
}

/// Stretch, bending and twist.
fn terms(constraints: &GridConstraints) -> Vec<Term> {
    let (grid, fabric) = (constraints.grid, &constraints.fabric);
    let (a, b, stride) = (grid.spacing.x, grid.spacing.y, grid.stride as usize);
    let (columns, rows) = (grid.columns as usize, grid.rows as usize);
    let mut terms = Vec::new();
    let mut run = |first: usize, step: usize, count: usize, l: f32, width: f32, stretch: f32, bend: f32| {
        for k in 0..count - 1 {
            let at = first + k * step;
            let spring =
                Term { slots: vec![at, at + step], weights: &[1.0, -1.0], k: stretch * width / l, length: Some(l) };
            terms.push(spring);
            if k > 0 && bend > 0.0 {
                let (slots, k) = (vec![at - step, at, at + step], bend * width / (l * l * l));
                terms.push(Term { slots, weights: &[1.0, -2.0, 1.0], k, length: None });
            }
        }
    };
    for row in 0..rows {
        let width = b * constraints.row_width[row];
        run(row * stride, 1, columns, a, width, fabric.stretch_weft, fabric.bend_weft);
    }
    for column in 0..columns {
        let width = a * constraints.column_width[column];
        run(column, stride, rows, b, width, fabric.stretch_warp, fabric.bend_warp);
    }
    let twist = (fabric.bend_warp + fabric.bend_weft) / (a * b);
    let twists = cells(constraints).map(|corners| Term {
        slots: corners.to_vec(),
        weights: &[1.0, -1.0, -1.0, 1.0],
        k: twist,
        length: None,
    });
    terms.extend(twists);
    terms
}

/// Corners p00, p10, p01, p11 of each cell.
fn cells(constraints: &GridConstraints) -> impl Iterator<Item = [usize; 4]> {
    let stride = constraints.grid.stride as usize;
    constraints.grid.cells().map(move |(row, column)| {
        let at = row as usize * stride + column as usize;
        [at, at + 1, at + stride, at + stride + 1]
    })
}

/// Stiffness at rest without directions.
pub(super) fn at_rest(constraints: &GridConstraints, add: Scalars) {
    let (a, b) = (constraints.grid.spacing.x, constraints.grid.spacing.y);
    for term in terms(constraints) {
        square(&term.slots, term.weights, term.k, add);
    }
    let shear = 2.0 * constraints.fabric.shear * a * b;
    for corners in cells(constraints) {
        square(&corners, &[-0.5 / a, 0.5 / a, -0.5 / a, 0.5 / a], shear, add);
        square(&corners, &[-0.5 / b, -0.5 / b, 0.5 / b, 0.5 / b], shear, add);
    }
}

/// Stiffness at `position`: springs without what compression would take from them, shear by its gradients alone, so that
/// the matrix is positive.
pub(super) fn now(constraints: &GridConstraints, position: &Soa3, add: Blocks) {
    let (a, b) = (constraints.grid.spacing.x, constraints.grid.spacing.y);
    for Term { slots, weights, k, length } in terms(constraints) {
        let Some(rest) = length else {
            square(&slots, weights, k, &mut |p, q, k| add(p, q, Mat3::from_diagonal(Vec3::splat(k))));
            continue;
        };
        let edge = position.get(slots[1]) - position.get(slots[0]);
        let length = edge.length().max(f32::MIN_POSITIVE);
        let n = edge / length;
        let along = Mat3::from_cols(n * n.x, n * n.y, n * n.z);
        let block = along + (Mat3::IDENTITY - along) * (1.0 - rest / length).max(0.0);
        square(&slots, weights, k, &mut |p, q, k| add(p, q, block * k));
    }
    let shear = constraints.fabric.shear * a * b;
    for corners in cells(constraints) {
        let [p00, p10, p01, p11] = corners.map(|i| position.get(i));
        let (e, f) = (p11 - p00, p10 - p01);
        let (u, v) = ((e + f) * (0.5 / a), (e - f) * (0.5 / b));
        let (p, q) = (v * (0.5 / a), u * (0.5 / b));
        let gradient = [-(p + q), p - q, q - p, p + q];
        for (i, g) in corners.iter().zip(gradient) {
            for (j, h) in corners.iter().zip(gradient) {
                add(*i, *j, Mat3::from_cols(g * h.x, g * h.y, g * h.z) * shear);
            }
        }
    }
}
