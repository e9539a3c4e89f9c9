//! Vertices at the same place become one.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

/// Width of a hash cell in tolerances. Wide enough that most vertices look into one cell only, narrow enough that
/// a cell rarely holds two vertices.
const CELL_WIDTH: f64 = 8.0;

/// The end of a cell's list.
const NONE: u32 = u32::MAX;

/// For each position the first position that stands within `tolerance` (m, more than 0) of it and was itself not
/// welded to another: its own index if there is none. All positions are finite.
///
/// Depends on nothing but the order of the positions: the hash map is only ever asked, never walked.
pub(super) fn weld(positions: &[Vec3], tolerance: f64) -> Vec<u32> {
    let cell = tolerance * CELL_WIDTH;
    let index = |p: DVec3| (p / cell).floor().as_i64vec3();
    let origin = positions.iter().copied().reduce(Vec3::min).unwrap_or_default().as_dvec3();
    // One list per cell: the map holds its newest vertex, `older` leads from there to the oldest.
    let mut newest = HashMap::with_capacity(positions.len());
    let mut older = vec![NONE; positions.len()];
    let mut first = Vec::with_capacity(positions.len());
    for (i, position) in positions.iter().enumerate() {
        let place = position.as_dvec3() - origin;
        let (from, to) = (index(place - tolerance), index(place + tolerance));
        let mut found = i as u32;
        for x in from.x..=to.x {
            for y in from.y..=to.y {
                for z in from.z..=to.z {
                    let mut next = newest.get(&[x, y, z]).copied().unwrap_or(NONE);
                    while next != NONE {
                        let other = positions[next as usize].as_dvec3() - origin;
                        if other.distance_squared(place) <= tolerance * tolerance {
                            found = found.min(next);
                        }
                        next = older[next as usize];
                    }
                }
            }
        }
        if found == i as u32 {
            older[i] = newest.insert(index(place).to_array(), found).unwrap_or(NONE);
        }
        first.push(found);
    }
    first
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    use super::*;

    #[test]
    fn what_is_apart_by_less_than_the_tolerance_is_one_even_across_cells() {
        let eight = (8.0 * 1e-3) as f32;
        let positions = [[0.0; 3], [eight - 2e-4, 0.5, 0.0], [eight + 2e-4, 0.5, 0.0], [eight + 2e-3, 0.5, 0.0]];
        assert_eq!(weld(&positions.map(Vec3::from), 1e-3), [0, 1, 1, 3]);
    }

    #[test]
    fn a_chain_of_close_vertices_does_not_collapse_into_one() {
        let chain: Vec<Vec3> = (0..100).map(|i| Vec3::X * (i as f32 * 0.75)).collect();
        let first = weld(&chain, 1.0);
        assert!((0..100).all(|i| chain[i].distance(chain[first[i] as usize]) <= 1.0));
        assert_eq!(first.iter().max(), Some(&98));
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(17), ..ProptestConfig::default() })]

        #[test]
        fn the_hash_grid_finds_what_comparing_all_pairs_finds(
            raw in prop::collection::vec([0_i8..12, 0_i8..12, 0_i8..3], 1..120),
        ) {
            // Steps of 0.3 tolerances: many neighbours within one, many just outside.
            let positions: Vec<Vec3> =
                raw.iter().map(|p| Vec3::from(p.map(|x| f32::from(x) * 0.3 - 1.7))).collect();
            let mut expected: Vec<u32> = Vec::new();
            for (i, p) in positions.iter().enumerate() {
                let found = (0..i).find(|j| {
                    expected[*j] == *j as u32 && positions[*j].as_dvec3().distance_squared(p.as_dvec3()) <= 1.0
                });
                expected.push(found.unwrap_or(i) as u32);
            }
            prop_assert_eq!(weld(&positions, 1.0), expected);
        }
    }
}
