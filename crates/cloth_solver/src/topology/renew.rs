//! Brings what follows from triangles up to date once some are others than before: areas, edges, hinges. What is not near those
//! stays as it is.

use super::hinge::{self, Side};
use super::{Change, Topology};

/// Drops those entries that are `removed`.
pub(super) fn retain<T>(all: &mut Vec<T>, removed: &[bool]) {
    let mut removed = removed.iter();
    all.retain(|_| !removed.next().copied().unwrap_or(false));
}

/// Takes out triangles, and numbers those of the hinges anew. A hinge of what is gone must not be left by [`edges`].
pub(super) fn take_out(topology: &mut Topology, removed: &[bool]) {
    retain(&mut topology.triangles, removed);
    retain(&mut topology.triangle_vertices, removed);
    retain(&mut topology.triangle_rest, removed);
    retain(&mut topology.triangle_backs, removed);
    if !topology.squares.is_empty() {
        retain(&mut topology.squares, removed);
    }
    let mut left = 0;
    let number: Vec<u32> = (removed.iter())
        .map(|removed| {
            left += u32::from(!removed);
            left - u32::from(!removed)
        })
        .collect();
    topology.hinge_triangles.as_flattened_mut().iter_mut().for_each(|triangle| *triangle = number[*triangle as usize]);
}

/// Sums up anew the areas of the particles that were touched, and notes those that are gone.
pub(super) fn areas(topology: &mut Topology, mut touched: Vec<u32>, change: &mut Change) {
    touched.sort_unstable();
    touched.dedup();
    let mut is_touched = vec![false; topology.slots()];
    let mut was_there = Vec::with_capacity(touched.len());
    for slot in &touched {
        is_touched[*slot as usize] = true;
        was_there.push(topology.area[*slot as usize] > 0.0);
        topology.area[*slot as usize] = 0.0;
    }
    for triangle in 0..topology.triangles.len() {
        let corners = topology.triangles[triangle];
        if corners.iter().any(|slot| is_touched[*slot as usize]) {
            for (slot, area) in corners.into_iter().zip(topology.corner_areas(triangle as u32)) {
                if is_touched[slot as usize] {
                    topology.area[slot as usize] += area;
                }
            }
        }
    }
    change.gone.extend(
        (touched.into_iter().zip(was_there))
            .filter(|(slot, was_there)| *was_there && topology.area[*slot as usize] <= 0.0)
            .map(|(slot, _)| slot),
    );
    change.touched = is_touched;
}

/// Finds anew the edges and hinges of all triangles around the particles that are touched.
pub(super) fn edges(topology: &mut Topology, is_touched: &[bool]) {
    let triangles = &topology.triangles;
    let mut near = is_touched.to_vec();
    for corners in triangles.iter().filter(|corners| corners.iter().any(|slot| is_touched[*slot as usize])) {
        corners.iter().for_each(|slot| near[*slot as usize] = true);
    }
    let is_near = |slots: &[u32]| slots.iter().filter(|slot| near[**slot as usize]).count() >= 2;
    let mut sides: Vec<Side> = (0..triangles.len() as u32)
        .filter(|triangle| is_near(&triangles[*triangle as usize]))
        .flat_map(|triangle| hinge::sides_of(triangle, triangles[triangle as usize]))
        .filter(|side| is_near(&side.edge))
        .collect();
    sides.sort_unstable();
    topology.edges.retain(|edge| !is_near(edge));
    topology.edges.extend(hinge::by_edge(&sides).map(|shared| shared[0].edge));
    let gone: Vec<bool> = topology.hinges.iter().map(|[a, b, ..]| is_near(&[*a, *b])).collect();
    retain(&mut topology.hinges, &gone);
    retain(&mut topology.hinge_triangles, &gone);
    retain(&mut topology.hinge_rest, &gone);
    let (rest, is_flat) = (&topology.rest, topology.grid.is_some());
    for (hinge, sharing) in hinge::hinges(triangles, rest, &sides) {
        let [a, b, c, d] = hinge.map(|slot| rest[slot as usize]);
        topology.hinges.push(hinge);
        topology.hinge_triangles.push(sharing);
        topology.hinge_rest.push(if is_flat { 0.0 } else { hinge::hinge_angle(a, b, c, d) });
    }
}
