//! Fingerprints: whether two things are the same, from 64 bits of each.

use glam::Vec3;

use crate::Topology;
use crate::contact::{Form, Shape};

/// A fingerprint in the making. The same words give the same fingerprint on every machine; one word that is another always gives
/// another one, and with several of them the chance that it is the same is about 2⁻⁶⁴. It is no protection against forgery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fingerprint(u64);

impl Default for Fingerprint {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fingerprint {
    /// Takes in one word.
    pub fn word(&mut self, word: u64) {
        // Each step is a bijection of what there was, and of the word. The odd number is 2⁶⁴ over the golden ratio.
        self.0 = (self.0.rotate_left(23) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }

    /// Takes in the bits of some numbers.
    pub fn numbers(&mut self, numbers: &[f32]) {
        numbers.iter().for_each(|number| self.word(u64::from(number.to_bits())));
    }

    /// Takes in bytes, and how many there are.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.word(bytes.len() as u64);
        let (words, rest) = bytes.as_chunks::<8>();
        words.iter().for_each(|word| self.word(u64::from_le_bytes(*word)));
        rest.iter().for_each(|byte| self.word(u64::from(*byte)));
    }

    /// All that was taken in, in 64 bits.
    pub fn finish(self) -> u64 {
        let mixed = (self.0 ^ (self.0 >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93);
        mixed ^ (mixed >> 32)
    }

    fn points(&mut self, points: &[Vec3]) {
        self.word(points.len() as u64);
        points.iter().for_each(|point| self.numbers(&point.to_array()));
    }

    fn triangles(&mut self, triangles: &[[u32; 3]]) {
        self.word(triangles.len() as u64);
        triangles.as_flattened().iter().for_each(|corner| self.word(u64::from(*corner)));
    }
}

impl Topology {
    /// A fingerprint of particles at rest and triangles.
    pub fn fingerprint(&self) -> u64 {
        let mut all = Fingerprint::default();
        all.points(&self.rest);
        all.triangles(&self.triangles);
        self.vertex_particle.iter().for_each(|particle| all.word(u64::from(*particle)));
        all.finish()
    }
}

impl Shape {
    /// A fingerprint of its form and size.
    pub fn fingerprint(&self) -> u64 {
        let mut all = Fingerprint::default();
        match self {
            Self::Sphere { radius } => all.numbers(&[1.0, *radius]),
            Self::Capsule { radius, half_length } => all.numbers(&[2.0, *radius, *half_length]),
            Self::HalfSpace => all.numbers(&[3.0]),
            Self::Convex(hull) => {
                all.numbers(&[4.0]);
                all.points(&hull.corners);
                hull.planes.iter().for_each(|(normal, offset)| all.numbers(&[normal.x, normal.y, normal.z, *offset]));
            }
            Self::Curved(curved) => match curved.form() {
                Form::Cylinder { radius, half_height } => all.numbers(&[5.0, radius, half_height]),
                Form::Cone { radius, half_height } => all.numbers(&[6.0, radius, half_height]),
                Form::Ellipsoid { half } => all.numbers(&[7.0, half.x, half.y, half.z]),
                Form::RoundedCuboid { core, radius } => all.numbers(&[8.0, core.x, core.y, core.z, radius]),
            },
            Self::Mesh(mesh) => {
                all.numbers(&[9.0, mesh.half_thickness()]);
                mesh.triangles().for_each(|corners| all.points(&corners));
            }
        }
        all.finish()
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec2, Vec2};

    use super::*;
    use crate::topology::Resolution;

    #[test]
    fn one_bit_that_is_another_gives_another_fingerprint() {
        let bytes: Vec<u8> = (0..203).map(|i| (i * 37 % 251) as u8).collect();
        let of = |bytes: &[u8]| {
            let mut all = Fingerprint::default();
            all.bytes(bytes);
            all.finish()
        };
        for bit in 0..8 * bytes.len() {
            let mut other = bytes.clone();
            other[bit / 8] ^= 1 << (bit % 8);
            assert_ne!(of(&other), of(&bytes), "bit {bit}");
        }
        assert_ne!(of(&bytes[..202]), of(&bytes));
    }

    #[test]
    fn shapes_and_topologies_have_one_fingerprint_each() {
        let shapes = [
            Shape::sphere(0.5).unwrap(),
            Shape::sphere(0.6).unwrap(),
            Shape::capsule(0.5, 1.0).unwrap(),
            Shape::cuboid(Vec3::ONE).unwrap(),
            Shape::cuboid(Vec3::new(1.0, 1.0, 1.1)).unwrap(),
            Shape::cylinder(0.5, 1.0).unwrap(),
            Shape::cone(0.5, 1.0).unwrap(),
            Shape::ellipsoid(Vec3::new(1.0, 2.0, 3.0)).unwrap(),
            Shape::rounded_cuboid(Vec3::ONE, 0.1).unwrap(),
            Shape::HalfSpace,
        ];
        for (i, a) in shapes.iter().enumerate() {
            for (j, b) in shapes.iter().enumerate() {
                assert_eq!(a.fingerprint() == b.fingerprint(), i == j, "{a:?} {b:?}");
            }
        }
        let rectangle =
            |x, y| Topology::rectangle(Vec2::ONE, Resolution::Cells(UVec2::new(x, y))).unwrap().fingerprint();
        assert_eq!(rectangle(4, 5), rectangle(4, 5));
        assert_ne!(rectangle(4, 5), rectangle(5, 4));
    }
}
