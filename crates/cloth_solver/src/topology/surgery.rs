//! Taking a topology apart: dividing triangles, parting the fans of vertices, taking triangles out.
//!
//! After each operation is finished every particle has one fan of triangles: a particle whose triangles no longer hang together by
//! edges is parted, too. But where fans met in one particle from the beginning, they do until it is parted there.

use std::collections::HashMap;
use std::sync::Arc;

use glam::Vec2;

use super::weave::{NONE, Weave};
use super::{Born, BornVertex, Change, NO_SQUARE, Topology, hinge, renew, with_room};
use crate::lanes::LANES;

/// Where an edge is divided.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Its ends, the smaller slot first.
    pub edge: [u32; 2],
    /// Where between them, 0..1.
    pub t: f32,
}

/// One operation on a topology.
pub(crate) struct Surgery<'a> {
    topology: &'a mut Topology,
    change: Change,
    halves: Vec<u32>,
    /// Triangles of each particle that was looked at.
    fans: HashMap<u32, Vec<u32>>,
    /// Triangles of each particle when fans were first asked for: `list[start[slot]..start[slot + 1]]`.
    start: Vec<u32>,
    list: Vec<u32>,
    removed: Vec<bool>,
    /// Particles whose triangles are other ones than before.
    touched: Vec<u32>,
}

impl<'a> Surgery<'a> {
    /// Begins.
    pub fn new(topology: &'a mut Arc<Topology>) -> Self {
        let topology = Topology::make_own(topology);
        let numbers: Vec<u32> = (0..topology.triangles.len() as u32).collect();
        let halves = match (&mut topology.weave, &topology.grid) {
            (Some(weave), _) => std::mem::take(&mut weave.halves),
            (None, Some(_)) => with_room(&numbers),
            (None, None) => vec![NONE; numbers.len()],
        };
        let change = Change { triangles: with_room(&numbers), ..Change::default() };
        let (fans, start, list, removed, touched) = Default::default();
        Self { topology, change, halves, fans, start, list, removed, touched }
    }

    /// The topology as it is so far.
    pub fn topology(&self) -> &Topology {
        self.topology
    }

    fn bear(&mut self, parents: [u32; 2], t: f32) -> u32 {
        let slot = self.topology.free;
        self.topology.free += 1;
        let born = Born { slot, parents, t };
        let rest = born.blend(|slot| self.topology.rest[slot]);
        let padded = (slot as usize + 2).next_multiple_of(LANES);
        if self.topology.rest.len() < padded {
            self.topology.rest.resize(padded, rest);
            self.topology.area.resize(padded, 0.0);
        }
        self.topology.rest[slot as usize] = rest;
        self.change.born.push(born);
        self.touched.extend([parents[0], parents[1], slot]);
        slot
    }

    fn bear_vertex(&mut self, parents: [u32; 2], t: f32, particle: u32) -> u32 {
        self.change.vertices.push(BornVertex { parents, t });
        self.topology.vertex_particle.push(particle);
        self.topology.vertex_particle.len() as u32 - 1
    }

    /// Divides every triangle at the crossings on its edges, at most two of which are crossed; in the order of the crossings,
    /// which have to be sorted by edge, the new particles. To be called before anything is parted.
    pub fn divide(&mut self, crossings: &[Crossing]) -> Vec<u32> {
        let mut is_end = vec![false; self.topology.slots()];
        crossings.iter().flat_map(|crossing| crossing.edge).for_each(|slot| is_end[slot as usize] = true);
        let born: Vec<u32> = crossings.iter().map(|crossing| self.bear(crossing.edge, crossing.t)).collect();
        let mut vertices = HashMap::new();
        for triangle in 0..self.topology.triangles.len() {
            let corners = self.topology.triangles[triangle];
            let ends = corners.map(|slot| is_end[slot as usize]);
            if ends.into_iter().filter(|is_end| *is_end).count() < 2 {
                continue;
            }
            let crossing = |side: usize| {
                let [a, b] = [corners[side], corners[(side + 1) % 3]];
                if !ends[side] || !ends[(side + 1) % 3] {
                    return None;
                }
                let at = crossings.binary_search_by_key(&[a.min(b), a.max(b)], |crossing| crossing.edge).ok()?;
                let t = crossings[at].t;
                // t from the side's first corner on.
                Some((side, (born[at], if a < b { t } else { 1.0 - t })))
            };
            let crossed: Vec<(usize, (u32, f32))> = (0..3).filter_map(crossing).collect();
            if !crossed.is_empty() {
                self.divide_triangle(triangle, &crossed, &mut vertices);
            }
        }
        born
    }

