//! How every scene looks: sun, soft sky, haze towards the horizon.

use bevy::asset::RenderAssetUsages;
use bevy::light::{CascadeShadowConfigBuilder, NotShadowCaster, NotShadowReceiver};
use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;

/// Colour of the sky at the horizon, into which the ground fades.
const HORIZON: Color = Color::srgb(0.80, 0.83, 0.86);
/// Colour of the sky overhead.
const ZENITH: Color = Color::srgb(0.45, 0.58, 0.74);
/// Light that the ground throws back.
const GROUND_BOUNCE: Color = Color::srgb(0.50, 0.47, 0.44);
/// Distances between which the ground fades into the horizon, m.
const HAZE: (f32, f32) = (7.0, 24.0);
/// Radius of the sphere the sky is painted on, m.
const SKY_RADIUS: f32 = 80.0;

/// Adds light and sky.
pub struct LookPlugin;

impl Plugin for LookPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(ClearColor(HORIZON))
            .insert_resource(GlobalAmbientLight::NONE)
            .add_systems(Startup, (spawn_sun, spawn_sky));
    }
}

/// What a camera needs to see haze and the light of the sky.
pub fn atmosphere(images: &mut Assets<Image>) -> impl Bundle {
    (
        DistanceFog { color: HORIZON, falloff: FogFalloff::Linear { start: HAZE.0, end: HAZE.1 }, ..default() },
        EnvironmentMapLight {
            intensity: 520.0,
            ..EnvironmentMapLight::hemispherical_gradient(images, ZENITH, HORIZON, GROUND_BOUNCE)
        },
    )
}

fn spawn_sun(mut commands: Commands) {
    commands.spawn((
        Name::new("Sun"),
        DirectionalLight {
            illuminance: 9_000.0,
            color: Color::srgb(1.0, 0.96, 0.90),
            shadow_maps_enabled: true,
            ..default()
        },
        CascadeShadowConfigBuilder {
            num_cascades: 2,
            first_cascade_far_bound: 6.0,
            maximum_distance: 18.0,
            ..default()
        }
        .build(),
        Transform::from_xyz(-5.0, 5.5, 2.6).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

/// A sphere around everything, painted from the horizon up to the zenith.
fn spawn_sky(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let mut sky = Sphere::new(SKY_RADIUS).mesh().uv(16, 24);
    let (horizon, zenith) = (LinearRgba::from(HORIZON), LinearRgba::from(ZENITH));
    let colors: Vec<[f32; 4]> = match sky.attribute(Mesh::ATTRIBUTE_POSITION) {
        Some(VertexAttributeValues::Float32x3(positions)) => positions
            .iter()
            .map(|[_, y, _]| horizon.mix(&zenith, (y / SKY_RADIUS).clamp(0.0, 1.0)).to_f32_array())
            .collect(),
        _ => Vec::new(),
    };
    sky.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
    sky.asset_usage = RenderAssetUsages::RENDER_WORLD;
    commands.spawn((
        Name::new("Sky"),
        Mesh3d(meshes.add(sky)),
        MeshMaterial3d(materials.add(StandardMaterial {
            unlit: true,
            fog_enabled: false,
            cull_mode: None,
            ..default()
        })),
        NotShadowCaster,
        NotShadowReceiver,
        Pickable::IGNORE,
    ));
}
