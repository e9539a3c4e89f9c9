//! Every authored component and resource is registered for reflection, with what an editor needs to make one.

use bevy::ecs::reflect::{ReflectComponent, ReflectResource};
use bevy::prelude::*;
use bevy::reflect::std_traits::ReflectDefault;
use bevy_cloth::*;

fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, ClothPlugin::default()));
    app
}

#[test]
fn every_authored_component_is_registered_with_its_default() {
    let app = app();
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let names = [
        "bevy_cloth::cloth::Cloth",
        "cloth_solver::fabric::Fabric",
        "bevy_cloth::pins::Pins",
        "cloth_solver::contact::cloth::SelfContact",
        "bevy_cloth::weights::Weights",
        "cloth_solver::forces::air::Air",
        "bevy_cloth::air::Wind",
        "cloth_solver::forces::gust::Gusts",
        "cloth_solver::forces::fan::Fan",
        "cloth_solver::forces::zone::WindZone",
        "bevy_cloth::collider::ClothCollider",
        "bevy_cloth::collider::ColliderFriction",
        "bevy_cloth::settings::Gravity",
        "bevy_cloth::settings::Substeps",
        "cloth_solver::method::Method",
        "bevy_cloth::settings::Grabs",
        "bevy_cloth::render::ClothColoring",
        "bevy_cloth::render::look::ClothLook",
        "bevy_cloth::stats::ClothStats",
        "bevy_cloth::teleport::Teleport",
        "bevy_cloth::sleep::ClothSleep",
        "bevy_cloth::contact::ContactEvents",
        "bevy_cloth::contact::ClothForce",
        "bevy_cloth::contact_view::ContactView",
    ];
    for name in names {
        let registration = registry.get_with_type_path(name).unwrap_or_else(|| panic!("{name} is not registered"));
        assert!(registration.data::<ReflectComponent>().is_some(), "{name} is not reflected as a component");
        assert!(registration.data::<ReflectDefault>().is_some(), "{name} has no reflected default");
    }
}

#[test]
fn every_resource_of_settings_is_registered_with_its_default() {
    let app = app();
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let names = [
        "bevy_cloth::settings::Shared<bevy_cloth::settings::Gravity>",
        "bevy_cloth::settings::Shared<bevy_cloth::settings::Substeps>",
        "bevy_cloth::settings::Shared<cloth_solver::method::Method>",
        "bevy_cloth::settings::Shared<bevy_cloth::air::Wind>",
        "bevy_cloth::settings::Shared<cloth_solver::forces::gust::Gusts>",
        "bevy_cloth::settings::Shared<bevy_cloth::render::ClothColoring>",
        "bevy_cloth::settings::Shared<bevy_cloth::teleport::Teleport>",
        "bevy_cloth::settings::Shared<bevy_cloth::sleep::ClothSleep>",
        "bevy_cloth::picking::ClothPicking",
        "bevy_time::time::Time<bevy_cloth::clock::ClothClock>",
    ];
    for name in names {
        let registration = registry.get_with_type_path(name).unwrap_or_else(|| panic!("{name} is not registered"));
        assert!(registration.data::<ReflectResource>().is_some(), "{name} is not reflected as a resource");
        assert!(registration.data::<ReflectDefault>().is_some(), "{name} has no reflected default");
        let entities = app.world().resource_entities();
        let id = app.world().components().get_id(registration.type_id()).expect("the plugin inserts it");
        assert!(entities.get(id).is_some(), "{name} is not in the world");
    }
}

#[test]
fn a_cloth_put_together_by_an_editor_runs() {
    let mut app = app();
    let entity = app.world_mut().spawn_empty().id();
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    for name in ["bevy_cloth::cloth::Cloth", "bevy_cloth::pins::Pins", "bevy_cloth::stats::ClothStats"] {
        let registration = registry.get_with_type_path(name).expect("registered");
        let value = registration.data::<ReflectDefault>().expect("default").default();
        let component = registration.data::<ReflectComponent>().expect("component");
        component.insert(&mut app.world_mut().entity_mut(entity), value.as_partial_reflect(), &registry);
    }
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(std::time::Duration::from_millis(50)));
    app.update();
    app.update();
    assert_eq!(app.world().get::<ClothStats>(entity).map(|stats| stats.particles), Some(41 * 41));
}
