//! Fire by contagion: edges that light one another by chance.

use crate::common::fire::*;
use cloth_solver::damage::fire::{Contagion, Stage};
use cloth_solver::damage::{Blade, cut};
use cloth_solver::{ClothError, Flammable};
use glam::Vec3;

fn burning(rule: Contagion) -> Burning {
    let mut sheet = Burning::new(sheet([0.4, 0.4], 0.02), &SHEET, &Flammable::Contagion(rule));
    sheet.fire.ignite(&sheet.particles, Vec3::ZERO, 0.03).unwrap();
    sheet
}

#[test]
fn the_same_seed_gives_the_same_fire_and_another_seed_another() {
    let fuel = |seed| {
        let mut sheet = burning(Contagion { seed, ..Contagion::default() });
        sheet.run(4.0);
        sheet.fire.fuel().iter().map(|fuel| fuel.to_bits()).collect::<Vec<_>>()
    };
    let one = fuel(7);
    assert_eq!(one, fuel(7));
    for seed in [0, 6, 8, u64::MAX] {
        assert_ne!(one, fuel(seed));
    }
}

#[test]
fn an_edge_breaks_when_its_damage_is_full_and_its_triangles_go_with_it() {
    // Nothing leaps: only what was lit burns, for 1/rate.
    let mut sheet = burning(Contagion { rate: 0.5, spread: 0.0, seed: 0 });
    let lit = sheet.slots(|rest| rest.length() <= 0.03);
    let touches = |corners: &[u32; 3]| corners.iter().any(|corner| lit.contains(corner));
    let mut gone = Vec::new();
    for _ in 0..180 {
        sheet.tick();
        assert!(sheet.fire.burnt_through().is_sorted());
        gone.extend_from_slice(sheet.fire.burnt_through());
        assert!(gone.is_empty() || (sheet.time - 2.0).abs() < 1.5 * DT || !sheet.fire.is_warm());
    }
    gone.sort_unstable();
    let around = |triangle: &u32| touches(&sheet.topology.triangles[*triangle as usize]);
    let count = sheet.topology.triangles.len() as u32;
    assert!(gone.len() > 10 && gone.iter().all(around));
    assert_eq!(gone, (0..count).filter(around).collect::<Vec<_>>());
    assert_eq!((sheet.fire.flaming(), sheet.stage(lit[0])), (0, Stage::Gone));
    assert!(lit.iter().all(|slot| sheet.fire.char()[*slot as usize] > 0.999));
}

#[test]
fn fire_spreads_until_all_is_gone_and_fuel_never_rises() {
    let mut sheet = burning(Contagion { rate: 0.5, ..Contagion::default() });
    let mut gone = 0;
    while sheet.fire.is_warm() && sheet.time < 60.0 {
        let before = sheet.fire.fuel().to_vec();
        sheet.tick();
        assert!(sheet.fire.fuel().iter().zip(&before).all(|(after, before)| after <= before));
        gone += sheet.fire.burnt_through().len();
    }
    assert!(!sheet.fire.is_warm());
    assert!(gone as f32 > 0.99 * sheet.topology.triangles.len() as f32, "{gone} triangles");
}

#[test]
fn the_more_burnt_spread_the_more_often() {
    // The first half of their lives gives a quarter of the leaps.
    let lit_by = |seconds: f32| {
        let fires = (0..40).map(|seed| {
            let mut sheet = burning(Contagion { rate: 0.25, spread: 0.4, seed });
            sheet.tick();
            let before = sheet.fire.ignited().len();
            sheet.run(seconds);
            sheet.lit_at.iter().filter(|at| at.is_finite()).count() - before
        });
        fires.sum::<usize>() as f32
    };
    let (early, late) = (lit_by(2.0), lit_by(4.0));
    // What is newly lit leaps as well, which makes it a little less than a quarter.
    assert!(early > 20.0 && early / late < 0.4 && early / late > 0.1, "{early} of {late}");
}

#[test]
fn the_tick_hardly_changes_how_fast_it_spreads() {
    let lit = |dt: f32| {
        let fires = (0..20).map(|seed| {
            let mut sheet = burning(Contagion { seed, ..Contagion::default() });
            sheet.dt = dt;
            sheet.run(3.0);
            sheet.lit_at.iter().filter(|at| at.is_finite()).count()
        });
        fires.sum::<usize>() as f32 / 20.0
    };
    let (fine, coarse) = (lit(1.0 / 240.0), lit(1.0 / 30.0));
    assert!((fine / coarse - 1.0).abs() < 0.15, "{fine} particles, {coarse} with longer ticks");
}

#[test]
fn water_puts_it_out_and_wet_edges_do_not_light() {
    let mut sheet = burning(Contagion::default());
    sheet.run(2.0);
    assert!(sheet.fire.flaming() > 10);
    sheet.fire.wet(&sheet.particles, Vec3::ZERO, 1.0, 0.05).unwrap();
    assert!(!sheet.fire.is_warm());
    assert_eq!(sheet.fire.ignite(&sheet.particles, Vec3::ZERO, 1.0), Ok(0));
    let fuel = sheet.fire.fuel().to_vec();
    sheet.run(5.0);
    assert_eq!((sheet.fire.fuel(), sheet.fire.flaming()), (&fuel[..], 0));
}

#[test]
fn edges_keep_their_damage_and_fire_when_the_cloth_is_cut() {
    let mut sheet = burning(Contagion::default());
    sheet.run(2.0);
    let before = sheet.topology.clone();
    let blade = Blade {
        from: [Vec3::new(-0.11, 0.003, 1.0), Vec3::new(-0.11, 0.003, -1.0)],
        to: [Vec3::new(0.11, 0.006, 1.0), Vec3::new(0.11, 0.006, -1.0)],
    };
    let (flaming, fuel) = (sheet.fire.flaming(), sheet.fire.fuel().to_vec());
    let position = sheet.particles.position.clone();
    let change = cut(&mut sheet.topology, &position, &blade).unwrap().change;
    sheet.follow(&before, &change);
    let kept = before.particles().all(|slot| sheet.fire.fuel()[slot as usize] == fuel[slot as usize]);
    assert!(kept && change.born.len() > 10);
    // So short a tick that nothing leaps: what burns now is what burnt, and what was born of it.
    sheet.dt = 1e-6;
    sheet.tick();
    let born: Vec<u32> = change.born.iter().map(|born| born.slot).collect();
    let burning = born.iter().filter(|slot| sheet.stage(**slot) == Stage::Flaming).count();
    assert!(burning > 0 && burning < born.len());
    assert!(sheet.fire.flaming() >= flaming.max(burning));
    sheet.dt = DT;
    for _ in 0..3600 {
        sheet.tick();
        sheet.take_out();
    }
    assert!(!sheet.fire.is_warm() && sheet.topology.triangles.len() < 100);
}

#[test]
fn wrong_rules_are_refused_by_name() {
    let field = |rule: Contagion| match Flammable::Contagion(rule).validate() {
        Err(ClothError::OutOfRange { field, .. }) => field,
        other => panic!("{other:?}"),
    };
    for bad in [f32::NAN, f32::INFINITY, -1.0, 1e10] {
        assert_eq!(field(Contagion { rate: bad, ..Contagion::default() }), "Contagion::rate");
        assert_eq!(field(Contagion { spread: bad, ..Contagion::default() }), "Contagion::spread");
    }
}