    fn divide_triangle(
        &mut self,
        triangle: usize,
        crossed: &[(usize, (u32, f32))],
        vertices: &mut HashMap<[u32; 2], u32>,
    ) {
        let rest = self.topology.triangle_rest[triangle];
        let flat = [Vec2::ZERO, rest.x_axis, rest.y_axis];
        let has_backs = !self.topology.triangle_backs.is_empty();
        let corner = |this: &Self, i: usize| Point {
            slot: this.topology.triangles[triangle][i % 3],
            vertex: this.topology.triangle_vertices[triangle][i % 3],
            back: if has_backs { this.topology.triangle_backs[triangle][i % 3] } else { NONE },
            flat: flat[i % 3],
        };
        let points: Vec<Point> = crossed
            .iter()
            .map(|&(side, (slot, t))| {
                let (a, b) = (corner(self, side), corner(self, side + 1));
                let vertex = self.vertex_between([a.vertex, b.vertex], t, slot, vertices);
                let back = if has_backs { self.vertex_between([a.back, b.back], t, slot, vertices) } else { NONE };
                Point { slot, vertex, back, flat: a.flat.lerp(b.flat, t) }
            })
            .collect();
        let parts: Vec<[Point; 3]> = match (crossed, points.as_slice()) {
            ([(side, _)], [p]) => {
                let [a, b, c] = [0, 1, 2].map(|i| corner(self, side + i));
                vec![[a, *p, c], [*p, b, c]]
            }
            ([(first, _), (second, _)], [p, q]) => {
                // Turned so that the corner between both crossed sides comes first: q on c a, p on a b.
                let (top, p, q) = if second - first == 1 { (*second, q, p) } else { (*first, p, q) };
                let [a, b, c] = [0, 1, 2].map(|i| corner(self, top + i));
                let across = p.flat.distance_squared(c.flat) < q.flat.distance_squared(b.flat);
                let quad = if across { [[*p, b, c], [*p, c, *q]] } else { [[*p, b, *q], [b, c, *q]] };
                vec![[a, *p, *q], quad[0], quad[1]]
            }
            _ => return,
        };
        self.touched.extend(self.topology.triangles[triangle]);
        let source = self.change.triangles[triangle];
        for (i, part) in parts.into_iter().enumerate() {
            let (slots, drawn) = (part.map(|p| p.slot), part.map(|p| p.vertex));
            let rest = glam::Mat2::from_cols(part[1].flat - part[0].flat, part[2].flat - part[0].flat);
            if i == 0 {
                self.topology.triangles[triangle] = slots;
                self.topology.triangle_vertices[triangle] = drawn;
                self.topology.triangle_rest[triangle] = rest;
                self.halves[triangle] = NONE;
                if has_backs {
                    self.topology.triangle_backs[triangle] = part.map(|p| p.back);
                }
                if let Some(square) = self.topology.squares.get_mut(triangle) {
                    *square = NO_SQUARE;
                }
            } else {
                if has_backs {
                    self.topology.triangle_backs.push(part.map(|p| p.back));
                }
                self.topology.triangles.push(slots);
                self.topology.triangle_vertices.push(drawn);
                self.topology.triangle_rest.push(rest);
                self.halves.push(NONE);
                if !self.topology.squares.is_empty() {
                    self.topology.squares.push(NO_SQUARE);
                }
                self.change.triangles.push(source);
            }
        }
    }

