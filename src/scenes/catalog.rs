//! The scenes of the game by name.

use cloth_scene::Scene;

/// A scene of the game.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The name of its file, without ending.
    pub name: &'static str,
    /// The file.
    ron: &'static str,
    /// A small picture of it, PNG.
    pub picture: Option<&'static [u8]>,
}

macro_rules! entry {
    ($name:literal) => {
        Entry { name: $name, ron: include_str!(concat!("../../assets/scenes/", $name, ".ron")), picture: None }
    };
    ($name:literal, picture) => {
        Entry { picture: Some(include_bytes!(concat!("../../assets/menu/", $name, ".png"))), ..entry!($name) }
    };
}

/// The name of the scene that opens without `--scene`.
pub const SANDBOX: &str = "sandbox";

/// The scenes of the menu, inside the program: it runs wherever it is started from. They are on the number keys, the tenth on 0.
pub const MENU: [Entry; 10] = [
    entry!("sandbox", picture),
    entry!("flag", picture),
    entry!("laundry", picture),
    entry!("tablecloth", picture),
    entry!("curtains", picture),
    entry!("fire_test", picture),
    entry!("trampoline", picture),
    entry!("tearing", picture),
    entry!("side_by_side", picture),
    entry!("mannequin", picture),
];

/// Plain scenes, most of them the lab's.
pub const MORE: [Entry; 9] = [
    entry!("burning_curtain"),
    entry!("flag_in_wind"),
    entry!("towel_on_box"),
    entry!("curtain"),
    entry!("top_hung"),
    entry!("corner_hung"),
    entry!("weight_on_corner"),
    entry!("swing"),
    entry!("drape_on_sphere"),
];

/// The names, for the command line's help.
pub fn names() -> String {
    let names: Vec<&str> = MENU.iter().chain(&MORE).map(|entry| entry.name).collect();
    names.join(", ")
}

impl Entry {
    /// The scene. The files of the game are checked by a test; one that is wrong gives an empty scene.
    pub fn scene(&self) -> Box<Scene> {
        Box::new(Scene::from_ron(self.ron).unwrap_or_default())
    }
}

/// The scene of that name, or in the file of that path (`.ron`).
pub fn open(text: &str) -> Result<Box<Scene>, String> {
    let ron = match MENU.iter().chain(&MORE).find(|entry| entry.name == text) {
        Some(entry) => entry.ron.to_string(),
        None if text.ends_with(".ron") => std::fs::read_to_string(text).map_err(|error| error.to_string())?,
        None => {
            return Err(format!("there is no scene of that name; there are {}, or a path that ends in .ron", names()));
        }
    };
    Scene::from_ron(&ron).map(Box::new).map_err(|error| error.to_string())
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
        let mut names: Vec<String> = MENU.iter().chain(&MORE).map(|entry| entry.name.to_string()).collect();
        files.sort_unstable();
        names.sort_unstable();
        assert_eq!(files, names);
        for name in names {
            let scene = open(&name).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(!scene.title.is_empty() && !scene.about.is_empty(), "{name}");
        }
    }

    #[test]
    fn what_cannot_be_opened_says_why() {
        let why = |text| open(text).expect_err("refused");
        assert!(why("circus").contains("sandbox, flag"), "{}", why("circus"));
        assert!(why("no/such/file.ron").contains("No such file"), "{}", why("no/such/file.ron"));
    }
}
