//! What a cloth is made of.

use glam::Vec2;

use crate::ClothError;

/// Standard gravity, m/s² (ISO 80000-3). Bending lengths and self-weight strains are quoted for it.
pub const STANDARD_GRAVITY: f32 = 9.806_65;

/// Damping of every preset, 1/s. An estimate, chosen so that a metre of cloth draped on an edge rests within ten seconds:
/// published fabric measurements are quasi-static and give none.
const DAMPING: f32 = 0.5;

/// A fabric in SI units. Warp is the direction along the roll (a curtain's height), weft across it.
///
/// The presets say which of their values are measured and which are estimated from the fabric's density class.
/// Sources, as cited there:
/// - **Wang 2011**: Wang, O'Brien, Ramamoorthi, *Data-driven elastic models for cloth*, as distributed with ARCSim;
/// - **Penava 2014**: *Determination of the elastic constants of plain woven fabrics by a tensile test*;
/// - **Gan 1991**: Gan, Ly, Steven, *A finite element analysis of the draping of fabric*;
/// - **Feng 2022**: statistics over the 618 fabrics of *Learning-based bending stiffness parameter estimation*.
///
/// Thickness and friction of a preset are typical of its class, and the damping is always an estimate.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component, bevy_reflect::Reflect))]
#[cfg_attr(feature = "ecs", reflect(Default))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fabric {
    /// Mass per area, kg/m²; 1e-5..=100, fabrics lie in 0.02..=1. The lower end is there for stability sweeps.
    pub areal_density: f32,
    /// Thickness, m; 1e-6..=0.1. Contact keeps half of it between the mid-surface and a collider.
    pub thickness: f32,
    /// Membrane stiffness along the warp (force per width and strain), N/m; 0.01..=1e9.
    pub stretch_warp: f32,
    /// Membrane stiffness along the weft, N/m; 0.01..=1e9.
    pub stretch_weft: f32,
    /// In-plane shear stiffness (force per width and radian), N/m; 0..=1e9.
    pub shear: f32,
    /// Bending stiffness for curvature along the warp, N·m; 0..=1e4. 1 gf·cm²/cm of a KES sheet is 98.1 µN·m.
    pub bend_warp: f32,
    /// Bending stiffness for curvature along the weft, N·m; 0..=1e4.
    pub bend_weft: f32,
    /// Internal friction: the rate at which motion fades that is not rigid motion of a piece, or of a piece that is pinned
    /// not the motion of its pins, 1/s; 0..=1000, default 0.5. Free fall and the momentum of free pieces do not feel it; the
    /// swing of what is pinned does.
    pub damping: f32,
    /// Coulomb friction coefficient against a collider, dimensionless; 0..=10.
    pub friction: f32,
    /// Largest strain the fabric takes in use, dimensionless; 1e-4..=10.
    pub stretch_limit: f32,
    /// Tension at which it tears, per width, N/m; above 0, up to 1e9. Of all presets an estimate from strip tests (5 cm wide)
    /// of the class: 500–700 N of cotton, 1000–1500 of denim, about 1000 of polyester, 600–900 of ripstop, 400–600 of silk.
    pub strength: f32,
}

#[cfg(feature = "ecs")]
use bevy_reflect::prelude::ReflectDefault;

impl Default for Fabric {
    /// [`Fabric::COTTON_POPLIN`].
    fn default() -> Self {
        Self::COTTON_POPLIN
    }
}

impl Fabric {
    /// Silk charmeuse, a light satin weave. Partly measured, partly estimated: the source table does not say which,
    /// so take the stiffnesses as estimates.
    pub const SILK_CHARMEUSE: Self = Self {
        areal_density: 0.08,
        thickness: 0.18e-3,
        stretch_warp: 500.0,
        stretch_weft: 500.0,
        shear: 30.0,
        bend_warp: 1.8e-6,
        bend_weft: 1.4e-6,
        damping: DAMPING,
        friction: 0.25,
        stretch_limit: 0.06,
        strength: 10_000.0,
    };

    /// Plain-woven cotton shirting, the default. Density, stretch, shear and bending measured (tables behind Penava
    /// 2014 and Feng 2022); one stretch value for both directions.
    pub const COTTON_POPLIN: Self = Self {
        areal_density: 0.15,
        thickness: 0.32e-3,
        stretch_warp: 5500.0,
        stretch_weft: 5500.0,
        shear: 60.0,
        bend_warp: 8e-6,
        bend_weft: 5e-6,
        damping: DAMPING,
        friction: 0.35,
        stretch_limit: 0.05,
        strength: 12_000.0,
    };

