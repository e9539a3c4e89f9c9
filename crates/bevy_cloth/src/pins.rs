//! The authored component that says which particles are held, and by what.

use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::ecs::reflect::ReflectMapEntities;
use bevy::prelude::*;

/// What holds a cloth: any number of groups, each a choice of particles and what they follow.
///
/// A pinned particle follows its frame exactly, whatever pulls at it. A particle chosen by several groups belongs to
/// the first of them. Changing `Pins` while the cloth runs replaces all pins and leaves everything else as it is.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_cloth::Pins;
/// # let hand = Entity::PLACEHOLDER;
/// // A curtain on five rods whose lower left corner is held by another entity.
/// let pins = Pins::rods(5).and(Pins::region(Vec3::new(-1.1, -0.8, -0.1), Vec3::new(-0.9, -0.7, 0.1)).to_entity(hand));
/// ```
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq, MapEntities)]
#[component(map_entities)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct Pins(pub Vec<PinGroup>);

/// Some particles of a cloth and what they follow.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct PinGroup {
    /// Which particles.
    pub select: PinSelect,
    /// What they follow.
    pub to: PinTarget,
}

/// Which particles of a cloth a [`PinGroup`] holds.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub enum PinSelect {
    /// The particles of the top edge nearest to this many points spread evenly over the width, both ends included.
    /// One rod holds the middle, none holds nothing. The top edge of a flat, evenly divided
    /// rectangle is its highest side (its first row if it lies level), of any other mesh every particle within a hundredth
    /// of its height from the highest.
    Rods(u32),
    /// The whole top edge.
    Top,
    /// The two ends of the top edge.
    Corners,
    /// The particles that these vertices of the mesh follow. The vertices of a rectangle are numbered row by row
    /// from the top left.
    Vertices(Vec<u32>),
    /// The particles whose rest position lies in a box (bounds included), in the cloth's own frame with its scale
    /// applied, m.
    Region {
        /// Lower bounds, m.
        min: Vec3,
        /// Upper bounds, m.
        max: Vec3,
    },
    /// The particles of vertices whose colour ([`Mesh::ATTRIBUTE_COLOR`]) has at least this much red. Only for a
    /// cloth made from a mesh that has vertex colours.
    VertexColor {
        /// Smallest red that pins, 0..=1 in the mesh's own (linear) numbers.
        threshold: f32,
    },
}

impl Default for PinSelect {
    fn default() -> Self {
        Self::Rods(2)
    }
}

/// What the particles of a [`PinGroup`] follow.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Default, Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub enum PinTarget {
    /// The cloth's own [`Transform`]: each particle is held at its rest position in the cloth's frame. On a skinned mesh: the joints,
    /// each particle is held where they take it.
    #[default]
    Cloth,
    /// The world: each particle is held where it was when the pin was made, however the cloth's transform moves.
    World,
    /// Another entity: each particle keeps the place it had in that entity's frame (without its scale) when the pin
    /// was made. If the entity goes, the pin stays where it was last. If it jumps the cloth goes along, see
    /// [`Teleport`](crate::Teleport).
    Entity(#[cfg_attr(feature = "serialize", serde(with = "crate::save::entity"))] Entity),
}

impl Pins {
    /// `count` pins spread evenly along the top edge, see [`PinSelect::Rods`].
    pub fn rods(count: u32) -> Self {
        Self::one(PinSelect::Rods(count))
    }

    /// The whole top edge.
    pub fn top() -> Self {
        Self::one(PinSelect::Top)
    }

    /// The two ends of the top edge.
    pub fn corners() -> Self {
        Self::one(PinSelect::Corners)
    }

    /// The particles that these vertices of the mesh follow, see [`PinSelect::Vertices`].
    pub fn vertices(vertices: impl IntoIterator<Item = u32>) -> Self {
        Self::one(PinSelect::Vertices(vertices.into_iter().collect()))
    }

    /// The particles at rest within a box, see [`PinSelect::Region`].
    pub fn region(min: Vec3, max: Vec3) -> Self {
        Self::one(PinSelect::Region { min, max })
    }

    /// The particles of vertices with at least `threshold` of red, see [`PinSelect::VertexColor`].
    pub fn vertex_color(threshold: f32) -> Self {
        Self::one(PinSelect::VertexColor { threshold })
    }

    /// Lets every group follow `entity`.
    pub fn to_entity(self, entity: Entity) -> Self {
        self.to(PinTarget::Entity(entity))
    }

    /// Lets every group stay where it is in the world.
    pub fn to_world(self) -> Self {
        self.to(PinTarget::World)
    }

    /// These groups and those of `other`; where both choose a particle, these hold it.
    pub fn and(mut self, other: Self) -> Self {
        self.0.extend(other.0);
        self
    }

    fn one(select: PinSelect) -> Self {
        Self(vec![PinGroup { select, to: PinTarget::default() }])
    }

    fn to(mut self, target: PinTarget) -> Self {
        for group in &mut self.0 {
            group.to = target;
        }
        self
    }
}

impl MapEntities for Pins {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        for group in &mut self.0 {
            if let PinTarget::Entity(entity) = &mut group.to {
                *entity = mapper.get_mapped(*entity);
            }
        }
    }
}
