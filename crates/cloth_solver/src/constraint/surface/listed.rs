//! Threads of a rectangle that was taken apart: what [`crate::constraint::kernel::lines`] does to rows and columns, on runs of any particles,
//! eight side by side.

use fearless_simd::Simd;

use crate::batch::{gather, gather3, scatter3};
use crate::constraint::kernel::lines::{self, Elimination, Links8, Met};
use crate::constraint::kernel::links::{Block, GONE, Worn};
use crate::constraint::kernel::sweep;
use crate::constraint::surface::grid::Stiffness;
use crate::constraint::wear::Wear;
use crate::lanes::{LANES, splat, store};
use crate::topology::Thread;
use crate::{Particles, Soa3};

/// What eight runs are brought together in, and worked on.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(in crate::constraint) struct Work {
    pub position: Soa3,
    pub moved: Soa3,
    pub inverse_mass: Vec<f32>,
    pub elimination: Elimination,
}

impl Work {
    /// For runs of up to `longest` particles.
    pub fn new(longest: usize) -> Self {
        let len = longest.next_multiple_of(LANES) * LANES;
        Self {
            position: Soa3::zeros(len),
            moved: Soa3::zeros(len),
            inverse_mass: vec![0.0; len],
            elimination: Elimination::new(longest),
        }
    }
}

/// Eight threads.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(in crate::constraint) struct Listed {
    /// The particles, eight lanes each; padding behind the end of a thread.
    slots: Vec<[u32; LANES]>,
    /// 1/width of each link, in spacings.
    narrow: Vec<f32>,
    /// Factors on compliance and rest length.
    compliance: Vec<f32>,
    rest: Vec<f32>,
    found: Links8,
    /// The rows or columns of the threads.
    runs: Vec<u32>,
}

/// Puts threads together by eights, those of about the same length, and none beside another one of the same row or column,
/// with which it may share a particle.
pub(in crate::constraint) fn pack(mut threads: Vec<Thread>, padding: u32) -> Vec<Listed> {
    threads.sort_by_key(|thread| (std::cmp::Reverse(thread.slots.len()), thread.run));
    let mut blocks: Vec<Listed> = Vec::new();
    for thread in threads {
        let free = |block: &Listed| block.runs.len() < LANES && !block.runs.contains(&thread.run);
        let at = blocks.iter().position(free).unwrap_or_else(|| {
            blocks.push(Listed::new(thread.slots.len(), padding));
            blocks.len() - 1
        });
        blocks[at].add(&thread);
    }
    blocks
}

impl Listed {
    fn new(count: usize, padding: u32) -> Self {
        let narrow = vec![GONE; count * LANES];
        Self {
            slots: vec![[padding; LANES]; count],
            compliance: narrow.clone(),
            rest: vec![1.0; count * LANES],
            found: Links8::new(count * LANES),
            narrow,
            runs: Vec::new(),
        }
    }

    fn add(&mut self, thread: &Thread) {
        let lane = self.runs.len();
        self.runs.push(thread.run);
        for (k, slot) in thread.slots.iter().enumerate() {
            self.slots[k][lane] = *slot;
        }
        for (k, width) in thread.width.iter().enumerate() {
            self.narrow[k * LANES + lane] = 1.0 / width;
            self.compliance[k * LANES + lane] = 1.0 / width;
        }
    }

    /// Takes over what became of the particles.
    pub fn wear(&mut self, wear: Option<Wear<'_>>) {
        for (link, narrow) in self.narrow.iter().enumerate().filter(|(_, narrow)| **narrow < GONE) {
            let (k, lane) = (link / LANES, link % LANES);
            let ends = [self.slots[k][lane], self.slots[k + 1][lane]];
            self.compliance[link] = (narrow * wear.map_or(1.0, |wear| wear.compliance(ends))).min(GONE);
            self.rest[link] = wear.map_or(1.0, |wear| wear.rest(ends));
        }
    }

