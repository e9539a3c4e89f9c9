//! Fire, and a game that answers to it: a curtain is lit after a second. The log tells what happens, the light of the room turns red
//! while it burns, and when nothing is left that could burn a new curtain is hung. The middle mouse button lights, too.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::common_conditions::once_after_delay;
use bevy_cloth::{
    Air, Cloth, ClothBurntOut, ClothBurntThrough, ClothExtinguished, ClothIgnited, ClothPlugin, Fabric, Flammable,
    IgniteCloth, Pins, ResetCloth,
};

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugin::default()))
        .add_systems(Startup, setup)
        .add_systems(Update, light.run_if(once_after_delay(Duration::from_secs(1))))
        .add_observer(on_ignited)
        .add_observer(on_extinguished)
        .add_observer(on_burnt_out)
        .run()
}

fn setup(mut commands: Commands, mut materials: ResMut<Assets<StandardMaterial>>) {
    let mut curtain = commands.spawn((
        Cloth::rectangle(0.8, 1.0),
        Fabric::COTTON_POPLIN,
        Flammable::default(),
        Pins::top(),
        Air::default(),
        MeshMaterial3d(materials.add(Color::srgb(0.85, 0.8, 0.7))),
    ));
    // An observer of one entity hears of that one only.
    curtain.observe(|through: On<ClothBurntThrough>| {
        debug!("{} triangles burnt through at {}", through.triangles, through.position);
    });
    commands.spawn((Camera3d::default(), Transform::from_xyz(0.7, 0.2, 2.2).looking_at(Vec3::ZERO, Vec3::Y)));
    commands.spawn((DirectionalLight::default(), Transform::from_xyz(2.0, 3.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y)));
}

fn light(curtain: Single<Entity, With<Cloth>>, mut commands: Commands) {
    commands.trigger(IgniteCloth { entity: *curtain, position: Vec3::new(-0.2, -0.5, 0.0), radius: 0.05 });
}

fn on_ignited(ignited: On<ClothIgnited>, mut room: Single<&mut DirectionalLight>) {
    info!("it burns at {}", ignited.position);
    room.color = Color::srgb(1.0, 0.55, 0.4);
}

fn on_extinguished(extinguished: On<ClothExtinguished>, mut room: Single<&mut DirectionalLight>) {
    info!("the last flame went out at {}, and some is left", extinguished.position);
    room.color = Color::WHITE;
}

fn on_burnt_out(burnt_out: On<ClothBurntOut>, mut room: Single<&mut DirectionalLight>, mut commands: Commands) {
    info!("burnt out: a new one is hung");
    room.color = Color::WHITE;
    commands.trigger(ResetCloth { entity: burnt_out.entity });
}
