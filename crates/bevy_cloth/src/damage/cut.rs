//! Cutting: a blade swept between two rays.

use bevy::prelude::*;
use cloth_solver::Soa3;
use cloth_solver::damage::Stroke;
use cloth_solver::topology::Change;

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

/// The strokes that are going on in a cloth, each with the number of the stroke and the camera it is seen by.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Strokes(Vec<([u64; 2], Stroke)>);

impl Strokes {
    /// Takes over what was torn, cut or burnt.
    pub fn follow(&mut self, change: &Change) {
        self.0.iter_mut().for_each(|(_, stroke)| stroke.follow(change));
    }

    /// Ends all but those whose number is `wanted`.
    #[cfg(feature = "picking")]
    pub fn retain(&mut self, wanted: impl Fn(u64) -> bool) {
        self.0.retain(|([number, _], _)| wanted(*number));
    }

    /// Takes one out, if it has begun.
    #[cfg(feature = "picking")]
    pub fn take(&mut self, which: [u64; 2]) -> Option<Stroke> {
        let at = self.0.iter().position(|(known, _)| *known == which)?;
        Some(self.0.swap_remove(at).1)
    }

    /// Puts one back.
    #[cfg(feature = "picking")]
    pub fn put(&mut self, which: [u64; 2], stroke: Stroke) {
        self.0.push((which, stroke));
    }
}

impl WholeItem<'_, '_> {
    /// Cuts it by a blade from `from`, or from where `stroke` left off, to `to`; the stroke from then on. The blade meets the
    /// shape that is `drawn`, or that of the last tick.
    pub fn sweep(
        &mut self,
        stroke: Option<Stroke>,
        [from, to]: [Ray3d; 2],
        reach: f32,
        drawn: bool,
        commands: &mut Commands,
    ) -> Stroke {
        let ends = |ray: Ray3d| [ray.origin, ray.get_point(reach)].map(|point| self.frame.to_local(point));
        let (from, to) = (ends(from), ends(to));
        let drawn = Some(self.shown.positions()).filter(|shown| drawn && shown.len() == self.topology.slots());
        let drawn = drawn.map(Soa3::from_slice);
        let position = drawn.as_ref().unwrap_or(&self.particles.position);
        let mut stroke = stroke.unwrap_or_else(|| Stroke::new(from, position));
        let mut now = self.topology.0.clone();
        if let Some(cut) = stroke.sweep(&mut now, position, to) {
            self.become_(now, &cut.change, commands);
            let (entity, position) = (self.entity, self.place(cut.at));
            report(commands, ClothCut { entity, particle: cut.at, position, edges: cut.edges as u32 });
        }
        stroke
    }
}

/// Answers [`CutCloth`].
pub(crate) fn on_cut(asked: On<CutCloth>, mut cloths: Query<Whole>, mut commands: Commands) {
    if let Ok(mut cloth) = cloths.get_mut(asked.entity) {
        cloth.sweep(None, [asked.from, asked.to], asked.reach, false, &mut commands);
    }
}
