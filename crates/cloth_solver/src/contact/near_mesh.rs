//! What of a cloth is near a triangle mesh, and what of the mesh is near that: cost follows what is near, not what there is.

use glam::Vec3;

use super::near::{Item, Part};
use super::nearest::{of_segments, on_triangle};
use super::shape::TriangleMesh;
use crate::lanes::LANES;
use crate::{Soa3, Topology};

impl Part {
    /// Lists what is near `mesh` of a cloth with particles at `local` in its frame: triangles and edges no farther than `far` (m) from
    /// its folds and borders if the cloth's longest edge is given, and particles no farther than `reach` from its surface.
    pub(super) fn list_mesh(
        &mut self,
        mesh: &TriangleMesh,
        (topology, local): (&Topology, &Soa3),
        number: &mut [u32],
        [reach, far]: [f32; 2],
        longest: Option<f32>,
    ) {
        let is_near = near_slots(mesh, local, longest.map_or(reach, |longest| reach.max(far + longest)));
        if longest.is_some() {
            self.list_folds(mesh, (topology, local), &is_near, number, far);
        }
        self.sharp = self.slots.len();
        self.bound = reach;
        for slot in 0..self.sharp {
            self.list_triangles(mesh, local.get(self.slots[slot] as usize), reach);
        }
        for slot in (0..local.len()).filter(|slot| is_near[*slot] && number[*slot] == u32::MAX) {
            if self.list_triangles(mesh, local.get(slot), reach) {
                self.slots.push(slot as u32);
            } else {
                self.first_near.pop();
            }
        }
    }

    /// Lists the triangles of the mesh near `p`; `true` if there are any.
    fn list_triangles(&mut self, mesh: &TriangleMesh, p: Vec3, reach: f32) -> bool {
        let first = self.near.len();
        self.first_near.push(first as u32);
        mesh.add_triangles(p, reach, &mut self.near);
        self.near.len() > first
    }

    /// The triangles of the mesh near the particle of that number; those beyond the last are like the last.
    pub(super) fn triangles_near(&self, number: usize) -> &[u32] {
        let number = number.min(self.slots.len() - 1);
        let end = self.first_near.get(number + 1).map_or(self.near.len(), |end| *end as usize);
        &self.near[self.first_near[number] as usize..end]
    }

    fn list_folds(
        &mut self,
        mesh: &TriangleMesh,
        (topology, local): (&Topology, &Soa3),
        is_near: &[bool],
        number: &mut [u32],
        far: f32,
    ) {
        let at = |slot: u32| local.get(slot as usize);
        let all_near = |corners: &[u32]| corners.iter().all(|slot| is_near[*slot as usize]);
        let mut add = |slots: &mut Vec<u32>, slot: u32| {
            let number = &mut number[slot as usize];
            if *number == u32::MAX {
                *number = slots.len() as u32;
                slots.push(slot);
            }
            *number
        };
        let (mut corners_near, mut edges_near) = (Vec::new(), Vec::new());
        for triangle in topology.triangles.iter().filter(|triangle| all_near(&triangle[..])) {
            let (first, corners) = (self.features.len() as u32, triangle.map(at));
            fold_around(mesh, &corners, far, &mut corners_near, &mut edges_near);
            self.features.extend(corners_near.drain(..).filter(|which| {
                let (point, weights) = (mesh.vertex(*which), on_triangle(mesh.vertex(*which), corners));
                (0..3).map(|i| corners[i] * weights[i]).sum::<Vec3>().distance(point) <= far
            }));
            let near = [first, self.features.len() as u32];
            if near[1] > first {
                self.triangles.push(Item { corners: triangle.map(|slot| add(&mut self.slots, slot)), near });
            }
        }
        let split = self.features.len();
        for edge in topology.edges.iter().filter(|edge| all_near(&edge[..])) {
            let (first, ends) = (self.features.len() as u32, edge.map(at));
            fold_around(mesh, &ends, far, &mut corners_near, &mut edges_near);
            self.features.extend(edges_near.drain(..).filter(|which| {
                let fold = mesh.edge(*which);
                let [s, t] = of_segments(ends, fold);
                ends[0].lerp(ends[1], s).distance(fold[0].lerp(fold[1], t)) <= far
            }));
            let near = [first, self.features.len() as u32];
            if near[1] > first {
                self.edges.push(Item { corners: edge.map(|slot| add(&mut self.slots, slot)), near });
            }
        }
        let (of_triangles, of_edges) = self.features.split_at_mut(split);
        self.points.extend(renumber(of_triangles).iter().map(|which| mesh.vertex(*which)));
        self.segments.extend(renumber(of_edges).iter().map(|which| mesh.edge(*which)));
    }
}

/// Which slots may be no farther than `reach` from the surface.
fn near_slots(mesh: &TriangleMesh, local: &Soa3, reach: f32) -> Vec<bool> {
    let mut is_near = vec![false; local.len()];
    for (group, is_near) in is_near.chunks_mut(LANES).enumerate() {
        let at = |lane: usize| local.get(group * LANES + lane);
        let (low, high) = (0..is_near.len()).fold((Vec3::MAX, Vec3::MIN), |(l, h), i| (l.min(at(i)), h.max(at(i))));
        if mesh.may_reach(low, high, reach) {
            is_near.iter_mut().enumerate().for_each(|(i, is_near)| *is_near = mesh.may_reach(at(i), at(i), reach));
        }
    }
    is_near
}

/// Finds the folds and borders of the mesh in a box around `points` that reaches `far` beyond them.
fn fold_around(mesh: &TriangleMesh, points: &[Vec3], far: f32, corners: &mut Vec<u32>, edges: &mut Vec<u32>) {
    let (low, high) = points.iter().fold((Vec3::MAX, Vec3::MIN), |(low, high), p| (low.min(*p), high.max(*p)));
    corners.clear();
    edges.clear();
    mesh.add_folds(low - far, high + far, corners, edges);
}

/// Gives the numbers that occur in `all` new ones without gaps, and tells what they were.
fn renumber(all: &mut [u32]) -> Vec<u32> {
    let mut known = all.to_vec();
    known.sort_unstable();
    known.dedup();
    all.iter_mut().for_each(|number| *number = known.partition_point(|other| other < number) as u32);
    known
}