    /// Knitted T-shirt cotton. Density, stretch and bending measured (Wang 2011, *gray-interlock*, 60 % cotton): the
    /// stretch is that of small strains; the knit hardens to 413 N/m along the warp, which this linear model omits.
    pub const COTTON_JERSEY: Self = Self {
        areal_density: 0.187,
        thickness: 0.6e-3,
        stretch_warp: 34.0,
        stretch_weft: 17.0,
        shear: 20.0,
        bend_warp: 20e-6,
        bend_weft: 14e-6,
        damping: DAMPING,
        friction: 0.4,
        stretch_limit: 0.2,
        strength: 6_000.0,
    };

    /// Denim of 11 oz/yd². Density, stretch and bending measured (Wang 2011, *11oz-black-denim*).
    pub const DENIM_11_OZ: Self = Self {
        areal_density: 0.324,
        thickness: 0.8e-3,
        stretch_warp: 1014.0,
        stretch_weft: 205.0,
        shear: 70.0,
        bend_warp: 120e-6,
        bend_weft: 60e-6,
        damping: DAMPING,
        friction: 0.5,
        stretch_limit: 0.03,
        strength: 25_000.0,
    };

    /// Woven wool for suits. Density, stretch, shear and bending measured (tables behind Gan 1991
    /// and Feng 2022).
    pub const WOOL_SUITING: Self = Self {
        areal_density: 0.235,
        thickness: 0.57e-3,
        stretch_warp: 2000.0,
        stretch_weft: 1000.0,
        shear: 60.0,
        bend_warp: 12e-6,
        bend_weft: 9e-6,
        damping: DAMPING,
        friction: 0.4,
        stretch_limit: 0.08,
        strength: 8_000.0,
    };

    /// Cotton canvas, as of tents and sails. Estimated.
    pub const CANVAS: Self = Self {
        areal_density: 0.39,
        thickness: 0.8e-3,
        stretch_warp: 4000.0,
        stretch_weft: 3000.0,
        shear: 200.0,
        bend_warp: 200e-6,
        bend_weft: 120e-6,
        damping: DAMPING,
        friction: 0.5,
        stretch_limit: 0.02,
        strength: 30_000.0,
    };

    /// Knitted polyester of flags. Partly measured, partly estimated: the source table does not say which, so take
    /// the stiffnesses as estimates.
    pub const FLAG_POLYESTER: Self = Self {
        areal_density: 0.112,
        thickness: 0.25e-3,
        stretch_warp: 1000.0,
        stretch_weft: 600.0,
        shear: 40.0,
        bend_warp: 5e-6,
        bend_weft: 4e-6,
        damping: DAMPING,
        friction: 0.3,
        stretch_limit: 0.04,
        strength: 20_000.0,
    };

    /// Nylon ripstop, as of kites and parachutes. Estimated; one stretch value for both directions.
    pub const NYLON_RIPSTOP: Self = Self {
        areal_density: 0.08,
        thickness: 0.1e-3,
        stretch_warp: 3000.0,
        stretch_weft: 3000.0,
        shear: 150.0,
        bend_warp: 2.5e-6,
        bend_weft: 2e-6,
        damping: DAMPING,
        friction: 0.2,
        stretch_limit: 0.03,
        strength: 15_000.0,
    };

    /// Cotton terry with loops. Estimated.
    pub const TERRY_TOWEL: Self = Self {
        areal_density: 0.45,
        thickness: 4e-3,
        stretch_warp: 400.0,
        stretch_weft: 300.0,
        shear: 40.0,
        bend_warp: 51e-6,
        bend_weft: 40e-6,
        damping: DAMPING,
        friction: 0.6,
        stretch_limit: 0.08,
        strength: 7_000.0,
    };

    /// Velvet of stage curtains. Estimated.
    pub const VELVET_CURTAIN: Self = Self {
        areal_density: 0.35,
        thickness: 1.5e-3,
        stretch_warp: 800.0,
        stretch_weft: 600.0,
        shear: 60.0,
        bend_warp: 36e-6,
        bend_weft: 30e-6,
        damping: DAMPING,
        friction: 0.5,
        stretch_limit: 0.04,
        strength: 9_000.0,
    };

    /// Voile, a sheer curtain. Estimated; one bending value for both directions.
    pub const VOILE: Self = Self {
        areal_density: 0.055,
        thickness: 0.12e-3,
        stretch_warp: 600.0,
        stretch_weft: 500.0,
        shear: 15.0,
        bend_warp: 1.3e-6,
        bend_weft: 1.3e-6,
        damping: DAMPING,
        friction: 0.25,
        stretch_limit: 0.05,
        strength: 4_000.0,
    };

