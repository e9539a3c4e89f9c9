//! Flammable cloth is lit, burns upward, goes through, tears easier, is put out by water and whole after a reset.

mod common;

use bevy::picking::pointer::{PointerAction, PointerButton};
use bevy::prelude::*;
use bevy_cloth::*;
use common::*;

fn hung(app: &mut App, flammable: Flammable) -> Entity {
    let cloth = (Cloth::rectangle(0.5, 0.5).with_cells(16, 16), Pins::top(), flammable);
    let cloth = app.world_mut().spawn(cloth).id();
    run(app, 4);
    cloth
}

fn light(app: &mut App, cloth: Entity, at: [f32; 2]) {
    app.world_mut().trigger(IgniteCloth { entity: cloth, position: Vec3::new(at[0], at[1], 0.0), radius: 0.03 });
}

fn triangles(app: &App, cloth: Entity) -> usize {
    get::<ClothTopology>(app, cloth).triangles.len()
}

fn mass(app: &App, cloth: Entity) -> f64 {
    get::<Particles>(app, cloth).mass.iter().map(|mass| f64::from(*mass)).sum()
}

#[test]
fn a_match_at_the_foot_lights_the_cloth_which_burns_up_goes_through_and_goes_out() {
    let mut app = headless();
    let cloth = hung(&mut app, Flammable::default());
    note_events::<ClothIgnited>(&mut app);
    note_events::<ClothBurntThrough>(&mut app);
    note_events::<ClothBurntOut>(&mut app);
    let (before, heavy) = (triangles(&app, cloth), mass(&app, cloth));
    light(&mut app, cloth, [0.0, -0.24]);
    run(&mut app, 2);
    assert_eq!(seen::<ClothIgnited>(&app).len(), 1);
    assert!(seen::<ClothIgnited>(&app)[0].position.y < -0.2);
    run(&mut app, 64 * 4);
    let fire = get::<ClothFire>(&app, cloth);
    let topology = get::<ClothTopology>(&app, cloth);
    let hot = topology.particles().filter(|slot| fire.temperature()[*slot as usize] > 500.0);
    let highest = hot.map(|slot| topology.rest[slot as usize].y).fold(f32::NEG_INFINITY, f32::max);
    assert!(highest > 0.0, "after four seconds it burns up to {highest} m");
    run(&mut app, 64 * 40);
    assert!(!seen::<ClothBurntThrough>(&app).is_empty());
    assert!(triangles(&app, cloth) < before / 2, "{} of {before} triangles are left", triangles(&app, cloth));
    assert!(mass(&app, cloth) < 0.6 * heavy);
    assert!(get::<Particles>(&app, cloth).is_finite());
}

#[test]
fn a_cloth_that_is_not_flammable_does_not_light_and_a_cold_one_moves_the_same_to_the_bit() {
    let mut app = headless();
    let cloth = || (Cloth::rectangle(0.5, 0.5).with_cells(16, 16), Pins::top());
    let plain = app.world_mut().spawn(cloth()).id();
    let flammable = app.world_mut().spawn((cloth(), Flammable::default())).id();
    run(&mut app, 4);
    light(&mut app, plain, [0.0, 0.0]);
    run(&mut app, 64);
    assert!(app.world().get::<ClothFire>(plain).is_none());
    assert_eq!(bits(&app, plain), bits(&app, flammable));
}

#[test]
fn water_puts_it_out_and_what_is_wet_does_not_light() {
    let mut app = headless();
    let cloth = hung(&mut app, Flammable::default());
    light(&mut app, cloth, [0.0, 0.0]);
    run(&mut app, 32);
    assert!(get::<ClothFire>(&app, cloth).flaming() > 0);
    let water = WetCloth { entity: cloth, position: Vec3::ZERO, radius: 1.0, water: 1.0 };
    app.world_mut().trigger(water);
    run(&mut app, 2);
    assert_eq!(get::<ClothFire>(&app, cloth).flaming(), 0);
    light(&mut app, cloth, [0.1, 0.1]);
    run(&mut app, 64);
    assert_eq!(get::<ClothFire>(&app, cloth).flaming(), 0);
}

