//! The demo opens scenes by name and from files, and says what is wrong with one instead of starting.

use std::path::PathBuf;
use std::process::{Command, Output};

fn demo(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cloth_demo"))
        .args(arguments)
        // Wherever it is started.
        .current_dir(std::env::temp_dir())
        .output()
        .expect("the demo starts")
}

fn refused(scene: &str) -> String {
    let output = demo(&["--scene", scene]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    String::from_utf8(output.stderr).expect("text")
}

fn written(name: &str, text: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("{}-{name}.ron", std::process::id()));
    std::fs::write(&path, text).expect("writable");
    path
}

#[test]
fn the_help_names_every_scene() {
    let output = demo(&["--help"]);
    assert!(output.status.success());
    let help = String::from_utf8(output.stdout).expect("text");
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/scenes")).expect("the folder is there")
    {
        let path = entry.expect("readable").path();
        let name = path.file_stem().expect("a name").to_string_lossy();
        assert!(help.contains(&*name), "{name} is missing in\n{help}");
    }
}

#[test]
fn a_scene_that_cannot_be_opened_ends_the_demo_with_the_reason() {
    assert!(refused("circus").contains("sandbox"));
    assert!(refused("no/such/file.ron").contains("No such file"));
    let unknown = written("unknown", "(\n  wnid: (1, 0, 0),\n)");
    let error = refused(unknown.to_str().expect("a path"));
    assert!(error.contains("line 3") || error.contains("line 2"), "{error}");
    assert!(error.contains("wnid"), "{error}");
    let negative = written("negative", "(cloths: [(size: (1, -1))])");
    let error = refused(negative.to_str().expect("a path"));
    assert!(error.contains("cloth 0: `Cloth::size.y` is -1"), "{error}");
    for path in [unknown, negative] {
        std::fs::remove_file(path).expect("removable");
    }
}
