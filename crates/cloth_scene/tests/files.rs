//! What scene files say is what is built, and what is wrong in them is told by place, field, value and range.

use std::path::PathBuf;

use cloth_scene::{Scene, SceneError, SceneMotion, World};
use cloth_solver::{Fabric, Method, measure};
use glam::{UVec2, Vec2, Vec3};

fn refused(text: &str) -> String {
    Scene::from_ron(text).expect_err(text).to_string()
}

fn scene(text: &str) -> Scene {
    Scene::from_ron(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[test]
fn an_empty_scene_is_the_default_one() {
    assert_eq!(scene("()"), Scene::default());
    assert_eq!(World::new(&Scene::default()).unwrap().ticks(), 300);
}

#[test]
fn a_scene_written_out_reads_back_the_same() {
    let scene = scene(
        r#"(title: "t", about: "a", seconds: 2, gravity: (0, -1.6, 0), air: (density: 2), wind: (1, 2, 3),
            gusts: (intensity: 0.1, length: 3, seed: 18446744073709551615), rate: 90,
            zones: [(name: "z", zone: (shape: Cuboid(size: (1, 2, 3)), velocity: (0, 1, 0), falloff: 0.1)), ()],
            fans: [(name: "f", fan: (on: false, speed: 3, oscillation: (angle: 1)), place: (at: (1, 1, 1))), ()],
            method: XpbdSweeps, substeps: 4, iterations: 7,
            cloths: [(name: "c", size: (2, 1), cells: (4, 3), fabric: Custom((areal_density: 0.3)), damping: 0.25,
                      self_contact: (distance: 0.002, rate: 40), pins: [Top, Corners, Rods(3), Left], weights: [(at: (0.5, 1), mass: 0.01)],
                      place: (at: (1, 2, 3), turn: (10, 20, 30)))],
            colliders: [(shape: Sphere(radius: 1), place: (at: (9, 0, 0))), (shape: Capsule(radius: 1, length: 2)),
                        (shape: Cuboid(size: (1, 2, 3))), (shape: Pyramid(base: (1, 2), height: 3), friction: 0.1),
                        (name: "floor", shape: Ground)])"#,
    );
    assert_eq!(scene.method, Method::XpbdSweeps);
    let written = ron::to_string(&scene).unwrap();
    assert_eq!(self::scene(&written), scene);
}

/// All scene files of the game: name and text.
fn all_files() -> Vec<(String, String)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/scenes");
    let files = std::fs::read_dir(folder).expect("the folder is there").map(|file| file.expect("readable").path());
    let mut files: Vec<PathBuf> = files.filter(|path| path.extension().is_some_and(|end| end == "ron")).collect();
    files.sort();
    files.iter().map(|path| (path.display().to_string(), std::fs::read_to_string(path).expect("readable"))).collect()
}

#[test]
fn every_scene_of_the_game_is_written_as_it_was_read_and_no_longer() {
    let files = all_files();
    assert!(files.len() > 10);
    for (name, text) in files {
        let scene = scene(&text);
        let written = scene.to_ron();
        assert_eq!(self::scene(&written), scene, "{name}:\n{written}");
        let size = |text: &str| text.chars().filter(|c| !c.is_whitespace()).count();
        let comments: usize =
            text.lines().filter_map(|line| line.split_once("//")).map(|(_, words)| size(words) + 2).sum();
        // What people write is as short as it gets, but for decimals and a comma here and there.
        let most = (size(&text) - comments) as f32 * 1.1;
        assert!(size(&written) as f32 <= most, "{name}: {} characters of {most}\n{written}", size(&written));
        assert!(written.lines().all(|line| line.len() <= 200), "{name}: {written}");
    }
}

#[test]
fn what_is_as_by_default_is_not_written() {
    assert_eq!(Scene::default().to_ron().split_whitespace().collect::<String>(), "()");
    let text = r#"(cloths: [(air: ())]"#;
    assert!(Scene::from_ron(text).is_err());
    let text =
        r#"(title: "a \"b\"", air: (), cloths: [(fire: (), fabric: Custom((shear: 7)), method: Pbd)], fans: [()])"#;
    let written = scene(text).to_ron();
    assert_eq!(scene(&written), scene(text));
    let flat: String = written.split_whitespace().collect();
    let expected = r#"(title:"a\"b\"",air:(),fans:[()],cloths:[(fabric:Custom((shear:7)),fire:(),method:Pbd)],)"#;
    assert_eq!(flat, expected);
}

