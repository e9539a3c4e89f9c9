//! A ray against the current triangles.

use glam::{DVec3, Vec3};

use crate::{Soa3, Topology};

/// Triangles in a leaf at most. Testing one costs about as much as testing two boxes.
const LEAF: usize = 4;

/// Deeper than any hierarchy: halving 2³² triangles takes 32 levels, and each leaves one box waiting.
const MAX_DEPTH: usize = 40;

/// What the slab test may lose to rounding: three operations on a distance, twice, as Ize 2013 (*Robust BVH ray
/// traversal*) bounds it. Without it a ray along the border of two boxes could miss both.
const SLAB_ROUNDING: f32 = 1.0 + 6.0 * f32::EPSILON;

/// A box around a run of triangles and how to go on from there.
#[derive(Clone, Copy, Debug)]
struct Node {
    min: Vec3,
    max: Vec3,
    /// Of a leaf where its triangles start in [`Surface::order`], else the second child; the first child comes next.
    next: u32,
    /// Number of triangles of a leaf, 0 for an inner node.
    count: u32,
}

/// The triangles of one cloth in a hierarchy of boxes, so that a ray meets few of them.
///
/// Built once from the rest shape, where neighbours are near each other, and refitted to the current positions. Made
/// anew when the triangles change.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component))]
#[derive(Clone, Debug, Default)]
pub struct Surface {
    /// Children after their parents.
    nodes: Vec<Node>,
    /// The triangles, leaf by leaf.
    order: Vec<u32>,
}

/// Where a ray meets a cloth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceHit {
    /// Distance from the ray's origin, m.
    pub distance: f32,
    /// The triangle hit.
    pub triangle: u32,
    /// Barycentric weights of the hit in that triangle, each 0..=1, their sum 1.
    pub weights: [f32; 3],
    /// The particle of the triangle nearest to the hit by weight.
    pub particle: u32,
    /// Unit normal of the triangle, towards the side the ray comes from.
    pub normal: Vec3,
}

impl Surface {
    /// A hierarchy over the triangles of `topology`, fitted to the rest shape.
    pub fn new(topology: &Topology) -> Self {
        let centroids: Vec<Vec3> = (topology.triangles.iter())
            .map(|triangle| triangle.iter().map(|slot| topology.rest[*slot as usize]).sum::<Vec3>() / 3.0)
            .collect();
        let order = (0..topology.triangles.len() as u32).collect();
        let mut surface = Self { nodes: Vec::with_capacity(centroids.len()), order };
        if !centroids.is_empty() {
            surface.split(&centroids, 0, centroids.len());
        }
        surface.refit(topology, &Soa3::from_slice(&topology.rest));
        surface
    }

    /// Adds the node over `order[start..end]` and all below it: halves by the median along the widest axis.
    fn split(&mut self, centroids: &[Vec3], start: usize, end: usize) {
        let node = self.nodes.len();
        let (next, count) = (start as u32, (end - start) as u32);
        self.nodes.push(Node { min: Vec3::ZERO, max: Vec3::ZERO, next, count });
        if end - start <= LEAF {
            return;
        }
        let run = &mut self.order[start..end];
        let all = run.iter().map(|triangle| centroids[*triangle as usize]);
        let size = all.clone().fold(Vec3::NEG_INFINITY, Vec3::max) - all.fold(Vec3::INFINITY, Vec3::min);
        let axis = size.max_position();
        let half = run.len() / 2;
        // By number where the centroids agree, so that the same cloth always gives the same hierarchy.
        let key = |triangle: &u32| centroids[*triangle as usize][axis];
        run.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        self.split(centroids, start, start + half);
        self.nodes[node].next = self.nodes.len() as u32;
        self.nodes[node].count = 0;
        self.split(centroids, start + half, end);
    }

    /// Fits the boxes to `positions` of the topology it was made for. Triangles with a NaN are in no box.
    pub fn refit(&mut self, topology: &Topology, positions: &Soa3) {
        for index in (0..self.nodes.len()).rev() {
            let Node { next, count, .. } = self.nodes[index];
            let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            let (min, max) = if count > 0 {
                let run = &self.order[next as usize..(next + count) as usize];
                let corners = run.iter().flat_map(|triangle| topology.triangles[*triangle as usize]);
                corners
                    .map(|slot| positions.get(slot as usize))
                    .fold(empty, |(min, max), p| (low(min, p), high(max, p)))
            } else {
                let [a, b] = [self.nodes[index + 1], self.nodes[next as usize]];
                (a.min.min(b.min), a.max.max(b.max))
            };
            self.nodes[index].min = min;
            self.nodes[index].max = max;
        }
    }

