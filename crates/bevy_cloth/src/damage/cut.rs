//! Cutting: a blade swept between two rays.

use std::sync::Arc;

use bevy::prelude::*;
use cloth_solver::damage::{self, Blade};

use super::apply::{Whole, WholeItem};
use crate::events::ClothCut;
use crate::report::report;

/// Trigger this to cut a cloth by what a ray sweeps over on its way from one place to another. Works while the clock is
/// paused. Where the ray meets no cloth nothing happens.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq)]
pub struct CutCloth {
    /// The cloth.
    pub entity: Entity,
    /// The ray at first, in the world.
    pub from: Ray3d,
    /// The ray at last, in the world.
    pub to: Ray3d,
    /// How far the rays reach, m.
    pub reach: f32,
}

/// Where the last blade of a stroke left off in a cloth, so that the next one goes on from there.
#[derive(Clone, Debug, Default)]
pub(crate) struct CutStroke {
    tips: Vec<u32>,
}

impl CutStroke {
    /// Cuts `cloth` from one ray to the other.
    pub fn sweep(&mut self, cloth: &mut WholeItem, from: Ray3d, to: Ray3d, reach: f32, commands: &mut Commands) {
        let ends = |ray: Ray3d| [ray.origin, ray.get_point(reach)].map(|point| cloth.frame.to_local(point));
        let blade = Blade { from: ends(from), to: ends(to) };
        let mut now = (*cloth.topology.0).clone();
        let Some(cut) = damage::cut(&mut now, &cloth.particles.position, &blade, &self.tips) else { return };
        cloth.become_(Arc::new(now), &cut.change, commands);
        self.tips = cut.tips;
        let position = cloth.place(cut.at);
        report(commands, ClothCut { entity: cloth.entity, particle: cut.at, position, edges: cut.edges as u32 });
    }
}

/// Answers [`CutCloth`].
pub(crate) fn on_cut(asked: On<CutCloth>, mut cloths: Query<Whole>, mut commands: Commands) {
    if let Ok(mut cloth) = cloths.get_mut(asked.entity) {
        CutStroke::default().sweep(&mut cloth, asked.from, asked.to, asked.reach, &mut commands);
    }
}
