//! What can be left out of a scene's model or be had cheaper.

pub use cloth_advice::{Change, Lever};
use cloth_scene::{Scene, SceneCloth, SceneFabric};
use cloth_solver::{Fabric, Method};
use glam::UVec2;

/// The scene with `change`.
pub fn changed(scene: &Scene, change: &Change) -> Scene {
    let mut scene = scene.clone();
    for cloth in &mut scene.cloths {
        if let Ok(before) = cloth.fabric() {
            let mut fabric = before;
            change.change_fabric(&mut fabric);
            if fabric != before {
                cloth.fabric = SceneFabric::Custom(fabric);
            }
        }
    }
    match change {
        Change::NoAir => scene.air = None,
        Change::NoFriction => scene.colliders.iter_mut().for_each(|collider| collider.friction = None),
        Change::NoSelfContact => scene.cloths.iter_mut().for_each(|cloth| cloth.self_contact = None),
        Change::NoColliders(which) => {
            let mut index = 0;
            scene.colliders.retain(|_| {
                index += 1;
                !which.contains(&(index - 1))
            });
        }
        Change::Coarser(times) => {
            for cloth in &mut scene.cloths {
                cloth.cells = (cloth.cells / (*times).max(1)).max(UVec2::ONE);
            }
        }
        Change::Budget { method, substeps, iterations } => {
            (scene.method, scene.substeps, scene.iterations) = (*method, *substeps, *iterations);
        }
        // A change of the fabric alone; and no scene tears.
        Change::NoBending | Change::NoShear | Change::Inextensible | Change::NoTearing => {}
    }
    scene
}

/// The parts that `full` has and that can be left out. `touched` tells for each collider whether a cloth came near.
pub fn parts(full: &Scene, touched: &[bool]) -> Vec<Change> {
    let fabrics: Vec<Fabric> = full.cloths.iter().filter_map(|cloth| cloth.fabric().ok()).collect();
    let any = |has: &dyn Fn(&Fabric) -> bool| fabrics.iter().any(has);
    let unused: Vec<usize> = (0..touched.len()).filter(|index| !touched[*index]).collect();
    let friction = !full.colliders.is_empty()
        && (any(&|fabric| fabric.friction > 0.0) || full.colliders.iter().any(|c| c.friction > Some(0.0)));
    [
        (any(&|fabric| fabric.bend_warp + fabric.bend_weft > 0.0), Change::NoBending),
        (any(&|fabric| fabric.shear > 0.0), Change::NoShear),
        (!fabrics.is_empty(), Change::Inextensible),
        (full.air.is_some(), Change::NoAir),
        (friction, Change::NoFriction),
        (full.cloths.iter().any(|cloth| cloth.self_contact.is_some()), Change::NoSelfContact),
        (!unused.is_empty(), Change::NoColliders(unused)),
    ]
    .into_iter()
    .filter_map(|(has, change)| has.then_some(change))
    .collect()
}

/// Coarser meshes, the coarsest first, as far as cells are left.
pub fn meshes(full: &Scene) -> Vec<Change> {
    let fewest = full.cloths.iter().map(|cloth| cloth.cells.min_element()).min().unwrap_or(0);
    [4, 2].into_iter().filter(|times| fewest / times >= 2).map(Change::Coarser).collect()
}

/// Fewer substeps of the same method, the fewest first.
pub fn substeps(full: &Scene) -> Vec<Change> {
    let (method, iterations) = (full.method, full.iterations);
    let fewer = [1, 2, 3, 5, 10, 20].into_iter().filter(|substeps| *substeps < full.substeps);
    fewer.map(|substeps| Change::Budget { method, substeps, iterations }).collect()
}

/// Budgets of `method` that are worth a try on this scene, the cheapest first: none where the step length that it
/// needs to be stable is out of reach.
pub fn budgets(method: Method, full: &Scene, quick: bool) -> Vec<Change> {
    let dt = 1.0 / full.rate;
    let explicit = |limit: f32| {
        let needed = (1.1 * dt * highest_frequency(full) / limit).ceil().max(1.0);
        if needed <= MOST_SUBSTEPS { vec![(needed as u32, 1)] } else { Vec::new() }
    };
    let mut budgets = match method {
        // Gains energy at every step length.
        Method::ExplicitEuler => Vec::new(),
        Method::SymplecticEuler | Method::StormerVerlet => explicit(2.0),
        Method::RungeKutta4 => explicit(2.83),
        Method::Pbd => vec![(1, 10), (2, 10), (5, 10), (10, 10)],
        Method::XpbdSweeps => vec![(5, 1), (10, 1), (20, 1), (40, 1)],
        Method::XpbdLines => vec![(2, 1), (5, 1), (10, 1), (20, 1)],
    };
    if quick {
        budgets.truncate(2);
    }
    let budget = |(substeps, iterations)| Change::Budget { method, substeps, iterations };
    budgets.into_iter().map(budget).collect()
}

