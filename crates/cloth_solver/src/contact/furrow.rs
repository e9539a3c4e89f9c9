//! Particles in the furrows of a triangle mesh: what is pushed off one side goes into the other.

use glam::Vec3;

use super::near::Part;
use super::patch::Patch;
use super::respond::Answer;
use super::shape::TriangleMesh;

/// Sides that a particle is pushed off after the first, at most: two of a furrow and three of a hollow, and what is uneven between.
const MOST_SIDES: u32 = 8;

/// What a particle may lack of the distance kept, as a part of it.
const NEAR_ENOUGH: f32 = 1e-2;

/// A push along what is left of a normal, once the sides that a particle lies on are taken from it, is no longer than that many times
/// what it makes good: beyond it, sides are as good as parallel, and there is no room between them.
const MOST_STEEP: f32 = 10.0;

/// Pushes particles that touch off those other sides of the mesh that they are too near to. They go along the sides that they were
/// pushed off before, so that the result is on all of them at once.
pub(super) fn settle(patch: &mut Patch, part: &Part, mesh: &TriangleMesh, answer: &Answer) {
    for number in 0..part.slots.len() {
        let near = part.triangles_near(number);
        if patch.touched[number] && patch.inverse_mass[number] > 0.0 && near.len() > 1 {
            settle_one(patch, number, answer, |p| mesh.among(p, near, part.bound));
        }
    }
}

fn settle_one(patch: &mut Patch, number: usize, answer: &Answer, nearest: impl Fn(Vec3) -> (f32, Vec3)) {
    let margin = answer.margin;
    // Of what was inside from the start a part may be left there.
    let start = nearest(patch.before.get(number)).0;
    let left_inside = if start < 0.0 { (margin - start - answer.way_out).max(0.0) } else { 0.0 };
    let (mut sides, mut count) = ([Vec3::ZERO; 2], 0);
    for _ in 0..MOST_SIDES {
        let now = patch.now.get(number);
        let (distance, normal) = nearest(now);
        let depth = margin - distance - left_inside;
        if depth <= NEAR_ENOUGH * margin {
            return;
        }
        let mut free = sides[..count].iter().fold(normal, |free, side| free - *side * free.dot(*side));
        if free.length() * MOST_STEEP < 1.0 {
            (free, count) = (normal, 0);
        }
        let along = free.normalize();
        let slip = patch.slip.get(number);
        let approach = (-slip.dot(normal)).max(0.0);
        let sliding = slip - normal * slip.dot(normal);
        let stopped = (answer.friction * approach / sliding.length().max(f32::MIN_POSITIVE)).min(1.0);
        let shift = along * (depth / along.dot(normal)) - sliding * (stopped * answer.part);
        let change = normal * approach - sliding * stopped;
        for (of, by) in
            [(&mut patch.now, shift), (&mut patch.shift, shift), (&mut patch.way, change), (&mut patch.slip, change)]
        {
            of.set(number, of.get(number) + by);
        }
        patch.deepest = patch.deepest.max(depth);
        if count < sides.len() {
            sides[count] = along;
            count += 1;
        }
    }
}
