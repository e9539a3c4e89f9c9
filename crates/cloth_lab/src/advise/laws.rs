//! Dimensionless numbers that tell in advance what a scene needs.

use cloth_scene::{Scene, SceneCloth, SceneShape};
use cloth_solver::fabric::STANDARD_GRAVITY;

use super::model::Change;
use super::play::{REST_SPEED, Recording};
use crate::report::number;

/// What a number says before anything is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// What it is about.
    pub about: &'static str,
    /// The number and its value.
    pub value: String,
    /// The rule.
    pub rule: &'static str,
    /// Whether the part is needed.
    pub needed: bool,
    /// The change whose measured verdict belongs beside it, if there is one.
    pub change: Option<Change>,
    /// Where there is none, what there is instead.
    pub instead: &'static str,
}

/// Strain under its own weight below which a fabric passes for inextensible.
const INEXTENSIBLE: f32 = 0.01;
/// Weight over bending stiffness of an edge above which folds are narrower than the edge.
const NO_BENDING: f32 = 30.0;
/// How many times slower than its terminal velocity cloth must stay for the air not to matter: forces go with the
/// square, so less than a twenty-fifth of its weight.
const MUCH: f32 = 5.0;

/// The predictions for a scene, of the most demanding of its cloths each.
pub fn predictions(scene: &Scene, full: &Recording) -> Vec<Prediction> {
    if scene.cloths.is_empty() {
        return Vec::new();
    }
    let gravity = scene.gravity.length();
    let largest = |of: &dyn Fn(&SceneCloth) -> f32| scene.cloths.iter().map(of).fold(0.0, f32::max);
    let smallest = |of: &dyn Fn(&SceneCloth) -> f32| scene.cloths.iter().map(of).fold(f32::INFINITY, f32::min);
    let strain = largest(&|cloth| hanging_strain(cloth, gravity));
    let weight = smallest(&|cloth| bending_number(cloth));
    let edges = largest(&|cloth| edge(cloth) / bending_length(cloth));
    let mut all = vec![
        Prediction {
            about: "stretch",
            value: format!("(σgL/2 + weights)/Y = {} %", number(f64::from(100.0 * strain), 2)),
            rule: "below 1 %: threads that do not stretch",
            needed: strain >= INEXTENSIBLE,
            change: Some(Change::Inextensible),
            instead: "",
        },
        Prediction {
            about: "bending",
            value: format!("Γ = σgl³/D = {}", number(f64::from(weight), 2)),
            rule: "above 30: folds narrower than an edge, no bending",
            needed: weight <= NO_BENDING,
            change: Some(Change::NoBending),
            instead: "",
        },
        Prediction {
            about: "half the cells",
            value: format!("2l/c = {}, c = (D/σg)^⅓", number(f64::from(2.0 * edges), 2)),
            rule: "up to 0.5: the mesh still shows its folds",
            needed: 2.0 * edges > 0.5,
            change: Some(Change::Coarser(2)),
            instead: "",
        },
    ];
    all.extend(air(scene, gravity));
    all.extend(swept(scene, full));
    let gap = scene.cloths.iter().map(edge).fold(0.0, f32::max);
    let meeting = meets_itself(full, gap);
    all.push(Prediction {
        about: "self-contact",
        value: format!(
            "far parts within an edge ({} mm): {}",
            number(f64::from(1e3 * gap), 2),
            if meeting { "yes" } else { "no" }
        ),
        rule: "no: none needed",
        needed: meeting,
        change: Some(Change::NoSelfContact),
        instead: "",
    });
    all.push(Prediction {
        about: "sleep",
        value: match full.at_rest_from {
            Some(from) => {
                format!("at rest (< {REST_SPEED} m/s) from {} s of {} s", number(f64::from(from), 2), scene.seconds)
            }
            None => format!("never at rest (< {REST_SPEED} m/s)"),
        },
        rule: "at rest for 0.5 s: could sleep",
        needed: full.at_rest_from.is_none_or(|from| scene.seconds - from < 0.5),
        change: None,
        instead: "not modelled yet",
    });
    all
}

fn air(scene: &Scene, gravity: f32) -> Option<Prediction> {
    let air = scene.air?;
    let terminal = |cloth: &SceneCloth| {
        let sigma = cloth.fabric().map_or(0.0, |fabric| fabric.areal_density);
        (2.0 * sigma * gravity / (air.density * air.normal * (1.0 - air.porosity)).max(1e-9)).sqrt()
    };
    let speed = |cloth: &SceneCloth| (gravity * cloth.size.max_element()).sqrt();
    let ratio = scene.cloths.iter().map(|cloth| terminal(cloth) / speed(cloth).max(1e-9)).fold(f32::INFINITY, f32::min);
    let wind = scene.wind.length();
    Some(Prediction {
        about: "air",
        value: format!("√(2σg/ρC)/√(gL) = {}, wind {} m/s", number(f64::from(ratio), 2), number(f64::from(wind), 2)),
        rule: "above 5 and no wind: no air",
        needed: wind > 0.0 || !scene.zones.is_empty() || !scene.fans.is_empty() || ratio <= MUCH,
        change: Some(Change::NoAir),
        instead: "",
    })
}