/// More substeps than this are not tried, as nothing that needs them can be cheap.
const MOST_SUBSTEPS: f32 = 400.0;

/// The highest frequency of the cloths of a scene, rad/s: that of a grid of springs, `ω² = 4 Σ k/m` over warp, weft, shear
/// and bending (16 of the latter's).
pub fn highest_frequency(scene: &Scene) -> f32 {
    let of_cloth = |cloth: &SceneCloth| {
        let Ok(fabric) = cloth.fabric() else { return 0.0 };
        let l = cloth.size / cloth.cells.max(UVec2::ONE).as_vec2();
        let stretch = fabric.stretch_weft / (l.x * l.x) + fabric.stretch_warp / (l.y * l.y);
        let shear = fabric.shear * (1.0 / (l.x * l.x) + 1.0 / (l.y * l.y));
        let bending = fabric.bend_weft / l.x.powi(4) + fabric.bend_warp / l.y.powi(4);
        ((4.0 * (stretch + shear) + 16.0 * bending) / fabric.areal_density).sqrt()
    };
    scene.cloths.iter().map(of_cloth).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> Scene {
        Scene::from_ron(
            "(air: (), wind: (1, 0, 0), substeps: 40, cloths: [(size: (1, 1), cells: (40, 20), damping: 2)],
              colliders: [(name: \"a\", shape: Ground, friction: 0.2), (name: \"b\", shape: Sphere(radius: 1)), (name: \"c\", shape: Ground)])",
        )
        .unwrap()
    }

    #[test]
    fn each_change_takes_out_what_it_names_and_nothing_else() {
        let full = scene();
        for change in parts(&full, &[true, false, false]) {
            let without = changed(&full, &change);
            let (was, now) = (full.cloths[0].fabric().unwrap(), without.cloths[0].fabric().unwrap());
            assert_eq!(now.bend_warp == 0.0, change == Change::NoBending, "{change:?}");
            assert_eq!(now.shear == 0.0, change == Change::NoShear, "{change:?}");
            assert_eq!(now.friction == 0.0, change == Change::NoFriction, "{change:?}");
            assert_eq!(without.air.is_none(), change == Change::NoAir, "{change:?}");
            assert_eq!(now.stretch_warp > was.stretch_warp, change == Change::Inextensible, "{change:?}");
            assert_eq!((was.damping, was.areal_density), (now.damping, now.areal_density));
            assert!(without.validate().is_ok(), "{change:?}");
        }
        let fewer = changed(&full, &Change::NoColliders(vec![0, 2]));
        assert_eq!(fewer.colliders.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), ["b"]);
    }

    #[test]
    fn what_a_scene_does_not_have_is_not_taken_out() {
        let bare = Scene::from_ron("(cloths: [(fabric: Custom((bend_warp: 0, bend_weft: 0, shear: 0)))])").unwrap();
        assert_eq!(parts(&bare, &[]), [Change::Inextensible]);
    }

    #[test]
    fn meshes_get_coarser_as_long_as_there_are_cells() {
        assert_eq!(meshes(&scene()), [Change::Coarser(4), Change::Coarser(2)]);
        assert_eq!(changed(&scene(), &Change::Coarser(4)).cloths[0].cells, UVec2::new(10, 5));
        let tiny = Scene::from_ron("(cloths: [(cells: (5, 40))])").unwrap();
        assert_eq!(meshes(&tiny), [Change::Coarser(2)]);
    }

    #[test]
    fn explicit_methods_are_tried_only_where_their_step_is_within_reach() {
        let soft = Scene::from_ron("(cloths: [(cells: (4, 4))])").unwrap();
        let stable = budgets(Method::SymplecticEuler, &soft, false);
        let [Change::Budget { substeps, .. }] = stable[..] else { panic!("{stable:?}") };
        // Neighbours: 4/l² (Y/σ) twice and shear: ω = 2·4·√((2·5500 + 2·60)/0.15) = 2178 rad/s.
        assert!((18..=22).contains(&substeps), "{substeps}");
        let fine = Scene::from_ron("(cloths: [(cells: (200, 200))])").unwrap();
        assert!(budgets(Method::StormerVerlet, &fine, false).is_empty());
    }

    #[test]
    fn fewer_substeps_are_fewer_than_the_scene_has() {
        let few = substeps(&Scene { substeps: 5, ..scene() });
        assert_eq!(few.len(), 3);
        assert!(few.iter().all(|c| matches!(c, Change::Budget { substeps, .. } if *substeps < 5)));
    }
}
