//! One front: windings that agree from triangle to triangle.

use glam::Vec3;

use super::hinge::{Side, by_edge, corner, direction, pairs};

/// Turns triangles over until neighbours run their common edge in opposite directions; `turn` is told of each. Each
/// connected piece keeps the winding that most of its triangles have, on a tie that of its first one.
///
/// A one-sided surface (a Möbius strip) has no such windings: there, some edges stay where the front meets the back.
pub(super) fn orient(triangles: &mut [[u32; 3]], rest: &[Vec3], sides: &[Side], mut turn: impl FnMut(usize)) {
    let links = links(triangles, rest, sides);
    let mut turned: Vec<Option<bool>> = vec![None; triangles.len()];
    let mut piece = Vec::new();
    for start in 0..triangles.len() {
        if turned[start].is_some() {
            continue;
        }
        piece.clear();
        piece.push((start, false));
        turned[start] = Some(false);
        let mut done = 0;
        while let Some(&(triangle, is_turned)) = piece.get(done) {
            done += 1;
            for (neighbour, disagrees) in links[triangle].iter().flatten() {
                let neighbour = *neighbour as usize;
                if turned[neighbour].is_none() {
                    turned[neighbour] = Some(is_turned ^ disagrees);
                    piece.push((neighbour, is_turned ^ disagrees));
                }
            }
        }
        let turned_count = piece.iter().filter(|(_, is_turned)| *is_turned).count();
        let minority = turned_count * 2 <= piece.len();
        for (triangle, _) in piece.iter().filter(|(_, is_turned)| *is_turned == minority) {
            triangles[*triangle].swap(1, 2);
            turn(*triangle);
        }
    }
}

/// For each triangle its neighbours, by the corner opposite to the common edge, and whether both run that edge in the
/// same direction.
fn links(triangles: &[[u32; 3]], rest: &[Vec3], sides: &[Side]) -> Vec<[Option<(u32, bool)>; 3]> {
    let mut links = vec![[None; 3]; triangles.len()];
    for [first, second] in by_edge(sides).flat_map(|shared| pairs(shared, rest)) {
        let disagrees = direction(triangles, &first) == direction(triangles, &second);
        for (side, other) in [(first, second), (second, first)] {
            let triangle = side.triangle as usize;
            links[triangle][corner(triangles[triangle], side.opposite)] = Some((other.triangle, disagrees));
        }
    }
    links
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::hinge::sides;

    fn oriented(mut triangles: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
        let sides = sides(&triangles);
        let mut vertices = triangles.clone();
        // No edge has three triangles, so that no place is looked at.
        orient(&mut triangles, &[], &sides, |triangle| vertices[triangle].swap(1, 2));
        assert_eq!(vertices, triangles);
        triangles
    }

    fn disagreements(triangles: &[[u32; 3]]) -> usize {
        by_edge(&sides(triangles))
            .filter(|shared| shared.len() == 2)
            .filter(|shared| direction(triangles, &shared[0]) == direction(triangles, &shared[1]))
            .count()
    }

    /// ```text
    /// 1 ── 3 ── 5
    /// │ ／ │ ／ │
    /// 0 ── 2 ── 4
    /// ```
    const STRIP: [[u32; 3]; 4] = [[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]];

    #[test]
    fn windings_that_agree_stay_as_they_are() {
        assert_eq!(oriented(STRIP.to_vec()), STRIP);
        assert_eq!(oriented(STRIP.map(|[a, b, c]| [a, c, b]).to_vec()), STRIP.map(|[a, b, c]| [a, c, b]));
    }

    #[test]
    fn the_majority_decides_even_against_the_first_triangle() {
        for wrong in 0..4 {
            let mut triangles = STRIP.to_vec();
            triangles[wrong].swap(1, 2);
            assert_eq!(disagreements(&oriented(triangles.clone())), 0);
            let facing_forward = |t: &[u32; 3]| {
                STRIP.iter().any(|s| (0..3).all(|i| (0..3).any(|k| s[k] == t[i] && s[(k + 1) % 3] == t[(i + 1) % 3])))
            };
            assert!(oriented(triangles).iter().all(facing_forward), "triangle {wrong}");
        }
    }

    #[test]
    fn pieces_do_not_care_about_each_other() {
        let far = STRIP.map(|[a, b, c]| [a + 10, c + 10, b + 10]);
        let both: Vec<[u32; 3]> = STRIP.into_iter().chain(far).collect();
        assert_eq!(oriented(both.clone()), both);
    }

    #[test]
    fn a_one_sided_strip_keeps_one_seam_and_no_more() {
        // Five quads in a ring, the last joined to the first upside down.
        let corner = |i: u32| if i == 5 { [1, 0] } else { [2 * i, 2 * i + 1] };
        let strip: Vec<[u32; 3]> = (0..5)
            .flat_map(|i| {
                let [[a, b], [c, d]] = [corner(i), corner(i + 1)];
                [[a, c, d], [a, d, b]]
            })
            .collect();
        assert_eq!(disagreements(&oriented(strip)), 1);
    }
}
