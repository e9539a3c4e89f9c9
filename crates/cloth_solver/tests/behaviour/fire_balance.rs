//! What fire by heat does to the particles: water, fuel, what follows from them, and what never happens.

use crate::common::fire::*;
use cloth_solver::damage::fire::*;
use cloth_solver::damage::{self, Blade, cut};
use cloth_solver::{ClothError, Fabric, Fire, Flammable};
use glam::Vec3;

const LATENT_HEAT: f32 = 2.26e6;

#[test]
fn wet_cloth_does_not_light_before_its_water_has_boiled_away() {
    let lights_after = |water: f32| {
        // Flames that burn as long as the test lasts.
        let slow = Flammability { mass_loss_rate: 1e-3, ..TALL_FLAMES };
        let mut strip = Burning::new(sheet([0.02, 0.04], 0.02), &SHEET, &Flammable::Heat(slow));
        strip.fire.wet(&strip.particles, Vec3::ZERO, 0.015, water).unwrap();
        let middle = strip.slots(|rest| rest.y.abs() < 1e-3)[0];
        assert_eq!(strip.fire.ignite_particle(middle), Ok(water == 0.0));
        strip.light(|rest| rest.y < -0.015);
        while strip.lit_at[middle as usize].is_infinite() && strip.time < 60.0 {
            let wet = strip.fire.moisture()[middle as usize];
            strip.tick();
            let hot = strip.fire.temperature()[middle as usize];
            assert!(strip.fire.moisture()[middle as usize] <= wet);
            assert!(wet == 0.0 || hot < 373.2 || strip.fire.moisture()[middle as usize] == 0.0, "{hot} K and wet");
        }
        strip.lit_at[middle as usize]
    };
    let first = lights_after(0.0);
    assert!(first <= DT);
    for water in [0.02, 0.1, 0.4] {
        let expected = (TO_IGNITION + water * LATENT_HEAT) / Flammability::COTTON.heat_flux;
        assert!((lights_after(water) - expected).abs() < 0.05, "{} s, not {expected} s", lights_after(water));
    }
}

#[test]
fn water_puts_fire_out_and_it_does_not_light_again() {
    let mut sheet = Burning::cotton(sheet([0.4, 0.4], 0.02));
    sheet.light(|rest| rest.length() < 0.03);
    sheet.run(2.5);
    assert!(sheet.fire.flaming() > 10);
    sheet.fire.wet(&sheet.particles, Vec3::ZERO, 0.5, 0.3).unwrap();
    sheet.tick();
    assert_eq!(sheet.fire.flaming(), 0);
    let fuel = sheet.fire.fuel().to_vec();
    sheet.run(60.0);
    assert_eq!(sheet.fire.flaming(), 0);
    assert_eq!(sheet.fire.fuel(), fuel, "it went on burning");
    assert!(!sheet.fire.is_warm());
}

#[test]
fn water_on_the_flames_alone_stops_the_front_as_well() {
    let mut sheet = Burning::cotton(sheet([0.4, 0.4], 0.02));
    sheet.light(|rest| rest.length() < 0.03);
    sheet.run(0.6);
    let flaming = sheet.fire.flaming();
    assert!(flaming > 0);
    sheet.fire.wet(&sheet.particles, Vec3::ZERO, 0.031, 0.3).unwrap();
    sheet.run(60.0);
    assert_eq!((sheet.fire.flaming(), sheet.fire.is_warm()), (0, false));
    assert_eq!(sheet.lit_at.iter().filter(|at| at.is_finite()).count(), flaming);
}

#[test]
fn too_little_water_does_not_put_fire_out() {
    let mut sheet = Burning::cotton(sheet([0.2, 0.2], 0.02));
    sheet.light(|_| true);
    sheet.run(1.5);
    let hot = sheet.fire.temperature()[0];
    sheet.fire.wet(&sheet.particles, Vec3::ZERO, 1.0, 0.01).unwrap();
    let cooled = hot - sheet.fire.temperature()[0];
    let expected = 0.01 * LATENT_HEAT / (0.15 * 1340.0 * sheet.fire.mass_factor()[0]);
    assert!((cooled / expected - 1.0).abs() < 1e-3, "by {cooled} K, not {expected} K");
    sheet.tick();
    assert!(sheet.fire.flaming() > 0);
}

