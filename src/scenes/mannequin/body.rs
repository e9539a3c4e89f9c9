//! What is seen of a mannequin: pieces turned of wood, and balls between them.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use cloth_scene::{Body, FigurePart};

/// Faces of a piece around and along it.
const FACES: (u32, u32) = (36, 28);
/// Length of wood that shows its texture once, m.
const GRAIN: f32 = 0.45;

/// A piece of a body.
pub struct Piece {
    /// The part that it moves with.
    pub part: FigurePart,
    /// Its surface.
    pub mesh: Mesh,
    /// Its place as seen from the part.
    pub place: Transform,
    /// Whether it is a ball of a joint.
    pub is_joint: bool,
}

/// A piece of wood as it comes off a lathe, along y.
#[derive(Clone, Copy, Debug)]
struct Turned {
    /// Heights of its upper and lower end, m.
    ends: (f32, f32),
    /// Half-axis along x at the upper end, in the middle and at the lower end, m; between them it changes smoothly.
    radii: [f32; 3],
    /// Half-axis along z in parts of that along x.
    depth: f32,
    /// How blunt the ends are: 2 makes an egg, more a rounded cylinder.
    blunt: f32,
}

impl Turned {
    /// A ball.
    fn ball(radius: f32) -> Self {
        Self { ends: (radius, -radius), radii: [radius; 3], depth: 1.0, blunt: 2.0 }
    }

    /// A limb that hangs from a joint.
    fn limb(ends: (f32, f32), radii: [f32; 3]) -> Self {
        Self { ends, radii, depth: 1.0, blunt: 5.0 }
    }

    /// A place on its surface, so far along and around it, 0..=1 each.
    fn at(&self, along: f32, around: f32) -> Vec3 {
        // Close together at the ends, where it is round.
        let part = 0.5 - 0.5 * (PI * along).cos();
        let [top, middle, bottom] = self.radii;
        let wide = 2.0 * (part - 0.5) * (part - 1.0) * top - 4.0 * part * (part - 1.0) * middle
            + 2.0 * part * (part - 0.5) * bottom;
        let radius = wide * (1.0 - (2.0 * part - 1.0).abs().powf(self.blunt)).max(0.0).sqrt();
        let (sine, cosine) = (TAU * around).sin_cos();
        Vec3::new(radius * sine, self.ends.0 + part * (self.ends.1 - self.ends.0), radius * self.depth * cosine)
    }

    fn mesh(&self, scale: f32) -> Mesh {
        let (columns, rows) = FACES;
        let (mut positions, mut normals, mut uvs, mut indices) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (row, column) in (0..=rows).flat_map(|row| (0..=columns).map(move |column| (row, column))) {
            let (along, around) = (row as f32 / rows as f32, column as f32 / columns as f32);
            let near = 1e-3;
            let down = self.at((along + near).min(1.0), around) - self.at((along - near).max(0.0), around);
            let right = self.at(along, around + near) - self.at(along, around - near);
            let pole = if row == 0 { Vec3::Y } else { Vec3::NEG_Y };
            let normal = if row == 0 || row == rows { pole } else { down.cross(right).normalize_or(pole) };
            let place = scale * self.at(along, around);
            positions.push(place);
            normals.push(normal);
            uvs.push(Vec2::new(around, place.y / GRAIN));
            if row < rows && column < columns {
                let a = row * (columns + 1) + column;
                let [b, c, d] = [a + 1, a + columns + 1, a + columns + 2];
                indices.extend([a, c, b, b, c, d]);
            }
        }
        Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
            .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
            .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
            .with_inserted_indices(Indices::U32(indices))
    }
}

