//! Brings everything on a cloth's entity up to what became of its topology.

use std::sync::Arc;

use bevy::ecs::query::QueryData;
use bevy::prelude::*;
use cloth_solver::cloth::Constraints;
use cloth_solver::contact::SelfContacts;
use cloth_solver::topology::Change;
use cloth_solver::{Particles, Topology, damage};

use super::fire::ClothFire;
use super::pieces::ClothPieces;
use super::tear::TearState;
use crate::cloth::{ClothFrame, ClothHistory, ClothTopology};
use crate::events::PiecesSeparated;
use crate::prepare::{Armature, ClothSkin};
use crate::report::report;
use crate::settings::Grabs;
use crate::shown::ShownShape;

/// What of a cloth has to follow when it is taken apart.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Whole {
    pub entity: Entity,
    pub topology: &'static mut ClothTopology,
    pub skin: &'static mut ClothSkin,
    pub frame: &'static ClothFrame,
    pub particles: &'static mut Particles,
    pub constraints: &'static mut Constraints,
    pub history: &'static mut ClothHistory,
    pub shown: &'static mut ShownShape,
    pub armature: Option<&'static mut Armature>,
    pub own: Option<&'static mut SelfContacts>,
    pub tear: Option<&'static mut TearState>,
    pub fire: Option<&'static mut ClothFire>,
    pub grabs: Option<&'static mut Grabs>,
    pub pieces: Option<&'static mut ClothPieces>,
}

impl WholeItem<'_, '_> {
    /// Where a particle stands in the world, m.
    pub fn place(&self, slot: u32) -> Vec3 {
        self.frame.to_world(self.particles.position.get(slot as usize))
    }

    /// Takes over `now`, which the topology became by `change`. Nothing else has followed it yet, not even the memory of
    /// loads.
    pub fn become_(&mut self, now: Arc<Topology>, change: &Change, commands: &mut Commands) {
        damage::follow(&self.topology.0, &now, change, &mut self.particles, &mut self.constraints);
        if let Some(own) = &mut self.own {
            own.follow(&now, change, &mut self.particles);
        }
        self.history.position.follow(change);
        self.history.strokes.follow(change);
        self.shown.follow(change);
        if let Some(armature) = &mut self.armature {
            armature.follow(change);
        }
        if let Some(tear) = &mut self.tear {
            tear.0.follow(change);
        }
        if let Some(fire) = &mut self.fire {
            fire.follow(&now, change);
            fire.take_toll(&now, &mut self.particles, &mut self.constraints);
        }
        if !(change.vertices.is_empty() && change.born.is_empty()) {
            Arc::make_mut(&mut self.skin.0).follow(change);
        }
        if let Some(grabs) = &mut self.grabs {
            follow_grabs(grabs, change);
        }
        let before = self.pieces.as_ref().map_or(1, |pieces| pieces.pieces.len());
        let pieces = ClothPieces::new(&now, &self.constraints, self.pieces.as_deref());
        let count = pieces.pieces.len();
        let newcomer = pieces.newcomer(self.pieces.as_deref()).filter(|_| count > before);
        match &mut self.pieces {
            Some(known) => **known = pieces,
            None => {
                commands.entity(self.entity).try_insert(pieces);
            }
        }
        self.topology.0 = now;
        if let Some(particle) = newcomer {
            let (entity, position) = (self.entity, self.place(particle));
            report(commands, PiecesSeparated { entity, particle, position, pieces: count as u32 });
        }
    }
}

/// A hand keeps what it holds under its new number. Of a triangle that was divided it holds the first part, in the middle;
/// what is gone it lets go.
fn follow_grabs(grabs: &mut Grabs, change: &Change) {
    grabs.0.retain_mut(|grab| {
        let mut parts = change.triangles.iter().enumerate().filter(|(_, source)| **source == grab.triangle);
        let Some((first, _)) = parts.next() else { return false };
        if parts.next().is_some() {
            grab.weights = Vec3::splat(1.0 / 3.0);
        }
        grab.triangle = first as u32;
        true
    });
}
