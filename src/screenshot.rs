//! A picture of a scene at one simulated moment, taken without a window.
//!
//! Frames are 1/60 s of simulated time however long they take to compute, so that the same command gives the same
//! picture on a fast and on a slow machine. Nothing is drawn until the moment has come; then time stands still, a
//! few frames are drawn so that every texture, pipeline and shadow map is there, and the last one is written.

use std::path::PathBuf;
use std::time::Duration;

use bevy::app::ScheduleRunnerPlugin;
use bevy::camera::RenderTarget;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::render_resource::TextureFormat;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;

use crate::camera::Canvas;

/// Length of a frame, s.
const FRAME: f64 = 1.0 / 60.0;
/// Frames drawn before the picture is taken.
const WARM_UP_FRAMES: u32 = 8;
/// Frames after which a picture that has not arrived is given up.
const PATIENCE_FRAMES: u32 = 600;

/// Takes one picture and exits.
pub struct ScreenshotPlugin {
    /// Where the picture goes.
    pub file: PathBuf,
    /// When it is taken, simulated s.
    pub at: f32,
    /// Width and height in pixels.
    pub size: UVec2,
}

#[derive(Resource)]
struct Shot {
    file: PathBuf,
    at: Duration,
    frames_drawn: u32,
}

impl Plugin for ScreenshotPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(
            DefaultPlugins
                .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
                .set(RenderPlugin { synchronous_pipeline_compilation: true, ..default() })
                .disable::<WinitPlugin>(),
        )
        .add_plugins(ScheduleRunnerPlugin::run_loop(Duration::ZERO))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(FRAME)))
        .insert_resource(Shot { file: self.file.clone(), at: Duration::from_secs_f32(self.at), frames_drawn: 0 })
        .add_systems(Last, take);
        let picture = Image::new_target_texture(self.size.x, self.size.y, TextureFormat::Rgba8UnormSrgb, None);
        let picture = app.world_mut().resource_mut::<Assets<Image>>().add(picture);
        app.insert_resource(Canvas(RenderTarget::from(picture)));
    }
}

/// Waits for the moment, draws, and asks for the picture.
fn take(
    mut commands: Commands,
    mut shot: ResMut<Shot>,
    mut time: ResMut<Time<Virtual>>,
    mut cameras: Query<&mut Camera>,
    canvas: Res<Canvas>,
    mut exit: MessageWriter<AppExit>,
) {
    // Once time stands still it cannot come any nearer.
    let has_come = time.is_paused() || time.elapsed() + time.delta() / 2 >= shot.at;
    for mut camera in &mut cameras {
        if camera.is_active != has_come {
            camera.is_active = has_come;
        }
    }
    if !has_come {
        return;
    }
    time.pause();
    shot.frames_drawn += 1;
    if shot.frames_drawn == WARM_UP_FRAMES
        && let Some(picture) = canvas.0.as_image()
    {
        commands.spawn(Screenshot::image(picture.clone())).observe(write);
    }
    if shot.frames_drawn > PATIENCE_FRAMES {
        error!("no picture arrived from the renderer within {PATIENCE_FRAMES} frames");
        exit.write(AppExit::error());
    }
}

/// Writes the picture that has arrived and ends the program.
fn write(captured: On<ScreenshotCaptured>, shot: Res<Shot>, mut exit: MessageWriter<AppExit>) {
    let written = captured
        .image
        .clone()
        .try_into_dynamic()
        .map_err(|error| error.to_string())
        .and_then(|picture| picture.to_rgb8().save(&shot.file).map_err(|error| error.to_string()));
    exit.write(match written {
        Ok(()) => AppExit::Success,
        Err(reason) => {
            error!("cannot write {}: {reason}", shot.file.display());
            AppExit::error()
        }
    });
}
