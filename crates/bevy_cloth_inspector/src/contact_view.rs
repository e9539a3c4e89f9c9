//! The debug view of contact: what of it is drawn, how much there is, and the lines.

use bevy::prelude::*;
use bevy_cloth::{ClothFrame, ClothSystems, ContactLists, ContactView};
use bevy_egui::egui;

use crate::widgets;

/// Pairs that may come near each other.
const CANDIDATE: Color = Color::srgb(0.25, 0.55, 1.0);
/// Contacts and the way they push.
const CONTACT: Color = Color::srgb(0.15, 0.9, 0.25);
/// Edges that pass through a triangle, and the triangle.
const CROSSING: [Color; 2] = [Color::srgb(1.0, 0.1, 0.1), Color::srgb(1.0, 0.6, 0.1)];
/// Length of a normal, m.
const NORMAL: f32 = 0.02;
/// Width of the lines, pixels.
const WIDTH: f32 = 2.0;

/// The gizmos the debug view of contact is drawn with: change their [`GizmoConfig`] to change its width, or to hide it.
#[derive(Default, Reflect, GizmoConfigGroup)]
pub struct ContactGizmos;

/// Draws the debug view of every cloth with [`ContactView`].
pub struct ContactViewPlugin;

impl Plugin for ContactViewPlugin {
    fn build(&self, app: &mut App) {
        let config = GizmoConfig { line: GizmoLineConfig { width: WIDTH, ..default() }, depth_bias: -1.0, ..default() };
        app.insert_gizmo_config(ContactGizmos, config)
            .add_systems(PostUpdate, draw.run_if(any_with_component::<ContactView>).after(ClothSystems::Draw));
    }
}

fn draw(mut gizmos: Gizmos<ContactGizmos>, cloths: Query<(&ContactLists, &ClothFrame)>) {
    for (lists, frame) in &cloths {
        for ([from, to], color) in lines(lists, frame) {
            gizmos.line(from, to, color);
        }
    }
}

/// Every line that is drawn, in the world, m.
fn lines(lists: &ContactLists, frame: &ClothFrame) -> impl Iterator<Item = ([Vec3; 2], Color)> {
    let candidates = lists.candidates.iter().map(|line| (*line, CANDIDATE));
    let contacts = lists.contacts.iter().map(|contact| {
        let end = contact.point + NORMAL * contact.normal;
        ([contact.point, end], CONTACT)
    });
    let crossings = lists.crossings.iter().flat_map(|crossing| {
        let [a, b, c] = crossing.triangle;
        [(crossing.edge, CROSSING[0]), ([a, b], CROSSING[1]), ([b, c], CROSSING[1]), ([c, a], CROSSING[1])]
    });
    let to_world = |(line, color): ([Vec3; 2], Color)| (line.map(|point| frame.to_world(point)), color);
    candidates.chain(contacts).chain(crossings).map(to_world)
}

/// Switches for what is drawn of `cloth`, each with how much there is.
pub fn show(ui: &mut egui::Ui, world: &mut World, cloth: Entity) {
    let before = world.get::<ContactView>(cloth).copied();
    let off = ContactView { candidates: false, contacts: false, crossings: false };
    let mut view = before.unwrap_or(off);
    let count = |of: fn(&ContactLists) -> usize| world.get::<ContactLists>(cloth).map_or(0, of);
    let counts = [count(|l| l.candidates.len()), count(|l| l.contacts.len()), count(|l| l.crossings.len())];
    let switches = [
        (
            "candidates",
            "Blue: pairs of features of cloth that may come near each other. Needs self-contact.",
            &mut view.candidates,
        ),
        (
            "contacts",
            "Green: where particles touch a solid, and cloth touches cloth, and the way it is pushed.",
            &mut view.contacts,
        ),
        ("crossings", "Red and orange: edges that pass through a triangle of the same cloth.", &mut view.crossings),
    ];
    for ((label, hint, on), count) in switches.into_iter().zip(counts) {
        widgets::switch(ui, label, hint, on, false);
        if *on {
            widgets::reading(ui, "drawn", "How many there are at present.", count.to_string());
        }
    }
    if view == before.unwrap_or(off) {
        return;
    }
    match view == off {
        true => drop(world.entity_mut(cloth).remove::<ContactView>()),
        false => drop(world.entity_mut(cloth).insert(view)),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use bevy::time::TimeUpdateStrategy;
    use bevy_cloth::{Cloth, ClothCollider, ClothPlugin, SelfContact};

    use super::*;

    /// A sheet that has fallen on its edge onto the ground, with `SelfContact`.
    fn heap() -> (App, Entity) {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, ClothPlugin::default()));
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_micros(15625)));
        app.world_mut().spawn(ClothCollider::Ground);
        let tilted = Quat::from_rotation_x(0.15) * Quat::from_rotation_z(0.2);
        let place = Transform::from_xyz(3.0, 0.46, 0.0).with_rotation(tilted);
        let cloth = (Cloth::rectangle(0.4, 0.8).with_cells(10, 20), SelfContact::default(), place);
        let cloth = app.world_mut().spawn(cloth).id();
        (0..100).for_each(|_| app.update());
        (app, cloth)
    }

    fn drawn(app: &App, cloth: Entity) -> Vec<([Vec3; 2], Color)> {
        let entity = app.world().entity(cloth);
        entity.get::<ContactLists>().map_or(Vec::new(), |lists| lines(lists, entity.get().unwrap()).collect())
    }

    #[test]
    fn what_is_switched_on_is_drawn_where_the_cloth_is_and_nothing_else() {
        let (mut app, cloth) = heap();
        assert_eq!(drawn(&app, cloth), []);
        app.world_mut().entity_mut(cloth).insert(ContactView::default());
        app.update();
        let lists = app.world().get::<ContactLists>(cloth).unwrap().clone();
        assert!(lists.candidates.len() > 10 && lists.contacts.len() > 10, "{lists:?}");
        let all = drawn(&app, cloth);
        assert_eq!(all.len(), lists.candidates.len() + lists.contacts.len() + 4 * lists.crossings.len());
        let far = |point: &Vec3| point.distance(Vec3::new(3.0, 0.2, 0.0)) > 1.0;
        assert!(!all.iter().any(|(line, _)| line.iter().any(far)), "{all:?}");
        app.world_mut().entity_mut(cloth).insert(ContactView { candidates: false, crossings: false, contacts: true });
        app.update();
        let contacts = drawn(&app, cloth);
        assert!(contacts.len() > 10 && contacts.iter().all(|(_, color)| *color == CONTACT));
        app.world_mut().entity_mut(cloth).remove::<ContactView>();
        app.update();
        assert!(!app.world().entity(cloth).contains::<ContactLists>());
    }

    #[test]
    fn looking_at_the_switches_changes_nothing() {
        for view in [None, Some(ContactView::default())] {
            let mut world = World::new();
            let cloth = world.spawn(Cloth::default()).id();
            if let Some(view) = view {
                world.entity_mut(cloth).insert(view);
            }
            world.clear_trackers();
            let _ = egui::Context::default().run_ui(egui::RawInput::default(), |ui| show(ui, &mut world, cloth));
            let now = world.entity(cloth).get_ref::<ContactView>();
            assert_eq!(now.as_deref().copied(), view);
            assert!(now.is_none_or(|now| !now.is_changed()));
        }
    }
}
