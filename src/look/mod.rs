//! How a scene is lit and what is around it: sun, sky, light from all sides, haze, exposure, glow.

mod cubemap;
mod panel;
mod sky;

use bevy::asset::AssetEventSystems;
use bevy::camera::{Exposure, Hdr};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::light::{CascadeShadowConfigBuilder, Skybox};
use bevy::post_process::bloom::{Bloom, BloomCompositeMode, BloomPrefilter};
use bevy::prelude::*;
use bevy::render::view::{ColorGrading, ColorGradingGlobal, ColorGradingSection};
use bevy_cloth_inspector::InspectorAppExt;
use cloth_scene::{SceneView, Setting};

use cubemap::Cubemap;
use sky::Sky;
pub use sky::{fractal, hash};

/// Luminance of what is painted with 1, cd/m²: white at normal exposure.
const WHITE: f32 = 1000.0;
/// Light of the sun at noon, lx.
const SUNLIGHT: f32 = 8500.0;
/// Edge of a face of the sky that is seen, and of the map its light comes from, texels.
const FACES: (u32, u32) = (512, 32);
/// While it is changed all the time, as by a slider, the sky that is seen is painted so many times coarser; and it counts as changed for
/// so long, s.
const COARSER: u32 = 4;
const SETTLES: f64 = 0.3;
/// Distances between which the ground fades into the horizon, m; much farther in the open.
const HAZE: (f32, f32) = (9.0, 30.0);
/// What is brighter than this many times white glows: fire, and nothing that is lit.
const GLOWS: f32 = 3.0;

/// How the scene is shown. Changing it changes light and sky.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct View(pub SceneView);

/// Lights every scene as its [`View`] says.
pub struct LookPlugin;

impl Plugin for LookPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<View>()
            .insert_resource(ClearColor(Color::BLACK))
            .insert_resource(GlobalAmbientLight::NONE)
            .add_inspector_section("Scene", true, panel::show)
            .add_systems(Startup, spawn_sun);
        paint(app);
    }
}

/// Paints light and sky whenever that is due.
fn paint(app: &mut App) {
    app.init_resource::<Painted>()
        .init_resource::<Next>()
        .add_systems(PostUpdate, (show, paint_next.run_if(is_due)).chain().before(AssetEventSystems));
}

/// What was painted in the last frame. The renderer looks for the images of a camera's light before it takes up those that are new: shown
/// in the frame they are told in, they would not be there yet, and nothing that they light would be drawn.
#[derive(Resource, Default)]
struct Next(Option<(Skybox, EnvironmentMapLight, Exposure, Option<DistanceFog>)>);

/// When the sky was painted, s of real time, and whether coarsely.
#[derive(Resource, Clone, Copy, Debug, Default)]
struct Painted {
    at: Option<f64>,
    is_coarse: bool,
}

impl Painted {
    fn lately(&self, time: &Time<Real>) -> bool {
        self.at.is_some_and(|at| time.elapsed_secs_f64() - at < SETTLES)
    }
}

/// Whether light and sky are to be painted: they changed, or a camera is new, or what was painted coarsely has not changed since.
fn is_due(view: Res<View>, cameras: Query<(), Added<Seeing>>, painted: Res<Painted>, time: Res<Time<Real>>) -> bool {
    view.is_changed() || !cameras.is_empty() || painted.is_coarse && !painted.lately(&time)
}

/// The camera that sees sky and light.
#[derive(Component)]
pub struct Seeing;

/// What a camera needs to see the scene as it is to be shown.
pub fn eyes() -> impl Bundle {
    (
        Seeing,
        Hdr,
        Tonemapping::TonyMcMapface,
        // A little more contrast and colour than film: the light of a fine day.
        ColorGrading {
            global: ColorGradingGlobal { post_saturation: 1.12, exposure: 0.4, ..default() },
            midtones: ColorGradingSection { contrast: 1.06, ..default() },
            shadows: ColorGradingSection { contrast: 1.02, ..default() },
            ..default()
        },
        Bloom {
            intensity: 0.12,
            prefilter: BloomPrefilter { threshold: GLOWS, threshold_softness: 0.3 },
            composite_mode: BloomCompositeMode::Additive,
            ..Bloom::NATURAL
        },
    )
}

#[derive(Component)]
struct Sun;

fn spawn_sun(mut commands: Commands) {
    commands.spawn((
        Name::new("Sun"),
        Sun,
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        CascadeShadowConfigBuilder {
            num_cascades: 2,
            first_cascade_far_bound: 6.0,
            maximum_distance: 18.0,
            ..default()
        }
        .build(),
        Transform::default(),
    ));
}

/// Shows what was painted in the last frame, if anything was.
fn show(mut next: ResMut<Next>, cameras: Query<Entity, With<Seeing>>, mut commands: Commands) {
    let Some((sky, light, exposure, haze)) = next.0.take() else { return };
    for camera in &cameras {
        let mut camera = commands.entity(camera);
        camera.insert((sky.clone(), light.clone(), exposure));
        match &haze {
            Some(haze) => camera.insert(haze.clone()),
            None => camera.remove::<DistanceFog>(),
        };
    }
}