#[test]
fn a_preset_is_found_by_its_name_in_any_case() {
    for (name, fabric) in Fabric::PRESETS {
        for name in [name.to_lowercase(), name.to_uppercase()] {
            let scene = scene(&format!("(cloths: [(cells: (2, 2), fabric: Preset({name:?}))])"));
            assert_eq!(scene.cloths[0].fabric(), Ok(*fabric));
        }
    }
}

#[test]
fn a_name_that_is_no_fabric_is_refused_with_those_that_are() {
    let error = refused(r#"(cloths: [(), (fabric: Preset("chain mail"))])"#);
    assert!(error.starts_with("cloth 1: there is no fabric `chain mail`"), "{error}");
    assert!(Fabric::PRESETS.iter().all(|(name, _)| error.contains(name)), "{error}");
}

#[test]
fn what_is_no_scene_is_refused_by_line_and_column() {
    for (text, line, column, reason) in [
        ("(\n  seconds: 5,\n  wnid: (1, 0, 0),\n)", 3, 3, "wnid"),
        ("(\n  seconds: ,\n)", 2, 12, ""),
        ("(cloths: [(\n pins: [Botom])])", 2, 9, "Botom"),
        ("(\n substeps: -1)", 2, 12, ""),
        ("(colliders: [(\n shape: Sphere(radius: 1, colour: 2))])", 2, 27, "colour"),
        ("", 1, 1, ""),
    ] {
        match Scene::from_ron(text) {
            Err(SceneError::Syntax { line: l, column: c, message }) => {
                assert_eq!(l, line, "{text}: {message}");
                assert!(c.abs_diff(column) <= 8, "{text}: column {c}, {message}");
                assert!(message.contains(reason), "{message}");
            }
            other => panic!("{text}: {other:?}"),
        }
    }
}

#[test]
fn what_is_out_of_range_is_refused_by_cloth_field_value_and_range() {
    let fine = "size: (1, 1), cells: (2, 2)";
    for (text, expected) in [
        ("(seconds: 0)".to_string(), "`Scene::seconds` is 0, allowed is 0.01..=3600 s"),
        ("(seconds: NaN)".into(), "`Scene::seconds` is NaN"),
        ("(substeps: 0)".into(), "`Scene::substeps` is 0, allowed is 1..=10,000"),
        ("(gravity: (0, inf, 0))".into(), "`Scene::gravity` is inf"),
        ("(air: (porosity: 2))".into(), "`Air::porosity` is 2, allowed is 0..=1"),
        ("(gusts: (intensity: 3))".into(), "`Gusts::intensity` is 3, allowed is 0..=2"),
        ("(fans: [(), (fan: (diameter: 0))])".into(), "fan 1: `Fan::diameter` is 0, allowed is 0.01..=100 m"),
        ("(fans: [(place: (at: (NaN, 0, 0)))])".into(), "fan 0: `SceneFan::place` is NaN"),
        ("(zones: [(zone: (falloff: -1))])".into(), "zone 0: `WindZone::falloff` is -1"),
        ("(zones: [(place: (turn: (0, inf, 0)))])".into(), "zone 0: `SceneZone::place` is inf"),
        (format!("(cloths: [({fine}), (size: (1, -1))])"), "cloth 1: `Cloth::size.y` is -1"),
        (format!("(cloths: [({fine}, damping: -2)])"), "cloth 0: `Fabric::damping` is -2, allowed is 0..=1000 1/s"),
        (format!("(cloths: [({fine}, fabric: Custom((shear: -1)))])"), "cloth 0: `Fabric::shear` is -1"),
        (format!("(cloths: [({fine}, weights: [(at: (2, 0), mass: 1)])])"), "cloth 0: `SceneWeight::at.x` is 2"),
        (format!("(cloths: [({fine}, weights: [(at: (1, 0), mass: -1)])])"), "cloth 0: `SceneWeight::mass` is -1"),
        (
            format!("(cloths: [({fine}, self_contact: (distance: 1))])"),
            "cloth 0: `SelfContact::distance` is 1, allowed is 1e-6..=0.1 m",
        ),
        (format!("(cloths: [({fine}, fire: (lit: [(0, 7)]))])"), "cloth 0: `SceneFire::lit.y` is 7"),
        (
            format!("(cloths: [({fine}, fire: (burns: Heat((char: 2))))])"),
            "cloth 0: `Flammability::char` is 2, allowed is 0..=0.95",
        ),
        (format!("(cloths: [({fine}, pins: [Rods(4000000000)])])"), "cloth 0: `ScenePins::Rods` is 4000000000"),
        (format!("(cloths: [({fine}, place: (at: (0, NaN, 0)))])"), "cloth 0: `SceneCloth::place` is NaN"),
        (format!("(cloths: [({fine})], colliders: [(shape: Ground), (shape: Sphere(radius: 0))])"), "collider 1: "),
        (
            format!("(cloths: [({fine})], colliders: [(shape: Ground, friction: -1)])"),
            "`SceneCollider::friction` is -1",
        ),
        ("(colliders: [(shape: Ground, place: (turn: (inf, 0, 0)))])".into(), "collider 0: `SceneCollider::place`"),
        ("(colliders: [(shape: Cuboid(size: (1, 0, 1)))])".into(), "collider 0: "),
    ] {
        let error = refused(&text);
        assert!(error.contains(expected), "{text}\n gave     {error}\n expected {expected}");
    }
}

#[test]
fn pins_and_weights_land_on_the_particles_they_name() {
    let scene = scene("(cloths: [(size: (2, 1), cells: (8, 4), pins: [Rods(3)], weights: [(at: (1, 0.5), mass: 2)])])");
    let world = World::new(&scene).unwrap();
    let cloth = &world.cloths[0];
    let grid = cloth.topology.grid.unwrap();
    let pinned: Vec<u32> = cloth.constraints.pins().pins.iter().map(|pin| pin.particle).collect();
    assert_eq!(pinned, [grid.slot(0, 0), grid.slot(0, 4), grid.slot(0, 8)]);
    let own = 0.15 * cloth.topology.area[grid.slot(2, 8) as usize];
    assert_eq!(cloth.particles.mass[grid.slot(2, 8) as usize], own + 2.0);
    assert_eq!(scene.cloths[0].weights[0].row_and_column(UVec2::new(8, 4)), UVec2::new(2, 8));
    assert_eq!(scene.cloths[0].size, Vec2::new(2.0, 1.0));
}

#[test]
fn a_cloth_falls_along_the_scenes_gravity_however_it_is_turned() {
    let scene = scene("(gravity: (0, 0, -10), cloths: [(cells: (2, 2), place: (at: (1, 2, 3), turn: (30, 40, 50)))])");
    let mut world = World::new(&scene).unwrap();
    for _ in 0..60 {
        world.tick();
    }
    let centre = measure::centre_of_mass(&world.cloths[0].particles).as_vec3();
    let fallen = world.frames[0].point(centre) - Vec3::new(1.0, 2.0, 3.0);
    assert!((fallen - Vec3::new(0.0, 0.0, -5.0)).length() < 0.05, "{fallen}");
}

#[test]
fn wind_takes_a_cloth_along_only_where_there_is_air() {
    let moved = |air: &str| {
        let text = format!(
            "(gravity: (0, 0, 0), wind: (0, 0, 4), {air} cloths: [(cells: (4, 4), place: (turn: (0, 180, 0)))])"
        );
        let mut world = World::new(&scene(&text)).unwrap();
        for _ in 0..60 {
            world.tick();
        }
        world.frames[0].point(measure::centre_of_mass(&world.cloths[0].particles).as_vec3()).z
    };
    assert_eq!(moved(""), 0.0);
    assert!(moved("air: (),") > 1.0);
}

#[test]
fn gusts_zones_and_fans_move_a_cloth_each_on_its_own() {
    let moved = |what: &str| {
        let cloth = "cloths: [(size: (0.4, 0.4), cells: (4, 4), place: (at: (1, 1, 0), turn: (0, 180, 0)))]";
        let mut world = World::new(&scene(&format!("(gravity: (0, 0, 0), air: (), {what} {cloth})"))).unwrap();
        for _ in 0..60 {
            world.tick();
        }
        world.frames[0].point(measure::centre_of_mass(&world.cloths[0].particles).as_vec3()) - Vec3::new(1.0, 1.0, 0.0)
    };
    assert_eq!(moved(""), Vec3::ZERO);
    let fan = moved("fans: [(place: (at: (1, 1, 2)))],");
    assert!(fan.z < -1.0, "{fan}");
    assert_eq!(moved("fans: [(fan: (on: false), place: (at: (1, 1, 2)))],"), Vec3::ZERO);
    let ball = "colliders: [(shape: Sphere(radius: 0.5), place: (at: (1, 1, 1)))],";
    assert_eq!(moved(&format!("fans: [(place: (at: (1, 1, 2)))], {ball}")), Vec3::ZERO);
    let zone = moved("zones: [(zone: (velocity: (1, 0, 0)), place: (at: (1, 1, 0), turn: (0, 90, 0)))],");
    assert!(zone.z < -0.3 && zone.x.abs() < 0.1, "{zone}");
    assert_eq!(moved("zones: [(place: (at: (4, 1, 0)))],"), Vec3::ZERO);
    let [steady, gusty] = [moved("wind: (0, 0, 3),"), moved("wind: (0, 0, 3), gusts: (intensity: 0.3),")];
    assert!(steady.distance(gusty) > 0.05, "{steady} and {gusty}");
    assert_eq!(gusty, moved("wind: (0, 0, 3), gusts: (intensity: 0.3),"));
    assert_ne!(gusty, moved("wind: (0, 0, 3), gusts: (intensity: 0.3, seed: 1),"));
}

#[test]
fn a_cloth_keeps_off_itself_where_the_scene_says_so() {
    let crossings = |own: &str| {
        // It falls on its edge and folds.
        let place = "place: (at: (0, 0.45, 0), turn: (8, 0, 10))";
        let cloth = format!("(size: (0.4, 0.8), cells: (12, 24), {own} {place})");
        let mut world = World::new(&scene(&format!("(cloths: [{cloth}], colliders: [(shape: Ground)])"))).unwrap();
        let most = (0..90).map(|_| {
            world.tick();
            measure::crossings(&world.cloths[0].topology, &world.cloths[0].particles).len()
        });
        most.max().unwrap_or_default()
    };
    assert_eq!(crossings("self_contact: (),"), 0);
    assert!(crossings("") > 10);
}

#[test]
fn a_cloth_that_is_lit_burns_from_there_and_one_that_is_not_stays_cold() {
    let cloth = |fire: &str| format!("(size: (0.2, 0.2), cells: (8, 8), pins: [Top], fire: {fire})");
    let lit = "(burns: Heat((heat_flux: 2e5, mass_loss_rate: 0.5)), lit: [(0.5, 1)])";
    let text = format!("(rate: 60, cloths: [{}, {}])", cloth(lit), cloth("()"));
    let mut world = World::new(&scene(&text)).expect("valid");
    let fire = |world: &World, index: usize| world.fires[index].clone().expect("it may burn");
    (0..3).for_each(|_| world.tick());
    let flame = fire(&world, 0).flame().expect("in flames");
    assert_eq!(flame, world.cloths[0].topology.grid.expect("a rectangle").slot(8, 4));
    (0..90).for_each(|_| world.tick());
    assert!(world.cloths[0].topology.triangles.len() < 128, "it burns through");
    assert_eq!((fire(&world, 1).is_warm(), world.cloths[1].topology.triangles.len()), (false, 128));
}

#[test]
fn every_scene_of_the_game_builds_and_says_what_it_shows() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../assets/scenes");
    let files: Vec<PathBuf> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(files.len() >= 8, "{files:?}");
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        let scene = Scene::from_ron(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        assert!(!scene.title.is_empty() && !scene.about.is_empty(), "{}", file.display());
        assert!(!scene.cloths.is_empty(), "{}", file.display());
        let mut world = World::new(&scene).unwrap();
        world.tick();
        assert!(world.cloths.iter().all(|cloth| cloth.particles.is_finite()), "{}", file.display());
    }
}

