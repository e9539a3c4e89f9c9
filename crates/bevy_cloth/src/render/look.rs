//! How the fabric of a cloth looks: the authored component [`ClothLook`].

use bevy::prelude::*;

/// How the fabric of a [`Cloth`](crate::Cloth) looks: its weave, its colours and its pattern.
///
/// A cloth with this component is drawn with a fabric material of its own: threads that are seen near by, folds that
/// darken, light that shines through, torn edges that fray, burnt holes with irregular rims, wet cloth that is darker. A
/// `StandardMaterial` of the entity is put aside meanwhile; a material of any other kind is not: take it off. Insert, change and remove it at any time. Out-of-range numbers
/// are clamped.
///
/// Needs a renderer: add [`ClothPlugin`](crate::ClothPlugin) after `DefaultPlugins`. Without a renderer it does nothing.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct ClothLook {
    /// How the threads cross; default plain.
    pub weave: Weave,
    /// Main colour: of the warp, and of the weft unless `second` says otherwise. Default unbleached cotton.
    pub color: Color,
    /// With a `pattern` its other colour, without one the colour of the weft (denim has a white one, shot silk another).
    /// Default `None`: the main colour, with a pattern white.
    pub second: Option<Color>,
    /// Stripes, checks and the like; default none.
    pub pattern: Pattern,
    /// Threads per metre as they are seen, 50..=20,000; default as usual for the weave. Loops of terry, stitches of knit.
    pub threads: f32,
    /// How strongly the fibres that stand out shine where the cloth is seen edge-on, 0..=1; default as usual for the weave.
    /// Velvet 1, satin 0.
    pub sheen: f32,
    /// Which part of the light shines through, 0..=1; default as usual for the weave. Voile 0.7, denim 0.02.
    pub translucency: f32,
    /// How smooth the threads are, 0..=1: 0 matt cotton, 1 silk that shines. Default as usual for the weave.
    pub gloss: f32,
}

/// How the threads of a fabric cross.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Clone, Debug, PartialEq)]
pub enum Weave {
    /// One over, one under: poplin, canvas, voile, wool.
    #[default]
    Plain,
    /// Diagonal ribs: denim.
    Twill,
    /// Long floats, smooth and shining: satin, charmeuse.
    Satin,
    /// Loops: towels.
    Terry,
    /// Stitches: jersey.
    Knit,
    /// Plain with a grid of thicker threads: parachutes, kites.
    Ripstop,
    /// A dense pile that stands up.
    Velvet,
}

impl Weave {
    /// All weaves.
    pub const ALL: [Self; 7] =
        [Self::Plain, Self::Twill, Self::Satin, Self::Terry, Self::Knit, Self::Ripstop, Self::Velvet];
}

/// A pattern of two colours on a fabric.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Default, Clone, Debug, PartialEq)]
pub enum Pattern {
    /// None.
    #[default]
    None,
    /// Stripes of one width, main and second colour by turns.
    Stripes {
        /// Width of each stripe, m; at least 0.001.
        width: f32,
        /// Whether they run along the weft, across the cloth; otherwise along the warp, down it.
        across: bool,
    },
    /// Warp and weft both dyed in stripes, as gingham is.
    Check {
        /// Width of each stripe, m; at least 0.001.
        width: f32,
    },
    /// One stripe of the second colour along the border, as towels have.
    Border {
        /// Width of the stripe, m; it lies twice its width inside the hem. At least 0.001.
        width: f32,
    },
    /// Equal bands over the whole cloth, main and second colour by turns, as on many flags.
    Bands {
        /// How many; 1..=100.
        count: u32,
        /// Whether they run along the weft, across the cloth; otherwise along the warp, down it.
        across: bool,
    },
}

impl Default for ClothLook {
    fn default() -> Self {
        Self::new(Weave::Plain, Color::srgb(0.93, 0.91, 0.86))
    }
}

impl ClothLook {
    /// A fabric of one colour, with what is usual for the weave.
    pub const fn new(weave: Weave, color: Color) -> Self {
        // Threads per metre, sheen, translucency, gloss.
        let (threads, sheen, translucency, gloss) = match weave {
            Weave::Plain => (1100.0, 0.20, 0.15, 0.15),
            Weave::Twill => (1000.0, 0.20, 0.02, 0.12),
            Weave::Satin => (2500.0, 0.0, 0.10, 0.90),
            Weave::Terry => (420.0, 0.45, 0.03, 0.0),
            Weave::Knit => (500.0, 0.30, 0.12, 0.10),
            Weave::Ripstop => (1600.0, 0.0, 0.35, 0.55),
            Weave::Velvet => (900.0, 1.0, 0.0, 0.10),
        };
        Self { weave, color, second: None, pattern: Pattern::None, threads, sheen, translucency, gloss }
    }

    /// Terry towelling.
    pub const fn terry(color: Color) -> Self {
        Self::new(Weave::Terry, color)
    }

    /// Indigo denim with a white weft.
    pub const DENIM: Self =
        Self::new(Weave::Twill, Color::srgb(0.10, 0.17, 0.38)).with_second(Color::srgb(0.40, 0.44, 0.50));

    /// Silk charmeuse.
    pub const fn silk(color: Color) -> Self {
        Self { translucency: 0.15, ..Self::new(Weave::Satin, color) }
    }

    /// A velvet curtain.
    pub const fn velvet(color: Color) -> Self {
        Self::new(Weave::Velvet, color)
    }

    /// Thin voile, through which light falls.
    pub const fn voile(color: Color) -> Self {
        Self { threads: 1500.0, sheen: 0.1, translucency: 0.7, ..Self::new(Weave::Plain, color) }
    }

    /// Heavy canvas.
    pub const fn canvas(color: Color) -> Self {
        Self { threads: 650.0, sheen: 0.1, translucency: 0.05, gloss: 0.05, ..Self::new(Weave::Plain, color) }
    }

    /// Cotton poplin, for shirts, sheets and tablecloths.
    pub const fn cotton(color: Color) -> Self {
        Self::new(Weave::Plain, color)
    }

    /// Nylon ripstop, for flags, kites and tents.
    pub const fn ripstop(color: Color) -> Self {
        Self::new(Weave::Ripstop, color)
    }

    /// Wool suiting.
    pub const fn wool(color: Color) -> Self {
        Self { threads: 900.0, sheen: 0.5, translucency: 0.02, gloss: 0.05, ..Self::new(Weave::Twill, color) }
    }

    /// Cotton jersey, as T-shirts are made of.
    pub const fn jersey(color: Color) -> Self {
        Self::new(Weave::Knit, color)
    }

    /// The same with a second colour: of the pattern, or without one of the weft.
    pub const fn with_second(self, second: Color) -> Self {
        Self { second: Some(second), ..self }
    }

    /// The same with a pattern in a second colour.
    pub const fn with_pattern(self, pattern: Pattern, second: Color) -> Self {
        Self { pattern, ..self.with_second(second) }
    }
}
