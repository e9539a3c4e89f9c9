//! Saving and loading: authored components by reflection, the state of the cloths by `SavedCloths`. The loaded game goes on to the last bit.

use std::error::Error;

use bevy::ecs::entity::{EntityHashMap, MapEntities};
use bevy::ecs::reflect::ReflectComponent;
use bevy::prelude::*;
use bevy::reflect::serde::{ReflectDeserializer, ReflectSerializer};
use bevy::time::TimeUpdateStrategy;
use bevy_cloth::{Air, Cloth, ClothCollider, ClothPlugin, Fabric, Particles, Pins, SavedCloths, Wind};
use serde::de::DeserializeSeed;

/// A saved game: of each entity its number and its components, and the cloths' state.
type Save = (Vec<(u64, Vec<String>)>, SavedCloths);

/// What is saved of each entity. All that is authored reflects.
const COMPONENTS: [&str; 7] = ["Transform", "Cloth", "Fabric", "Pins", "Air", "Wind", "ClothCollider"];

fn game() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, ClothPlugin::default()));
    app.register_type::<Transform>().insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    // The first update only starts the clock.
    app.update();
    app
}

fn save(world: &World) -> Result<Save, ron::Error> {
    let registry = world.resource::<AppTypeRegistry>().read();
    let mut entities = Vec::new();
    for entity in
        world.iter_entities().filter(|entity| entity.contains::<Cloth>() || entity.contains::<ClothCollider>())
    {
        let of_type = |name| registry.get_with_short_type_path(name)?.data::<ReflectComponent>()?.reflect(entity);
        let components = COMPONENTS.into_iter().filter_map(of_type);
        let written =
            components.map(|value| ron::to_string(&ReflectSerializer::new(value.as_partial_reflect(), &registry)));
        entities.push((entity.id().to_bits(), written.collect::<Result<_, _>>()?));
    }
    Ok((entities, SavedCloths::take(world)))
}

fn load(world: &mut World, (entities, mut cloths): Save) -> Result<EntityHashMap<Entity>, Box<dyn Error>> {
    let registry = world.resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let mut map = EntityHashMap::default();
    for (number, components) in entities {
        let mut entity = world.spawn_empty();
        map.insert(Entity::from_bits(number), entity.id());
        for text in components {
            let value = ReflectDeserializer::new(&registry).deserialize(&mut ron::Deserializer::from_str(&text)?)?;
            let of_type = value.get_represented_type_info().and_then(|info| registry.get(info.type_id()));
            let component = of_type.and_then(|of_type| of_type.data::<ReflectComponent>()).ok_or("no component")?;
            component.insert(&mut entity, value.as_partial_reflect(), &registry);
        }
    }
    cloths.map_entities(&mut map);
    cloths.restore(world)?;
    Ok(map)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut first = game();
    let wind = Wind(Vec3::new(0.0, 0.0, 4.0));
    let curtain = (Cloth::rectangle(1.0, 1.0), Fabric::VOILE, Pins::rods(4), Air::default(), wind);
    let curtain = first.world_mut().spawn(curtain).id();
    first.world_mut().spawn((ClothCollider::Sphere { radius: 0.2 }, Transform::from_xyz(0.0, -0.2, 0.25)));
    (0..60).for_each(|_| first.update());
    let text = ron::to_string(&save(first.world())?)?;
    println!("saved in {} kB; it begins: {:.200}", text.len() / 1000, text);

    let mut second = game();
    let map = load(second.world_mut(), ron::from_str(&text)?)?;
    (0..60).for_each(|_| [&mut first, &mut second].into_iter().for_each(App::update));
    let position = |app: &App, cloth| app.world().get::<Particles>(cloth).map(|particles| particles.position.clone());
    assert!(position(&first, curtain).is_some() && position(&first, curtain) == position(&second, map[&curtain]));
    println!("a second later the loaded game is the same to the last bit");
    Ok(())
}
