//! What the colours of a cloth are.

use bevy::ecs::query::QueryData;
use bevy::prelude::*;
use cloth_solver::contact::Contacts;
use cloth_solver::damage::fire::{FLAME_TEMPERATURE, Fire, ROOM_TEMPERATURE, Stage};
use cloth_solver::{Fabric, Particles, Topology, measure};

use super::ClothColoring;
use super::wear;
use crate::damage::{ClothFire, TearState, Tearable};

/// Speed that is shown as the largest, m/s: of a fall from 1.3 m.
const FASTEST: f32 = 5.0;

/// Linear colour of a glowing rim: brighter than white, so that it shines where the camera blooms.
const EMBER: [f32; 3] = [6.0, 1.2, 0.15];

/// What colours follow from beside the particles.
#[derive(QueryData)]
pub(crate) struct Told {
    contacts: &'static Contacts,
    tear: Option<&'static TearState>,
    tearable: Option<&'static Tearable>,
    fire: Option<Ref<'static, ClothFire>>,
}

impl ToldItem<'_, '_> {
    /// Whether the colours are other ones than a tick ago, whatever the particles did.
    pub fn is_burning(&self) -> bool {
        self.fire.as_ref().is_some_and(|fire| fire.is_warm() || fire.is_changed())
    }

    /// What has become of the cloth by fire and water.
    pub fn fire(&self) -> Option<&Fire> {
        let fire: &ClothFire = self.fire.as_ref()?;
        Some(fire)
    }

    /// Fills `supports`, one for each slot, with the unit normal of the solid that the particle touches, or zero; leaves it empty if
    /// the cloth touches nothing.
    pub fn supports(&self, topology: &Topology, particles: &Particles, supports: &mut Vec<Vec3>) {
        supports.clear();
        if self.contacts.touching > 0 {
            let normal = |slot| self.contacts.normal_at(particles.position.get(slot)).unwrap_or(Vec3::ZERO);
            supports.extend((0..topology.slots()).map(normal));
        }
    }

    /// Fills `shares`, one for each slot, with what `coloring` tells: 0 where nothing is, 1 at its limit.
    pub fn shares(
        &self,
        coloring: ClothColoring,
        topology: &Topology,
        particles: &Particles,
        fabric: &Fabric,
        shares: &mut Vec<f32>,
    ) {
        if matches!(coloring, ClothColoring::Stress | ClothColoring::Strain) {
            measure::particle_strain(topology, particles, shares);
            shares.iter_mut().for_each(|share| *share /= fabric.stretch_limit);
        } else {
            shares.clear();
            shares.resize(topology.slots(), 0.0);
        }
        match coloring {
            ClothColoring::Material | ClothColoring::Strain => {}
            ClothColoring::Stress => {
                for (slot, share) in shares.iter_mut().enumerate() {
                    let torn = self.tear.zip(self.tearable).filter(|(tear, _)| slot < tear.0.slots());
                    let load = torn.map(|(tear, tearable)| {
                        tear.0.load(slot) / (fabric.strength * tearable.scale * tear.0.strength(slot))
                    });
                    let burnt = self.fire.as_ref().and_then(|fire| fire.char().get(slot).copied());
                    *share = load.unwrap_or(*share).max(burnt.unwrap_or(0.0));
                }
            }
            ClothColoring::Temperature => {
                for (share, kelvin) in shares.iter_mut().zip(self.fire.iter().flat_map(|fire| fire.temperature())) {
                    *share = (kelvin - ROOM_TEMPERATURE) / (FLAME_TEMPERATURE - ROOM_TEMPERATURE);
                }
            }
            ClothColoring::Speed => {
                for (slot, share) in shares.iter_mut().enumerate() {
                    *share = particles.velocity.get(slot).length() / FASTEST;
                }
            }
            ClothColoring::Contact => {
                for (slot, share) in shares.iter_mut().enumerate() {
                    *share = f32::from(self.contacts.touches(particles.position.get(slot)));
                }
            }
        }
    }

    /// What fire and water make of `color` at a particle: brown, black, at the rim of a hole glowing; and dark where it is
    /// wet.
    pub fn scorched(&self, slot: u32, color: [f32; 4]) -> [f32; 4] {
        let Some(fire) = &self.fire else { return color };
        let at = slot as usize;
        let (Some(scorch), Some(char)) = (fire.scorch().get(at), fire.char().get(at)) else { return color };
        // Brown takes the blue first, char all but a twentieth.
        let brown = [1.0 - 0.45 * scorch, 1.0 - 0.7 * scorch, 1.0 - 0.85 * scorch];
        let black = 1.0 - 0.95 * (3.0 * char).min(1.0);
        let [_, wet] = wear::burn_and_wet(Some(fire), slot);
        let mut burnt = color;
        for axis in 0..3 {
            burnt[axis] *= brown[axis] * black * (1.0 - 0.45 * wet.max(0.0));
        }
        if fire.stage(slot) == Stage::Ember && fire.temperature()[at] > 600.0 {
            burnt[..3].copy_from_slice(&EMBER);
        }
        burnt
    }
}