    /// The vertex between two others, the same for all triangles that have these two.
    fn vertex_between(
        &mut self,
        [a, b]: [u32; 2],
        t: f32,
        particle: u32,
        vertices: &mut HashMap<[u32; 2], u32>,
    ) -> u32 {
        let (low, high, along) = if a < b { (a, b, t) } else { (b, a, 1.0 - t) };
        if let Some(vertex) = vertices.get(&[low, high]) {
            return *vertex;
        }
        let vertex = self.bear_vertex([low, high], along, particle);
        vertices.insert([low, high], vertex);
        vertex
    }

    /// The triangles around a particle, in ascending order.
    pub fn fan(&mut self, slot: u32) -> Vec<u32> {
        if self.start.is_empty() {
            self.find_fans();
        }
        if let Some(fan) = self.fans.get(&slot) {
            return fan.clone();
        }
        let at = slot as usize;
        let range = if at + 1 < self.start.len() { self.start[at] as usize..self.start[at + 1] as usize } else { 0..0 };
        self.list[range].iter().copied().filter(|triangle| !self.is_removed(*triangle)).collect()
    }

    fn find_fans(&mut self) {
        let slots = self.topology.slots();
        self.start = vec![0; slots + 1];
        for slot in self.topology.triangles.iter().flatten() {
            self.start[*slot as usize + 1] += 1;
        }
        for slot in 0..slots {
            self.start[slot + 1] += self.start[slot];
        }
        let mut next = self.start.clone();
        self.list = vec![0; 3 * self.topology.triangles.len()];
        for (triangle, slots) in self.topology.triangles.iter().enumerate() {
            for slot in slots {
                let at = &mut next[*slot as usize];
                self.list[*at as usize] = triangle as u32;
                *at += 1;
            }
        }
    }

    fn is_removed(&self, triangle: u32) -> bool {
        self.removed.get(triangle as usize).copied().unwrap_or(false)
    }

    /// Takes triangles out.
    pub fn remove(&mut self, triangles: &[u32]) {
        self.removed.resize(self.topology.triangles.len(), false);
        let mut around = Vec::new();
        for triangle in triangles {
            let Some(removed) = self.removed.get_mut(*triangle as usize) else { continue };
            *removed = true;
            around.extend(self.topology.triangles[*triangle as usize]);
        }
        around.sort_unstable();
        around.dedup();
        for slot in &around {
            let left = self.fan(*slot).into_iter().filter(|triangle| !self.is_removed(*triangle)).collect();
            self.fans.insert(*slot, left);
        }
        self.touched.extend(&around);
        around.retain(|slot| !self.is_joint(*slot));
        self.part_all(around, |_, _, _| false);
    }

    /// Whether fans met at `slot` from the beginning.
    fn is_joint(&self, slot: u32) -> bool {
        self.topology.joints.binary_search(&slot).is_ok()
    }

    /// Parts the fan of each of `slots` where `between` says that two of its triangles that share an edge part, and then
    /// wherever fans do not hang together any more.
    pub fn part_all(&mut self, mut slots: Vec<u32>, between: impl Fn(&Topology, u32, u32) -> bool) {
        slots.sort_unstable();
        slots.dedup();
        // Which triangles part is asked of the edges as they are now: parting one end must not hide it from the other.
        let groups: Vec<Vec<Vec<u32>>> = slots.iter().map(|slot| self.groups(*slot, &between)).collect();
        let mut waiting = Vec::new();
        for (slot, groups) in slots.into_iter().zip(groups) {
            if let Ok(at) = self.topology.joints.binary_search(&slot) {
                self.topology.joints.remove(at);
            }
            self.part(slot, groups, &mut waiting);
        }
        // What is left in one piece by them may have come apart around its neighbours, each of which was named many times.
        waiting.sort_unstable();
        waiting.dedup();
        while let Some(slot) = waiting.pop() {
            if self.is_joint(slot) {
                continue;
            }
            let groups = self.groups(slot, &|_: &Topology, _, _| false);
            self.part(slot, groups, &mut waiting);
        }
    }

