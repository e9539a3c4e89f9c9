//! The scene as it was opened.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothCollider, Fan, ResetCloth};

use crate::select::Selectable;

/// Puts the scene back as it was opened: cloth, places and sizes of all objects, what was deleted; what was thrown or
/// duplicated goes. Settings, camera and time stay.
#[derive(Event, Clone, Copy, Debug)]
pub struct ResetScene;

/// Asks for the scene to be opened anew with all its settings, camera, time and colouring. The scenes answer it.
#[derive(Event, Clone, Copy, Debug)]
pub struct ReopenScene;

/// What came into the scene while it was played. It goes when the scene is reset.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct MadeInPlay;

/// What an object was like when the scene was opened.
#[derive(Component, Clone, Debug)]
pub struct Opened {
    /// `None` of what hangs on another object.
    place: Option<Transform>,
    fan: Option<Fan>,
    collider: Option<ClothCollider>,
    cloth: Option<Cloth>,
}

/// An object of the scene that was deleted.
#[derive(Component, Clone, Copy, Debug)]
pub struct Deleted;

pub fn plugin(app: &mut App) {
    app.add_systems(Last, note).add_observer(reset);
}

/// Notes what every object is like when it comes. Then another scene has opened, and what was deleted of the last one is
/// not wanted any more.
fn note(
    new: Query<
        (Entity, &Transform, Has<ChildOf>, Option<&Fan>, Option<&ClothCollider>, Option<&Cloth>),
        Added<Selectable>,
    >,
    (parents, made): (Query<&ChildOf>, Query<(), With<MadeInPlay>>),
    deleted: Query<Entity, (With<Deleted>, Allow<Disabled>)>,
    mut commands: Commands,
) {
    let mut opened = new.iter().filter(|(entity, ..)| !made.contains(parents.root_ancestor(*entity))).peekable();
    if opened.peek().is_none() {
        return;
    }
    deleted.iter().for_each(|entity| commands.entity(entity).despawn());
    for (entity, place, is_child, fan, collider, cloth) in opened {
        let place = (!is_child).then_some(*place);
        let opened = Opened { place, fan: fan.copied(), collider: collider.cloned(), cloth: cloth.cloned() };
        commands.entity(entity).try_insert(opened);
    }
}

/// The parts of an object that are put back.
type Parts = (
    &'static Opened,
    Option<&'static mut Transform>,
    Option<&'static mut Fan>,
    Option<&'static mut ClothCollider>,
    Option<&'static mut Cloth>,
);

/// Answers [`ResetScene`].
fn reset(
    _: On<ResetScene>,
    made: Query<Entity, With<MadeInPlay>>,
    deleted: Query<Entity, (With<Deleted>, Allow<Disabled>)>,
    mut objects: Query<Parts, Allow<Disabled>>,
    cloths: Query<Entity, (With<Cloth>, Allow<Disabled>)>,
    mut commands: Commands,
) {
    for entity in &made {
        commands.entity(entity).despawn();
    }
    for entity in &deleted {
        commands.entity(entity).remove::<Deleted>().remove_recursive::<Children, Disabled>();
    }
    for (opened, place, fan, collider, cloth) in &mut objects {
        put_back(place, opened.place.as_ref());
        put_back(fan, opened.fan.as_ref());
        put_back(collider, opened.collider.as_ref());
        put_back(cloth, opened.cloth.as_ref());
    }
    // What goes is a cloth no more by then, and is left alone.
    cloths.iter().for_each(|entity| commands.trigger(ResetCloth { entity }));
}

/// Puts a component back to what it was, if it is another.
fn put_back<T: Component<Mutability = bevy::ecs::component::Mutable> + Clone + PartialEq>(
    now: Option<Mut<T>>,
    before: Option<&T>,
) {
    if let (Some(mut now), Some(before)) = (now, before)
        && *now != *before
    {
        *now = before.clone();
    }
}
