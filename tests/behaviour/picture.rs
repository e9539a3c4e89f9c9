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
use bevy_cloth::{
    Cloth, ClothColoring, ClothFlames, ClothLook, ClothPlugin, CutCloth, Flammable, IgniteCloth, Pattern, Pins,
    ResetCloth,
};
use cloth_cases::cases;

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

/// With pipelines compiled in the background, as games have them: what needs another pipeline is not drawn until that is there.
#[test]
fn cloth_is_seen_in_every_frame_whatever_happens_to_it() {
    for look in [None, Some(ClothLook::velvet(Color::srgb(0.0, 0.6, 0.0)))].into_iter().skip(cases(1, 0)) {
        let mut studio = Studio::filmed(Pins::top());
        let world = studio.app.world_mut();
        let cloth = world.query_filtered::<Entity, With<Cloth>>().single(world).expect("a cloth");
        world.entity_mut(cloth).insert(Flammable::default());
        if let Some(look) = look {
            world.entity_mut(cloth).insert(look);
        }
        studio.film_until_seen();
        studio.set_frame(Duration::from_secs_f64(1.0 / 60.0));
        let ray = |x: f32| Ray3d::new(Vec3::new(x, 0.2, 1.0), Dir3::NEG_Z);
        let happens: [(&str, &dyn Fn(&mut World)); 7] = [
            ("its colours tell stress", &|world| {
                world.entity_mut(cloth).insert(ClothColoring::Stress);
            }),
            ("its colours tell speed", &|world| {
                world.entity_mut(cloth).insert(ClothColoring::Speed);
            }),
            ("its material is shown again", &|world| {
                world.entity_mut(cloth).remove::<ClothColoring>();
            }),
            ("it is cut", &|world| {
                world.trigger(CutCloth { entity: cloth, from: ray(-0.6), to: ray(0.1), reach: 2.0 });
            }),
            ("it is put back", &|world| world.trigger(ResetCloth { entity: cloth })),
            ("it burns", &|world| {
                let position = Vec3::new(0.3, -0.4, 0.0);
                world.trigger(IgniteCloth { entity: cloth, position, radius: 0.05 });
            }),
            ("its look changes, if it has one", &|world| {
                if let Some(mut look) = world.get_mut::<ClothLook>(cloth) {
                    *look = ClothLook { pattern: Pattern::Check { width: 0.1 }, ..ClothLook::voile(Color::WHITE) };
                }
            }),
        ];
        for (what, happen) in happens {
            happen(studio.app.world_mut());
            for (frame, picture) in studio.film(cases(4, 8)).iter().enumerate() {
                let seen = picture.seen_share();
                assert!(seen > 0.9, "{look:?}: when {what}, {seen} of it is seen in frame {frame} after that");
            }
        }
    }
}

/// A cloth, a lamp and a camera, without a window.
struct Studio {
    app: App,
    target: Handle<Image>,
}

/// The pictures that arrived.
#[derive(Resource, Default)]
struct Arrived(Vec<Image>);

impl Studio {
    fn new(pins: Pins) -> Self {
        Self::with(pins, true)
    }

    /// With pipelines compiled in the background.
    fn filmed(pins: Pins) -> Self {
        Self::with(pins, false)
    }

    fn with(pins: Pins, synchronous_pipeline_compilation: bool) -> Self {
        let mut app = App::new();
        app.add_plugins((
            DefaultPlugins
                .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
                .set(RenderPlugin {
                    render_creation: RenderCreation::Manual(renderer()),
                    synchronous_pipeline_compilation,
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
        self.film(1).remove(0)
    }

    /// What is seen in the next frames.
    fn film(&mut self, frames: usize) -> Vec<Picture> {
        let arrive = |captured: On<ScreenshotCaptured>, mut arrived: ResMut<Arrived>| {
            arrived.0.push(captured.image.clone());
        };
        for _ in 0..frames {
            self.app.world_mut().spawn(Screenshot::image(self.target.clone())).observe(arrive);
            self.app.update();
        }
        for _ in 0..1000 {
            let arrived = &mut self.app.world_mut().resource_mut::<Arrived>().0;
            if arrived.len() == frames {
                return arrived.drain(..).map(|image| Picture::read(&image)).collect();
            }
            self.app.update();
        }
        panic!("no picture arrived from the renderer");
    }

    /// Waits until the pipelines of what is in sight are compiled.
    fn film_until_seen(&mut self) {
        self.picture(FRONT, FRONT);
        for _ in 0..600 {
            if self.film(1)[0].seen_share() > 0.9 {
                return;
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        panic!("the cloth is never seen");
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

/// Which pixels are not black, green or of the colours of fire, and how bright their green is, row by row from the top left.
struct Picture {
    is_seen: Vec<bool>,
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
            is_seen: colors.iter().map(|c| c.red.max(c.green).max(c.blue) > 0.001).collect(),
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

    /// The share of pixels that are not black where the cloth is.
    fn seen_share(&self) -> f32 {
        let seen = self.middle().filter(|i| self.is_seen[*i]).count();
        seen as f32 / self.middle().count() as f32
    }

    /// The pixels in the middle of the picture, where the cloth is.
    fn middle(&self) -> impl Iterator<Item = usize> {
        (0..self.is_seen.len()).filter(|i| {
            (i % WIDTH as usize).abs_diff(WIDTH as usize / 2) < 30
                && (i / WIDTH as usize).abs_diff(HEIGHT as usize / 2) < 30
        })
    }

    /// Number of pixels that are red to yellow.
    fn warm_pixels(&self) -> usize {
        self.is_warm.iter().filter(|is_warm| **is_warm).count()
    }

    /// Mean linear brightness of the middle of the picture, where the cloth is.
    fn brightness_of_cloth(&self) -> f32 {
        let pixels: Vec<f32> = self.middle().map(|i| self.brightness[i]).collect();
        pixels.iter().sum::<f32>() / pixels.len() as f32
    }
}
