//! Contact of a cloth with itself: what is told of it.

use bevy::prelude::*;
use cloth_solver::contact::SelfContacts;

use crate::events::{ClothTangled, ClothUntangled};
use crate::prepare::StepPlan;
use crate::report::report;
use crate::sleep::ClothAsleep;

/// The cloth was told to be tangled.
#[derive(Component, Clone, Copy, Debug)]
#[component(clone_behavior = Ignore)]
pub(crate) struct Tangled;

/// Tells which cloths have begun or ceased in this tick to pass through themselves. One that nobody watches any more is not said
/// to be tangled.
pub(crate) fn tell(
    cloths: Query<
        (Entity, Option<&SelfContacts>, Has<Tangled>, &StepPlan),
        (Or<(With<SelfContacts>, With<Tangled>)>, Without<ClothAsleep>),
    >,
    mut commands: Commands,
) {
    for (entity, own, was_tangled, plan) in &cloths {
        let crossings = own.map_or(0, SelfContacts::tangled) as u32;
        match (crossings > 0, was_tangled) {
            (true, false) if plan.substeps > 0 => {
                commands.entity(entity).try_insert(Tangled);
                report(&mut commands, ClothTangled { entity, crossings });
            }
            (false, true) if plan.substeps > 0 || own.is_none() => {
                commands.entity(entity).try_remove::<Tangled>();
                report(&mut commands, ClothUntangled { entity });
            }
            _ => {}
        }
    }
}
