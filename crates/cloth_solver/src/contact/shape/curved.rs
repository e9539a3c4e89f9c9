//! Solids with curved surfaces: cylinder, cone, ellipsoid, box with rounded edges.
//!
//! Particles of a cloth meet the surface itself, triangles and edges a polyhedron inside: the core of the rounded box at the
//! distance of its radius, of the others one with its corners on the surface.

use glam::{Vec2, Vec3};

use super::{ConvexHull, ellipsoid};

/// The form of a [`Curved`] solid, centred on the origin of its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// A cylinder along y.
    Cylinder {
        /// Radius, m.
        radius: f32,
        /// Half the height, m.
        half_height: f32,
    },
    /// A cone along y, its apex at +`half_height`.
    Cone {
        /// Radius of the base, m.
        radius: f32,
        /// Half the height, m.
        half_height: f32,
    },
    /// An ellipsoid.
    Ellipsoid {
        /// Semi-axes, m.
        half: Vec3,
    },
    /// All points no farther than a radius from a box.
    RoundedCuboid {
        /// Half the edges of that box, m.
        core: Vec3,
        /// Radius of the edges, m.
        radius: f32,
    },
}

/// A convex solid with a curved surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Curved {
    form: Form,
    /// What triangles and edges meet.
    hull: ConvexHull,
}

impl Curved {
    pub(super) fn new(form: Form) -> Self {
        let hull = match form {
            Form::Cylinder { radius, half_height } => ConvexHull::in_cylinder(radius, half_height),
            Form::Cone { radius, half_height } => ConvexHull::in_cone(radius, half_height),
            Form::Ellipsoid { half } => ConvexHull::in_ellipsoid(half),
            Form::RoundedCuboid { core, .. } => ConvexHull::cuboid(core),
        };
        Self { form, hull }
    }

    /// Its form.
    pub fn form(&self) -> Form {
        self.form
    }

    pub(crate) fn hull(&self) -> &ConvexHull {
        &self.hull
    }

    /// How far the surface is from [`Self::hull`] where that counts, m.
    pub(crate) fn rounding(&self) -> f32 {
        if let Form::RoundedCuboid { radius, .. } = self.form { radius } else { 0.0 }
    }

    /// The least radius of curvature of a surface without edges, m; `None` with edges.
    pub(crate) fn least_curvature_radius(&self) -> Option<f32> {
        match self.form {
            Form::Cylinder { .. } | Form::Cone { .. } => None,
            Form::Ellipsoid { half } => Some(half.min_element().powi(2) / half.max_element()),
            Form::RoundedCuboid { radius, .. } => Some(radius),
        }
    }

    /// Half the edges of the box that holds it, m.
    pub(crate) fn half_extent(&self) -> Vec3 {
        match self.form {
            Form::Cylinder { radius, half_height } | Form::Cone { radius, half_height } => {
                Vec3::new(radius, half_height, radius)
            }
            Form::Ellipsoid { half } => half,
            Form::RoundedCuboid { core, radius } => core + radius,
        }
    }

    pub(super) fn bounding_radius(&self) -> f32 {
        match self.form {
            Form::Cylinder { radius, half_height } | Form::Cone { radius, half_height } => {
                hypotenuse(radius, half_height)
            }
            Form::Ellipsoid { half } => half.max_element(),
            Form::RoundedCuboid { core, radius } => core.length() + radius,
        }
    }

    pub(super) fn inner_radius(&self) -> f32 {
        match self.form {
            Form::Cylinder { radius, half_height } => radius.min(half_height),
            // The circle in the triangle that the cone is cut to along its axis.
            Form::Cone { radius, half_height } => {
                2.0 * radius * half_height / (radius + hypotenuse(radius, 2.0 * half_height))
            }
            Form::Ellipsoid { half } => half.min_element(),
            Form::RoundedCuboid { core, radius } => core.min_element() + radius,
        }
    }

    /// See [`super::Shape::distance_and_normal`].
    pub(super) fn distance_and_normal(&self, p: Vec3) -> (f32, Vec3) {
        match self.form {
            Form::Cylinder { radius, half_height } => revolved(p, |rho, y| {
                let (aside, above) = (rho - radius, y.abs() - half_height);
                let up = Vec2::Y * 1.0_f32.copysign(y);
                match (aside > 0.0, above > 0.0) {
                    (true, true) => from_corner(Vec2::new(aside, above.copysign(y))),
                    _ if aside >= above => (aside, Vec2::X),
                    _ => (above, up),
                }
            }),
            Form::Cone { radius, half_height } => revolved(p, |rho, y| {
                let (slant, length) = (Vec2::new(radius, -2.0 * half_height), hypotenuse(radius, 2.0 * half_height));
                let (from_apex, outward) = (Vec2::new(rho, y - half_height), Vec2::new(-slant.y, slant.x) / length);
                let (below, out) = (-half_height - y, outward.dot(from_apex));
                let along = slant.dot(from_apex) / length;
                match () {
                    () if below <= 0.0 && out <= 0.0 => {
                        if out >= below {
                            (out, outward)
                        } else {
                            (below, Vec2::NEG_Y)
                        }
                    }
                    () if below > 0.0 && rho <= radius => (below, Vec2::NEG_Y),
                    () if along <= 0.0 => from_corner(from_apex),
                    () if along >= length => from_corner(Vec2::new(rho - radius, -below)),
                    () => (out, outward),
                }
            }),
            Form::Ellipsoid { half } => ellipsoid::distance_and_normal(half, p),
            Form::RoundedCuboid { core, radius } => {
                let over = p.abs() - core;
                let away = over.max(Vec3::ZERO);
                let (height, axis) = (over.max_element(), over.max_position());
                let side = Vec3::AXES[axis] * 1.0_f32.copysign(p[axis]);
                if height <= 0.0 {
                    return (height - radius, side);
                }
                (away.length() - radius, (away * Vec3::ONE.copysign(p)).normalize_or(side))
            }
        }
    }
}

/// Distance and normal of a solid of revolution about y: `profile` knows them at a distance from the axis and a height.
fn revolved(p: Vec3, profile: impl Fn(f32, f32) -> (f32, Vec2)) -> (f32, Vec3) {
    let aside = Vec2::new(p.x, p.z);
    let outward = aside.normalize_or(Vec2::X);
    let (distance, normal) = profile(aside.length(), p.y);
    (distance, Vec3::new(normal.x * outward.x, normal.y, normal.x * outward.y))
}

/// The same on every machine, which `f32::hypot` is not.
fn hypotenuse(a: f32, b: f32) -> f32 {
    (a * a + b * b).sqrt()
}

/// Distance and direction from a corner of the profile; at the corner itself, or too far off to tell, up.
fn from_corner(way: Vec2) -> (f32, Vec2) {
    (way.length(), way.normalize_or(Vec2::Y))
}