/// A scene of one cloth with these fields.
fn with_cloth(fields: &str) -> String {
    format!("(cloths: [(size: (1, 1), cells: (10, 10), {fields})])")
}

#[test]
fn a_piece_cut_out_of_a_rectangle_has_the_cells_within_its_outline_and_no_others() {
    let text = with_cloth("outline: [(0, 0), (1, 0), (1, 0.5), (0.5, 0.5), (0.5, 1), (0, 1)], pins: [Top]");
    let scene = Scene::from_ron(&text).expect("valid");
    let piece = scene.cloths[0].piece().expect("a piece");
    assert_eq!(piece.triangles.len(), 2 * 75, "three quarters of a hundred cells");
    let area: f32 = piece
        .triangles
        .iter()
        .map(|triangle| triangle.map(|vertex| piece.positions[vertex as usize]))
        .map(|[a, b, c]| (b - a).cross(c - a).z / 2.0)
        .sum();
    assert!((area - 0.75).abs() < 1e-5, "{area}: counterclockwise, of the right size");
    let mut world = World::new(&scene).expect("built");
    assert_eq!(world.cloths[0].constraints.pins().pins.len(), 11);
    (0..30).for_each(|_| world.tick());
    let lowest = measure::bounds(&world.cloths[0].topology, &world.cloths[0].particles.position).0.y;
    assert!((-0.6..-0.4).contains(&lowest), "{lowest}: it hangs by its top");
}

