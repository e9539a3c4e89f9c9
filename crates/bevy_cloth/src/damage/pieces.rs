//! The pieces a cloth that was taken apart consists of, and the end of the small ones.

use bevy::prelude::*;
use cloth_solver::cloth::Constraints;
use cloth_solver::topology::Pieces;
use cloth_solver::{Soa3, Topology, damage};

use super::apply::Whole;
use super::tear::Tearable;
use crate::events::DebrisGone;
use crate::prepare::StepPlan;
use crate::report::report;
use crate::sleep::ClothAsleep;
use crate::step::ClothTick;

/// The pieces a cloth consists of, once it was torn, cut or burnt. Read-only; all of them stay simulated.
#[derive(Component, Clone, Debug, Default)]
#[component(clone_behavior = Ignore)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct ClothPieces {
    /// The pieces, by their first particles.
    pub pieces: Vec<ClothPiece>,
    /// For each slot its piece; `u32::MAX` for padding.
    pub of_slot: Vec<u32>,
}

/// One piece of a cloth.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct ClothPiece {
    /// Its first particle.
    pub particle: u32,
    /// Number of its triangles.
    pub triangles: u32,
    /// Whether anything holds it.
    pub pinned: bool,
    /// For how long it has been apart from what is pinned, s of the cloth's clock; 0 while it is pinned.
    pub adrift: f32,
}

impl ClothPieces {
    /// Of `topology`. A piece keeps its time adrift from `before`.
    pub(crate) fn new(topology: &Topology, constraints: &Constraints, before: Option<&Self>) -> Self {
        let Pieces { of_slot, triangles } = topology.pieces();
        let mut pieces: Vec<ClothPiece> = (triangles.into_iter())
            .map(|triangles| ClothPiece { particle: u32::MAX, triangles, pinned: false, adrift: 0.0 })
            .collect();
        for (slot, piece) in of_slot.iter().enumerate().filter(|(_, piece)| **piece != u32::MAX) {
            let piece = &mut pieces[*piece as usize];
            piece.particle = piece.particle.min(slot as u32);
        }
        for pin in &constraints.pins().pins {
            if let Some(piece) = of_slot.get(pin.particle as usize).and_then(|piece| pieces.get_mut(*piece as usize)) {
                piece.pinned = true;
            }
        }
        for piece in pieces.iter_mut().filter(|piece| !piece.pinned) {
            let old = before.and_then(|before| {
                let known = before.of_slot.get(piece.particle as usize)?;
                before.pieces.get(*known as usize)
            });
            piece.adrift = old.map_or(0.0, |old| old.adrift);
        }
        Self { pieces, of_slot }
    }

    /// The first particle of a piece that was no piece `before`, or not one of its own.
    pub(crate) fn newcomer(&self, before: Option<&Self>) -> Option<u32> {
        let mut known: Vec<u32> = Vec::with_capacity(self.pieces.len());
        (self.pieces.iter().map(|piece| piece.particle)).find(|particle| {
            let was = before.map_or(Some(&0), |before| before.of_slot.get(*particle as usize));
            let Some(was) = was.filter(|was| **was != u32::MAX && !known.contains(was)) else { return true };
            known.push(*was);
            false
        })
    }

    /// The box around piece `piece` where particles stand at `position`, cloth frame, m.
    pub fn bounds(&self, piece: u32, position: &Soa3) -> (Vec3, Vec3) {
        let of_piece = self.of_slot.iter().enumerate().filter(|(_, known)| **known == piece);
        of_piece.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), (slot, _)| {
            let at = position.get(slot);
            (low.min(at), high.max(at))
        })
    }
}

/// Lets the time of what drifts go by, and takes small pieces out once their time is up.
pub(crate) fn clear_debris(
    mut cloths: Query<(Whole, &Tearable, &StepPlan), (With<ClothPieces>, Without<ClothAsleep>)>,
    tick: Res<ClothTick>,
    mut commands: Commands,
) {
    for (mut cloth, tearable, plan) in &mut cloths {
        if plan.substeps == 0 || tick.still {
            continue;
        }
        let Some(pieces) = cloth.pieces.as_mut() else { continue };
        let mut over = vec![false; pieces.pieces.len()];
        for (piece, over) in pieces.pieces.iter_mut().zip(&mut over).filter(|(piece, _)| !piece.pinned) {
            piece.adrift += tick.dt;
            *over = piece.triangles < tearable.debris && piece.adrift > tearable.debris_lifetime;
        }
        if !over.contains(&true) {
            continue;
        }
        let of_slot = &pieces.of_slot;
        let gone: Vec<u32> = (cloth.topology.triangles.iter().enumerate())
            .filter(|(_, corners)| over[of_slot[corners[0] as usize] as usize])
            .map(|(triangle, _)| triangle as u32)
            .collect();
        let particle = cloth.topology.triangles[gone[0] as usize][0];
        let position = cloth.place(particle);
        let mut now = cloth.topology.0.clone();
        if let Some(change) = damage::remove(&mut now, &gone) {
            cloth.become_(now, &change, &mut commands);
            report(
                &mut commands,
                DebrisGone { entity: cloth.entity, particle, position, triangles: gone.len() as u32 },
            );
        }
    }
}