    /// Garment leather. Partly measured, partly estimated: the source table does not say which, so take the
    /// stiffnesses as estimates; one value for both directions.
    pub const LEATHER_GARMENT: Self = Self {
        areal_density: 0.6,
        thickness: 0.9e-3,
        stretch_warp: 13_000.0,
        stretch_weft: 13_000.0,
        shear: 5000.0,
        bend_warp: 250e-6,
        bend_weft: 250e-6,
        damping: DAMPING,
        friction: 0.5,
        stretch_limit: 0.02,
        strength: 18_000.0,
    };

    /// Craft felt of 1 mm. Estimated; one value for both directions.
    pub const FELT_1_MM: Self = Self {
        areal_density: 0.25,
        thickness: 1.2e-3,
        stretch_warp: 1500.0,
        stretch_weft: 1500.0,
        shear: 550.0,
        bend_warp: 120e-6,
        bend_weft: 120e-6,
        damping: DAMPING,
        friction: 0.5,
        stretch_limit: 0.06,
        strength: 5_000.0,
    };

    /// Office paper: no fabric, the stiff end of the scale. Density, stretch, shear and bending measured (its
    /// bending as ARCSim ships it); one value for both directions.
    pub const PAPER: Self = Self {
        areal_density: 0.09,
        thickness: 0.1e-3,
        stretch_warp: 5e5,
        stretch_weft: 5e5,
        shear: 2e5,
        bend_warp: 400e-6,
        bend_weft: 400e-6,
        damping: DAMPING,
        friction: 0.35,
        stretch_limit: 0.005,
        strength: 6_000.0,
    };

    /// All presets under the names shown to a user, the default first.
    pub const PRESETS: &[(&'static str, Self)] = &[
        ("Cotton poplin", Self::COTTON_POPLIN),
        ("Cotton jersey", Self::COTTON_JERSEY),
        ("Silk charmeuse", Self::SILK_CHARMEUSE),
        ("Voile", Self::VOILE),
        ("Wool suiting", Self::WOOL_SUITING),
        ("Denim, 11 oz", Self::DENIM_11_OZ),
        ("Canvas", Self::CANVAS),
        ("Flag, knitted polyester", Self::FLAG_POLYESTER),
        ("Nylon ripstop", Self::NYLON_RIPSTOP),
        ("Terry towel", Self::TERRY_TOWEL),
        ("Velvet curtain", Self::VELVET_CURTAIN),
        ("Felt, 1 mm", Self::FELT_1_MM),
        ("Leather, garment", Self::LEATHER_GARMENT),
        ("Paper", Self::PAPER),
    ];

    /// `Ok` if every number is within its range, which its field's documentation gives; else the first that is not.
    pub fn validate(&self) -> Result<(), ClothError> {
        let check = ClothError::check;
        let stiffness = |field, value| check(field, value, 1e-2..=1e9, "0.01..=1e9 N/m");
        let bending = |field, value| check(field, value, 0.0..=1e4, "0..=1e4 N·m");
        check("Fabric::areal_density", self.areal_density, 1e-5..=100.0, "1e-5..=100 kg/m²")?;
        check("Fabric::thickness", self.thickness, 1e-6..=0.1, "1e-6..=0.1 m")?;
        stiffness("Fabric::stretch_warp", self.stretch_warp)?;
        stiffness("Fabric::stretch_weft", self.stretch_weft)?;
        check("Fabric::shear", self.shear, 0.0..=1e9, "0..=1e9 N/m")?;
        bending("Fabric::bend_warp", self.bend_warp)?;
        bending("Fabric::bend_weft", self.bend_weft)?;
        check("Fabric::damping", self.damping, 0.0..=1000.0, "0..=1000 1/s")?;
        check("Fabric::friction", self.friction, 0.0..=10.0, "0..=10")?;
        check("Fabric::stretch_limit", self.stretch_limit, 1e-4..=10.0, "1e-4..=10")?;
        check("Fabric::strength", self.strength, f32::MIN_POSITIVE..=1e9, "above 0, up to 1e9 N/m")
    }

    /// Bending length `(D/σg)^(1/3)` under [`STANDARD_GRAVITY`], m: x along the weft, y along the warp.
    ///
    /// The length at which weight and bending stiffness balance. Folds are about that wide, so a mesh that is to show
    /// them wants edges of at most half of it.
    pub fn bending_length(&self) -> Vec2 {
        let weight = self.areal_density * STANDARD_GRAVITY;
        Vec2::new((self.bend_weft / weight).cbrt(), (self.bend_warp / weight).cbrt())
    }
}
