//! Whether a triangle mesh is one of quads in rows and columns, whatever way each quad is cut and whatever its shape.
//!
//! From a row of particles and the first one of the next row, all others of that follow, triangle by triangle: so a sheet is known by
//! two of its sides, a tube by one of its ends. What is found has every triangle and every particle once, or it is none.

use std::collections::HashMap;

use glam::{DMat2, DVec3, Mat2};

use super::grid::TAIL;
use super::mesh::flattened;
use super::quads::{QuadsRest, star};
use super::{Grid, Quads, Topology, hinge};
use crate::lanes::LANES;

/// Least mean of cos² of the angle between lines and the warp that texture coordinates tell. A bias cut is solved otherwise.
const ALIGNED: f64 = 0.75;

/// Lines are smooth: how far the turn of a line within the surface may change from one particle to the next, and the turn itself, rad,
/// root mean square.
const ROUGH: f64 = 0.2;
const TURN: f64 = 0.5;

/// Largest cosine of the angle between rows and columns.
const SHEARED: f64 = 0.8;

/// How many times longer and wider the largest cell may be than the smallest.
const UNEVEN: f64 = 20.0;

/// A triangle half of a cell, and which of its corners is not on the diagonal.
type Half = (u32, u8);

/// Rows of particles from one side to the other, left to right seen from the front with the first row below.
struct Found {
    rows: Vec<Vec<u32>>,
    halves: Vec<Half>,
    is_closed: bool,
    /// How far from right angles its cells are together.
    askew: f64,
}

impl Topology {
    /// A mesh whose triangles are the halves of quads in rows and columns, open as a cape or closed as a sleeve, with
    /// [`Topology::quads`], so that it is solved along them. Particles are numbered anew, row by row; triangles, their order and the
    /// render vertices stay. Any other mesh comes back as it is.
    ///
    /// Quads may be cut either way and be of any size and shape that changes smoothly, and the surface may be bent. Rows and columns
    /// take the place of weft and warp; where texture coordinates tell of a warp that runs askew to both, the mesh stays as it is.
    /// A sheet has one border, a tube two; neither has holes or a pole where triangles meet like spokes.
    #[must_use]
    pub fn into_quads(self) -> Self {
        self.as_quads().unwrap_or(self)
    }

    fn as_quads(&self) -> Option<Self> {
        if self.grid.is_some() || self.quads.is_some() || self.original_triangles as usize != self.triangles.len() {
            return None;
        }
        let mesh = Halfedges::new(self)?;
        let found = match mesh.borders()?.as_slice() {
            [border] => mesh.sheet(border)?,
            [border, _] => mesh.tube(border)?,
            _ => return None,
        };
        self.woven_quads(found)
    }