    /// The links that are there: their ends, λ of the last substep, 1/width.
    pub fn links(&self) -> impl Iterator<Item = ([u32; 2], f32, f32)> + '_ {
        (self.narrow.iter().enumerate()).filter(|(_, narrow)| **narrow < GONE).map(|(link, narrow)| {
            let (k, lane) = (link / LANES, link % LANES);
            ([self.slots[k][lane], self.slots[k + 1][lane]], self.found.lambda[link], *narrow)
        })
    }

    /// Number of links and of bends.
    pub fn count(&self) -> [usize; 2] {
        let links = self.links().count();
        // A thread has one bend less than it has links.
        [links, links - self.runs.len()]
    }

    fn block(&self, spacing: f32) -> Block {
        Block { base: 0, stride: LANES, count: self.slots.len(), spacing, links: 0 }
    }

    #[inline(always)]
    fn gather<S: Simd>(&self, simd: S, particles: &Particles, work: &mut Work) {
        for (k, slots) in self.slots.iter().enumerate() {
            gather3(simd, &particles.position, slots).store(&mut work.position, k * LANES);
            gather3(simd, &particles.moved, slots).store(&mut work.moved, k * LANES);
            store(gather(simd, &particles.inverse_mass, slots), &mut work.inverse_mass, k * LANES);
        }
    }

    #[inline(always)]
    fn scatter<S: Simd>(&self, simd: S, work: &Work, particles: &mut Particles) {
        for (k, slots) in self.slots.iter().enumerate() {
            scatter3(crate::lanes::Vec3x8::load(simd, &work.moved, k * LANES), &mut particles.moved, slots);
        }
    }

    /// Bending of each thread.
    #[inline(always)]
    pub fn bend<S: Simd>(&self, simd: S, particles: &mut Particles, stiffness: Stiffness, work: &mut Work) {
        let Some(bend) = stiffness.bend(simd, splat(simd, 1.0)) else { return };
        self.gather(simd, particles, work);
        let worn = Worn::new(&self.compliance, &self.rest);
        let Work { position, moved, inverse_mass, elimination } = &mut *work;
        lines::bend(simd, self.block(stiffness.spacing), position, moved, inverse_mass, bend, worn, elimination);
        self.scatter(simd, work, particles);
    }

    /// A pass over the stretch of each thread.
    #[inline(always)]
    pub fn solve<S: Simd, const FIRST: bool>(
        &mut self,
        simd: S,
        particles: &mut Particles,
        stiffness: Stiffness,
        work: &mut Work,
    ) -> Met<S> {
        self.gather(simd, particles, work);
        let block = self.block(stiffness.spacing);
        let worn = Worn::new(&self.compliance, &self.rest);
        let Work { position, moved, inverse_mass, .. } = &mut *work;
        let (compliance, found) = ((splat(simd, stiffness.stretch), stiffness.how), &mut self.found);
        let met =
            lines::stretch::<S, _, FIRST, false>(simd, block, position, moved, inverse_mass, compliance, worn, found);
        self.scatter(simd, work, particles);
        met
    }

    /// The same constraints swept, rigidly without `stiffness`.
    #[inline(always)]
    pub fn sweep<S: Simd>(
        &self,
        simd: S,
        particles: &mut Particles,
        stiffness: Option<Stiffness>,
        work: &mut Work,
        spacing: f32,
    ) {
        self.gather(simd, particles, work);
        let worn = Some(Worn::new(&self.compliance, &self.rest));
        #[expect(clippy::manual_map, reason = "a closure would lack the dispatched instruction set")]
        let compliance = match stiffness {
            Some(stiffness) => Some(stiffness.of_one_spacing(simd)),
            None => None,
        };
        let Work { position, moved, inverse_mass, .. } = &mut *work;
        sweep::block(simd, self.block(spacing), position, moved, inverse_mass, compliance, worn);
        self.scatter(simd, work, particles);
    }

    /// Waves across the threads slowed: see [`lines::filter`].
    #[inline(always)]
    pub fn filter<S: Simd>(&mut self, simd: S, particles: &mut Particles, spacing: f32, work: &mut Work, square: f32) {
        self.gather(simd, particles, work);
        let Work { position, moved, inverse_mass, elimination } = &mut *work;
        lines::filter::<S, false>(
            simd,
            self.block(spacing),
            position,
            moved,
            inverse_mass,
            &mut self.found,
            elimination,
            square,
        );
        self.scatter(simd, work, particles);
    }
}
