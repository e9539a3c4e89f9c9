//! Every tool in a game with the real mouse and keys, also while time stands.

mod cloth;
mod handles;
mod objects;

use bevy::prelude::*;
use bevy_cloth::*;
use bevy_cloth_inspector::Selected;

use super::Tool;
use crate::select::Selectable;
use crate::test_game::Game;

/// A cloth of 1 m × 1 m in the middle of the view.
pub const SHEET: Vec3 = Vec3::new(0.0, 1.5, 0.0);

impl Game {
    /// A game with a cloth that hangs in the middle of the view, and that tool in the hand.
    pub fn with_sheet(tool: Tool) -> (Self, Entity) {
        let mut game = Self::new();
        let sheet = (Cloth::rectangle(1.0, 1.0).with_cells(16, 16), Pins::top(), Flammable::default());
        let sheet = game.spawn((Selectable(1), sheet, Transform::from_translation(SHEET)));
        game.run(0.1);
        game.press(tool.face().key);
        (game, sheet)
    }

    /// Where a particle is in the world, m.
    pub fn particle(&self, cloth: Entity, particle: u32) -> Vec3 {
        let local = self.get::<Particles>(cloth).position.get(particle as usize);
        self.get::<ClothFrame>(cloth).to_world(local)
    }

    /// The particle in the middle of the cloth.
    pub fn middle(&self, cloth: Entity) -> u32 {
        self.get::<ClothTopology>(cloth).grid.expect("a rectangle has a grid").slot(8, 8)
    }

    pub fn hangs_free(&self, cloth: Entity, particle: u32) -> bool {
        self.get::<Particles>(cloth).inverse_mass[particle as usize] > 0.0
    }

    pub fn select(&mut self, entity: Entity) {
        self.app.world_mut().resource_mut::<Selected>().0 = Some(entity);
    }

    pub fn selected(&self) -> Option<Entity> {
        self.app.world().resource::<Selected>().0
    }

    pub fn count<F: bevy::ecs::query::QueryFilter>(&mut self) -> usize {
        self.app.world_mut().query_filtered::<Entity, F>().iter(self.app.world()).count()
    }
}
