//! Flammable cloth is lit, burns upward, goes through, tears easier, is put out by water and whole after a reset.

use crate::common::*;
use bevy::picking::pointer::{PointerAction, PointerButton};
use bevy::prelude::*;
use bevy_cloth::*;

fn hung(app: &mut App, more: impl Bundle) -> Entity {
    let cloth = (Cloth::rectangle(0.25, 0.25).with_cells(8, 8), Pins::top());
    let cloth = app.world_mut().spawn(cloth).insert(more).id();
    run(app, 4);
    cloth
}

/// Burns up within two seconds, in every direction.
fn tinder() -> Flammable {
    let flame = Flammability { heat_flux: 2e5, mass_loss_rate: 0.15, reach_across: 0.2, reach_down: 0.2, ..default() };
    Flammable::Heat(Flammability { afterglow: 0.1, ..flame })
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
fn a_match_at_the_foot_lights_the_cloth_which_burns_up() {
    let mut app = headless();
    let cloth = hung(&mut app, Flammable::default());
    note_events::<ClothIgnited>(&mut app);
    light(&mut app, cloth, [0.0, -0.12]);
    run(&mut app, 2);
    assert_eq!(seen::<ClothIgnited>(&app).len(), 1);
    assert!(seen::<ClothIgnited>(&app)[0].position.y < -0.1);
    run(&mut app, 64 * 3);
    let fire = get::<ClothFire>(&app, cloth);
    let topology = get::<ClothTopology>(&app, cloth);
    let hot = topology.particles().filter(|slot| fire.temperature()[*slot as usize] > 500.0);
    let highest = hot.map(|slot| topology.rest[slot as usize].y).fold(f32::NEG_INFINITY, f32::max);
    assert!(highest > 0.0, "after three seconds it burns up to {highest} m");
}

#[test]
fn what_burns_goes_through_loses_its_mass_and_is_told_to_have_burnt_out() {
    let mut app = headless();
    let cloth = hung(&mut app, tinder());
    note_events::<ClothBurntThrough>(&mut app);
    note_events::<ClothBurntOut>(&mut app);
    note_events::<ClothExtinguished>(&mut app);
    let (before, heavy) = (triangles(&app, cloth), mass(&app, cloth));
    light(&mut app, cloth, [0.0, -0.12]);
    run(&mut app, 64 * 3);
    let gone: u32 = seen::<ClothBurntThrough>(&app).iter().map(|told| told.triangles).sum();
    assert_eq!(gone as usize, before, "every triangle is told once");
    assert_eq!(triangles(&app, cloth), 0);
    assert!(mass(&app, cloth) < 1e-6 * heavy);
    assert!(get::<Particles>(&app, cloth).is_finite());
    assert_eq!(seen::<ClothBurntOut>(&app).len(), 1);
    assert_eq!(take_messages::<ClothBurntOut>(&mut app).len() + take_messages::<ClothExtinguished>(&mut app).len(), 0);
    assert!(seen::<ClothExtinguished>(&app).is_empty());
}

#[test]
fn the_last_flame_to_go_out_is_told_at_once_though_the_cloth_is_hot() {
    let mut app = headless();
    let flammable = Flammable::Heat(Flammability { afterglow: 1000.0, mass_loss_rate: 0.25, ..default() });
    let cloth = hung(&mut app, (flammable, Gravity(Vec3::ZERO)));
    note_events::<ClothExtinguished>(&mut app);
    // Where nothing is near enough to light, what was lit burns down alone.
    let wet = WetCloth { entity: cloth, position: Vec3::ZERO, radius: 1.0, water: 1.0 };
    light(&mut app, cloth, [0.0, 0.0]);
    run(&mut app, 2);
    assert!(seen::<ClothExtinguished>(&app).is_empty());
    let burning = get::<ClothFire>(&app, cloth).flame().expect("it burns");
    app.world_mut().trigger(wet);
    app.update();
    let &[told] = seen::<ClothExtinguished>(&app) else { panic!("{:?}", seen::<ClothExtinguished>(&app)) };
    assert_eq!((told.entity, told.particle), (cloth, burning));
    assert!(told.position.length() < 0.05);
    assert_eq!(take_messages::<ClothExtinguished>(&mut app), [told]);
    assert!(get::<ClothFire>(&app, cloth).is_warm(), "hot and wet");
}

#[test]
fn a_weight_on_burning_cloth_stays_what_it_is_until_its_particle_is_gone() {
    let weight = |cells: u32| Weights::one(PinSelect::Vertices(vec![cells * (cells + 1) + cells / 2]), 0.05);
    let mut app = headless();
    let rule = Flammability { mass_loss_rate: 0.25, ..default() };
    let cloth = hung(&mut app, (Flammable::Heat(rule), weight(8)));
    let plain = hung(&mut app, Flammable::Heat(rule));
    for cloth in [cloth, plain] {
        app.world_mut().trigger(IgniteCloth { entity: cloth, position: Vec3::ZERO, radius: 1.0 });
    }
    // All burns alike, and all of it is still there when three quarters of it are lost.
    while get::<ClothFire>(&app, plain).fuel()[0] > 0.2 {
        app.update();
        let [more, less] = [cloth, plain].map(|cloth| mass(&app, cloth));
        assert!((more - less - 0.05).abs() < 1e-6, "the weight is {} kg", more - less);
    }
    // Another fabric, or another weight, is that of burnt cloth.
    app.world_mut().entity_mut(cloth).insert(Weights::one(PinSelect::Vertices(vec![76]), 0.02));
    let denim = Fabric { areal_density: 2.0 * Fabric::default().areal_density, ..default() };
    app.world_mut().entity_mut(plain).insert(denim);
    let before = mass(&app, plain);
    app.update();
    let [more, less] = [cloth, plain].map(|cloth| mass(&app, cloth));
    assert!((less / before - 2.0).abs() < 0.1, "{before} kg became {less}");
    assert!((more - 0.02 - before).abs() < 0.1 * before, "{more} kg");
}

#[test]
fn a_cloth_that_is_not_flammable_does_not_light_and_a_cold_one_moves_the_same_to_the_bit() {
    let mut app = headless();
    let cloth = || (Cloth::rectangle(0.25, 0.25).with_cells(8, 8), Pins::top());
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
    note_events::<ClothExtinguished>(&mut app);
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
    assert_eq!(seen::<ClothExtinguished>(&app).len(), 1);
}

#[test]
fn water_puts_out_a_contagion_and_its_end_is_told() {
    let mut app = headless();
    let cloth = hung(&mut app, Flammable::Contagion(Contagion::default()));
    note_events::<ClothExtinguished>(&mut app);
    light(&mut app, cloth, [0.0, 0.0]);
    run(&mut app, 32);
    assert!(get::<ClothFire>(&app, cloth).flaming() > 0);
    app.world_mut().trigger(WetCloth { entity: cloth, position: Vec3::ZERO, radius: 1.0, water: 1.0 });
    run(&mut app, 2);
    assert_eq!(get::<ClothFire>(&app, cloth).flaming(), 0);
    assert_eq!(seen::<ClothExtinguished>(&app).len(), 1);
}

#[test]
fn the_seed_of_a_contagion_decides_which_fire_it_is() {
    let burnt = |seed| {
        let mut app = headless();
        let flammable = Flammable::Contagion(Contagion { rate: 1.0, spread: 20.0, seed });
        let cloth = hung(&mut app, flammable);
        light(&mut app, cloth, [0.0, 0.0]);
        run(&mut app, 64 * 2);
        assert!(triangles(&app, cloth) < 128, "it burns through");
        (bits(&app, cloth), get::<ClothTopology>(&app, cloth).triangles.clone())
    };
    let (one, again, other) = (burnt(1), burnt(1), burnt(2));
    assert!(one == again, "the same seed, the same fire");
    assert!(one.1 != other.1, "another seed, another fire");
}

#[test]
fn a_reset_makes_a_burnt_cloth_whole_and_cold() {
    let mut app = headless();
    let cloth = hung(&mut app, tinder());
    let (whole, heavy) = (triangles(&app, cloth), mass(&app, cloth));
    light(&mut app, cloth, [0.0, -0.1]);
    run(&mut app, 64 * 2);
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
    light(&mut app, cloth, [0.0, -0.1]);
    let grab = Grab { triangle: 60, target: Vec3::new(0.2, 0.1, 0.4), ..default() };
    app.world_mut().entity_mut(cloth).insert(Grabs(vec![grab]));
    for round in 0..60 {
        let x = 0.1 * (round as f32 * 0.7).sin();
        let ray = |y: f32| Ray3d::new(Vec3::new(x, y, 2.0), Dir3::NEG_Z);
        app.world_mut().trigger(CutCloth { entity: cloth, from: ray(-0.25), to: ray(-0.05), reach: 10.0 });
        let pull = if round % 2 == 0 { Direction::Weft } else { Direction::Warp };
        app.world_mut().trigger(TearCloth { entity: cloth, position: Vec3::new(-x, 0.05, 0.0), pull });
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
    app.world_mut().resource_mut::<ClothPicking>().middle = Some(ClothTool::Water);
    act(&mut app, PointerAction::Press(PointerButton::Middle));
    run(&mut app, 2);
    assert_eq!(get::<ClothFire>(&app, cloth).flaming(), 0);
}

#[test]
fn match_and_water_are_drawn_across_the_cloth_until_the_button_is_up() {
    const MOVE: PointerAction = PointerAction::Move { delta: Vec2::ZERO };
    let mut app = with_pointer();
    let cloth = hung(&mut app, Flammable::default());
    let act = |app: &mut App, x: f32, action| {
        send(app, [x, 300.0], action);
        app.update();
    };
    let sweep = |app: &mut App, from: u32, to: u32| (from..=to).for_each(|step| act(app, 10.0 * step as f32, MOVE));
    let between = |app: &App, from: f32, to: f32, is_so: &dyn Fn(&ClothFire, usize) -> bool| {
        let fire = get::<ClothFire>(app, cloth);
        let rest = &get::<ClothTopology>(app, cloth).rest;
        let near = |slot: &usize| (from..to).contains(&rest[*slot].x) && rest[*slot].y.abs() < 0.04;
        (0..rest.len()).filter(near).filter(|slot| is_so(fire, *slot)).count()
    };
    let is_hot = |fire: &ClothFire, slot: usize| fire.temperature()[slot] > 500.0;
    // A pixel is 2.8 mm on the cloth, the middle of the picture its middle.
    act(&mut app, 370.0, MOVE);
    act(&mut app, 370.0, PointerAction::Press(PointerButton::Middle));
    sweep(&mut app, 37, 42);
    act(&mut app, 420.0, PointerAction::Release(PointerButton::Middle));
    sweep(&mut app, 42, 44);
    let [left, middle, right] = [(-0.1, -0.05), (-0.02, 0.07), (0.09, 0.13)].map(|(a, b)| between(&app, a, b, &is_hot));
    assert!(left > 0 && middle > 1, "{left} and {middle} particles are alight");
    assert_eq!(right, 0, "the button is up");
    app.world_mut().resource_mut::<ClothPicking>().middle = Some(ClothTool::Water);
    act(&mut app, 370.0, PointerAction::Press(PointerButton::Middle));
    run(&mut app, 64);
    sweep(&mut app, 37, 42);
    act(&mut app, 420.0, PointerAction::Release(PointerButton::Middle));
    let fire = get::<ClothFire>(&app, cloth);
    assert_eq!(fire.flaming(), 0);
    let wettest = fire.moisture().iter().copied().fold(0.0, f32::max);
    assert!(wettest > 1.2, "half a litre, and a second more of one, less steam: {wettest} kg/m²");
    run(&mut app, 64);
    let after = get::<ClothFire>(&app, cloth).moisture().iter().copied().fold(0.0, f32::max);
    assert!(after <= wettest, "the button is up");
}
