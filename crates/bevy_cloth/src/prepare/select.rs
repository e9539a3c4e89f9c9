//! From authored [`Pins`] to the particles they choose.

use bevy::prelude::*;
use cloth_solver::{ClothError, Topology};

use super::source::{Skin, bounds};
use crate::pins::PinSelect;

/// How far below its highest particle the top edge of a cloth made from a mesh reaches, as a part of its height.
const TOP_EDGE: f32 = 0.01;

/// The particles that `select` chooses, in ascending order of no particular meaning, each once.
pub(crate) fn select(select: &PinSelect, topology: &Topology, skin: &Skin) -> Result<Vec<u32>, ClothError> {
    let rest = |slot: &u32| topology.rest[*slot as usize];
    let mut chosen = match select {
        PinSelect::Rods(count) => rods(&top_edge(topology), topology, *count),
        PinSelect::Top => top_edge(topology),
        PinSelect::Corners => rods(&top_edge(topology), topology, 2),
        PinSelect::Vertices(vertices) => {
            vertices.iter().map(|vertex| particle_of(*vertex, topology)).collect::<Result<_, _>>()?
        }
        PinSelect::Region { min, max } => {
            check_bounds("PinSelect::Region.min", *min)?;
            check_bounds("PinSelect::Region.max", *max)?;
            let inside = |slot: &u32| rest(slot).cmpge(*min).all() && rest(slot).cmple(*max).all();
            topology.particles().filter(inside).collect()
        }
        PinSelect::VertexColor { threshold } => {
            ClothError::check("PinSelect::VertexColor.threshold", *threshold, 0.0..=1.0, "0..=1")?;
            if skin.colors.len() < topology.vertex_particle.len() {
                let allowed = "a threshold on a mesh that has `Mesh::ATTRIBUTE_COLOR`";
                return Err(ClothError::OutOfRange { field: "PinSelect::VertexColor", value: *threshold, allowed });
            }
            let vertices = topology.vertex_particle.iter().zip(&skin.colors);
            let painted = vertices.filter(|(_, color)| color[0] >= *threshold).map(|(slot, _)| *slot);
            painted.filter(|slot| topology.is_particle(*slot)).collect()
        }
    };
    chosen.sort_unstable();
    chosen.dedup();
    Ok(chosen)
}

/// How free each slot is by what is painted on the mesh, 0..=1; of several vertices of a particle the least free counts.
pub(crate) fn freedom(topology: &Topology, skin: &Skin) -> Result<Vec<f32>, ClothError> {
    let mut free = vec![1.0_f32; topology.slots()];
    let vertices = topology.vertex_particle.iter().map(|slot| *slot as usize);
    if skin.freedom.is_empty() {
        vertices.zip(&skin.colors).for_each(|(slot, color)| free[slot] = free[slot].min(color[0].clamp(0.0, 1.0)));
        return Ok(free);
    }
    for (slot, painted) in vertices.zip(&skin.freedom) {
        ClothError::check("ATTRIBUTE_FREEDOM", *painted, 0.0..=1.0, "0..=1")?;
        free[slot] = free[slot].min(*painted);
    }
    Ok(free)
}

/// The particle of a vertex that a pin names.
fn particle_of(vertex: u32, topology: &Topology) -> Result<u32, ClothError> {
    let field = "PinSelect::Vertices";
    let vertices = &topology.vertex_particle;
    match vertices.get(vertex as usize) {
        Some(slot) if topology.is_particle(*slot) => Ok(*slot),
        Some(_) => Err(ClothError::LoneVertex { field, vertex }),
        None => Err(ClothError::NoSuchParticle { field, particle: vertex, particles: vertices.len() }),
    }
}

fn check_bounds(field: &'static str, corner: Vec3) -> Result<(), ClothError> {
    let worst = corner.to_array().into_iter().find(|x| x.is_nan());
    worst.map_or(Ok(()), |value| Err(ClothError::OutOfRange { field, value, allowed: "any number of metres" }))
}

fn top_edge(topology: &Topology) -> Vec<u32> {
    if let Some(grid) = &topology.grid {
        // The first row, unless a mesh lies with another side up.
        let row = |row: u32| (0..grid.columns).map(|column| grid.slot(row, column)).collect::<Vec<_>>();
        let column = |column: u32| (0..grid.rows).map(|row| grid.slot(row, column)).collect::<Vec<_>>();
        let sides = [row(0), row(grid.rows - 1), column(0), column(grid.columns - 1)];
        let height =
            |side: &[u32]| side.iter().map(|slot| topology.rest[*slot as usize].y).fold(f32::INFINITY, f32::min);
        let higher = |best: Vec<u32>, side: Vec<u32>| if height(&side) > height(&best) { side } else { best };
        return sides.into_iter().reduce(higher).unwrap_or_default();
    }
    let (min, max) = bounds(topology);
    let lowest = max.y - TOP_EDGE * (max.y - min.y);
    topology.particles().filter(|slot| topology.rest[*slot as usize].y >= lowest).collect()
}

/// The particles of `edge` nearest to `count` points spread evenly over its width, both ends included.
fn rods(edge: &[u32], topology: &Topology, count: u32) -> Vec<u32> {
    let x = |slot: &u32| topology.rest[*slot as usize].x;
    let left = edge.iter().map(x).fold(f32::INFINITY, f32::min);
    let right = edge.iter().map(x).fold(f32::NEG_INFINITY, f32::max);
    // More rods than particles hold each particle once, and no more need be looked for.
    let count = count.min(edge.len() as u32);
    (0..count)
        .filter_map(|rod| {
            let part = if count == 1 { 0.5 } else { rod as f32 / (count - 1) as f32 };
            let place = left + (right - left) * part;
            edge.iter().min_by(|a, b| (x(a) - place).abs().total_cmp(&(x(b) - place).abs())).copied()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_solver::topology::Resolution;

    fn strip(columns: u32) -> Topology {
        let cells = Resolution::Cells(UVec2::new(columns - 1, 2));
        Topology::rectangle(Vec2::new(2.0, 1.0), cells).unwrap_or_default()
    }

    fn columns(topology: &Topology, rods: u32) -> Vec<u32> {
        select(&PinSelect::Rods(rods), topology, &Skin::default()).unwrap_or_default()
    }

    #[test]
    fn rods_hold_both_ends_and_lie_evenly_between() {
        assert_eq!(columns(&strip(9), 5), [0, 2, 4, 6, 8]);
        assert_eq!(columns(&strip(9), 2), [0, 8]);
    }

    #[test]
    fn one_rod_holds_the_middle_and_none_holds_nothing() {
        assert_eq!(columns(&strip(9), 1), [4]);
        assert!(columns(&strip(9), 0).is_empty());
    }

    #[test]
    fn more_rods_than_particles_hold_every_particle_once() {
        assert_eq!(columns(&strip(5), 4_000_000_000), [0, 1, 2, 3, 4]);
    }

    #[test]
    fn a_vertex_that_does_not_exist_is_named() {
        let refused = select(&PinSelect::Vertices(vec![0, 99]), &strip(5), &Skin::default());
        let particles = 15;
        assert_eq!(refused, Err(ClothError::NoSuchParticle { field: "PinSelect::Vertices", particle: 99, particles }));
    }
}
