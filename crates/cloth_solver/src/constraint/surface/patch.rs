//! What is no longer where it was made in a rectangle that was taken apart: threads, cells and loose triangles, in lists.
//!
//! Rows and columns are solved by eights where they lie. An eight of which any is torn goes into lists as a whole.

use fearless_simd::Simd;

use crate::batch::Batches;
use crate::constraint::kernel::cells::{CellModel, ListedCells};
use crate::constraint::kernel::hinges::Hinges;
use crate::constraint::kernel::lines::Met;
use crate::constraint::kernel::triangles::{Of, Triangles};
use crate::constraint::surface::grid::Stiffness;
use crate::constraint::surface::listed::{Listed, Work, pack};
use crate::constraint::wear::Wear;
use crate::lanes::LANES;
use crate::topology::{Along, regular_runs, threads};
use crate::{Fabric, Grid, Particles, Substep, Topology};

/// What was taken apart.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(in crate::constraint) struct Patch {
    weft: Listed8,
    warp: Listed8,
    cells: ListedCells,
    triangles: Option<Triangles>,
    hinges: Option<Hinges>,
}

/// Threads along one direction.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
struct Listed8 {
    /// For each eight of rows or columns whether it is solved where it lies.
    regular: Vec<bool>,
    blocks: Vec<Listed>,
}

impl Listed8 {
    fn new(topology: &Topology, grid: &Grid, along: Along) -> Self {
        let runs = regular_runs(topology, grid, along);
        let regular: Vec<bool> = runs.chunks(LANES).map(|eight| eight.iter().all(|regular| *regular)).collect();
        let listed = threads(topology, along, |run| !regular[run as usize / LANES]);
        Self { blocks: pack(listed, topology.padding()), regular }
    }
}

impl Patch {
    /// Of a rectangle; `None` if it was never taken apart.
    pub fn new(topology: &Topology, fabric: &Fabric) -> Option<Self> {
        let (grid, weave) = (topology.grid?, topology.weave.as_ref()?);
        let moved = grid.cells().filter_map(|(row, column)| {
            topology.cell(&grid, row, column).filter(|corners| *corners != grid.cell(row, column))
        });
        let cells = Batches::new(&moved.collect::<Vec<_>>(), topology.slots(), topology.padding());
        let mut is_loose = vec![false; topology.triangles.len()];
        weave.loose.iter().for_each(|triangle| is_loose[*triangle as usize] = true);
        let bends = fabric.bend_warp > 0.0 || fabric.bend_weft > 0.0;
        // Between whole cells, threads and cells resist bending.
        let hinges = (topology.hinge_triangles.iter().enumerate())
            .filter(|(_, sharing)| bends && sharing.iter().any(|triangle| is_loose[*triangle as usize]))
            .map(|(hinge, _)| hinge as u32);
        let hinges: Vec<u32> = hinges.collect();
        Some(Self {
            weft: Listed8::new(topology, &grid, Along::Weft),
            warp: Listed8::new(topology, &grid, Along::Warp),
            cells: ListedCells::new(cells),
            triangles: (!weave.loose.is_empty()).then(|| Triangles::new(topology, &weave.loose, fabric)),
            hinges: (!hinges.is_empty()).then(|| Hinges::new(topology, &hinges, fabric)),
        })
    }

    fn listed(&self, along: Along) -> &Listed8 {
        match along {
            Along::Weft => &self.weft,
            Along::Warp => &self.warp,
        }
    }

    fn listed_mut(&mut self, along: Along) -> &mut Listed8 {
        match along {
            Along::Weft => &mut self.weft,
            Along::Warp => &mut self.warp,
        }
    }

    /// Whether the row or column `run` is solved where it lies.
    pub fn is_regular(&self, along: Along, run: usize) -> bool {
        self.listed(along).regular[run / LANES]
    }

