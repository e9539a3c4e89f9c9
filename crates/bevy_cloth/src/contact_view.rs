//! Where a cloth touches, is about to, and passes through itself: listed for debug views.

use bevy::prelude::*;
use cloth_solver::contact::{ContactPoint, Contacts, SelfContacts};
use cloth_solver::{Particles, measure};

use crate::cloth::ClothTopology;
use crate::groups::Groups;
use crate::prepare::StepPlan;
use crate::schedule::ClothSystems;

/// Put this on a [`Cloth`](crate::Cloth) to have listed in [`ContactLists`], after every frame in which it moved, where it touches. For
/// debug views: `bevy_cloth_inspector` draws the lists. Without it nothing is listed and nothing is computed.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
#[require(ContactLists)]
pub struct ContactView {
    /// Lists the pairs of features that may come near each other. Needs [`SelfContact`](crate::SelfContact). Default `true`.
    pub candidates: bool,
    /// Lists where it touches solids, itself and other cloths. Default `true`.
    pub contacts: bool,
    /// Lists the edges that pass through a triangle of the same cloth, also without [`SelfContact`](crate::SelfContact). Takes a
    /// millisecond for 8,000 triangles. Default `true`.
    pub crossings: bool,
}

impl Default for ContactView {
    fn default() -> Self {
        Self { candidates: true, contacts: true, crossings: true }
    }
}

/// What [`ContactView`] lists, all in the cloth's own frame: [`ClothFrame::to_world`](crate::ClothFrame::to_world) takes it to the world.
/// Read-only; what is not asked for is empty.
#[derive(Component, Clone, Debug, Default, PartialEq)]
#[component(clone_behavior = Ignore)]
pub struct ContactLists {
    /// The nearest points of each pair of features that may come near each other, m.
    pub candidates: Vec<[Vec3; 2]>,
    /// Where it touches solids (particles only), itself and other cloths.
    pub contacts: Vec<ContactPoint>,
    /// Edges that pass through a triangle.
    pub crossings: Vec<Crossing>,
}

/// An edge that passes through a triangle, cloth frame, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The ends of the edge.
    pub edge: [Vec3; 2],
    /// The corners of the triangle.
    pub triangle: [Vec3; 3],
}

/// Lists what is asked for of the cloths that moved.
fn list(
    mut cloths: Query<
        (
            Entity,
            &ContactView,
            &mut ContactLists,
            (&ClothTopology, &Particles, &Contacts, Option<&SelfContacts>),
            &StepPlan,
        ),
        Or<(Changed<ContactView>, Changed<Particles>, Changed<ClothTopology>)>,
    >,
    groups: Res<Groups>,
) {
    for (entity, view, mut lists, (topology, particles, contacts, own), plan) in &mut cloths {
        let group = plan.group.and_then(|group| groups.contacts_of(group, entity)).filter(|_| own.is_some());
        let mut found = ContactLists::default();
        if view.candidates {
            found.candidates = match (group, own) {
                (Some((group, index)), _) => group.candidate_lines(index),
                (None, Some(own)) => own.candidate_lines(),
                (None, None) => Vec::new(),
            };
        }
        if view.contacts {
            found.contacts = contacts.points(topology, particles);
            found.contacts.extend(match (group, own) {
                (Some((group, index)), _) => group.contact_points(index),
                (None, Some(own)) => own.contact_points(),
                (None, None) => Vec::new(),
            });
        }
        if view.crossings {
            let at = |slot: u32| particles.position.get(slot as usize);
            let crossing = |passage: measure::Passage| Crossing {
                edge: passage.edge.map(at),
                triangle: topology.triangles[passage.triangle as usize].map(at),
            };
            found.crossings = measure::crossings(topology, particles).into_iter().map(crossing).collect();
        }
        lists.set_if_neq(found);
    }
}

fn on_removed(removed: On<Remove, ContactView>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<ContactLists>();
}

/// Adds the systems of this file.
pub(crate) fn plugin(app: &mut App) {
    app.register_type::<ContactView>()
        .add_systems(PostUpdate, list.run_if(any_with_component::<ContactView>).in_set(ClothSystems::Draw))
        .add_observer(on_removed);
}
