//! How wide the panel is and which sections are open, and the file that keeps it for the next run.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

use bevy::prelude::*;
use bevy::time::Real;
use serde::{Deserialize, Serialize};

/// The layout is written no more often than this.
const PAUSE: Duration = Duration::from_secs(1);

/// How wide the panel is and which sections are open. The user changes it by dragging and clicking.
#[derive(Resource, Reflect, Serialize, Deserialize, Clone, Debug, PartialEq)]
#[reflect(Resource, Default)]
#[serde(default)]
pub struct InspectorLayout {
    /// Width the user wants, logical pixels. The panel never takes more than a third of the window. Default 310.
    pub width: f32,
    /// By title: whether a section is open. A section that is not listed is as it is by default. Read when a section is shown for
    /// the first time.
    pub open: BTreeMap<String, bool>,
}

impl Default for InspectorLayout {
    fn default() -> Self {
        Self { width: 310.0, open: BTreeMap::new() }
    }
}

/// Insert this before the app starts to keep the [`InspectorLayout`] in this file (RON) from one run to the next. Without it
/// nothing is read or written.
#[derive(Resource, Clone, Debug)]
pub struct InspectorLayoutFile(pub PathBuf);

/// Reads the layout. No file is no error; a file that is no layout is left out with a warning.
pub fn load(file: Res<InspectorLayoutFile>, mut layout: ResMut<InspectorLayout>) {
    let Ok(text) = std::fs::read_to_string(&file.0) else { return };
    match ron::from_str(&text) {
        Ok(read) => *layout = read,
        Err(error) => warn!("{} is no layout of the inspector: {error}", file.0.display()),
    }
}

/// Writes the layout a moment after it changed, and when the app exits.
pub fn save(
    file: Res<InspectorLayoutFile>,
    layout: Res<InspectorLayout>,
    time: Res<Time<Real>>,
    exits: MessageReader<AppExit>,
    mut due: Local<Option<Duration>>,
) {
    if layout.is_changed() && !layout.is_added() && due.is_none() {
        *due = Some(time.elapsed() + PAUSE);
    }
    if due.is_none_or(|due| time.elapsed() < due && exits.is_empty()) {
        return;
    }
    *due = None;
    let text = ron::ser::to_string_pretty(&*layout, ron::ser::PrettyConfig::default());
    let written = text
        .map_err(|error| error.to_string())
        .and_then(|text| std::fs::write(&file.0, text).map_err(|error| error.to_string()));
    if let Err(error) = written {
        warn!("cannot write {}: {error}", file.0.display());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn app(file: PathBuf) -> App {
        let mut app = App::new();
        app.add_plugins(MinimalPlugins)
            .init_resource::<InspectorLayout>()
            .insert_resource(InspectorLayoutFile(file))
            .add_systems(PreStartup, load)
            .add_systems(Last, save);
        app
    }

    #[test]
    fn what_was_open_and_how_wide_is_known_in_the_next_run() {
        let file = std::env::temp_dir().join(format!("{}-layout.ron", std::process::id()));
        let _ = std::fs::remove_file(&file);
        let mut first = app(file.clone());
        first.update();
        assert!(!file.exists());
        first.world_mut().resource_mut::<InspectorLayout>().width = 250.0;
        first.world_mut().resource_mut::<InspectorLayout>().open.insert("Wind".into(), true);
        first.world_mut().write_message(AppExit::Success);
        first.update();
        let mut second = app(file.clone());
        second.update();
        assert_eq!(second.world().resource::<InspectorLayout>(), first.world().resource::<InspectorLayout>());
        std::fs::write(&file, "no layout").unwrap();
        let mut third = app(file.clone());
        third.update();
        assert_eq!(*third.world().resource::<InspectorLayout>(), InspectorLayout::default());
        std::fs::remove_file(file).unwrap();
    }
}
