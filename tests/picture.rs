//! Cloth is drawn: pictures rendered without a window, by software if there is no GPU, and looked at pixel by pixel.
//!
//! A green cloth of one square metre hangs before a black background. A camera looks at it from three metres, once
//! from the front and once from behind, and the only lamp shines from where the test puts it.

use std::panic::catch_unwind;
use std::time::Duration;

use bevy::camera::RenderTarget;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::TextureFormat;
use bevy::render::renderer::initialize_renderer;
use bevy::render::settings::{Backends, RenderCreation, RenderResources, WgpuSettings};
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::tasks::block_on;
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;
use bevy_cloth::{Cloth, ClothFlames, ClothPlugin, CutCloth, Flammable, IgniteCloth, Pins, ResetCloth};

const WIDTH: u32 = 320;
const HEIGHT: u32 = 240;
/// Distance of the camera from the cloth, m.
const DISTANCE: f32 = 3.0;
/// Pixels per metre at the distance of the cloth, for Bevy's default field of view of 45° over the height.
const PIXELS_PER_METRE: f32 = HEIGHT as f32 / (2.0 * DISTANCE * 0.414_213_56);
/// Frames after which shaders, textures and meshes must have reached the renderer.
const WARM_UP_FRAMES: usize = 4;
const FRONT: Vec3 = Vec3::new(0.0, 0.0, DISTANCE);
const BEHIND: Vec3 = Vec3::new(0.0, 0.0, -DISTANCE);

#[test]
fn cloth_is_drawn_where_it_is_and_nowhere_else() {
    let mut studio = Studio::new(Pins::top());
    let picture = studio.picture(FRONT, FRONT);
    let half = 0.5 * PIXELS_PER_METRE;
    assert!(picture.green_share(|offset| offset.abs().max_element() < half - 3.0) > 0.99, "holes in the cloth");
    assert_eq!(picture.green_share(|offset| offset.abs().max_element() > half + 3.0), 0.0, "cloth outside the cloth");
}

#[test]
fn both_faces_are_lit_by_the_light_on_their_side_only() {
    let mut studio = Studio::new(Pins::top());
    let [front, behind] = [FRONT, BEHIND].map(|side| studio.picture(side, side).brightness_of_cloth());
    let against_the_light = studio.picture(BEHIND, FRONT).brightness_of_cloth();
    assert!(front > 0.2, "the front is dark: {front}");
    assert!((0.8..1.25).contains(&(behind / front)), "front {front}, back {behind}");
    assert!(against_the_light < 0.2 * front, "the back is lit by a lamp on the other side: {against_the_light}");
}

#[test]
fn a_second_of_falling_is_seen() {
    let mut studio = Studio::new(Pins::region(Vec3::new(-0.51, 0.45, -0.1), Vec3::new(-0.45, 0.51, 0.1)));
    let before = studio.picture(FRONT, FRONT);
    studio.run(Duration::from_secs(1));
    let after = studio.picture(FRONT, FRONT);
    let changed = before.is_green.iter().zip(&after.is_green).filter(|(before, after)| before != after).count();
    let cloth = before.is_green.iter().filter(|is_green| **is_green).count();
    assert!(changed * 5 > cloth, "only {changed} of {cloth} pixels changed");
    let corner = |offset: Vec2| offset.distance(Vec2::new(-0.5, 0.5) * PIXELS_PER_METRE) < 6.0;
    assert!(after.green_share(corner) > 0.1, "the pinned corner is not where it was");
}

#[test]
fn flames_are_seen_and_light_the_cloth() {
    let mut studio = Studio::new(Pins::top());
    // The lamp is behind the cloth, so that the front is dark.
    let dark = studio.picture(FRONT, BEHIND);
    let world = studio.app.world_mut();
    let cloth = world.query_filtered::<Entity, With<Cloth>>().single(world).expect("a cloth");
    world.entity_mut(cloth).insert(Flammable::default());
    let lighter = IgniteCloth { entity: cloth, position: Vec3::new(0.0, -0.5, 0.0), radius: 0.1 };
    studio.app.update();
    studio.app.world_mut().trigger(lighter);
    studio.run(Duration::from_millis(500));
    let burning = studio.picture(FRONT, BEHIND);
    studio.app.world_mut().entity_mut(cloth).insert(ClothFlames::Hidden);
    let hidden = studio.picture(FRONT, BEHIND);
    assert_eq!(dark.warm_pixels(), 0);
    assert!(burning.warm_pixels() > 100, "{} pixels of flame", burning.warm_pixels());
    assert!(hidden.warm_pixels() * 10 < burning.warm_pixels(), "{} are left of them", hidden.warm_pixels());
    let [lit, unlit] = [&burning, &hidden].map(Picture::brightness_of_cloth);
    assert!(lit > 1.5 * unlit.max(0.001), "by its flames {lit}, without {unlit}");
}

