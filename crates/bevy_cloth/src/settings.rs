//! Settings that a cloth has as a component, or shares with all others as a resource.

use bevy::prelude::*;
use cloth_solver::ClothError;
use cloth_solver::tick::DEFAULT_SUBSTEPS;

/// A value for every cloth that has no component of the type `T` of its own.
///
/// The plugin inserts `Shared<Gravity>`, `Shared<Wind>`, `Shared<Gusts>`, `Shared<Substeps>`, `Shared<Method>`,
/// `Shared<Teleport>` and, with the feature `render`, `Shared<ClothColoring>`, `Shared<ClothFlames>` and `Shared<ClothSubdivision>`.
/// (One type cannot be both: in Bevy 0.19 a resource is a component that may exist only once.)
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Deref, DerefMut)]
#[reflect(Resource, Default, Clone, Debug, PartialEq)]
pub struct Shared<T: Clone + core::fmt::Debug + Default + PartialEq>(pub T);

/// Acceleration that acts on every particle, in world axes, m/s²; each axis −10,000 to 10,000. Default (0, −9.81, 0).
///
/// A component on a cloth overrides the resource [`Shared<Gravity>`].
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct Gravity(pub Vec3);

impl Gravity {
    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        let mut axes = self.0.to_array().into_iter();
        axes.try_for_each(|axis| ClothError::check("Gravity", axis, -1e4..=1e4, "-10,000..=10,000 m/s² on each axis"))
    }
}

impl Default for Gravity {
    fn default() -> Self {
        Self(Vec3::new(0.0, -9.81, 0.0))
    }
}

/// Into how many substeps a tick is divided: the budget that buys stiffness and liveliness.
///
/// A component on a cloth overrides the resource [`Shared<Substeps>`].
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct Substeps {
    /// Substeps in a quiet tick, 1 to 200. Default 10.
    pub count: u32,
    /// Up to how many there may be where load, motion or a collider asks for more, 1 to 200. Default 80. A flag in a wind of
    /// 10 m/s asks for about 30, in a storm or an impact for all. With fewer, cloth in violent motion stretches more than its
    /// fabric does. Below `count` it has no effect. Only the method [`XpbdLines`](crate::Method::XpbdLines) takes more.
    pub max: u32,
    /// Iterations in a substep, of methods that iterate (see [`Method::iterates`](crate::Method::iterates)), 1 to 100.
    /// Default 1.
    pub iterations: u32,
}

impl Substeps {
    /// The fewer of both.
    pub(crate) fn least(self, other: &Self) -> Self {
        let Self { count, max, iterations } = *other;
        let (count, iterations) = (self.count.min(count), self.iterations.min(iterations));
        Self { count, max: self.max.min(max).max(count), iterations }
    }

    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        ClothError::check("Substeps::count", self.count as f32, 1.0..=200.0, "1..=200")?;
        ClothError::check("Substeps::max", self.max as f32, 1.0..=200.0, "1..=200")?;
        ClothError::check("Substeps::iterations", self.iterations as f32, 1.0..=100.0, "1..=100")
    }
}

impl Default for Substeps {
    fn default() -> Self {
        let [count, max] = DEFAULT_SUBSTEPS;
        Self { count, max, iterations: 1 }
    }
}

/// Hands on a cloth: each pulls a point of one triangle towards a target. Picking inserts it while the pointer holds
/// the cloth; any system may do the same.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct Grabs(pub Vec<Grab>);

impl Grabs {
    /// Checks every hand against a cloth of so many triangles.
    pub(crate) fn validate(&self, triangles: usize) -> Result<(), ClothError> {
        self.0.iter().try_for_each(|grab| grab.validate(triangles))
    }
}

/// One hand on a cloth: a stiff spring that never pulls harder than it may.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, Clone, Debug, PartialEq)]
pub struct Grab {
    /// Tells the hands on one cloth apart, so that each is known again from tick to tick. Any number that is not
    /// taken; picking counts down from the largest.
    pub hand: u32,
    /// The triangle held: index into the triangles of the cloth's [`ClothTopology`](crate::ClothTopology).
    pub triangle: u32,
    /// Barycentric weights of the point held; they sum to 1.
    pub weights: Vec3,
    /// Where the point is pulled to, in the world, m.
    pub target: Vec3,
    /// Stiffness of the spring, N/m; 0.001 to 10,000,000. Default 200.
    pub stiffness: f32,
    /// The hand never pulls harder than this, N; 0 to 1,000,000. Default 20.
    pub max_force: f32,
}

impl Grab {
    fn validate(&self, triangles: usize) -> Result<(), ClothError> {
        let Self { triangle, weights, target, stiffness, max_force, hand: _ } = *self;
        if triangle as usize >= triangles {
            let allowed = "a triangle of the cloth";
            return Err(ClothError::OutOfRange { field: "Grab::triangle", value: triangle as f32, allowed });
        }
        for weight in weights.to_array() {
            ClothError::check("Grab::weights", weight, -0.01..=1.01, "0..=1 each, with the sum 1")?;
        }
        ClothError::check("Grab::weights", weights.element_sum(), 0.99..=1.01, "0..=1 each, with the sum 1")?;
        for axis in target.to_array() {
            ClothError::check("Grab::target", axis, f32::MIN..=f32::MAX, "finite numbers of metres")?;
        }
        ClothError::check("Grab::stiffness", stiffness, 1e-3..=1e7, "0.001..=10,000,000 N/m")?;
        ClothError::check("Grab::max_force", max_force, 0.0..=1e6, "0..=1,000,000 N")
    }
}

impl Default for Grab {
    fn default() -> Self {
        Self {
            hand: 0,
            triangle: 0,
            weights: Vec3::splat(1.0 / 3.0),
            target: Vec3::ZERO,
            stiffness: 200.0,
            max_force: 20.0,
        }
    }
}