/// Paints sky and light anew, for the next frame.
fn paint_next(
    view: Res<View>,
    mut suns: Query<(&mut DirectionalLight, &mut Transform), With<Sun>>,
    mut images: ResMut<Assets<Image>>,
    mut painted: ResMut<Painted>,
    mut next: ResMut<Next>,
    time: Res<Time<Real>>,
) {
    *painted = Painted { at: Some(time.elapsed_secs_f64()), is_coarse: painted.lately(&time) };
    let view = &view.0;
    let sky = Sky::new(view);
    for (mut light, mut place) in &mut suns {
        let (towards, color, strength) = lamp(view, &sky);
        *place = Transform::IDENTITY.looking_to(-towards, Vec3::Y);
        light.color = Color::linear_rgb(color.x, color.y, color.z);
        light.illuminance = SUNLIGHT * strength;
    }
    let edge = if painted.is_coarse { FACES.0 / COARSER } else { FACES.0 };
    let seen = images.add(Cubemap::paint(edge, |at| sky.seen(at)).image());
    let (diffuse, glossy) = Cubemap::paint(FACES.1, |at| sky.lights(at)).light();
    let (diffuse_map, specular_map) = (images.add(diffuse), images.add(glossy));
    let brighter = view.exposure.exp2();
    let fade = match view.setting {
        Setting::Meadow => Some((40.0, 260.0)),
        Setting::Plain | Setting::Studio => Some(HAZE),
        Setting::Room => None,
    };
    let haze =
        sky.seen(Vec3::new(0.0, 0.0, -1.0)).lerp(sky.horizon, if view.setting == Setting::Meadow { 0.0 } else { 0.5 });
    let haze = if view.setting == Setting::Studio { sky.seen(Vec3::NEG_Z) } else { haze } * brighter;
    let haze = fade.map(|(start, end)| DistanceFog {
        color: Color::linear_rgb(haze.x, haze.y, haze.z),
        falloff: FogFalloff::Linear { start, end },
        ..default()
    });
    let sky = Skybox { image: Some(seen), brightness: WHITE, ..default() };
    let light = EnvironmentMapLight { diffuse_map, specular_map, intensity: WHITE, ..default() };
    next.0 = Some((sky, light, Exposure { ev100: Exposure::EV100_BLENDER - view.exposure }, haze));
}

/// The one light that throws shadows: direction towards it, colour and strength.
fn lamp(view: &SceneView, sky: &Sky) -> (Vec3, Vec3, f32) {
    match view.setting {
        Setting::Studio => {
            let day = (sky.horizon.element_sum() / 2.08).clamp(0.06, 1.0);
            (Vec3::new(-0.75, 1.25, 0.8).normalize(), Vec3::new(1.0, 0.97, 0.93), 0.62 * day)
        }
        // At night the moon stands where the sun will be.
        _ if sky.sun.y < -0.03 => (-sky.sun, sky.sunlight, 1.0),
        _ => (sky.sun.with_y(sky.sun.y.max(0.02)).normalize(), sky.sunlight, 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::time::TimeUpdateStrategy;
    use std::time::Duration;

    fn app() -> (App, Entity) {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default()))
            .init_asset::<Image>()
            .init_resource::<View>()
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(50)));
        paint(&mut app);
        let camera = app.world_mut().spawn(eyes()).id();
        (app, camera)
    }

    fn told(app: &mut App) -> Vec<AssetId<Image>> {
        let mut told = app.world_mut().resource_mut::<Messages<AssetEvent<Image>>>();
        told.drain().filter_map(|told| if let AssetEvent::Added { id } = told { Some(id) } else { None }).collect()
    }

    #[test]
    fn a_changed_sky_is_shown_once_the_renderer_has_its_images_and_the_old_one_until_then() {
        let (mut app, camera) = app();
        let images = |app: &App| {
            let camera = app.world().entity(camera);
            let (sky, light) = (camera.get::<Skybox>()?.image.as_ref()?, camera.get::<EnvironmentMapLight>()?);
            Some([sky, &light.diffuse_map, &light.specular_map].map(Handle::id))
        };
        for hour in [9.0, 12.0] {
            let old = images(&app);
            app.world_mut().resource_mut::<View>().0.hour = hour;
            app.update();
            assert_eq!(images(&app), old, "at {hour} h");
            let told = told(&mut app);
            app.update();
            let new = images(&app).expect("a sky");
            assert!(Some(new) != old && new.iter().all(|image| told.contains(image)), "at {hour} h");
        }
    }

    #[test]
    fn the_sky_is_painted_coarsely_while_it_is_changed_and_then_finely() {
        let (mut app, camera) = app();
        let edge = |app: &App| {
            let image = app.world().get::<Skybox>(camera).unwrap().image.as_ref().unwrap();
            app.world().resource::<Assets<Image>>().get(image).unwrap().width()
        };
        app.update();
        app.update();
        assert_eq!(edge(&app), FACES.0, "at once where it is new");
        for hour in [9.0, 9.1, 9.2] {
            app.world_mut().resource_mut::<View>().0.hour = hour;
            app.update();
            app.update();
            assert_eq!(edge(&app), FACES.0 / COARSER, "at {hour} h");
        }
        for _ in 0..10 {
            app.update();
        }
        assert_eq!(edge(&app), FACES.0);
    }
}