#[test]
fn a_cloth_that_is_cut_and_put_back_is_seen_in_every_frame() {
    let mut studio = Studio::new(Pins::top());
    studio.picture(FRONT, FRONT);
    let world = studio.app.world_mut();
    let cloth = world.query_filtered::<Entity, With<Cloth>>().single(world).expect("a cloth");
    studio.set_frame(Duration::from_millis(16));
    let ray = |x: f32| Ray3d::new(Vec3::new(x, 0.0, 1.0), Dir3::NEG_Z);
    let shown = studio.film(8, |world, frame| match frame {
        1 => world.trigger(CutCloth { entity: cloth, from: ray(-1.0), to: ray(1.0), reach: 5.0 }),
        4 => world.trigger(ResetCloth { entity: cloth }),
        _ => {}
    });
    let cloth = PIXELS_PER_METRE * PIXELS_PER_METRE;
    assert!(shown.iter().all(|pixels| *pixels as f32 > 0.8 * cloth), "{shown:?} of {cloth} pixels");
}

/// A cloth, a lamp and a camera, without a window.
struct Studio {
    app: App,
    target: Handle<Image>,
}

/// The picture that arrived last.
#[derive(Resource, Default)]
struct Arrived(Option<Image>);

/// How many pixels of each frame are green.
#[derive(Resource)]
struct Film(Vec<usize>);

impl Studio {
    fn new(pins: Pins) -> Self {
        let mut app = App::new();
        app.add_plugins((
            DefaultPlugins
                .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
                .set(RenderPlugin {
                    render_creation: RenderCreation::Manual(renderer()),
                    synchronous_pipeline_compilation: true,
                    ..default()
                })
                .disable::<WinitPlugin>()
                .disable::<LogPlugin>()
                .disable::<PipelinedRenderingPlugin>(),
            ClothPlugin::default(),
        ))
        .insert_resource(ClearColor(Color::BLACK))
        .insert_resource(GlobalAmbientLight::NONE)
        .init_resource::<Arrived>();
        app.finish();
        app.cleanup();

        let world = app.world_mut();
        let target = Image::new_target_texture(WIDTH, HEIGHT, TextureFormat::Rgba8UnormSrgb, None);
        let target = world.resource_mut::<Assets<Image>>().add(target);
        let green = StandardMaterial { base_color: Color::srgb(0.0, 1.0, 0.0), reflectance: 0.0, ..default() };
        let green = world.resource_mut::<Assets<StandardMaterial>>().add(green);
        world.spawn((Cloth::rectangle(1.0, 1.0).with_cells(20, 20), pins, MeshMaterial3d(green)));
        world.spawn((Camera3d::default(), Tonemapping::None, RenderTarget::from(target.clone())));
        world.spawn(DirectionalLight::default());
        let mut studio = Self { app, target };
        studio.run(Duration::from_millis(50));
        studio
    }

    /// Lets simulated time pass.
    fn run(&mut self, time: Duration) {
        const FRAMES_PER_SECOND: f64 = 60.0;
        self.set_frame(Duration::from_secs_f64(1.0 / FRAMES_PER_SECOND));
        for _ in 0..(time.as_secs_f64() * FRAMES_PER_SECOND).round() as usize {
            self.app.update();
        }
    }

    /// What a camera at one place sees by the light of a lamp at another, while time stands still.
    fn picture(&mut self, camera: Vec3, lamp: Vec3) -> Picture {
        self.set_frame(Duration::ZERO);
        let world = self.app.world_mut();
        let place = |from: Vec3| Transform::from_translation(from).looking_at(Vec3::ZERO, Vec3::Y);
        *world.query_filtered::<&mut Transform, With<Camera3d>>().single_mut(world).expect("a camera") = place(camera);
        *world.query_filtered::<&mut Transform, With<DirectionalLight>>().single_mut(world).expect("a lamp") =
            place(lamp);
        for _ in 0..WARM_UP_FRAMES {
            self.app.update();
        }
        let arrive = |captured: On<ScreenshotCaptured>, mut arrived: ResMut<Arrived>| {
            arrived.0 = Some(captured.image.clone());
        };
        self.app.world_mut().spawn(Screenshot::image(self.target.clone())).observe(arrive);
        for _ in 0..1000 {
            self.app.update();
            if let Some(image) = self.app.world_mut().resource_mut::<Arrived>().0.take() {
                return Picture::read(&image);
            }
        }
        panic!("no picture arrived from the renderer");
    }

