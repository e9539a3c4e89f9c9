//! Pictures of what is played: one at a key, or every frame at a fixed rate.

use std::path::PathBuf;
use std::time::Duration;

use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::time::TimeUpdateStrategy;

/// Takes a picture of the window and writes it beside the program's working folder as `bevy_cloth-1.png`, counting up.
#[derive(Event, Clone, Copy, Debug)]
pub struct TakePicture;

/// Records every frame while the game is played.
pub struct RecordPlugin {
    /// The folder that the frames go to, made if it is not there; `None` records nothing.
    pub folder: Option<PathBuf>,
    /// Frames in a second of simulated time.
    pub rate: f64,
    /// After how many seconds of simulated time the program ends; `None` for never.
    pub seconds: Option<f32>,
}

#[derive(Resource)]
struct Recording {
    folder: PathBuf,
    frame: u32,
    last: Option<u32>,
}

impl Plugin for RecordPlugin {
    fn build(&self, app: &mut App) {
        app.add_observer(take_picture);
        let Some(folder) = &self.folder else { return };
        if let Err(error) = std::fs::create_dir_all(folder) {
            error!("cannot record to {}: {error}", folder.display());
            return;
        }
        let last = self.seconds.map(|seconds| (f64::from(seconds) * self.rate).round() as u32);
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / self.rate)))
            .insert_resource(Recording { folder: folder.clone(), frame: 0, last })
            .add_systems(Last, record);
    }
}

fn take_picture(_: On<TakePicture>, mut commands: Commands) {
    let free = (1..).map(|number| PathBuf::from(format!("bevy_cloth-{number}.png"))).find(|file| !file.exists());
    if let Some(file) = free {
        commands
            .spawn(Screenshot::primary_window())
            .observe(move |captured: On<ScreenshotCaptured>| write(&captured, &file));
    }
}

/// Asks for a picture of each frame.
fn record(mut recording: ResMut<Recording>, mut commands: Commands, mut exit: MessageWriter<AppExit>) {
    if recording.last.is_some_and(|last| recording.frame >= last) {
        // Two frames later all that were asked for have arrived.
        if recording.last.is_some_and(|last| recording.frame >= last + 2) {
            exit.write(AppExit::Success);
        }
        recording.frame += 1;
        return;
    }
    let file = recording.folder.join(format!("frame_{:05}.png", recording.frame));
    recording.frame += 1;
    commands
        .spawn(Screenshot::primary_window())
        .observe(move |captured: On<ScreenshotCaptured>| write(&captured, &file));
}

fn write(captured: &ScreenshotCaptured, file: &PathBuf) {
    let picture = captured.image.clone().try_into_dynamic().map_err(|error| error.to_string());
    match picture.and_then(|picture| picture.to_rgb8().save(file).map_err(|error| error.to_string())) {
        Ok(()) => info!("wrote {}", file.display()),
        Err(reason) => error!("cannot write {}: {reason}", file.display()),
    }
}
