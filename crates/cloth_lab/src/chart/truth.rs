//! The reference's run of each case.

use std::f64::consts::PI;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use cloth_scene::ScenePins;
use glam::DVec3;
use indicatif::ProgressBar;

use super::case::{Case, Judged};
use super::record::Record;
use crate::reference::{Motion, Sheet, highest_frequency, rest};

/// Threads that references are computed on.
const THREADS: usize = 2;
/// Parts of the stability limit that steps are.
const PARTS: [f64; 2] = [0.25, 0.125];
/// Differences in shape, mm (rms), and in strain up to which two step lengths agree.
const SURE: (f64, f64) = (0.2, 2e-4);
/// How far out of its plane a sheet that may fold starts towards rest, m: flat, it would stay flat.
const BULGE: f64 = 0.01;

/// The reference's run of a case.
#[derive(Clone, Debug)]
pub struct Truth {
    /// What it gave, in the smaller steps.
    pub record: Record,
    /// Where a case that is judged at rest starts.
    pub start: Option<Vec<DVec3>>,
    /// Energy of hanging at rest, J; of cases whose energy is compared.
    pub rest_energy: f64,
    /// How sure it is, in words.
    pub convergence: String,
    /// Ticks that are compared: those up to which its two step lengths agree to 0.2 mm of shape (rms) and 2e-4 of largest
    /// strain.
    pub until: usize,
}

/// The reference's run of every case, computed on two threads.
pub fn truths(cases: &[Case], bar: &ProgressBar) -> Vec<Option<Truth>> {
    let next = AtomicUsize::new(0);
    let found: Vec<Mutex<Option<Truth>>> = cases.iter().map(|_| Mutex::new(None)).collect();
    // The longest first.
    let mut order: Vec<usize> = (0..cases.len()).collect();
    order.sort_by_key(|i| std::cmp::Reverse((cases[*i].judged != Judged::Rest, cases[*i].ticks())));
    std::thread::scope(|scope| {
        for _ in 0..THREADS {
            scope.spawn(|| {
                while let Some(index) = order.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let truth = truth(&cases[*index]);
                    if let Ok(mut slot) = found[*index].lock() {
                        *slot = truth;
                    }
                    bar.inc(1);
                }
            });
        }
    });
    found.into_iter().map(|slot| slot.into_inner().ok().flatten()).collect()
}

/// The reference's run of one case; `None` for a scene that it does not know.
pub fn truth(case: &Case) -> Option<Truth> {
    let sheet = Sheet::from_scene(&case.scene, case.offset())?;
    if case.judged == Judged::Rest { Some(at_rest(case, &sheet)) } else { Some(in_motion(case, &sheet)) }
}

fn at_rest(case: &Case, sheet: &Sheet) -> Truth {
    let bulge = |p: &DVec3| *p + DVec3::Z * BULGE * (PI * p.x).cos() * (0.5 - p.y);
    // Hung by its whole top edge a sheet stays flat.
    let cloth = &case.scene.cloths[0];
    let may_fold = cloth.pins != [ScenePins::Top] || !cloth.weights.is_empty();
    let from = sheet.flat.iter().map(|p| if may_fold { bulge(p) } else { *p }).collect();
    let rest = rest(sheet, from);
    let strain = sheet.largest_strain(&rest.x);
    Truth {
        record: Record { strain: vec![strain], shape: rest.x.clone(), ..Record::default() },
        rest_energy: sheet.potential_energy(&rest.x),
        convergence: format!("{} Newton steps, residual {:.1e} of the weight", rest.steps, rest.residual),
        until: case.ticks(),
        start: Some(rest.x),
    }
}

fn in_motion(case: &Case, sheet: &Sheet) -> Truth {
    let limit = 2.0 / highest_frequency(sheet, &sheet.flat);
    let [(mut coarse, coarse_shapes), (mut fine, mut fine_shapes)] = PARTS.map(|part| play(case, sheet, part * limit));
    let rest_energy = if case.judged.by_energy() { sheet.potential_energy(&hanging(sheet)) } else { 0.0 };
    let apart = |tick: &usize| {
        let shapes = coarse_shapes[*tick].iter().zip(&fine_shapes[*tick]).map(|(a, b)| a.distance_squared(*b));
        let shape = 1e3 * (shapes.sum::<f64>() / sheet.mass.len() as f64).sqrt();
        shape <= SURE.0 && (coarse.strain[*tick] - fine.strain[*tick]).abs() <= SURE.1
    };
    let until = (0..case.ticks()).take_while(apart).count().max(1);
    coarse.shape = coarse_shapes[until - 1].clone();
    fine.shape = fine_shapes.swap_remove(until - 1);
    let apart = coarse.against(&fine, case, until, rest_energy);
    let mut convergence = format!(
        "steps of {:.2e} s and {:.2e} s: until {:.2} s {:.1e} apart in strain, {:.1e} mm in shape",
        PARTS[0] * limit,
        PARTS[1] * limit,
        until as f64 / f64::from(case.scene.rate),
        apart.strain_error,
        apart.shape_rms
    );
    for (name, value) in [("period", apart.period), ("amplitude", apart.amplitude), ("energy left", apart.energy_left)]
    {
        if let Some(value) = value {
            convergence += &format!("; {name} {:.1e} apart", (value - 1.0).abs());
        }
    }
    Truth { convergence, record: fine, until, start: None, rest_energy }
}

/// The sheet hanging straight down from its top edge, unstretched, in its own frame.
fn hanging(sheet: &Sheet) -> Vec<DVec3> {
    let down = sheet.gravity.normalize_or_zero();
    let top = sheet.flat.first().map_or(0.0, |p| p.y);
    sheet.flat.iter().map(|p| DVec3::new(p.x, top, 0.0) + down * (top - p.y)).collect()
}

/// Plays a case; all positions after each tick beside.
fn play(case: &Case, sheet: &Sheet, h: f64) -> (Record, Vec<Vec<DVec3>>) {
    let mut motion = Motion::new(sheet, sheet.flat.clone(), vec![DVec3::ZERO; sheet.flat.len()]);
    let mut record = Record { energy: vec![motion.energy()], ..Record::default() };
    let tip = (sheet.rows - 1) * sheet.columns + sheet.columns / 2;
    let mut shapes = Vec::with_capacity(case.ticks());
    for _ in 0..case.ticks() {
        motion.advance(1.0 / f64::from(case.scene.rate), h);
        record.strain.push(sheet.largest_strain(&motion.x));
        record.tip.push(motion.x[tip].z);
        record.energy.push(motion.energy());
        shapes.push(motion.x.clone());
    }
    (record, shapes)
}