    /// Shows so many frames, before each of which `act` is done, and counts the green pixels of each.
    fn film(&mut self, frames: usize, act: impl Fn(&mut World, usize)) -> Vec<usize> {
        self.app.insert_resource(Film(vec![0; frames]));
        for frame in 0..frames {
            act(self.app.world_mut(), frame);
            let arrive = move |captured: On<ScreenshotCaptured>, mut film: ResMut<Film>| {
                let picture = Picture::read(&captured.image);
                film.0[frame] = picture.is_green.iter().filter(|is_green| **is_green).count();
            };
            self.app.world_mut().spawn(Screenshot::image(self.target.clone())).observe(arrive);
            self.app.update();
        }
        self.picture(FRONT, FRONT);
        self.app.world().resource::<Film>().0.clone()
    }

    fn set_frame(&mut self, length: Duration) {
        self.app.insert_resource(TimeUpdateStrategy::ManualDuration(length));
    }
}

fn renderer() -> RenderResources {
    catch_unwind(|| block_on(initialize_renderer(Backends::VULKAN, None, &WgpuSettings::default()))).unwrap_or_else(
        |_| {
            panic!(
                "There is no Vulkan adapter. On a machine without a GPU install a software renderer; \
             on Debian and Ubuntu that is the package mesa-vulkan-drivers."
            )
        },
    )
}

/// Which pixels are green or of the colours of fire, and how bright their green is, row by row from the top left.
struct Picture {
    is_green: Vec<bool>,
    is_warm: Vec<bool>,
    brightness: Vec<f32>,
}

impl Picture {
    fn read(image: &Image) -> Self {
        let colors: Vec<LinearRgba> = (0..HEIGHT)
            .flat_map(|y| (0..WIDTH).map(move |x| (x, y)))
            .map(|(x, y)| image.get_color_at(x, y).expect("a readable pixel").to_linear())
            .collect();
        Self {
            is_green: colors.iter().map(|c| c.green > 0.002 && c.green > 3.0 * c.red.max(c.blue)).collect(),
            is_warm: colors.iter().map(|c| c.red > 0.05 && c.red > c.green && c.green > c.blue).collect(),
            brightness: colors.iter().map(|c| c.green).collect(),
        }
    }

    /// The share of green pixels among those whose offset from the middle (right and up, pixels) is chosen.
    fn green_share(&self, choose: impl Fn(Vec2) -> bool) -> f32 {
        let offset = |pixel: usize| {
            let (x, y) = (pixel as u32 % WIDTH, pixel as u32 / WIDTH);
            Vec2::new(x as f32 + 0.5 - WIDTH as f32 / 2.0, HEIGHT as f32 / 2.0 - y as f32 - 0.5)
        };
        let chosen: Vec<bool> =
            self.is_green.iter().enumerate().filter(|(i, _)| choose(offset(*i))).map(|(_, green)| *green).collect();
        assert!(!chosen.is_empty(), "no pixel was chosen");
        chosen.iter().filter(|green| **green).count() as f32 / chosen.len() as f32
    }

    /// Number of pixels that are red to yellow.
    fn warm_pixels(&self) -> usize {
        self.is_warm.iter().filter(|is_warm| **is_warm).count()
    }

    /// Mean linear brightness of the middle of the picture, where the cloth is.
    fn brightness_of_cloth(&self) -> f32 {
        let middle = |i: &usize| {
            (i % WIDTH as usize).abs_diff(WIDTH as usize / 2) < 30
                && (i / WIDTH as usize).abs_diff(HEIGHT as usize / 2) < 30
        };
        let pixels: Vec<f32> = (0..self.brightness.len()).filter(middle).map(|i| self.brightness[i]).collect();
        pixels.iter().sum::<f32>() / pixels.len() as f32
    }
}