#[test]
fn pins_and_colliders_move_as_their_scene_says() {
    let text = "(
        cloths: [(size: (1, 1), cells: (4, 4), pins: [Top], motion: (keys: [(0, ()), (0.5, (at: (0, 0.25, 0)))]))],
        colliders: [(shape: Sphere(radius: 0.1), place: (at: (0, 9, 0)), motion: (keys: [(0, ()), (1, (at: (0, 0, 2)))]))],
    )";
    let mut world = World::new(&Scene::from_ron(text).expect("valid")).expect("built");
    (0..60).for_each(|_| world.tick());
    let highest = measure::bounds(&world.cloths[0].topology, &world.cloths[0].particles.position).1.y;
    assert!((highest - 0.75).abs() < 1e-4, "{highest}");
    let at = world.cloths[0].contacts.colliders[0].motion.to.position;
    assert!((at - Vec3::new(0.0, 9.0, 2.0)).length() < 1e-4, "{at}");
}

#[test]
fn a_gathered_curtain_is_as_narrow_at_its_top_as_its_scene_says() {
    let scene = Scene::from_ron(&with_cloth("pins: [Rods(5)], gather: 0.5")).expect("valid");
    let mut world = World::new(&scene).expect("built");
    (0..90).for_each(|_| world.tick());
    let cloth = &world.cloths[0];
    let held = cloth.constraints.pins().pins.iter().map(|pin| cloth.particles.position.get(pin.particle as usize).x);
    let (low, high) = held.fold((f32::MAX, f32::MIN), |(low, high), x| (low.min(x), high.max(x)));
    assert!((high - low - 0.5).abs() < 1e-4, "{low} {high}");
}