fn swept(scene: &Scene, full: &Recording) -> Option<Prediction> {
    let size = |shape: &SceneShape| match *shape {
        SceneShape::Sphere { radius } | SceneShape::Capsule { radius, .. } => Some(radius),
        SceneShape::Cuboid { size } => Some(size.min_element() / 2.0),
        SceneShape::Pyramid { base, height } => Some(base.min_element().min(height) / 2.0),
        SceneShape::Ellipsoid { radii } => Some(radii.min_element()),
        SceneShape::Cylinder { radius, height } | SceneShape::Cone { radius, height } => Some(radius.min(height / 2.0)),
        SceneShape::RoundedCuboid { size, .. } => Some(size.min_element() / 2.0),
        SceneShape::Ground => None,
    };
    let thinnest = scene.colliders.iter().filter_map(|collider| size(&collider.shape)).min_by(f32::total_cmp)?;
    let step = full.fastest / (scene.rate * scene.substeps as f32);
    Some(Prediction {
        about: "swept contact",
        value: format!(
            "v h = {} mm, thinnest collider {} mm",
            number(f64::from(1e3 * step), 2),
            number(f64::from(1e3 * thinnest), 2)
        ),
        rule: "less than the collider's radius: none needed",
        needed: step > thinnest,
        change: None,
        instead: "not modelled yet",
    })
}

/// Mean strain of the threads by the cloth's own weight and what hangs on it, were it hung by its top edge.
fn hanging_strain(cloth: &SceneCloth, gravity: f32) -> f32 {
    let Ok(fabric) = cloth.fabric() else { return 0.0 };
    let weights: f32 = cloth.weights.iter().map(|weight| weight.mass * gravity).sum();
    let own = fabric.areal_density * gravity * cloth.size.y / 2.0;
    (own + weights / cloth.size.x) / fabric.stretch_warp.min(fabric.stretch_weft)
}

/// Edge length, the longer of both directions, m.
fn edge(cloth: &SceneCloth) -> f32 {
    (cloth.size / cloth.cells.as_vec2()).max_element()
}

/// Bending length of the stiffer direction, `(D/σg)^⅓` in standard gravity, m.
fn bending_length(cloth: &SceneCloth) -> f32 {
    let Ok(fabric) = cloth.fabric() else { return 0.0 };
    (fabric.bend_warp.max(fabric.bend_weft) / (fabric.areal_density * STANDARD_GRAVITY)).cbrt().max(1e-9)
}

fn bending_number(cloth: &SceneCloth) -> f32 {
    (edge(cloth) / bending_length(cloth)).powi(3)
}

/// Whether at the end two points that are more than four edges apart on the cloth are nearer than `gap`, m.
fn meets_itself(full: &Recording, gap: f32) -> bool {
    let Some(shape) = full.shapes.last() else { return false };
    shape.0.iter().any(|sheet| {
        let across = sheet.points_across.x as usize;
        let place = |index: usize| ((index / across) as i64, (index % across) as i64);
        // Sorted by x, a point meets only those that follow within the gap.
        let mut order: Vec<usize> = (0..sheet.points.len()).collect();
        order.sort_by(|a, b| sheet.points[*a].x.total_cmp(&sheet.points[*b].x));
        order.iter().enumerate().any(|(rank, a)| {
            let near = order[rank + 1..].iter().take_while(|b| sheet.points[**b].x - sheet.points[*a].x < gap);
            near.into_iter().any(|b| {
                let ((row_a, column_a), (row_b, column_b)) = (place(*a), place(*b));
                (row_a - row_b).abs().max((column_a - column_b).abs()) > 4
                    && sheet.points[*a].distance_squared(sheet.points[*b]) < gap * gap
            })
        })
    })
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::advise::play::play;

    fn predicted(text: &str) -> Vec<Prediction> {
        let scene = Scene::from_ron(text).unwrap();
        predictions(&scene, &play(&scene, Duration::MAX).unwrap())
    }

    fn needed(all: &[Prediction], about: &str) -> bool {
        all.iter().find(|prediction| prediction.about == about).unwrap_or_else(|| panic!("{about}: {all:?}")).needed
    }

    #[test]
    fn cotton_counts_as_inextensible_and_jersey_with_a_weight_does_not() {
        assert!(!needed(&predicted("(seconds: 0.1, cloths: [(cells: (4, 4))])"), "stretch"));
        let jersey = "(seconds: 0.1, cloths: [(cells: (4, 4), fabric: Preset(\"cotton jersey\"), weights: [(at: (1, 1), mass: 0.1)])])";
        assert!(needed(&predicted(jersey), "stretch"));
    }

    #[test]
    fn a_mesh_coarser_than_the_folds_needs_no_bending_and_a_fine_one_does() {
        assert!(!needed(&predicted("(seconds: 0.1, cloths: [(cells: (4, 4))])"), "bending"));
        let felt = "(seconds: 0.1, cloths: [(cells: (40, 40), fabric: Preset(\"felt, 1 mm\"))])";
        assert!(needed(&predicted(felt), "bending"));
    }

    #[test]
    fn air_matters_to_what_is_light_and_to_all_in_wind() {
        let heavy = "seconds: 0.1, air: (density: 0.01), cloths: [(size: (0.1, 0.1), cells: (4, 4))]";
        assert!(!needed(&predicted(&format!("({heavy})")), "air"));
        assert!(needed(&predicted(&format!("({heavy}, wind: (1, 0, 0))")), "air"));
        assert!(needed(&predicted("(seconds: 0.1, air: (), cloths: [(cells: (4, 4))])"), "air"));
    }

    #[test]
    fn a_sheet_folded_in_two_meets_itself_and_a_flat_one_does_not() {
        let scene = Scene::from_ron("(seconds: 0.1, gravity: (0, 0, 0), cloths: [(cells: (20, 20))])").unwrap();
        let mut flat = play(&scene, Duration::MAX).unwrap();
        assert!(!meets_itself(&flat, 0.05));
        let sheet = &mut flat.shapes.last_mut().unwrap().0[0];
        sheet.points.iter_mut().for_each(|point| point.x = point.x.abs());
        assert!(meets_itself(&flat, 0.05));
    }
}
