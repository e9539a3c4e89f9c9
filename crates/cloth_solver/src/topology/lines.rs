//! The threads of a rectangle that was taken apart: runs of links along warp or weft that hang together.
//!
//! A link stands for half the width of each whole cell beside it. Where a crack runs along it, it is there twice, each half
//! as wide; where a crack begins, a thread forks:
//!
//! ```text
//!   ─ o ══ o ══ o ── o ── o ─      the thread that was there, half as wide from the crack's tip on
//!              ╲
//!               o ── o ── o ─      and another one, from the tip
//! ```

use super::{Grid, Topology};

/// Where links run.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Along {
    /// Along the rows.
    Weft,
    /// Down the columns.
    Warp,
}

/// A run of links.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Thread {
    /// The row or column it lies in.
    pub run: u32,
    /// Its particles.
    pub slots: Vec<u32>,
    /// The width of each link, in spacings: 1 between two whole cells, ½ beside one.
    pub width: Vec<f32>,
}

/// For each row or column of a rectangle whether it is as it was made: all of its particles, at their full width.
pub(crate) fn regular_runs(topology: &Topology, grid: &Grid, along: Along) -> Vec<bool> {
    let mut regular = vec![true; if along == Along::Weft { grid.rows } else { grid.columns } as usize];
    for (row, column) in grid.cells() {
        let (made, now) = (grid.cell(row, column), topology.cell(grid, row, column));
        for (i, corner) in made.into_iter().enumerate().filter(|_| now != Some(made)) {
            let run = if along == Along::Weft { row as usize + i / 2 } else { column as usize + i % 2 };
            regular[run] &= now.is_some_and(|now| now[i] == corner);
        }
    }
    regular
}

/// The threads along `along` of a rectangle in those rows or columns that are `wanted`, run by run; in an undamaged one as many
/// as it has rows or columns. Empty for any other mesh.
pub(crate) fn threads(topology: &Topology, along: Along, wanted: impl Fn(u32) -> bool) -> Vec<Thread> {
    let Some(grid) = topology.grid else { return Vec::new() };
    let (runs, count) = match along {
        Along::Weft => (grid.rows, grid.columns),
        Along::Warp => (grid.columns, grid.rows),
    };
    let mut threads = Vec::with_capacity(runs as usize);
    let mut open: Vec<usize> = Vec::new();
    for run in (0..runs).filter(|run| wanted(*run)) {
        open.clear();
        for k in 0..count - 1 {
            // At most one link beside each of two cells, or one for both.
            let before = (run > 0).then(|| beside(topology, &grid, along, run - 1, k, 1)).flatten();
            let after = (run + 1 < runs).then(|| beside(topology, &grid, along, run, k, 0)).flatten();
            let links = match (before, after) {
                (Some(a), Some(b)) if a == b => [Some((a, 1.0)), None],
                (a, b) => [a.map(|a| (a, 0.5)), b.map(|b| (b, 0.5))],
            };
            let mut going_on = Vec::with_capacity(2);
            for ([a, b], width) in links.into_iter().flatten() {
                let known = open.iter().position(|thread: &usize| ends_at(&threads[*thread], a));
                let thread = known.map(|at| open.swap_remove(at)).unwrap_or_else(|| {
                    threads.push(Thread { run, slots: vec![a], width: Vec::new() });
                    threads.len() - 1
                });
                threads[thread].slots.push(b);
                threads[thread].width.push(width);
                going_on.push(thread);
            }
            std::mem::swap(&mut open, &mut going_on);
        }
    }
    threads
}

fn ends_at(thread: &Thread, slot: u32) -> bool {
    thread.slots.last() == Some(&slot)
}

/// The ends of link `k` of a run at its border (0 the first, 1 the second) with the cells of row or column `cells`.
fn beside(topology: &Topology, grid: &Grid, along: Along, cells: u32, k: u32, border: usize) -> Option<[u32; 2]> {
    let corners = match along {
        Along::Weft => topology.cell(grid, cells, k)?,
        Along::Warp => topology.cell(grid, k, cells)?,
    };
    Some(match along {
        Along::Weft => [corners[2 * border], corners[2 * border + 1]],
        Along::Warp => [corners[border], corners[border + 2]],
    })
}