/// All pieces of a body.
pub fn pieces(body: &Body) -> Vec<Piece> {
    use FigurePart::*;
    let turned = |ends, radii, depth, blunt| Turned { ends, radii, depth, blunt };
    let still = Transform::IDENTITY;
    let at = |x: f32, y: f32, z: f32| Transform::from_xyz(x, y, z);
    let mut all = vec![
        (Pelvis, turned((0.078, -0.10), [0.110, 0.147, 0.10], 0.72, 3.0), still, false),
        (Chest, Turned { depth: 0.9, ..Turned::ball(0.088) }, still, true),
        (Chest, turned((0.41, 0.05), [0.116, 0.145, 0.106], 0.62, 3.0), still, false),
        (Head, Turned::ball(0.042), at(0.0, 0.005, 0.0), true),
        (Head, Turned::limb((0.09, 0.0), [0.036, 0.033, 0.036]), still, false),
        (Head, turned((0.295, 0.055), [0.070, 0.076, 0.052], 1.09, 2.0), at(0.0, 0.0, -0.006), false),
    ];
    let sides = [
        (-1.0, [LeftUpperArm, LeftForearm, LeftHand, LeftThigh, LeftShank, LeftFoot]),
        (1.0, [RightUpperArm, RightForearm, RightHand, RightThigh, RightShank, RightFoot]),
    ];
    for (side, [upper_arm, forearm, hand, thigh, shank, foot]) in sides {
        let lying = at(0.0, -0.042, 0.0) * Transform::from_rotation(Quat::from_rotation_x(FRAC_PI_2));
        all.extend([
            (Chest, Turned::ball(0.054), at(side * 0.18, 0.36, 0.0), true),
            (upper_arm, Turned::limb((-0.032, -0.268), [0.044, 0.041, 0.033]), still, false),
            (forearm, Turned::ball(0.036), still, true),
            (forearm, Turned::limb((-0.022, -0.236), [0.036, 0.034, 0.024]), still, false),
            (hand, Turned::ball(0.025), still, true),
            (hand, turned((-0.016, -0.160), [0.013, 0.018, 0.010], 1.8, 3.0), still, false),
            (Pelvis, Turned::ball(0.066), at(side * 0.088, 0.0, 0.0), true),
            (thigh, Turned::limb((-0.040, -0.402), [0.068, 0.064, 0.048]), still, false),
            (shank, Turned::ball(0.048), still, true),
            (shank, Turned::limb((-0.032, -0.396), [0.047, 0.047, 0.032]), still, false),
            (foot, Turned::ball(0.035), still, true),
            (foot, turned((0.062, -0.185), [0.030, 0.041, 0.034], 0.78, 3.0), lying, false),
        ]);
    }
    let piece = |(part, turned, place, is_joint): (FigurePart, Turned, Transform, bool)| Piece {
        part,
        mesh: turned.mesh(body.scale),
        place: Transform { translation: body.scale * place.translation, ..place },
        is_joint,
    };
    all.into_iter().map(piece).collect()
}

#[cfg(test)]
mod tests {
    use bevy::mesh::VertexAttributeValues;
    use cloth_scene::SceneShape;

    use super::*;

    /// How far a point is outside a solid, m.
    fn outside(shape: &SceneShape, at: Vec3) -> f32 {
        match *shape {
            SceneShape::Capsule { radius, length } => {
                (at - Vec3::Y * at.y.clamp(-length / 2.0, length / 2.0)).length() - radius
            }
            _ => f32::INFINITY,
        }
    }

    #[test]
    fn what_is_seen_of_a_body_lies_within_what_cloth_cannot_enter() {
        let body = Body::new(1.75);
        let solids = body.solids();
        for Piece { part, mesh, place, .. } in pieces(&body) {
            // Toes and fingertips are where no cloth is.
            if matches!(
                part,
                FigurePart::LeftFoot | FigurePart::RightFoot | FigurePart::LeftHand | FigurePart::RightHand
            ) {
                continue;
            }
            let Some(VertexAttributeValues::Float32x3(positions)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION) else {
                panic!("no positions")
            };
            for at in positions.iter().map(|at| place.transform_point(Vec3::from_array(*at))) {
                // The balls of hips are within the thighs, too.
                let of = solids.iter().filter(|(of, ..)| *of == part);
                let least = of.map(|(_, shape, pose)| outside(shape, pose.inverse_point(at))).fold(f32::MAX, f32::min);
                assert!(least < 1e-3, "{part:?}: {at} is {least} m outside");
            }
        }
    }

    #[test]
    fn a_turned_piece_is_closed_and_faces_outward() {
        let mesh = Turned::limb((0.0, -0.4), [0.07, 0.06, 0.05]).mesh(1.0);
        let Some(VertexAttributeValues::Float32x3(positions)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION) else {
            panic!("no positions")
        };
        let Some(Indices::U32(indices)) = mesh.indices() else { panic!("no indices") };
        let at = |index: u32| Vec3::from_array(positions[index as usize]);
        let volume: f32 =
            indices.chunks_exact(3).map(|corners| at(corners[0]).dot(at(corners[1]).cross(at(corners[2]))) / 6.0).sum();
        assert!((0.003..0.005).contains(&volume), "{volume} m³");
    }
}