    /// The rows from the top, the warp running up.
    fn woven_quads(&self, found: Found) -> Option<Self> {
        let Found { mut rows, halves, is_closed, .. } = found;
        rows.reverse();
        let [across, down] = self.alignment(&rows, is_closed);
        let is_turned = across.0 > down.0;
        if self.is_warp_told && across.0.max(down.0) < ALIGNED {
            return None;
        }
        let mut up = if is_turned { across.1 } else { down.1 };
        if is_turned && !is_closed {
            // A quarter turn: what was on the right is above.
            let (height, width) = (rows.len(), rows[0].len());
            rows = (0..width).map(|row| (0..height).map(|column| rows[column][width - 1 - row]).collect()).collect();
        } else if is_turned {
            up = -up;
        }
        if up < 0.0 {
            rows.reverse();
            rows.iter_mut().for_each(|row| row.reverse());
        }
        let (count, columns) = (rows.len() as u32, rows[0].len() as u32);
        let stride = columns.next_multiple_of(LANES as u32);
        let grid = Grid { columns, rows: count, stride, spacing: glam::Vec2::ONE };
        let mut quads = Quads { grid, closed: is_closed, turned: is_turned && is_closed };
        let mut made = Self { quads: Some(quads), ..self.clone() };
        let mut slot_of = vec![None; self.slots()];
        made.rest.clear();
        for (row, particles) in rows.iter().enumerate() {
            for column in 0..stride as usize {
                let particle = particles[column.min(particles.len() - 1)] as usize;
                made.rest.push(self.rest[particle]);
                if column < particles.len() {
                    slot_of[particle] = Some(grid.slot(row as u32, column as u32));
                }
            }
        }
        made.rest.resize(made.rest.len() + TAIL, made.rest.last().copied().unwrap_or_default());
        let at_rest = quads.at_rest(|slot| made.rest[slot as usize].as_dvec3());
        if !is_smooth(&quads, &at_rest, |slot| made.rest[slot as usize].as_dvec3()) {
            return None;
        }
        let mean = |links: &[glam::DVec2]| {
            let there = || links.iter().filter(|link| link.x > 0.0);
            (there().map(|link| link.x).sum::<f64>() / there().count() as f64) as f32
        };
        quads.grid.spacing = glam::Vec2::new(mean(&at_rest.links[0]), mean(&at_rest.links[1]));
        made.quads = Some(quads);
        // A vertex that no triangle uses has no particle.
        let no_particle = made.padding();
        let renumber = |particle: &mut u32| *particle = slot_of[*particle as usize].unwrap_or(no_particle);
        made.vertex_particle.iter_mut().for_each(renumber);
        made.triangles.as_flattened_mut().iter_mut().for_each(renumber);
        made.joints.iter_mut().for_each(renumber);
        made.joints.sort_unstable();
        made.squares = vec![0; made.triangles.len()];
        halves.iter().for_each(|(triangle, square)| made.squares[*triangle as usize] = *square);
        made.triangle_rest = made.along_lines(&quads);
        made.renumbered();
        Some(made)
    }

    /// How well the warp of the triangles runs along rows, and up columns: mean of cos², and of the cosine.
    fn alignment(&self, rows: &[Vec<u32>], is_closed: bool) -> [(f64, f64); 2] {
        let rest = |particle: u32| self.rest[particle as usize].as_dvec3();
        // The direction along rows and up columns at each particle.
        let mut along = vec![[DVec3::ZERO; 2]; self.slots()];
        for (row, particles) in rows.iter().enumerate() {
            let count = particles.len();
            for (column, particle) in particles.iter().enumerate() {
                let left = if is_closed { (column + count - 1) % count } else { column.saturating_sub(1) };
                let right = if is_closed { (column + 1) % count } else { (column + 1).min(count - 1) };
                let (above, below) = (row.saturating_sub(1), (row + 1).min(rows.len() - 1));
                along[*particle as usize] = [
                    (rest(particles[right]) - rest(particles[left])).normalize_or_zero(),
                    (rest(rows[above][column]) - rest(rows[below][column])).normalize_or_zero(),
                ];
            }
        }
        let (mut sums, mut total) = ([(0.0, 0.0); 2], 0.0);
        for (triangle, corners) in self.triangles.iter().enumerate() {
            let flat: DMat2 = self.triangle_rest[triangle].as_dmat2();
            let [p0, p1, p2] = corners.map(rest);
            let m = flat.inverse().y_axis;
            let (warp, area) = ((p1 - p0) * m.x + (p2 - p0) * m.y, flat.determinant() / 3.0);
            for corner in corners {
                for (sum, direction) in sums.iter_mut().zip(along[*corner as usize]) {
                    let cosine = warp.dot(direction);
                    sum.0 += cosine * cosine * area;
                    sum.1 += cosine * area;
                }
                total += area;
            }
        }
        sums.map(|(square, sum)| (square / total, sum / total))
    }

