//! Editing a component or resource in place, without touching it where nothing changes.

use bevy::ecs::component::Mutable;
use bevy::prelude::*;
use bevy_cloth::Shared;

/// Lets `change` work on a copy of the component, and writes it back only if it differs, so that nothing counts as
/// changed because it was looked at.
pub fn edit<C>(world: &mut World, entity: Entity, change: impl FnOnce(&mut C))
where
    C: Component<Mutability = Mutable> + Clone + PartialEq,
{
    let Some(before) = world.get::<C>(entity).cloned() else { return };
    let mut after = before.clone();
    change(&mut after);
    if after != before
        && let Some(mut component) = world.get_mut::<C>(entity)
    {
        *component = after;
    }
}

/// As [`edit`], for a resource.
pub fn edit_resource<R>(world: &mut World, change: impl FnOnce(&mut R))
where
    R: Resource<Mutability = Mutable> + Clone + PartialEq,
{
    let Some(before) = world.get_resource::<R>().cloned() else { return };
    let mut after = before.clone();
    change(&mut after);
    if after != before {
        *world.resource_mut::<R>() = after;
    }
}

/// Edits the component of `cloth` if it has one, else the resource shared by all.
pub fn edit_own_or_shared<C>(world: &mut World, cloth: Option<Entity>, change: impl FnOnce(&mut C))
where
    C: Component<Mutability = Mutable> + Clone + PartialEq + Default + std::fmt::Debug,
    Shared<C>: Resource<Mutability = Mutable>,
{
    match cloth.filter(|entity| world.entity(*entity).contains::<C>()) {
        Some(entity) => edit(world, entity, change),
        None => edit_resource(world, |shared: &mut Shared<C>| change(&mut shared.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Component, Clone, PartialEq, Debug)]
    struct Value(f32);

    #[test]
    fn looking_at_a_component_is_no_change_and_editing_it_is_one() {
        let mut world = World::new();
        let entity = world.spawn(Value(1.0)).id();
        world.clear_trackers();
        edit(&mut world, entity, |value: &mut Value| value.0 = 1.0);
        assert!(!world.entity(entity).get_ref::<Value>().expect("there").is_changed());
        edit(&mut world, entity, |value: &mut Value| value.0 = 2.0);
        let value = world.entity(entity).get_ref::<Value>().expect("there");
        assert!(value.is_changed());
        assert_eq!(*value, Value(2.0));
    }

    #[test]
    fn what_is_not_there_is_not_edited() {
        let mut world = World::new();
        let entity = world.spawn_empty().id();
        edit(&mut world, entity, |_: &mut Value| panic!("there is no component"));
    }
}