    /// The nearest point where the ray from `origin` along `direction` (of any length) meets the triangles at
    /// `positions`, from either side; the surface has been refitted to them. `None` if it meets none, or is itself not
    /// finite.
    pub fn cast(&self, topology: &Topology, positions: &Soa3, origin: Vec3, direction: Vec3) -> Option<SurfaceHit> {
        let direction = direction.try_normalize()?;
        let mut nearest: Option<SurfaceHit> = None;
        let mut waiting = [0; MAX_DEPTH];
        let mut count = usize::from(origin.is_finite() && !self.nodes.is_empty());
        while count > 0 {
            count -= 1;
            let index = waiting[count];
            let node = &self.nodes[index as usize];
            let reach = nearest.map_or(f32::INFINITY, |hit| hit.distance);
            if !node.is_met(origin, direction, reach) {
                continue;
            }
            if node.count == 0 {
                // The child that lies ahead along the ray last, so that it is looked into first.
                let [first, second] = [index + 1, node.next];
                let centre =
                    |child: u32| (self.nodes[child as usize].min + self.nodes[child as usize].max).dot(direction);
                let children = if centre(first) <= centre(second) { [second, first] } else { [first, second] };
                waiting[count..count + 2].copy_from_slice(&children);
                count += 2;
                continue;
            }
            for triangle in &self.order[node.next as usize..(node.next + node.count) as usize] {
                let hit = meet(topology, positions, *triangle, origin, direction);
                if let Some(hit) = hit.filter(|hit| nearest.is_none_or(|nearest| hit.distance < nearest.distance)) {
                    nearest = Some(hit);
                }
            }
        }
        nearest
    }
}

impl Node {
    /// Whether the ray enters the box before `reach`, m.
    fn is_met(&self, origin: Vec3, direction: Vec3, reach: f32) -> bool {
        let (mut enter, mut leave) = (0.0_f32, reach);
        for axis in 0..3 {
            let (min, max, start, step) = (self.min[axis], self.max[axis], origin[axis], direction[axis]);
            if step == 0.0 {
                // Parallel to the slab: 0/0 at its border is no number.
                if start < min || start > max {
                    return false;
                }
                continue;
            }
            // By the sign of the step rather than by size, so that an empty box (min > max) stays empty.
            let (near, far) = if step > 0.0 { (min, max) } else { (max, min) };
            enter = enter.max((near - start) / step);
            leave = leave.min((far - start) / step * SLAB_ROUNDING);
        }
        enter <= leave
    }
}

/// The smaller of each coordinate, the other where one is NaN.
fn low(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(a.x.min(b.x), a.y.min(b.y), a.z.min(b.z))
}

/// The larger of each coordinate, the other where one is NaN.
fn high(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(a.x.max(b.x), a.y.max(b.y), a.z.max(b.z))
}

/// Where the ray meets one triangle (Möller, Trumbore 1997), from either side.
///
/// In f64, and with the weights' own rounding in f32 allowed for: a ray through an edge meets one of its triangles.
fn meet(topology: &Topology, positions: &Soa3, triangle: u32, origin: Vec3, direction: Vec3) -> Option<SurfaceHit> {
    let slots = topology.triangles[triangle as usize];
    let [p0, p1, p2] = slots.map(|slot| positions.get(slot as usize).as_dvec3());
    let (origin, direction): (DVec3, DVec3) = (origin.as_dvec3(), direction.as_dvec3());
    let (edge1, edge2) = (p1 - p0, p2 - p0);
    let normal = edge1.cross(edge2);
    let (from, across) = (origin - p0, direction.cross(edge2));
    let determinant = edge1.dot(across);
    let around = from.cross(edge1);
    let (u, v) = (from.dot(across) / determinant, direction.dot(around) / determinant);
    let distance = edge2.dot(around) / determinant;
    let rounding = -f64::from(f32::EPSILON);
    // A triangle without area, edge-on or not finite makes infinities or NaNs here, and none of them passes.
    let inside = u >= rounding && v >= rounding && 1.0 - u - v >= rounding;
    if !(inside && distance >= 0.0 && distance.is_finite()) {
        return None;
    }
    let (u, v) = (u.clamp(0.0, 1.0), v.clamp(0.0, 1.0));
    let weights = [(1.0 - u - v).max(0.0), u, v].map(|weight| weight as f32);
    let heaviest = if weights[0] >= weights[1].max(weights[2]) { 0 } else { 1 + usize::from(weights[2] > weights[1]) };
    let towards_origin = if normal.dot(direction) > 0.0 { -normal } else { normal };
    let normal = towards_origin.normalize().as_vec3();
    Some(SurfaceHit { distance: distance as f32, triangle, weights, particle: slots[heaviest], normal })
}

#[cfg(test)]
mod tests {
    use glam::{UVec2, Vec2};
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    use super::*;
    use crate::topology::Resolution;

    fn sheet() -> (Topology, Soa3, Surface) {
        let topology = Topology::rectangle(Vec2::new(2.0, 1.0), Resolution::Cells(UVec2::new(20, 10))).unwrap();
        let positions = Soa3::from_slice(&topology.rest);
        let surface = Surface::new(&topology);
        (topology, positions, surface)
    }