#[test]
fn hot_cloth_out_of_the_flame_cools_by_convection_and_radiation() {
    // Heated and left alone: 20 (T − T_air) + 2 · 0.9 σ_SB (T⁴ − T_air⁴), against the equation in f64.
    let mut strip = Burning::cotton(sheet([0.02, 0.04], 0.02));
    strip.light(|rest| rest.y < -0.015);
    let middle = strip.slots(|rest| rest.y.abs() < 1e-3)[0] as usize;
    while strip.fire.temperature()[middle] < 450.0 {
        strip.tick();
    }
    strip.fire.wet(&strip.particles, Vec3::NEG_Y * 0.02, 0.011, 1.0).unwrap();
    // Until what was found to be in the flame has been looked up anew.
    strip.run(0.3);
    let mut expected = f64::from(strip.fire.temperature()[middle]);
    for _ in 0..20_000 {
        let radiated = 1.8 * 5.670_374e-8 * (expected.powi(4) - 293.15_f64.powi(4));
        expected -= 1e-4 * (20.0 * (expected - 293.15) + radiated) / (0.15 * 1340.0);
    }
    strip.run(2.0);
    let found = f64::from(strip.fire.temperature()[middle]);
    assert!(((found - 293.15) / (expected - 293.15) - 1.0).abs() < 0.03, "{found} K, not {expected} K");
}

#[test]
fn a_flame_burns_as_long_as_its_fuel_lasts_and_leaves_the_char() {
    let mut sheet = Burning::cotton(sheet([0.1, 0.1], 0.02));
    sheet.light(|_| true);
    let mass: f32 = 0.15 * (1.0 - Flammability::COTTON.char);
    let expected = mass * 0.95 / Flammability::COTTON.mass_loss_rate;
    while sheet.fire.flaming() > 0 || sheet.time == 0.0 {
        sheet.tick();
    }
    assert!((sheet.time - expected).abs() < 0.05, "{} s, not {expected} s", sheet.time);
    sheet.run(Flammability::COTTON.afterglow + 60.0);
    assert!(
        sheet.slots(|_| true).iter().all(|slot| sheet.fire.mass_factor()[*slot as usize] == Flammability::COTTON.char)
    );
    assert!(!sheet.fire.is_warm());
}

#[test]
fn burnt_triangles_are_told_once_in_order_and_in_the_end_all() {
    let mut sheet = Burning::cotton(sheet([0.2, 0.2], 0.02));
    sheet.light(|rest| rest.y < -0.09);
    let mut gone = Vec::new();
    while sheet.time < 40.0 {
        sheet.tick();
        let told = sheet.fire.burnt_through();
        assert!(told.is_sorted());
        let burnt = |slot: &u32| sheet.fire.fuel()[*slot as usize] <= 0.05;
        assert!(told.iter().all(|triangle| sheet.topology.triangles[*triangle as usize].iter().all(burnt)));
        gone.extend_from_slice(told);
    }
    gone.sort_unstable();
    assert_eq!(gone, (0..sheet.topology.triangles.len() as u32).collect::<Vec<_>>());
    assert!(sheet.slots(|_| true).iter().all(|slot| sheet.stage(*slot) == Stage::Gone));
}

#[test]
fn the_rim_of_a_hole_is_ember_and_glows_while_the_rest_is_out() {
    let mut sheet = Burning::cotton(sheet([0.4, 0.4], 0.02));
    // Wet all around, so that the fire stays within.
    for corner in [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y] {
        sheet.fire.wet(&sheet.particles, corner * 0.25, 0.2, 2.0).unwrap();
    }
    sheet.fire.ignite(&sheet.particles, Vec3::ZERO, 0.045).unwrap();
    sheet.run(1.0);
    while sheet.fire.flaming() > 0 {
        sheet.tick();
    }
    let embers: Vec<u32> =
        sheet.slots(|_| true).into_iter().filter(|slot| sheet.stage(*slot) == Stage::Ember).collect();
    assert!(!embers.is_empty());
    assert!(embers.iter().all(|slot| sheet.fire.temperature()[*slot as usize] > 800.0));
    sheet.run(60.0);
    assert!(embers.iter().all(|slot| sheet.stage(*slot) == Stage::Ember));
    assert!(!sheet.fire.is_warm());
}

#[test]
fn polyester_melts_away_from_heat_that_does_not_light_it() {
    let [cotton, polyester] = [Flammability::COTTON, Flammability::POLYESTER].map(|flammability| {
        let mut strip = Burning::new(sheet([0.02, 0.04], 0.02), &SHEET, &Flammable::Heat(flammability));
        strip.light(|rest| rest.y < -0.015);
        let middle = strip.slots(|rest| rest.y.abs() < 1e-3)[0];
        while strip.fire.temperature()[middle as usize] < 600.0 {
            strip.tick();
        }
        assert_eq!(strip.stage(middle), Stage::Heating);
        (strip.fire.fuel()[middle as usize], strip.fire.rest_scale()[middle as usize])
    });
    assert!(cotton.0 == 1.0 && cotton.1 > 0.94, "{cotton:?}");
    assert!(polyester.0 < 0.95 && polyester.1 <= 0.7 + 1e-6, "{polyester:?}");
}

