//! What the command line says: scene, size, and whether to play or to take a picture.

use std::path::PathBuf;
use std::str::FromStr;

use bevy::math::UVec2;
use clap::{Parser, ValueEnum};

use crate::scenes;
use cloth_scene::Scene;

/// Cloth you can hang, drag and push things through.
///
/// Without options the sandbox opens in a window; press H there for the keys.
#[derive(Parser, Clone, Debug, PartialEq)]
#[command(name = "cloth_demo", version)]
pub struct Options {
    /// The scene to open.
    #[arg(
        long,
        value_name = "NAME|FILE.ron",
        value_parser = scenes::open,
        default_value = scenes::SANDBOX,
        help = format!("The scene to open: {}, or a scene file", scenes::names())
    )]
    pub scene: Box<Scene>,

    /// Size of the window or picture in pixels; left out, 1280x720.
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,

    /// Take a picture without opening a window, write it to FILE (.png) and exit.
    #[arg(long, value_name = "FILE", value_parser = png_path)]
    pub screenshot: Option<PathBuf>,

    /// Simulated time at which the picture is taken, in seconds.
    #[arg(long, value_name = "SECONDS", value_parser = seconds, default_value = "3", requires = "screenshot")]
    pub at: f32,

    /// Show the inspector in the picture, too.
    #[arg(long, requires = "screenshot")]
    pub ui: bool,

    /// Record every frame of what is played to DIR as frame_00000.png and so on.
    #[arg(long, value_name = "DIR", conflicts_with = "screenshot")]
    pub record: Option<PathBuf>,

    /// Frames recorded in a second of simulated time.
    #[arg(long, value_name = "HZ", value_parser = clap::value_parser!(u32).range(1..=240), default_value_t = 30, requires = "record")]
    pub rate: u32,

    /// Simulated time after which recording and program end, in seconds; left out, they go on.
    #[arg(long, value_name = "SECONDS", value_parser = seconds, requires = "record")]
    pub seconds: Option<f32>,

    /// Start with the cloth's time standing still.
    #[arg(long)]
    pub paused: bool,

    /// What the colours of the cloth show.
    #[arg(long, value_name = "WHAT", value_enum, default_value_t = Coloring::Material)]
    pub coloring: Coloring,
}

/// What the colours of the cloth show.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coloring {
    /// The cloth's own material.
    Material,
    /// Stress and fire damage, from blue (none) to red (where it tears, or is burnt).
    Stress,
    /// How far the threads are stretched, from blue (not at all) to red (the fabric's limit).
    Strain,
    /// Temperature, from blue (a room) to red (a flame).
    Temperature,
    /// Speed, from blue (at rest) to red (5 m/s).
    Speed,
    /// Contact: red where something is touched.
    Contact,
}

/// Width and height in pixels, written `1280x720`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub UVec2);

impl Options {
    /// Width and height in pixels.
    pub fn pixels(&self) -> UVec2 {
        self.size.map_or(UVec2::new(1280, 720), |size| size.0)
    }
}

impl Size {
    const SMALLEST: u32 = 16;
    const LARGEST: u32 = 8192;
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (width, height) =
            text.split_once(['x', 'X']).ok_or_else(|| "expected WIDTHxHEIGHT, for example 1280x720".to_string())?;
        let side = |name: &str, text: &str| {
            let side: u32 = text.parse().map_err(|_| format!("the {name} `{text}` is not a whole number"))?;
            if (Self::SMALLEST..=Self::LARGEST).contains(&side) {
                Ok(side)
            } else {
                Err(format!("the {name} is {side}, allowed is {}..={}", Self::SMALLEST, Self::LARGEST))
            }
        };
        Ok(Self(UVec2::new(side("width", width)?, side("height", height)?)))
    }
}

fn png_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        Ok(path)
    } else {
        Err("only .png files can be written".to_string())
    }
}

fn seconds(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(seconds) if (0.0..=3600.0).contains(&seconds) => Ok(seconds),
        Ok(seconds) => Err(format!("{seconds} s is out of range, allowed is 0..=3600 s")),
        Err(_) => Err("expected a number of seconds".to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(arguments: &[&str]) -> Result<Options, String> {
        Options::try_parse_from(std::iter::once(&"cloth_demo").chain(arguments)).map_err(|error| error.to_string())
    }

    #[test]
    fn no_arguments_open_the_sandbox_in_a_window() {
        let options = parse(&[]).expect("valid");
        assert_eq!(options.scene.title, "Sandbox");
        assert_eq!((options.size, options.pixels()), (None, UVec2::new(1280, 720)));
        assert_eq!(options.screenshot, None);
    }

    #[test]
    fn a_screenshot_has_a_time() {
        let options = parse(&["--screenshot", "out.png", "--at", "2.5", "--size", "320x240"]).expect("valid");
        assert_eq!(options.at, 2.5);
        assert_eq!(options.size, Some(Size(UVec2::new(320, 240))));
    }

    #[test]
    fn a_scene_of_the_game_opens_by_name_and_the_help_lists_them() {
        assert_eq!(parse(&["--scene", "flag_in_wind"]).expect("valid").scene.cloths[0].name, "flag");
        let help = parse(&["--help"]).expect_err("help");
        for name in ["sandbox", "top_hung", "flag_in_wind", "tablecloth"] {
            assert!(help.contains(name), "{help}");
        }
    }

    #[test]
    fn wrong_values_are_refused_with_the_reason() {
        for (arguments, reason) in [
            (&["--size", "320"][..], "WIDTHxHEIGHT"),
            (&["--size", "0x240"], "allowed is 16..=8192"),
            (&["--size", "axb"], "not a whole number"),
            (&["--screenshot", "out.bmp"], "only .png"),
            (&["--screenshot", "out.png", "--at", "NaN"], "out of range"),
            (&["--at", "3"], "--screenshot"),
            (&["--rate", "30"], "--record"),
            (&["--scene", "circus"], "sandbox"),
            (&["--scene", "no/such.ron"], "No such file"),
        ] {
            let error = parse(arguments).expect_err("refused");
            assert!(error.contains(reason), "{arguments:?} gave:\n{error}");
        }
    }
}