    fn point_of(topology: &Topology, positions: &Soa3, hit: &SurfaceHit) -> Vec3 {
        let corners = topology.triangles[hit.triangle as usize].map(|slot| positions.get(slot as usize));
        (0..3).map(|i| corners[i] * hit.weights[i]).sum()
    }

    #[test]
    fn a_ray_meets_the_sheet_where_it_should_from_either_side() {
        let (topology, positions, surface) = sheet();
        for side in [1.0, -1.0] {
            let origin = Vec3::new(0.33, -0.21, 3.0 * side);
            let hit = surface.cast(&topology, &positions, origin, Vec3::NEG_Z * side * 7.0).unwrap();
            assert!((hit.distance - 3.0).abs() < 1e-6);
            assert_eq!(hit.normal, Vec3::Z * side);
            assert!((point_of(&topology, &positions, &hit) - Vec3::new(0.33, -0.21, 0.0)).length() < 1e-6);
            let nearest = Vec3::new(0.3, -0.2, 0.0);
            assert!((topology.rest[hit.particle as usize] - nearest).length() < 1e-6);
        }
    }

    #[test]
    fn a_ray_through_a_particle_or_an_edge_does_not_slip_through() {
        let (topology, positions, surface) = sheet();
        let middle = |edge: &[u32; 2]| edge.map(|slot| topology.rest[slot as usize]).into_iter().sum::<Vec3>() / 2.0;
        let particles = topology.particles().map(|slot| topology.rest[slot as usize]);
        let inside = |p: &Vec3| p.x.abs() < 0.99 && p.y.abs() < 0.49;
        for target in particles.chain(topology.edges.iter().map(middle)).filter(inside) {
            for origin in [target + Vec3::Z, Vec3::new(0.1, 0.2, 3.0), Vec3::new(-5.0, 0.7, -0.3)] {
                assert!(surface.cast(&topology, &positions, origin, target - origin).is_some(), "{target}");
            }
        }
    }

    #[test]
    fn a_ray_beside_behind_or_along_the_sheet_meets_nothing() {
        let (topology, positions, surface) = sheet();
        let cast = |origin, direction| surface.cast(&topology, &positions, origin, direction);
        assert_eq!(cast(Vec3::new(1.01, 0.0, 1.0), Vec3::NEG_Z), None);
        assert_eq!(cast(Vec3::Z, Vec3::Z), None);
        assert_eq!(cast(Vec3::NEG_X * 3.0, Vec3::X), None);
    }

    #[test]
    fn what_is_not_finite_is_not_met_and_hides_nothing_else() {
        let (topology, mut positions, mut surface) = sheet();
        positions.set(0, Vec3::NAN);
        positions.set(1, Vec3::INFINITY);
        surface.refit(&topology, &positions);
        let cast = |origin, direction| surface.cast(&topology, &positions, origin, direction);
        assert_eq!(cast(Vec3::new(-0.99, 0.49, 1.0), Vec3::NEG_Z), None);
        assert!(cast(Vec3::new(0.3, 0.1, 1.0), Vec3::NEG_Z).is_some());
        assert_eq!(cast(Vec3::NAN, Vec3::NEG_Z), None);
        assert_eq!(cast(Vec3::Z, Vec3::NAN), None);
        assert_eq!(cast(Vec3::Z, Vec3::ZERO), None);
        positions.fill(Vec3::NAN);
        surface.refit(&topology, &positions);
        assert_eq!(surface.cast(&topology, &positions, Vec3::Z, Vec3::NEG_Z), None);
        assert_eq!(Surface::default().cast(&topology, &positions, Vec3::Z, Vec3::NEG_Z), None);
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(17), ..ProptestConfig::default() })]

        #[test]
        fn the_hierarchy_finds_what_trying_every_triangle_finds(
            bend in 0.2_f32..6.0,
            origin in prop::array::uniform3(-3.0_f32..3.0),
            target in prop::array::uniform3(-1.0_f32..1.0),
        ) {
            let (topology, mut positions, mut surface) = sheet();
            for i in 0..topology.slots() {
                let p = topology.rest[i];
                positions.set(i, Vec3::new((p.x * bend).sin(), p.y, (p.x * bend).cos() + 0.1 * p.y));
            }
            surface.refit(&topology, &positions);
            let (origin, direction) = (Vec3::from(origin), Vec3::from(target) - Vec3::from(origin));
            let found = surface.cast(&topology, &positions, origin, direction);
            let expected = (0..topology.triangles.len() as u32)
                .filter_map(|triangle| meet(&topology, &positions, triangle, origin, direction.normalize()))
                .min_by(|a, b| a.distance.total_cmp(&b.distance));
            prop_assert_eq!(found.map(|hit| hit.distance), expected.map(|hit| hit.distance));
            if let Some(hit) = found {
                prop_assert!(hit.normal.dot(direction) <= 0.0);
                let point = origin + direction.normalize() * hit.distance;
                prop_assert!((point_of(&topology, &positions, &hit) - point).length() < 1e-4);
            }
        }
    }
}
