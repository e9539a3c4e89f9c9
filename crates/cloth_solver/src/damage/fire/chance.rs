//! A source of chance that can be saved.

use core::convert::Infallible;

use rand::rngs::Xoshiro256PlusPlus;
use rand::{Rng, SeedableRng, TryRng};

/// A source of chance that knows what it was made from and how often it was asked: from that it can be made again.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize), serde(from = "Drawn", into = "Drawn"))]
#[derive(Clone, Debug)]
pub(super) struct Chance {
    drawn: Drawn,
    source: Xoshiro256PlusPlus,
}

#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug)]
struct Drawn {
    seed: u64,
    count: u64,
}

impl Chance {
    pub fn new(seed: u64) -> Self {
        Self { drawn: Drawn { seed, count: 0 }, source: Xoshiro256PlusPlus::seed_from_u64(seed) }
    }
}

impl TryRng for Chance {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        self.drawn.count += 1;
        self.source.try_next_u32()
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        self.drawn.count += 1;
        self.source.try_next_u64()
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(8) {
            chunk.copy_from_slice(&self.next_u64().to_le_bytes()[..chunk.len()]);
        }
        Ok(())
    }
}

impl From<Drawn> for Chance {
    fn from(drawn: Drawn) -> Self {
        let mut source = Xoshiro256PlusPlus::seed_from_u64(drawn.seed);
        // Numbers of 32 bits take as much of the source as those of 64.
        (0..drawn.count).for_each(|_| {
            source.next_u64();
        });
        Self { drawn, source }
    }
}

impl From<Chance> for Drawn {
    fn from(chance: Chance) -> Self {
        chance.drawn
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;

    #[test]
    fn it_goes_on_where_it_was_made_again() {
        let mut chance = Chance::new(7);
        for round in 0..200_u32 {
            let mut again = Chance::from(Drawn::from(chance.clone()));
            assert_eq!(again.random::<u64>(), chance.random::<u64>());
            match round % 3 {
                0 => drop(chance.random::<f32>()),
                1 => drop(chance.random_range(0..round + 1)),
                _ => chance.fill_bytes(&mut [0; 13]),
            }
        }
    }

    #[test]
    fn it_draws_what_its_source_draws() {
        let (mut chance, mut source) = (Chance::new(3), Xoshiro256PlusPlus::seed_from_u64(3));
        for _ in 0..100 {
            assert_eq!(chance.random::<f32>(), source.random::<f32>());
            assert_eq!(chance.random_range(0..17_u32), source.random_range(0..17_u32));
        }
    }
}