#[test]
fn the_seed_of_a_contagion_decides_which_fire_it_is() {
    let burnt = |seed| {
        let mut app = headless();
        let flammable = Flammable::Contagion(Contagion { seed, ..default() });
        let cloth = hung(&mut app, flammable);
        light(&mut app, cloth, [0.0, 0.0]);
        run(&mut app, 64 * 8);
        assert!(triangles(&app, cloth) < 512, "it burns through");
        (bits(&app, cloth), get::<ClothTopology>(&app, cloth).triangles.clone())
    };
    let (one, again, other) = (burnt(1), burnt(1), burnt(2));
    assert!(one == again, "the same seed, the same fire");
    assert!(one.1 != other.1, "another seed, another fire");
}

#[test]
fn a_reset_makes_a_burnt_cloth_whole_and_cold() {
    let mut app = headless();
    let cloth = hung(&mut app, Flammable::default());
    let (whole, heavy) = (triangles(&app, cloth), mass(&app, cloth));
    light(&mut app, cloth, [0.0, -0.2]);
    run(&mut app, 64 * 12);
    assert!(triangles(&app, cloth) < whole);
    app.world_mut().trigger(ResetCloth { entity: cloth });
    run(&mut app, 3);
    assert_eq!(triangles(&app, cloth), whole);
    assert!((mass(&app, cloth) / heavy - 1.0).abs() < 1e-6);
    assert!(!get::<ClothFire>(&app, cloth).is_warm());
}

#[test]
fn a_cloth_torn_cut_held_and_burning_at_once_stays_finite() {
    let mut app = headless();
    let cloth = hung(&mut app, Flammable::default());
    app.world_mut().entity_mut(cloth).insert((Tearable::default(), Air::default(), Wind(Vec3::new(2.0, 0.0, 1.0))));
    light(&mut app, cloth, [0.0, -0.2]);
    let grab = Grab { triangle: 250, target: Vec3::new(0.2, 0.1, 0.4), ..default() };
    app.world_mut().entity_mut(cloth).insert(Grabs(vec![grab]));
    for round in 0..60 {
        let x = 0.2 * (round as f32 * 0.7).sin();
        let ray = |y: f32| Ray3d::new(Vec3::new(x, y, 2.0), Dir3::NEG_Z);
        app.world_mut().trigger(CutCloth { entity: cloth, from: ray(-0.5), to: ray(-0.1), reach: 10.0 });
        let pull = if round % 2 == 0 { Direction::Weft } else { Direction::Warp };
        app.world_mut().trigger(TearCloth { entity: cloth, position: Vec3::new(-x, 0.1, 0.0), pull });
        run(&mut app, 8);
        assert!(get::<Particles>(&app, cloth).is_finite(), "round {round}");
    }
    assert!(app.world().get::<ClothRejection>(cloth).is_none());
}

#[test]
fn a_wrong_flammability_is_refused_by_name() {
    let mut app = headless();
    let flammable = Flammable::Heat(Flammability { heat_flux: -1.0, ..default() });
    let cloth = hung(&mut app, flammable);
    let text = get::<ClothRejection>(&app, cloth).error().to_string();
    assert!(text.contains("heat_flux") && text.contains("-1"), "{text}");
}

#[test]
fn a_middle_click_lights_and_with_water_in_hand_puts_out() {
    let mut app = with_pointer();
    let cloth = hung(&mut app, Flammable::default());
    let act = |app: &mut App, action| {
        send(app, [400.0, 300.0], action);
        app.update();
    };
    act(&mut app, PointerAction::Move { delta: Vec2::ZERO });
    act(&mut app, PointerAction::Press(PointerButton::Middle));
    act(&mut app, PointerAction::Release(PointerButton::Middle));
    run(&mut app, 16);
    assert!(get::<ClothFire>(&app, cloth).flaming() > 0);
    app.world_mut().resource_mut::<ClothPicking>().tool = FireTool::Water;
    act(&mut app, PointerAction::Press(PointerButton::Middle));
    run(&mut app, 2);
    assert_eq!(get::<ClothFire>(&app, cloth).flaming(), 0);
}