    /// The triangles around `slot`, those that hang together by edges each a group; the group of the first triangle first.
    fn groups(&mut self, slot: u32, between: &impl Fn(&Topology, u32, u32) -> bool) -> Vec<Vec<u32>> {
        let fan = self.fan(slot);
        let mut group: Vec<usize> = (0..fan.len()).collect();
        for i in 0..fan.len() {
            for k in i + 1..fan.len() {
                if self.share_edge_at(fan[i], fan[k], slot) && !between(self.topology, fan[i], fan[k]) {
                    let (from, to) = (group[i].max(group[k]), group[i].min(group[k]));
                    group.iter_mut().filter(|group| **group == from).for_each(|group| *group = to);
                }
            }
        }
        let mut names: Vec<usize> = group.clone();
        names.sort_unstable();
        names.dedup();
        names.iter().map(|name| (0..fan.len()).filter(|i| group[*i] == *name).map(|i| fan[i]).collect()).collect()
    }

    /// Whether two triangles around `slot` share an edge that ends there.
    fn share_edge_at(&self, a: u32, b: u32, slot: u32) -> bool {
        let (a, b) = (self.topology.triangles[a as usize], self.topology.triangles[b as usize]);
        a.iter().any(|corner| *corner != slot && b.contains(corner))
    }

    /// Gives every group of triangles but the first a copy of the particle.
    fn part(&mut self, slot: u32, groups: Vec<Vec<u32>>, waiting: &mut Vec<u32>) {
        if groups.len() < 2 {
            return;
        }
        for triangle in groups.iter().flatten() {
            waiting.extend(self.topology.triangles[*triangle as usize].iter().filter(|corner| **corner != slot));
        }
        let mut groups = groups.into_iter();
        let kept = groups.next().unwrap_or_default();
        for group in groups {
            // A neighbour's fan is the same triangles still, though one of their corners has another name.
            let copy = self.bear([slot; 2], 0.0);
            let mut drawn: Vec<[u32; 2]> = Vec::new();
            for triangle in &group {
                let triangle = *triangle as usize;
                let at = hinge::corner(self.topology.triangles[triangle], slot);
                self.topology.triangles[triangle][at] = copy;
                let vertex = self.topology.triangle_vertices[triangle][at];
                self.topology.triangle_vertices[triangle][at] = self.copy_of(vertex, copy, &mut drawn);
                if let Some(back) = self.topology.triangle_backs.get(triangle).map(|back| back[at]) {
                    self.topology.triangle_backs[triangle][at] = self.copy_of(back, copy, &mut drawn);
                }
            }
            self.fans.insert(copy, group);
        }
        self.fans.insert(slot, kept);
    }

    /// The copy of a vertex that follows `particle`, one for all triangles; `drawn` are those there are.
    fn copy_of(&mut self, vertex: u32, particle: u32, drawn: &mut Vec<[u32; 2]>) -> u32 {
        if let Some([_, new]) = drawn.iter().find(|[old, _]| *old == vertex) {
            return *new;
        }
        let new = self.bear_vertex([vertex; 2], 0.0, particle);
        drawn.push([vertex, new]);
        new
    }

    /// Brings everything that follows from the triangles up to date, and tells what changed; `None` if nothing did.
    pub fn finish(mut self) -> Option<Change> {
        if self.touched.is_empty() {
            if let Some(weave) = &mut self.topology.weave {
                weave.halves = self.halves;
            }
            return None;
        }
        let topology = self.topology;
        topology.quads = None;
        if !self.removed.is_empty() {
            self.removed.resize(topology.triangles.len(), false);
            renew::take_out(topology, &self.removed);
            renew::retain(&mut self.halves, &self.removed);
            renew::retain(&mut self.change.triangles, &self.removed);
        }
        let slots = topology.slots();
        topology.weave = topology
            .grid
            .map(|grid| Box::new(Weave::new(&grid, &topology.triangles, std::mem::take(&mut self.halves))));
        renew::areas(topology, self.touched, &mut self.change);
        renew::edges(topology, &self.change.touched);
        self.change.slots = slots;
        Some(self.change)
    }
}

/// A corner of a part of a triangle.
#[derive(Clone, Copy)]
struct Point {
    slot: u32,
    vertex: u32,
    /// Of the back, if it has vertices of its own.
    back: u32,
    /// In the triangle's weft and warp coordinates, m.
    flat: Vec2,
}