    /// The listed links: see [`Listed::links`].
    pub fn links(&self, along: Along) -> impl Iterator<Item = ([u32; 2], f32, f32)> + '_ {
        self.listed(along).blocks.iter().flat_map(Listed::links)
    }

    /// Takes over what became of the particles.
    pub fn wear(&mut self, wear: Option<Wear<'_>>) {
        self.weft.blocks.iter_mut().chain(&mut self.warp.blocks).for_each(|block| block.wear(wear));
        self.cells.wear(wear);
        if let Some(triangles) = &mut self.triangles {
            triangles.wear(wear);
        }
    }

    /// The loose triangles, if any.
    pub fn triangles_mut(&mut self) -> Option<&mut Triangles> {
        self.triangles.as_mut()
    }

    /// Number of constraints, `of_cell` in each cell.
    pub fn count(&self, of_cell: usize, bends_weft: bool, bends_warp: bool) -> usize {
        let mut count = self.cells.count() * of_cell;
        count += self.triangles.as_ref().map_or(0, |triangles| triangles.count())
            + self.hinges.as_ref().map_or(0, Hinges::count);
        for (along, bends) in [(Along::Weft, bends_weft), (Along::Warp, bends_warp)] {
            for [links, across] in self.listed(along).blocks.iter().map(Listed::count) {
                count += links + if bends { across } else { 0 };
            }
        }
        count
    }

    /// Solves once what belongs to no thread, as constraints, in a substep of that [`Substep::square`].
    #[inline(always)]
    pub fn solve_loose<S: Simd>(
        &mut self,
        simd: S,
        particles: &mut Particles,
        grid: &Grid,
        model: CellModel,
        square: f32,
    ) {
        self.cells.solve(simd, particles, grid, model);
        if let Some(hinges) = &self.hinges {
            hinges.solve(simd, particles, square);
        }
        if let Some(triangles) = &mut self.triangles {
            triangles.solve(simd, particles, square, Of::All);
        }
    }

    /// The same as it pulls where the substep begins; `model` for the longest one.
    #[inline(always)]
    pub fn push_loose<S: Simd>(
        &mut self,
        simd: S,
        particles: &mut Particles,
        grid: &Grid,
        model: CellModel,
        sub: &Substep,
    ) {
        self.cells.push(simd, particles, grid, model, sub.share());
        if let Some(hinges) = &self.hinges {
            hinges.push(simd, particles, sub);
        }
        if let Some(triangles) = &mut self.triangles {
            triangles.solve(simd, particles, sub.square(), Of::AllFromStart);
        }
    }

    /// Bending of the listed threads.
    #[inline(always)]
    pub fn bend<S: Simd>(
        &self,
        simd: S,
        along: Along,
        particles: &mut Particles,
        stiffness: Stiffness,
        work: &mut Work,
    ) {
        for block in &self.listed(along).blocks {
            block.bend(simd, particles, stiffness, work);
        }
    }

    /// A pass over the stretch of the listed threads.
    #[inline(always)]
    pub fn solve<S: Simd, const FIRST: bool>(
        &mut self,
        simd: S,
        along: Along,
        particles: &mut Particles,
        stiffness: Stiffness,
        work: &mut Work,
    ) -> Met<S> {
        let mut met = Met::nothing(simd);
        for block in &mut self.listed_mut(along).blocks {
            met = met.and(block.solve::<S, FIRST>(simd, particles, stiffness, work));
        }
        met
    }

    /// The same constraints swept; rigidly without `stiffness`.
    #[inline(always)]
    pub fn sweep<S: Simd>(
        &mut self,
        simd: S,
        along: Along,
        particles: &mut Particles,
        stiffness: Option<Stiffness>,
        spacing: f32,
        work: &mut Work,
    ) {
        for block in &self.listed_mut(along).blocks {
            block.sweep(simd, particles, stiffness, work, spacing);
        }
    }

    /// Waves across the listed threads slowed: see [`crate::constraint::kernel::lines::filter`].
    #[inline(always)]
    pub fn filter<S: Simd>(
        &mut self,
        simd: S,
        along: Along,
        particles: &mut Particles,
        spacing: f32,
        work: &mut Work,
        square: f32,
    ) {
        for block in &mut self.listed_mut(along).blocks {
            block.filter(simd, particles, spacing, work, square);
        }
    }
}
