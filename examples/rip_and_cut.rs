//! A cloth on a rod rips under a weight that is too heavy for it; after two seconds a blade goes across what hangs. The log tells
//! what happens. Pull with the left mouse button, cut with the right one.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::common_conditions::once_after_delay;
use bevy_cloth::{
    Air, Cloth, ClothCollider, ClothCut, ClothPlugin, ClothTorn, CutCloth, Fabric, PiecesSeparated, PinSelect, Pins,
    Tearable, Weights,
};

/// Where the camera is; the blade is swept from there.
const EYE: Vec3 = Vec3::new(0.6, 0.2, 2.8);

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugin::default()))
        .add_systems(Startup, setup)
        .add_systems(Update, cut.run_if(once_after_delay(Duration::from_secs(2))))
        .add_observer(|torn: On<ClothTorn>| info!("torn at {}, overload {:.2}", torn.position, torn.overload))
        .add_observer(|cut: On<ClothCut>| info!("cut at {}, {} edges long", cut.position, cut.edges))
        .add_observer(|apart: On<PiecesSeparated>| info!("{} pieces", apart.pieces))
        .run()
}

fn setup(mut commands: Commands, mut materials: ResMut<Assets<StandardMaterial>>) {
    // 4 kg on a patch of the lower edge.
    let patch = PinSelect::Region { min: Vec3::new(-0.1, -0.51, -0.1), max: Vec3::new(0.1, -0.45, 0.1) };
    commands.spawn((
        Cloth::rectangle(1.4, 1.0),
        Fabric::COTTON_POPLIN,
        Pins::top(),
        Tearable::default(),
        Air::default(),
        Weights::one(patch, 4.0),
        MeshMaterial3d(materials.add(Color::srgb(0.75, 0.7, 0.55))),
        // Lifted a little, so that it swings; a sheet that moves in its own plane only cannot fold.
        Transform::from_rotation(Quat::from_rotation_x(0.15)),
    ));
    commands.spawn((ClothCollider::Ground, Transform::from_xyz(0.0, -0.9, 0.0)));
    commands.spawn((Camera3d::default(), Transform::from_translation(EYE).looking_at(Vec3::ZERO, Vec3::Y)));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(2.0, 3.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

fn cut(cloths: Query<Entity, With<Cloth>>, mut commands: Commands) {
    let towards = |point: Vec3| Ray3d { origin: EYE, direction: Dir3::new(point - EYE).unwrap_or(Dir3::NEG_Z) };
    for entity in &cloths {
        let [from, to] = [Vec3::new(-0.8, 0.3, 0.0), Vec3::new(0.8, 0.1, 0.0)].map(towards);
        commands.trigger(CutCloth { entity, from, to, reach: 10.0 });
    }
}
