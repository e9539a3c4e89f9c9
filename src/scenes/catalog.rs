//! The scenes by name, and those in files.

use cloth_scene::Scene as SceneFile;

/// What can be opened with `--scene`.
#[derive(Clone, Debug, PartialEq)]
pub enum Scene {
    /// A curtain on a rod, with a sphere, a pyramid and a capsule to push through it, and a fan.
    Sandbox,
    /// A scene file.
    File(Box<SceneFile>),
}

/// The name of the scene that opens without `--scene`.
pub const SANDBOX: &str = "sandbox";

/// The scene files of the game by name, inside the program: it runs wherever it is started from.
pub const FILES: [(&str, &str); 10] = [
    ("top_hung", include_str!("../../assets/scenes/top_hung.ron")),
    ("corner_hung", include_str!("../../assets/scenes/corner_hung.ron")),
    ("weight_on_corner", include_str!("../../assets/scenes/weight_on_corner.ron")),
    ("swing", include_str!("../../assets/scenes/swing.ron")),
    ("drape_on_sphere", include_str!("../../assets/scenes/drape_on_sphere.ron")),
    ("tablecloth", include_str!("../../assets/scenes/tablecloth.ron")),
    ("towel_on_box", include_str!("../../assets/scenes/towel_on_box.ron")),
    ("curtain", include_str!("../../assets/scenes/curtain.ron")),
    ("flag_in_wind", include_str!("../../assets/scenes/flag_in_wind.ron")),
    ("burning_curtain", include_str!("../../assets/scenes/burning_curtain.ron")),
];

/// The names, for the command line's help.
pub fn names() -> String {
    let names: Vec<&str> = std::iter::once(SANDBOX).chain(FILES.iter().map(|(name, _)| *name)).collect();
    names.join(", ")
}

/// The scene of that name, or in the file of that path (`.ron`).
pub fn open(text: &str) -> Result<Scene, String> {
    if text == SANDBOX {
        return Ok(Scene::Sandbox);
    }
    let ron = match FILES.iter().find(|(name, _)| *name == text) {
        Some((_, ron)) => (*ron).to_string(),
        None if text.ends_with(".ron") => std::fs::read_to_string(text).map_err(|error| error.to_string())?,
        None => {
            return Err(format!("there is no scene of that name; there are {}, or a path that ends in .ron", names()));
        }
    };
    SceneFile::from_ron(&ron).map(|scene| Scene::File(Box::new(scene))).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_file_of_the_repository_is_in_the_program_and_opens() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/scenes");
        let mut files: Vec<String> = std::fs::read_dir(folder)
            .expect("the folder is there")
            .map(|entry| entry.expect("readable").path().file_stem().expect("a name").to_string_lossy().into_owned())
            .collect();
        let mut names = FILES.map(|(name, _)| name.to_string()).to_vec();
        files.sort_unstable();
        names.sort_unstable();
        assert_eq!(files, names);
        for name in names {
            assert!(matches!(open(&name), Ok(Scene::File(_))), "{name}");
        }
    }

    #[test]
    fn what_cannot_be_opened_says_why() {
        let why = |text| open(text).expect_err("refused");
        assert!(why("circus").contains("sandbox, top_hung"), "{}", why("circus"));
        assert!(why("no/such/file.ron").contains("No such file"), "{}", why("no/such/file.ron"));
    }
}