    /// The triangles at rest with the warp along the lines.
    fn along_lines(&self, quads: &Quads) -> Vec<Mat2> {
        let rest = |slot: u32| self.rest[slot as usize].as_dvec3();
        let stride = quads.grid.stride;
        let warp = |corners: &[u32; 3]| {
            // The cell's upper row, and where it begins.
            let row = corners.iter().map(|slot| slot / stride).min().unwrap_or_default();
            let columns = corners.map(|slot| slot % stride);
            let [low, high] =
                [columns.iter().min(), columns.iter().max()].map(|column| column.copied().unwrap_or_default());
            let [p00, p10, p01, p11] = quads.cell(row, if high - low > 1 { high } else { low }).map(rest);
            if quads.turned { p10 - p00 + p11 - p01 } else { p00 - p01 + p10 - p11 }
        };
        self.triangles.iter().map(|corners| flattened(corners.map(rest), Some(warp(corners)))).collect()
    }

    /// Finds anew what follows from the numbers of the particles.
    fn renumbered(&mut self) {
        let sides = hinge::sides(&self.triangles);
        (self.hinges, self.hinge_triangles) = hinge::hinges(&self.triangles, &self.rest, &sides).unzip();
        self.edges = hinge::by_edge(&sides).map(|shared| shared[0].edge).collect();
        let angle = |hinge: &[u32; 4]| {
            let [a, b, c, d] = hinge.map(|slot| self.rest[slot as usize]);
            hinge::hinge_angle(a, b, c, d)
        };
        self.hinge_rest = self.hinges.iter().map(angle).collect();
        self.area = vec![0.0; self.rest.len()];
        for triangle in 0..self.triangles.len() {
            for (slot, area) in self.triangles[triangle].into_iter().zip(self.corner_areas(triangle as u32)) {
                self.area[slot as usize] += area;
            }
        }
        self.free = self.rest.len() as u32;
    }
}

/// Whether lines run smoothly and cells are fit to be solved along them.
fn is_smooth(quads: &Quads, at_rest: &QuadsRest, rest: impl Fn(u32) -> DVec3) -> bool {
    let (mut low, mut high) = (glam::DVec2::INFINITY, glam::DVec2::ZERO);
    for (row, column) in quads.cells() {
        let cell = &at_rest.cells[quads.grid.slot(row, column) as usize];
        (low, high) = (low.min(cell.size), high.max(cell.size));
        let parts = [cell.shear, cell.skew.x, cell.skew.y, cell.twist];
        // Written so that a NaN is not smooth.
        if !(cell.shear.abs() < SHEARED && cell.area > 0.0 && parts.iter().all(|part| part.is_finite())) {
            return false;
        }
    }
    if !(high.cmple(low * UNEVEN).all() && low.min_element() > 0.0) {
        return false;
    }
    let Grid { rows, columns, .. } = quads.grid;
    let (mut turns, mut changes) = ((0.0, 0), (0.0, 0));
    for along in 0..2 {
        let (runs, count) = if along == 0 { (rows, columns) } else { (columns, rows) };
        for run in 0..runs {
            let mut last: Option<f64> = None;
            for k in 0..count {
                let (row, column) = if along == 0 { (run, k) } else { (k, run) };
                let slot = quads.grid.slot(row, column);
                let bend = &at_rest.bends[along][slot as usize];
                let around = quads.neighbours(row, column).map(|slot| slot.map(&rest));
                let [a, b] = star(rest(slot), around);
                let normal = a.cross(b).normalize_or_zero();
                let line = if along == 0 { a } else { b };
                let turn = (a * bend.skew.x + b * bend.skew.y).dot(normal.cross(line).normalize_or_zero());
                if bend.shape > 0.0 {
                    turns = (turns.0 + turn * turn, turns.1 + 1);
                    if let Some(last) = last {
                        changes = (changes.0 + (turn - last) * (turn - last), changes.1 + 1);
                    }
                }
                last = (bend.shape > 0.0).then_some(turn);
            }
        }
    }
    let below = |(sum, count): (f64, u32), limit: f64| count == 0 || sum < limit * limit * f64::from(count);
    below(turns, TURN) && below(changes, ROUGH)
}

/// Which triangle lies to the left of which side.
struct Halfedges<'a> {
    topology: &'a Topology,
    triangle: HashMap<[u32; 2], u32>,
    /// How many triangles meet at each particle.
    valence: Vec<u32>,
}

