//! What hangs on a cloth pulls it down, and can be hung on, changed and taken off at any time.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;

const CELLS: u32 = 10;
/// The lower right corner of a square of so many cells.
const CORNER: u32 = (CELLS + 1) * (CELLS + 1) - 1;

fn corner() -> PinSelect {
    PinSelect::Vertices(vec![CORNER])
}

/// A square of jersey that hangs by its top edge.
fn hung(app: &mut App) -> Entity {
    let cloth = Cloth::rectangle(0.5, 0.5).with_cells(CELLS, CELLS);
    let fabric = Fabric { damping: 5.0, ..Fabric::COTTON_JERSEY };
    app.world_mut().spawn((cloth, fabric, Pins::top())).id()
}

fn heights(app: &App, cloth: Entity) -> (f32, f32) {
    let positions = world_positions(app, cloth);
    (positions[(CORNER - CELLS) as usize].y, positions[CORNER as usize].y)
}

fn total_mass(app: &App, cloth: Entity) -> f32 {
    get::<Particles>(app, cloth).mass.iter().sum()
}

#[test]
fn a_weight_pulls_its_corner_down_and_without_it_the_corner_rises() {
    let mut app = headless();
    let cloth = hung(&mut app);
    run(&mut app, 200);
    let (_, before) = heights(&app, cloth);
    app.world_mut().entity_mut(cloth).insert(Weights::one(corner(), 0.02));
    run(&mut app, 300);
    let (other, pulled) = heights(&app, cloth);
    assert!(pulled < before - 0.01, "{before} m before, {pulled} m with the weight");
    assert!(pulled < other - 0.01, "the corner without a weight is at {other} m, the other at {pulled} m");
    app.world_mut().entity_mut(cloth).remove::<Weights>();
    run(&mut app, 300);
    let (_, after) = heights(&app, cloth);
    assert!(after - pulled > 0.9 * (before - pulled), "{before} m before, {pulled} m with the weight, {after} m after");
}

#[test]
fn hanging_a_weight_on_changing_and_removing_it_leaves_the_shape_as_it_is() {
    let mut app = headless();
    let cloth = hung(&mut app);
    run(&mut app, 60);
    let changes: [fn(&mut EntityWorldMut); 3] = [
        |cloth| _ = cloth.insert(Weights::one(corner(), 0.01)),
        |cloth| _ = cloth.insert(Weights::one(PinSelect::Corners, 0.02)),
        |cloth| _ = cloth.remove::<Weights>(),
    ];
    for change in changes {
        let before = world_positions(&app, cloth);
        change(&mut app.world_mut().entity_mut(cloth));
        run(&mut app, 1);
        let moved = largest_move(&before, &world_positions(&app, cloth));
        assert!(moved < 0.01, "a point went {moved} m in a tick");
        assert!(app.world().get::<ClothRejection>(cloth).is_none());
    }
}

#[test]
fn the_chosen_particles_share_a_weight_and_two_weights_add_up() {
    let mut app = headless();
    let cloth = hung(&mut app);
    run(&mut app, 2);
    let bare = get::<Particles>(&app, cloth).mass.clone();
    let weights = Weights::one(PinSelect::Top, 1.1).and(Weights::one(corner(), 0.5)).and(Weights::one(corner(), 0.25));
    app.world_mut().entity_mut(cloth).insert(weights);
    run(&mut app, 2);
    let topology = get::<ClothTopology>(&app, cloth);
    let mass = &get::<Particles>(&app, cloth).mass;
    for vertex in [0, CELLS, CORNER] {
        let slot = topology.vertex_particle[vertex as usize] as usize;
        let expected = if vertex == CORNER { 0.75 } else { 0.1 };
        assert!(
            (mass[slot] - bare[slot] - expected).abs() < 1e-6,
            "vertex {vertex} carries {}",
            mass[slot] - bare[slot]
        );
    }
}

#[test]
fn a_weight_stays_on_a_cloth_that_gets_another_fabric_other_pins_or_is_recovered() {
    let mut app = headless();
    let cloth = hung(&mut app);
    app.world_mut().entity_mut(cloth).insert(Weights::one(corner(), 0.5));
    run(&mut app, 3);
    let area = 0.25;
    let carried = |app: &App, density: f32| total_mass(app, cloth) - density * area;
    assert!((carried(&app, Fabric::COTTON_JERSEY.areal_density) - 0.5).abs() < 1e-5);
    app.world_mut().entity_mut(cloth).insert((Fabric::CANVAS, Pins::corners()));
    run(&mut app, 3);
    assert!((carried(&app, Fabric::CANVAS.areal_density) - 0.5).abs() < 1e-5);
    app.world_mut().get_mut::<Particles>(cloth).unwrap().velocity.x[5] = f32::NAN;
    run(&mut app, 3);
    assert!(get::<Particles>(&app, cloth).is_finite());
    assert!((carried(&app, Fabric::CANVAS.areal_density) - 0.5).abs() < 1e-5);
}

#[test]
fn a_wrong_weight_is_refused_by_name_and_a_mended_one_goes_on() {
    let mut app = headless();
    let cloth = hung(&mut app);
    run(&mut app, 2);
    for (select, mass, expected) in [
        (corner(), f32::NAN, "`Weight::mass` is NaN, allowed is 0..=1,000,000 kg"),
        (corner(), -1.0, "`Weight::mass` is -1"),
        (PinSelect::Vertices(vec![9999]), 1.0, "9999"),
    ] {
        app.world_mut().entity_mut(cloth).insert(Weights::one(select, mass));
        run(&mut app, 2);
        let error = get::<ClothRejection>(&app, cloth).error().to_string();
        assert!(error.contains(expected), "{error}");
        app.world_mut().entity_mut(cloth).insert(Weights::one(corner(), 0.1));
        run(&mut app, 2);
        assert!(app.world().get::<ClothRejection>(cloth).is_none());
    }
}
