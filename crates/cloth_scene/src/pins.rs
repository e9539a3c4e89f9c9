//! What holds a cloth.

use cloth_solver::ClothError;
use glam::{UVec2, Vec2};
use serde::{Deserialize, Serialize};

/// What holds a cloth.
#[derive(Serialize, Deserialize, Clone, Debug, PartialEq)]
pub enum ScenePins {
    /// The whole top edge.
    Top,
    /// So many rows from the top, 1..=10,000: a yoke. One is the top edge.
    Rows(u32),
    /// The two ends of the top edge.
    Corners,
    /// This many points spread evenly along the top edge, both ends included, 0..=100,000. One holds the middle.
    Rods(u32),
    /// The whole left edge, as a flag on its pole.
    Left,
    /// The whole right edge.
    Right,
    /// The whole bottom edge.
    Bottom,
    /// The particles nearest to these points, as parts of width (from the left) and height (from the top), 0..=1.
    At(Vec<Vec2>),
}

impl ScenePins {
    /// The points held, as parts of width (from the left) and height (from the top), of a cloth of so many cells.
    pub fn places(&self, cells: UVec2) -> Vec<Vec2> {
        let along = |count: u32| (0..=count).map(move |place| place as f32 / count as f32);
        match self {
            Self::Top => along(cells.x).map(|part| Vec2::new(part, 0.0)).collect(),
            Self::Rows(rows) => {
                let rows = (0..(*rows).min(cells.y + 1)).map(|row| row as f32 / cells.y as f32);
                rows.flat_map(|part| along(cells.x).map(move |across| Vec2::new(across, part))).collect()
            }
            Self::Corners => vec![Vec2::ZERO, Vec2::X],
            Self::Rods(0) => Vec::new(),
            Self::Rods(1) => vec![Vec2::new(0.5, 0.0)],
            Self::Rods(rods) => along(rods - 1).map(|part| Vec2::new(part, 0.0)).collect(),
            Self::Left => along(cells.y).map(|part| Vec2::new(0.0, part)).collect(),
            Self::Right => along(cells.y).map(|part| Vec2::new(1.0, part)).collect(),
            Self::Bottom => along(cells.x).map(|part| Vec2::new(part, 1.0)).collect(),
            Self::At(places) => places.clone(),
        }
    }

    /// Row and column (from the top left) of the particles held, of a rectangle of so many cells.
    pub fn rows_and_columns(&self, cells: UVec2) -> Vec<UVec2> {
        let nearest = |part: &Vec2| (part.clamp(Vec2::ZERO, Vec2::ONE) * cells.as_vec2()).round().as_uvec2();
        self.places(cells).iter().map(nearest).map(|place| UVec2::new(place.y, place.x)).collect()
    }

    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        match self {
            Self::Rods(rods) => ClothError::check("ScenePins::Rods", *rods as f32, 0.0..=1e5, "0..=100,000"),
            Self::Rows(rows) => ClothError::check("ScenePins::Rows", *rows as f32, 1.0..=1e4, "1..=10,000"),
            Self::At(places) => places.iter().flat_map(|place| place.to_array()).try_for_each(|part| {
                ClothError::check("ScenePins::At", part, 0.0..=1.0, "0..=1, parts of width and height")
            }),
            _ => Ok(()),
        }
    }
}