impl<'a> Halfedges<'a> {
    /// `None` of a surface with one side only.
    fn new(topology: &'a Topology) -> Option<Self> {
        let mut made = Self {
            topology,
            triangle: HashMap::with_capacity(3 * topology.triangles.len()),
            valence: vec![0; topology.slots()],
        };
        for (triangle, [a, b, c]) in topology.triangles.iter().enumerate() {
            for side in [[*a, *b], [*b, *c], [*c, *a]] {
                made.valence[side[0] as usize] += 1;
                if made.triangle.insert(side, triangle as u32).is_some() {
                    return None;
                }
            }
        }
        Some(made)
    }

    /// The triangle to the left of a side, and its corner off that.
    fn left_of(&self, a: u32, b: u32) -> Option<(u32, u32)> {
        let triangle = *self.triangle.get(&[a, b])?;
        let apex =
            self.topology.triangles[triangle as usize].into_iter().find(|corner| *corner != a && *corner != b)?;
        Some((triangle, apex))
    }

    /// The borders, each in the direction that has the cloth on the left; `None` if any two touch.
    fn borders(&self) -> Option<Vec<Vec<u32>>> {
        let mut next = HashMap::new();
        let mut starts = Vec::new();
        for [a, b, c] in &self.topology.triangles {
            for [from, to] in [[*a, *b], [*b, *c], [*c, *a]] {
                if !self.triangle.contains_key(&[to, from]) {
                    starts.push(from);
                    if next.insert(from, to).is_some() {
                        return None;
                    }
                }
            }
        }
        let mut borders = Vec::new();
        for start in starts {
            let mut border = Vec::new();
            let mut at = start;
            while let Some(to) = next.remove(&at) {
                border.push(at);
                at = to;
            }
            if !border.is_empty() {
                borders.push(border);
            }
        }
        Some(borders)
    }

    /// The next row above `low`, whose first particle is `first`, and the halves of the cells between.
    fn strip(&self, low: &[u32], is_closed: bool, first: u32) -> Option<(Vec<u32>, Vec<Half>)> {
        let cells = if is_closed { low.len() } else { low.len() - 1 };
        let (mut high, mut halves) = (vec![first], Vec::with_capacity(2 * cells));
        for column in 0..cells {
            let (a, b, above) = (low[column], low[(column + 1) % low.len()], high[column]);
            let (lower, apex) = self.left_of(a, b)?;
            let (upper, next, squares) = if apex == above {
                let (upper, next) = self.left_of(above, b)?;
                (upper, next, [a, next])
            } else {
                let (upper, corner) = self.left_of(a, apex)?;
                if corner != above {
                    return None;
                }
                (upper, apex, [b, above])
            };
            for (triangle, square) in [lower, upper].into_iter().zip(squares) {
                let corners = self.topology.triangles[triangle as usize];
                halves.push((triangle, corners.iter().position(|corner| *corner == square)? as u8));
            }
            high.push(next);
        }
        if is_closed && high.pop() != Some(first) {
            return None;
        }
        Some((high, halves))
    }

    /// How far from right angles the cells between two rows are together.
    fn askew(&self, low: &[u32], high: &[u32], is_closed: bool) -> f64 {
        let rest = |particle: u32| self.topology.rest[particle as usize].as_dvec3();
        let cells = if is_closed { low.len() } else { low.len() - 1 };
        (0..cells)
            .map(|column| {
                let right = (column + 1) % low.len();
                let [a, b, c, d] = [low[column], low[right], high[column], high[right]].map(rest);
                let (across, up) = ((b - a) + (d - c), (c - a) + (d - b));
                across.normalize_or_zero().dot(up.normalize_or_zero()).powi(2)
            })
            .sum()
    }