#[test]
fn a_motion_goes_from_key_to_key_and_round_again() {
    let motion: SceneMotion =
        ron::from_str("(keys: [(1, ()), (2, (at: (1, 0, 0))), (3, ())], repeat: true)").expect("valid");
    let at = |time| motion.at(time).position.x;
    assert_eq!([at(0.0), at(1.0), at(1.5), at(2.0), at(2.5), at(3.5)], [0.0, 0.0, 0.5, 1.0, 0.5, 0.5]);
}

#[test]
fn what_a_scene_says_wrong_of_look_and_motion_is_told() {
    for (text, told) in [
        (with_cloth("gather: 0"), "SceneCloth::gather"),
        (with_cloth("outline: [(0, 2)]"), "SceneCloth::outline"),
        (with_cloth("tearing: (scale: 0)"), "SceneTearing::scale"),
        (with_cloth("look: (color: (2, 0, 0))"), "SceneLook::color"),
        (with_cloth("look: (pattern: Stripes(0))"), "SceneLook::pattern"),
        (with_cloth("motion: (keys: [(1, ()), (1, ())])"), "SceneMotion::keys"),
        (with_cloth("pins: [At([(0, -1)])]"), "ScenePins::At"),
        ("(view: (hour: 25))".into(), "SceneView::hour"),
        ("(view: (camera: (from: (0, 0, 0), to: (0, 0, 0))))".into(), "SceneCamera::from"),
        ("(colliders: [(shape: Cuboid(size: (1, 1, 1)), mass: 1)])".into(), "SceneCollider::mass"),
        ("(colliders: [(shape: Sphere(radius: 1), finish: Paint((0, 0, 7)))])".into(), "Finish::color"),
    ] {
        let error = Scene::from_ron(&text).expect_err(&text).to_string();
        assert!(error.contains(told), "{text}: {error}");
    }
}
