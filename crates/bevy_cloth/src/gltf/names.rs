//! What the names and values in a glTF file mean.

use std::fmt;

use cloth_solver::Fabric;
use serde_json::{Map, Value};

use crate::Tearable;
use crate::pins::Pins;

/// Every key there is, for the message about one that is not.
const KEYS: &str = "cloth, cloth_pins, cloth_strength, cloth_burns, cloth_air, cloth_self_contact";

const PINS: &str = "\"top\", \"corners\", \"color\", \"attribute\", \"none\", or a number of rods, 0..=1000";

/// What is wrong with an entry.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The key, as it is written in the file.
    pub key: String,
    /// The value found, as JSON.
    pub value: String,
    /// What is allowed in its place.
    pub allowed: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` is {}, allowed is {}", self.key, self.value, self.allowed)
    }
}

/// What holds the cloth.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum PinsWanted {
    /// Known without the mesh.
    Pins(Pins),
    /// Those vertices that are painted in [`ATTRIBUTE_PIN`](super::ATTRIBUTE_PIN).
    Attribute,
}

/// What a file says about one cloth.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Wanted {
    /// Whether it is cloth, if anything says so.
    pub cloth: Option<bool>,
    pub fabric: Option<Fabric>,
    pub pins: Option<PinsWanted>,
    /// [`Tearable::scale`].
    pub strength: Option<f32>,
    pub burns: bool,
    pub air: Option<bool>,
    pub self_contact: bool,
}

impl Wanted {
    /// From the extras of an object, its mesh and its material, in that order: what comes first counts. Tells everything that is
    /// wrong.
    pub fn read<'a>(extras: impl IntoIterator<Item = &'a str>) -> (Self, Vec<Problem>) {
        let mut all: Map<String, Value> = Map::new();
        let mut problems = Vec::new();
        for text in extras {
            // What is no object of names and values is somebody else's.
            let Ok(Value::Object(entries)) = serde_json::from_str(text) else { continue };
            for (key, value) in entries.into_iter().filter(|(key, _)| key == "cloth" || key.starts_with("cloth_")) {
                all.entry(key).or_insert(value);
            }
        }
        let mut wanted = Self::default();
        for (key, value) in &all {
            if let Err(allowed) = wanted.take(key, value) {
                problems.push(Problem { key: key.clone(), value: value.to_string(), allowed });
            }
        }
        (wanted, problems)
    }

    /// Takes over one entry, or says what is allowed in its place.
    fn take(&mut self, key: &str, value: &Value) -> Result<(), String> {
        match key {
            "cloth" => match value {
                Value::String(name) => {
                    self.fabric = Some(fabric(name)?);
                    self.cloth = Some(true);
                }
                other => self.cloth = Some(truth(other).ok_or_else(fabrics)?),
            },
            "cloth_pins" => self.pins = Some(pins(value)?),
            "cloth_strength" => {
                let strength = value.as_f64().map(|value| value as f32);
                let strength =
                    strength.filter(|scale| Tearable { scale: *scale, ..Tearable::default() }.validate().is_ok());
                self.strength = Some(strength.ok_or("a number above 0, up to 1000")?);
            }
            "cloth_burns" => self.burns = truth(value).ok_or("true or false")?,
            "cloth_air" => self.air = Some(truth(value).ok_or("true or false")?),
            "cloth_self_contact" => self.self_contact = truth(value).ok_or("true or false")?,
            _ => return Err(format!("one of the keys {KEYS}")),
        }
        Ok(())
    }
}

/// Yes or no, as Blender writes it: older versions know no boolean properties.
fn truth(value: &Value) -> Option<bool> {
    match value {
        Value::Bool(value) => Some(*value),
        Value::Number(number) if number.as_f64() == Some(0.0) => Some(false),
        Value::Number(number) if number.as_f64() == Some(1.0) => Some(true),
        _ => None,
    }
}

/// The preset of that name, whether it is written in capitals or not, with its details after the comma or without.
fn fabric(name: &str) -> Result<Fabric, String> {
    let short = |name: &str| name.split(',').next().unwrap_or_default().trim().to_lowercase().replace('_', " ");
    let is_it = |(known, _): &&(&str, Fabric)| known.eq_ignore_ascii_case(name.trim()) || short(known) == short(name);
    Fabric::PRESETS.iter().find(is_it).map(|(_, fabric)| *fabric).ok_or_else(fabrics)
}

fn fabrics() -> String {
    let names: Vec<String> = Fabric::PRESETS.iter().map(|(name, _)| format!("\"{name}\"")).collect();
    format!("true, false, or a fabric: {}", names.join(", "))
}

fn pins(value: &Value) -> Result<PinsWanted, String> {
    let pins = match value {
        Value::String(name) => match name.trim().to_lowercase().as_str() {
            "top" => Pins::top(),
            "corners" => Pins::corners(),
            "color" | "colour" => Pins::vertex_color(0.5),
            "attribute" => return Ok(PinsWanted::Attribute),
            "none" => Pins::default(),
            _ => return Err(PINS.into()),
        },
        other => {
            let count = other.as_f64().filter(|count| count.fract() == 0.0 && (0.0..=1000.0).contains(count));
            Pins::rods(count.ok_or(PINS)? as u32)
        }
    };
    Ok(PinsWanted::Pins(pins))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_object_counts_before_its_mesh_and_that_before_its_material() {
        let extras = [r#"{"cloth": "canvas"}"#, r#"{"cloth": false, "cloth_pins": 4}"#, r#"{"cloth_pins": "top"}"#];
        let (wanted, problems) = Wanted::read(extras);
        assert_eq!(problems, []);
        assert_eq!((wanted.cloth, wanted.fabric), (Some(true), Some(Fabric::CANVAS)));
        assert_eq!(wanted.pins, Some(PinsWanted::Pins(Pins::rods(4))));
    }

    #[test]
    fn every_preset_is_known_by_its_name_in_any_case_with_and_without_details() {
        for (name, fabric) in Fabric::PRESETS {
            let short = name.split(',').next().unwrap();
            for name in [(*name).to_string(), name.to_lowercase(), short.to_uppercase(), short.replace(' ', "_")] {
                let (wanted, problems) = Wanted::read([format!(r#"{{"cloth": "{name}"}}"#).as_str()]);
                assert_eq!((wanted.fabric, problems.len()), (Some(*fabric), 0), "{name}");
            }
        }
    }

    #[test]
    fn what_is_wrong_is_told_with_key_value_and_what_is_allowed() {
        let entries = [
            (r#""cloth": "cottn""#, "Cotton poplin"),
            (r#""cloth": 2"#, "true, false"),
            (r#""cloth_pins": "left""#, "corners"),
            (r#""cloth_pins": 2.5"#, "rods"),
            (r#""cloth_pins": -1"#, "rods"),
            (r#""cloth_strength": 0"#, "above 0"),
            (r#""cloth_strength": "very""#, "above 0"),
            (r#""cloth_burns": "yes""#, "true or false"),
            (r#""cloth_pinz": 3"#, "cloth_pins"),
        ];
        for (entry, allowed) in entries {
            let (wanted, problems) = Wanted::read([format!("{{{entry}}}").as_str()]);
            assert_eq!(wanted, Wanted::default(), "{entry}");
            assert!(problems.len() == 1 && problems[0].allowed.contains(allowed), "{entry}: {problems:?}");
            assert!(problems[0].to_string().contains(entry.split('"').nth(1).unwrap()), "{}", problems[0]);
        }
        for others in ["", "[1]", "7", r#"{"clothes": 3, "mass": 2}"#] {
            assert_eq!(Wanted::read([others]), (Wanted::default(), Vec::new()));
        }
    }
}
