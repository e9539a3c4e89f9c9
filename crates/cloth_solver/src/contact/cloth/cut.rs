//! The sides of a fresh cut or tear: a blade has a width.
//!
//! What was parted stands at one place, where nothing says on which side of the other it is. Each side is drawn into its own cloth, along
//! its surface: so it stays on the side on which it hangs together, and passes through nothing on the way.

use glam::Vec3;

use crate::topology::Change;
use crate::{Particles, Topology};

/// How far each side is drawn back, in parts of the distance kept, and at most in parts of what it is drawn towards.
const WIDTH: f32 = 0.05;

/// Draws apart the sides of what `change` has parted, which keep `distance` m.
pub(super) fn draw_apart(now: &Topology, change: &Change, particles: &mut Particles, distance: f32) {
    let mut is_side = vec![false; now.slots()];
    for born in change.born.iter().filter(|born| born.parents[0] == born.parents[1]) {
        is_side[born.slot as usize] = true;
        is_side[born.parents[0] as usize] = true;
    }
    // From each particle to the middle of its triangles, weighed by their area.
    let mut inward = vec![(0.0_f32, Vec3::ZERO); now.slots()];
    for corners in &now.triangles {
        if !corners.iter().any(|slot| is_side[*slot as usize]) {
            continue;
        }
        let [a, b, c] = corners.map(|slot| particles.position.get(slot as usize));
        let (area, middle) = ((b - a).cross(c - a).length(), (a + b + c) / 3.0);
        for (slot, x) in corners.iter().zip([a, b, c]).filter(|(slot, _)| is_side[**slot as usize]) {
            let (sum, way) = &mut inward[*slot as usize];
            (*sum, *way) = (*sum + area, *way + (middle - x) * area);
        }
    }
    for (slot, (area, way)) in inward.into_iter().enumerate() {
        if area <= 0.0 || particles.inverse_mass[slot] <= 0.0 {
            continue;
        }
        let way = way / area;
        let shift = way.clamp_length_max(WIDTH * way.length().min(distance));
        for all in [&mut particles.position, &mut particles.previous] {
            all.set(slot, all.get(slot) + shift);
        }
    }
}
