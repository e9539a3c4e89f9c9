//! What fire by heat never does, whatever the fabric and the tick, and what it refuses.

use crate::common::fire::*;
use cloth_solver::damage::fire::*;
use cloth_solver::{ClothError, Fabric, Fire, Flammable, Particles, Topology};
use glam::Vec3;
use proptest::prelude::*;

#[test]
fn fuel_and_what_follows_from_it_never_come_back_and_nothing_gets_hotter_than_the_flame() {
    for (dt, areal_density) in [(1.0 / 240.0, 0.15), (1.0 / 60.0, 0.15), (0.1, 0.15), (0.1, 1e-3), (5.0, 0.02)] {
        for (name, flammability) in Flammability::PRESETS {
            let fabric = Fabric { areal_density, ..SHEET };
            let mut sheet = Burning::new(sheet([0.3, 0.3], 0.02), &fabric, &Flammable::Heat(*flammability));
            sheet.dt = dt;
            sheet.light(|rest| rest.y < -0.14);
            let told = |fire: &Fire| {
                [fire.fuel(), fire.strength(), fire.stiffness(), fire.rest_scale(), fire.mass_factor()].concat()
            };
            for tick in 0..200 {
                let before = told(&sheet.fire);
                sheet.tick();
                let after = told(&sheet.fire);
                assert!(after.iter().zip(&before).all(|(after, before)| after <= before && *after >= 0.0), "{name}");
                let range = ROOM_TEMPERATURE - 0.02..=FLAME_TEMPERATURE + 0.01;
                assert!(sheet.fire.temperature().iter().all(|t| range.contains(t)), "{name}, tick {tick} of {dt} s");
                if tick == 50 {
                    sheet.fire.wet(&sheet.particles, Vec3::ZERO, 0.1, 0.02).unwrap();
                }
            }
            assert!(sheet.fire.char().iter().any(|char| *char > 0.5) || dt < 0.01, "{name}");
        }
    }
}

#[test]
fn coarse_and_fine_meshes_burn_as_fast() {
    for (size, spacing) in [([3.0, 12.0], 1.0), ([0.002, 1.0], 0.001)] {
        let rate = Burning::cotton(sheet(size, spacing)).speed(|rest| rest.y);
        assert!((rate / 0.09 - 1.0).abs() < 0.05, "{rate} m/s with cells of {spacing} m");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn no_allowed_fabric_surroundings_or_tick_makes_it_explode(
        heats in prop::array::uniform4(0.0_f32..1.0),
        reaches in prop::array::uniform3(-4.0_f32..1.0),
        rest in prop::array::uniform5(0.0_f32..1.0),
        wind in prop::array::uniform3(-1.0_f32..1.0),
        power in -3.0_f32..6.0,
    ) {
        let ten = |exponent: f32| 10.0_f32.powf(exponent);
        let ignition = 400.0 + 600.0 * heats[1];
        let flammability = Flammability {
            specific_heat: ten(2.0 + 2.0 * heats[0]),
            conductivity: 10.0 * heats[3],
            ignition,
            decomposition: 380.0 + (ignition - 380.0) * heats[2],
            heat_flux: ten(3.0 + 3.0 * rest[0]),
            reach_up: ten(reaches[0]),
            reach_across: ten(reaches[1]),
            reach_down: ten(reaches[2]),
            mass_loss_rate: ten(-4.0 + 5.0 * rest[1]),
            char: 0.95 * rest[2],
            shrinkage: 0.9 * rest[3],
            afterglow: 1000.0 * rest[4],
        };
        let fabric = Fabric { areal_density: ten(-5.0 + 7.0 * rest[1]), thickness: ten(-6.0 + 5.0 * heats[3]), ..SHEET };
        let mut sheet = Burning::new(mesh([0.2, 0.2], 0.02, 0.4), &fabric, &Flammable::Heat(flammability));
        sheet.around.wind = Vec3::from(wind).normalize_or_zero() * ten(power);
        sheet.dt = ten(-4.0 + 4.0 * rest[0]);
        sheet.light(|rest| rest.y < 0.01);
        sheet.particles.position.set(7, Vec3::NAN);
        sheet.particles.position.set(9, Vec3::splat(f32::INFINITY));
        for _ in 0..40 {
            sheet.tick();
            let range = ROOM_TEMPERATURE - 1.0..=FLAME_TEMPERATURE + 1.0;
            prop_assert!(sheet.fire.temperature().iter().all(|t| range.contains(t)));
            prop_assert!(sheet.fire.fuel().iter().all(|fuel| (0.0..=1.0).contains(fuel)));
        }
    }
}

#[test]
fn wrong_numbers_are_refused_by_name() {
    let set: [(&str, fn(&mut Flammability, f32)); 12] = [
        ("Flammability::specific_heat", |f, v| f.specific_heat = v),
        ("Flammability::conductivity", |f, v| f.conductivity = v),
        ("Flammability::ignition", |f, v| f.ignition = v),
        ("Flammability::decomposition", |f, v| f.decomposition = v),
        ("Flammability::heat_flux", |f, v| f.heat_flux = v),
        ("Flammability::reach_up", |f, v| f.reach_up = v),
        ("Flammability::reach_across", |f, v| f.reach_across = v),
        ("Flammability::reach_down", |f, v| f.reach_down = v),
        ("Flammability::mass_loss_rate", |f, v| f.mass_loss_rate = v),
        ("Flammability::char", |f, v| f.char = v),
        ("Flammability::shrinkage", |f, v| f.shrinkage = v),
        ("Flammability::afterglow", |f, v| f.afterglow = v),
    ];
    let field = |result: Result<(), ClothError>| match result {
        Err(ClothError::OutOfRange { field, .. }) => field,
        other => panic!("{other:?}"),
    };
    for (name, set) in set {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 1e10] {
            let mut flammability = Flammability::default();
            set(&mut flammability, bad);
            assert_eq!(field(Flammable::Heat(flammability).validate()), name, "{bad}");
        }
    }
    let mut sheet = Burning::cotton(sheet([0.1, 0.1], 0.02));
    let Burning { topology, particles, fire, .. } = &mut sheet;
    let wrong = |wind, air, up| field(Surroundings { wind, air, up }.validate());
    assert_eq!(wrong(Vec3::NAN, 293.0, Vec3::Y), "Surroundings::wind");
    assert_eq!(wrong(Vec3::ZERO, 20.0, Vec3::Y), "Surroundings::air");
    assert_eq!(wrong(Vec3::ZERO, 293.0, Vec3::INFINITY), "Surroundings::up");
    assert_eq!(field(fire.ignite(particles, Vec3::NAN, 1.0).map(drop)), "centre of Fire's region");
    assert_eq!(field(fire.ignite(particles, Vec3::ZERO, -1.0).map(drop)), "radius of Fire's region");
    assert_eq!(field(fire.wet(particles, Vec3::ZERO, 1.0, -0.1)), "Fire::wet(water)");
    assert!(matches!(fire.ignite_particle(1 << 20), Err(ClothError::NoSuchParticle { particle: 1_048_576, .. })));
    let other: Topology = mesh([0.3, 0.3], 0.02, 0.0);
    assert!(fire.burn(&other, particles, &Surroundings::default(), DT).is_err());
    assert!(fire.burn(topology, &Particles::new(&other, 0.15), &Surroundings::default(), DT).is_err());
    for (name, preset) in Flammability::PRESETS {
        assert_eq!(preset.validate(), Ok(()), "{name}");
    }
}
