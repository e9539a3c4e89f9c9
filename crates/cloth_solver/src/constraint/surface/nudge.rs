//! What frees cloth that was crushed within its own plane.
//!
//! No force acts across a sheet that lies in a plane to the last bit. Crushed there, it cannot buckle: its cells turn over,
//! jam, and shake for ever with the energy of threads that cannot get out of each other's way. No real sheet is that flat,
//! so a crushed one is pushed off its plane by next to nothing, the custom of buckling analysis (Koiter 1945), and the
//! instability does the rest. A flat sheet that is not crushed stays flat; one that is not flat is left alone to the bit.

use crate::constraint::surface::grid::GridConstraints;
use crate::{Particles, Soa3};

/// Length over rest length of the mean weft or warp edge of a cell below which it counts as crushed: far less than hanging
/// or a picture frame leaves of it.
const CRUSHED: f32 = 0.7;

/// Largest push on a particle across the plane in a tick, m/s: far below what can be seen.
const NUDGE: f32 = 1e-6;

/// Pushes every free particle of a flat and crushed rectangle across its plane, no two neighbours alike.
pub(in crate::constraint) fn nudge(grid: &GridConstraints, particles: &mut Particles) {
    let Particles { position, velocity, inverse_mass, .. } = particles;
    let axes = [(&position.x, &mut velocity.x), (&position.y, &mut velocity.y), (&position.z, &mut velocity.z)];
    // The first particle off the plane of the first ends the search.
    let across = axes.into_iter().find(|(along, _)| grid.is_level(along));
    let Some((_, velocity)) = across.filter(|_| is_crushed(grid, position)) else { return };
    for (slot, velocity) in velocity.iter_mut().enumerate().filter(|(slot, _)| inverse_mass[*slot] > 0.0) {
        // Knuth's multiplicative hash.
        let hash = (slot as u32).wrapping_mul(0x9E37_79B9).cast_signed();
        *velocity += NUDGE * (hash as f32 / 2_147_483_648.0);
    }
}

/// Whether a cell that lies where it was made is crushed.
fn is_crushed(constraints: &GridConstraints, position: &Soa3) -> bool {
    let grid = constraints.grid;
    let limit = grid.spacing * grid.spacing * (4.0 * CRUSHED * CRUSHED);
    let (stride, across) = (grid.stride as usize, grid.columns as usize - 1);
    let mut found = false;
    for row in 0..grid.rows as usize - 1 {
        let at = row * stride;
        let above = [&position.x, &position.y, &position.z].map(|axis| &axis[at..=at + across]);
        let below = [&position.x, &position.y, &position.z].map(|axis| &axis[at + stride..=at + stride + across]);
        let whole = &constraints.cell_mask()[at..at + across];
        // Without an early end, which could not become vector code.
        for k in 0..across {
            let (mut weft, mut warp) = (0.0, 0.0);
            for axis in 0..3 {
                let (e, f) = (below[axis][k + 1] - above[axis][k], above[axis][k + 1] - below[axis][k]);
                weft += (e + f) * (e + f);
                warp += (e - f) * (e - f);
            }
            found |= whole[k] > 0.0 && (weft < limit.x || warp < limit.y);
        }
    }
    found
}