    /// Whether `found` has everything once.
    fn is_all(&self, found: &Found) -> bool {
        let mut seen = vec![false; self.topology.slots()];
        let once = |seen: &mut [bool], at: u32| !std::mem::replace(&mut seen[at as usize], true);
        let particles = found.rows.iter().flatten().all(|particle| once(&mut seen, *particle));
        let mut seen = vec![false; self.topology.triangles.len()];
        let triangles = found.halves.iter().all(|(triangle, _)| once(&mut seen, *triangle));
        let count = found.rows.iter().map(Vec::len).sum::<usize>();
        particles && triangles && found.halves.len() == seen.len() && count == self.topology.particle_count()
    }

    /// The rows of a sheet with that border.
    fn sheet(&self, border: &[u32]) -> Option<Found> {
        let (length, triangles) = (border.len(), self.topology.triangles.len());
        if !length.is_multiple_of(2) || !triangles.is_multiple_of(2) {
            return None;
        }
        // Cells across and down: their sum is half the border, their product half the triangles.
        let (sum, product) = (length / 2, triangles / 2);
        let root = (sum * sum).checked_sub(4 * product)?.isqrt();
        let sizes = [[(sum - root) / 2, (sum + root) / 2], [(sum + root) / 2, (sum - root) / 2]];
        if sizes[0][0] * sizes[0][1] != product || sizes[0][0] + sizes[0][1] != sum || sizes[0][0] == 0 {
            return None;
        }
        let mut best: Option<Found> = None;
        for [across, up] in sizes.into_iter().take(if root == 0 { 1 } else { 2 }) {
            let at = |from: usize, by: usize| border[(from + by) % length];
            let is_corner = |from: usize, by: usize| self.valence[at(from, by) as usize] <= 2;
            let corners = [0, across, across + up, 2 * across + up];
            // Half the starts, of which the others are the same sheet upside down.
            for start in (0..length).filter(|start| corners.iter().all(|by| is_corner(*start, *by))) {
                let found = self.sheet_from(across, up, |by| at(start, by));
                let Some(found) = found.filter(|found| self.is_all(found)) else { continue };
                if best.as_ref().is_none_or(|best| found.askew < best.askew) {
                    best = Some(found);
                }
            }
        }
        best
    }

    /// The rows of a sheet from the border that begins at its lower left corner.
    fn sheet_from(&self, across: usize, up: usize, border: impl Fn(usize) -> u32) -> Option<Found> {
        let length = 2 * (across + up);
        let mut found =
            Found { rows: vec![(0..=across).map(&border).collect()], halves: Vec::new(), is_closed: false, askew: 0.0 };
        for row in 1..=up {
            let low = &found.rows[row - 1];
            let (high, halves) = self.strip(low, false, border(length - row))?;
            if high.last() != Some(&border(across + row)) {
                return None;
            }
            found.askew += self.askew(low, &high, false);
            found.halves.extend(halves);
            found.rows.push(high);
        }
        Some(found)
    }

    /// The rows of a tube whose lower end is that border.
    fn tube(&self, border: &[u32]) -> Option<Found> {
        let (across, triangles) = (border.len(), self.topology.triangles.len());
        if across < 3 || !triangles.is_multiple_of(2 * across) {
            return None;
        }
        let mut found = Found { rows: vec![border.to_vec()], halves: Vec::new(), is_closed: true, askew: 0.0 };
        for row in 1..=triangles / (2 * across) {
            let low = &found.rows[row - 1];
            // Every neighbour above the first particle of the row could be the first of the next: the nearest to a right angle is.
            let mut best: Option<(f64, Vec<u32>, Vec<Half>)> = None;
            let (mut first, last) = (low[1], low[across - 1]);
            for _ in 0..self.valence[low[0] as usize] {
                let Some((_, apex)) = self.left_of(low[0], first) else { break };
                if apex == last {
                    break;
                }
                first = apex;
                if let Some((high, halves)) = self.strip(low, true, first) {
                    let askew = self.askew(low, &high, true);
                    if best.as_ref().is_none_or(|(least, ..)| askew < *least) {
                        best = Some((askew, high, halves));
                    }
                }
            }
            let (askew, high, halves) = best?;
            found.askew += askew;
            found.halves.extend(halves);
            found.rows.push(high);
        }
        self.is_all(&found).then_some(found)
    }
}
