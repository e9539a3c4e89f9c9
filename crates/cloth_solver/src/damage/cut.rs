//! Cutting: a blade is swept from one ray to another, and what it passes is divided along a straight line.
//!
//! Triangles are divided where the blade meets their edges, but for crossings so near to a particle that the line is led
//! through it. Then every particle on the line is parted into what lies on either side.

use std::sync::Arc;

use glam::Vec3;

use super::line::{Line, Seen, pierces};
use crate::topology::{Change, Crossing, Surgery};
use crate::{Soa3, Topology};

/// What a pointer's ray sweeps over on its way from one place to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blade {
    /// Near and far end of the first ray, cloth frame, m.
    pub from: [Vec3; 2],
    /// Near and far end of the last ray, cloth frame, m.
    pub to: [Vec3; 2],
}

/// What a cut did.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// To particles and triangles.
    pub change: Change,
    /// How many edges long the line is.
    pub edges: usize,
    /// A particle in the middle of the line.
    pub at: u32,
}

/// Cuts `topology`, whose particles stand at `position`, with `blade`.
///
/// Nothing changes where nothing is crossed: the same blade again does nothing. `None` if it crossed nothing.
pub fn cut(topology: &mut Arc<Topology>, position: &Soa3, blade: &Blade) -> Option<Cut> {
    Stroke::new(blade.from, position).sweep(topology, position, blade.to)
}

/// A stroke of many blades, each from where the one before left off, through a cloth that moves meanwhile: the line is
/// without a gap, however cloth and rays move.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub struct Stroke {
    /// The last ray: near and far end, cloth frame, m.
    ray: [Vec3; 2],
    /// Where the particles stood at that time.
    position: Soa3,
    /// The particles at which the line ends inside a triangle that the last ray pierces.
    tips: Vec<u32>,
}

impl Stroke {
    /// Begins at `ray`, near and far end (cloth frame, m), where the particles stand at `position`.
    pub fn new(ray: [Vec3; 2], position: &Soa3) -> Self {
        Self { ray, position: position.clone(), tips: Vec::new() }
    }

    /// Cuts `topology`, whose particles stand at `position` by now, from the last ray on to the ray `to`. `None` if nothing is
    /// crossed. What it cuts, the stroke itself has followed.
    pub fn sweep(&mut self, topology: &mut Arc<Topology>, position: &Soa3, to: [Vec3; 2]) -> Option<Cut> {
        let drawn = Line::new(topology, [&self.position, position], [self.ray, to]).map(|mut line| {
            line.hold(&self.tips);
            line.snap();
            (line.crossings(), line.seen, line.on)
        });
        self.ray = to;
        self.position.clone_from(position);
        let (crossings, seen, mut on) = drawn?;
        if crossings.is_empty() && !on.contains(&true) {
            self.tips.clear();
            return None;
        }
        let change = part(topology, &crossings, seen, &mut on);
        change.iter().for_each(|change| self.position.follow(change));
        // Also if nothing was parted: a line that ends at the first particle it is led through goes on from there.
        let is_on = |slot: &u32| on.get(*slot as usize).is_some_and(|on| *on);
        let place = |slot: u32| self.position.get(slot as usize);
        self.tips = (topology.triangles.iter())
            .filter(|corners| corners.iter().any(is_on) && pierces(to, corners.map(place)))
            .flat_map(|corners| corners.iter().copied().filter(is_on))
            .collect();
        let path: Vec<u32> = (0..on.len() as u32).filter(is_on).collect();
        Some(Cut { change: change?, edges: path.len().saturating_sub(1), at: path[path.len() / 2] })
    }

    /// Takes over what else was torn, cut or burnt.
    pub fn follow(&mut self, change: &Change) {
        self.position.follow(change);
    }
}

/// Divides triangles at `crossings`, which are `on` the line from then on, and parts every particle on it.
fn part(topology: &mut Arc<Topology>, crossings: &[Crossing], mut seen: Seen, on: &mut Vec<bool>) -> Option<Change> {
    let mut surgery = Surgery::new(topology);
    let born = surgery.divide(crossings);
    let slots = surgery.topology().slots();
    seen.follow(slots, crossings, &born);
    on.resize(slots, false);
    for slot in &born {
        on[*slot as usize] = true;
    }
    let between = |topology: &Topology, a: u32, b: u32| {
        let (first, second) = (topology.triangles[a as usize], topology.triangles[b as usize]);
        let is_shared = |slot: &u32| first.contains(slot) && second.contains(slot);
        first.iter().filter(|slot| is_shared(slot) && on[**slot as usize]).count() == 2
            && [first, second].into_iter().all(|corners| runs_along(corners, is_shared, &seen, on))
    };
    surgery.part_all((0..slots as u32).filter(|slot| on[*slot as usize]).collect(), between);
    surgery.finish()
}

/// Whether the line runs along the edge of a triangle that is between those corners which are shared, both of them on the
/// line: not if it is led through the third corner, too, on its way from one to the other.
fn runs_along(corners: [u32; 3], is_shared: impl Fn(&u32) -> bool, seen: &Seen, on: &[bool]) -> bool {
    let way = seen.way(corners.into_iter());
    let Some(third) = corners.into_iter().find(|slot| !is_shared(slot) && on[*slot as usize]) else { return true };
    let time = seen.when(third, way);
    let [before, after] = [f32::lt, f32::gt]
        .map(|order| corners.iter().filter(|slot| is_shared(slot)).any(|slot| order(&seen.when(*slot, way), &time)));
    !(before && after)
}