#[test]
fn a_cold_cloth_stays_as_it_is() {
    let mut sheet = Burning::cotton(sheet([0.2, 0.2], 0.02));
    let before = format!("{:?}", sheet.fire);
    sheet.run(1.0);
    assert!(!sheet.fire.is_warm());
    assert_eq!(format!("{:?}", sheet.fire), before);
    assert!(sheet.slots(|_| true).iter().all(|slot| sheet.stage(*slot) == Stage::Virgin));
}

#[test]
fn the_same_fire_burns_alike_to_the_bit_and_no_time_changes_nothing() {
    let burn = || {
        let mut sheet = Burning::cotton(mesh([0.3, 0.3], 0.02, 0.3));
        sheet.around.wind = Vec3::new(0.4, 0.0, 0.2);
        sheet.fire.ignite(&sheet.particles, Vec3::new(0.15, 0.1, 0.0), 0.03).unwrap();
        sheet.run(4.0);
        sheet
    };
    let (one, mut two) = (burn(), burn());
    let bits = |sheet: &Burning| sheet.fire.temperature().iter().map(|t| t.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&one), bits(&two));
    for dt in [0.0, -1.0, f32::NAN] {
        two.dt = dt;
        two.tick();
    }
    assert_eq!(bits(&one), bits(&two));
}

#[test]
fn what_is_born_of_burning_cloth_burns_as_its_parents_do() {
    let mut sheet = Burning::cotton(mesh([0.1, 0.1], 0.02, 0.3));
    sheet.light(|rest| rest.y < 0.03);
    sheet.run(2.0);
    let (before, old) = (sheet.topology.clone(), sheet.fire.clone());
    let blade = Blade {
        from: [Vec3::new(-0.01, 0.037, 1.0), Vec3::new(-0.01, 0.037, -1.0)],
        to: [Vec3::new(0.11, 0.061, 1.0), Vec3::new(0.11, 0.061, -1.0)],
    };
    let position = sheet.particles.position.clone();
    let change = cut(&mut sheet.topology, &position, &blade).unwrap().change;
    sheet.follow(&before, &change);
    assert!(change.born.iter().any(|born| born.t > 0.0) && change.born.iter().any(|born| born.t == 0.0));
    for born in &change.born {
        let values =
            |fire: &Fire, slot: u32| [fire.temperature(), fire.fuel(), fire.scorch()].map(|v| v[slot as usize]);
        for k in 0..3 {
            let blend = born.blend(|parent| values(&sheet.fire, parent as u32)[k]);
            assert!((values(&sheet.fire, born.slot)[k] - blend).abs() < 1e-3);
        }
    }
    assert_eq!(old.temperature()[..40], sheet.fire.temperature()[..40]);
    assert_eq!(sheet.fire.fuel().len(), sheet.topology.slots());
    for _ in 0..1800 {
        sheet.tick();
        sheet.take_out();
    }
    assert!(sheet.topology.triangles.is_empty(), "{} are left", sheet.topology.triangles.len());
}

#[test]
fn a_fire_whose_cloth_is_taken_out_as_it_burns_through_spreads_as_fast() {
    let lit = |takes_out: bool| {
        let mut strip = Burning::cotton(sheet([0.2, 1.0], 0.02));
        strip.light(|rest| rest.y < -0.499 && rest.x < -0.05);
        for _ in 0..900 {
            strip.tick();
            if takes_out {
                strip.take_out();
            }
        }
        assert_eq!(takes_out, strip.topology.triangles.len() < 900);
        strip.lit_at.iter().filter(|at| at.is_finite()).count() as f32
    };
    let (whole, taken) = (lit(false), lit(true));
    assert!(whole < 540.0 && (taken / whole - 1.0).abs() < 0.02, "{taken} particles instead of {whole}");
}

#[test]
fn a_cloth_whose_change_was_not_followed_is_refused() {
    let mut sheet = Burning::cotton(sheet([0.1, 0.1], 0.02));
    damage::remove(&mut sheet.topology, &[3]).unwrap();
    let found = sheet.fire.burn(&sheet.topology, &sheet.particles, &sheet.around, DT);
    assert!(matches!(found, Err(ClothError::OutOfRange { .. })), "{found:?}");
}

#[test]
fn the_fabric_may_change_while_it_burns() {
    let mut sheet = Burning::cotton(sheet([0.1, 0.4], 0.02));
    sheet.light(|rest| rest.y < -0.19);
    sheet.run(1.0);
    let temperature = sheet.fire.temperature().to_vec();
    let heavy = Fabric { areal_density: 0.6, ..SHEET };
    sheet.fire.set(&sheet.topology, &heavy, &Flammable::default()).unwrap();
    assert_eq!(sheet.fire.temperature(), temperature);
    sheet.fire.set(&sheet.topology, &SHEET, &Flammable::Contagion(Contagion::default())).unwrap();
    assert!(!sheet.fire.is_warm());
}
