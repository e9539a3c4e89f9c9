//! What taking cloth apart did to its particles and triangles, for all that keeps an array of either.

/// A particle that was not there before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Born {
    /// Its slot.
    pub slot: u32,
    /// The two particles it lies between; twice the same for a copy. Both are in smaller slots, and may be born
    /// themselves.
    pub parents: [u32; 2],
    /// Where between them it lies at rest: 0 at the first, 1 at the second.
    pub t: f32,
}

impl Born {
    /// The value at this particle of something the parents have `value` of.
    pub fn blend<T>(&self, value: impl Fn(usize) -> T) -> T
    where
        T: core::ops::Mul<f32, Output = T> + core::ops::Add<Output = T>,
    {
        let [a, b] = self.parents.map(|slot| slot as usize);
        // A copy is the same to the last bit.
        if a == b { value(a) } else { value(a) * (1.0 - self.t) + value(b) * self.t }
    }
}

/// A render vertex that was not there before.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BornVertex {
    /// The two vertices it lies between; twice the same for a copy. Both have smaller numbers.
    pub parents: [u32; 2],
    /// Where between them it lies: 0 at the first, 1 at the second.
    pub t: f32,
}

/// What taking a cloth apart did to its particles and triangles. Slots keep their meaning; what is new is at the end.
/// Triangles are numbered anew.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Change {
    /// Number of slots now, padding included.
    pub slots: usize,
    /// Particles that were not there before, in ascending order of their slots.
    pub born: Vec<Born>,
    /// Render vertices that were not there before, in the order of their numbers, which follow on those there were.
    pub vertices: Vec<BornVertex>,
    /// For each triangle now the triangle before that it is, or is a part of.
    pub triangles: Vec<u32>,
    /// Particles whose last triangle is gone: they have no area and no mass any more.
    pub gone: Vec<u32>,
    /// For each slot whether it stands for another area than before.
    pub(crate) touched: Vec<bool>,
}
