//! When two features that move evenly over a substep first come too near: additive conservative advancement (Li, Kaufman, Jiang
//! 2021, *Codimensional incremental potential contact*).

use glam::Vec3A;

use super::nearest::{Kind, gap_along, nearest};

/// The part of the way that is safe, of which each step of the advancement takes so much.
const ADVANCE: f32 = 0.9;

/// Steps after which what has neither met nor passed counts as met. Ten are usual; each closes nine tenths of what is left.
const STEPS: u32 = 48;

/// The part of the substep, 0..1, after which the pair first comes nearer than `least` (m), if it does before the end. `from` are its
/// particles at the start, farther apart than `least`, `moved` how far they move.
pub(super) fn first_meeting(kind: Kind, from: &[Vec3A; 4], moved: &[Vec3A; 4], least: f32) -> Option<f32> {
    let mean = (moved[0] + moved[1] + moved[2] + moved[3]) * 0.25;
    let moved = moved.map(|moved| moved - mean);
    let longest = |all: &[Vec3A]| all.iter().map(|moved| moved.length()).fold(0.0, f32::max);
    let (first, second) = moved.split_at(kind.split());
    let most = longest(first) + longest(second);
    let mut t = 0.0_f32;
    for step in 0..STEPS {
        let at: [Vec3A; 4] = core::array::from_fn(|i| from[i] + moved[i] * t);
        let found = nearest(kind, &at);
        let distance = found.between.length();
        if step > 0 && distance < 1.1 * least {
            return Some(t);
        }
        // Parted by a plane from here to the end.
        let end: [Vec3A; 4] = core::array::from_fn(|i| from[i] + moved[i]);
        let normal = found.between / distance;
        if gap_along(kind, &at, normal).min(gap_along(kind, &end, normal)) > 1.1 * least {
            return None;
        }
        t += ADVANCE * (distance - least) / most;
        if t >= 1.0 || t.is_nan() {
            return None;
        }
    }
    Some(t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_vertex_that_falls_through_a_triangle_meets_it_half_way() {
        let from = [Vec3A::Y, Vec3A::NEG_X, Vec3A::new(1.0, 0.0, -1.0), Vec3A::new(1.0, 0.0, 1.0)];
        let fall = [Vec3A::NEG_Y * 2.0, Vec3A::ZERO, Vec3A::ZERO, Vec3A::ZERO];
        let t = first_meeting(Kind::VertexTriangle, &from, &fall, 0.01).unwrap();
        assert!((t - 0.495).abs() < 0.005, "{t}");
        let aside = [Vec3A::new(9.0, -2.0, 0.0), Vec3A::ZERO, Vec3A::ZERO, Vec3A::ZERO];
        assert_eq!(first_meeting(Kind::VertexTriangle, &from, &aside, 0.01), None);
    }

    fn point() -> impl Strategy<Value = Vec3A> {
        [-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0].prop_map(Vec3A::from_array)
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn no_meeting_is_missed(from in [point(), point(), point(), point()], moved in [point(), point(), point(), point()]) {
            for kind in [Kind::VertexTriangle, Kind::EdgeEdge] {
                let least = 0.02_f32;
                let at = |t: f32| -> [Vec3A; 4] { core::array::from_fn(|i| from[i] + moved[i] * t) };
                if nearest(kind, &from).between.length() < 2.0 * least {
                    continue;
                }
                let sampled = (0..=500).map(|i| i as f32 / 500.0).find(|t| nearest(kind, &at(*t)).between.length() < 0.9 * least);
                match (first_meeting(kind, &from, &moved, least), sampled) {
                    (None, Some(t)) => prop_assert!(false, "{kind:?} met at {t}"),
                    (Some(found), Some(t)) => prop_assert!(found <= t + 1e-3, "{kind:?} met at {t}, found at {found}"),
                    // What is not done after so many steps counts as met: near misses do.
                    (Some(found), None) => {
                        let distance = nearest(kind, &at(found)).between.length();
                        prop_assert!(distance < 2.0 * least && distance > 0.9 * least, "{distance}");
                    }
                    (None, None) => {}
                }
            }
        }
    }
}
