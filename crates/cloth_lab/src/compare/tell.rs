//! The comparison as text and as a picture.

use crate::plot::{Axis, Figure, Look, MANY, Panel, Series, Stroke};
use crate::report::{Table, header, number};

use super::play::Outcome;
use super::{Args, Contestant, Reference, Run};

/// Errors of the largest strain at which times are compared, dimensionless.
const LEVELS: [f64; 4] = [0.1, 0.03, 0.01, 0.001];

/// How each engine is told what the fabric is.
const MAPPING: &str = "\
## What is compared

A sheet of 1 × 1 m of cotton poplin (0.15 kg/m², 5500 N/m, shear 60 N/m, bending 8 and 5 µN·m), under 9.81 m/s², in ticks
of 1/60 s on one core: scenes of the chart. Those judged at rest are let go from the reference's rest and judged by the mean
of the largest strain over their last quarter, with an internal friction of 5 1/s in all engines, of which a pose at rest does
not depend. The swing (top edge held, let go from horizontal, undamped) and the drape (0.6 s onto a ball) are judged by the
largest strain of the whole run; that is one number of a wild motion, and a coarse run may meet it by chance. The weight weighs a thousand particles. Strains are of warp and weft edges, tension only.

- **rapier3d 0.36**, soft-body cloth: springs along warp and weft and both diagonals of each cell. Diagonals get the shear
  stiffness G, edges the stiffness k₁ that makes a pull meet Y = k₁ + G − G²/(k₁ + G), at the border half of it. Each
  spring's natural frequency is √(k (w_a + w_b))/2π at damping ratio 0, which is the implicit spring of stiffness k.
  Bending is left to skip-one springs that have no stiffness when flat; they get the k = 16 D/l² that stores a turn of one
  radian rightly. Masses are this project's, internal friction its `deformation_damping`. Its iterations are internal PGS
  sweeps per substep (default 4).
- **rapier-cloth-core 0.3**: XPBD over the edges of triangles. The one diagonal of a cell gets 2 G, edges k₁ as above,
  as compliances; hinges this project's own D b/s. Masses are thirds of triangles: this project's but at the four corners.
  Its damping slows rigid motion too. It has no mass per particle: the weight hangs on it as a force, without inertia.
  *Rigid* is the same with compliance 0, which turns its tethers on: what it then hides is not carried by the cloth.

";

/// Every run as a row.
pub fn table(runs: &[Run]) -> Table {
    let mut table = Table::new([
        "scene",
        "by",
        "substeps",
        "iterations",
        "s per simulated s",
        "largest strain",
        "mean strain",
        "error",
        "outcome",
    ]);
    for run in runs {
        let played = &run.played;
        let outcome = match &played.outcome {
            Outcome::Ok => "ok".to_owned(),
            Outcome::Diverged => "diverged".to_owned(),
            Outcome::Unsupported(reason) => format!("unsupported: {reason}"),
        };
        table.push([
            run.scene.to_owned(),
            run.by.name(),
            run.substeps.to_string(),
            run.iterations.to_string(),
            number(played.cost, 3),
            percent(played.largest),
            percent(played.mean),
            percent(run.error),
            outcome,
        ]);
    }
    table
}

fn percent(strain: f64) -> String {
    if strain.is_finite() { format!("{} %", number(100.0 * strain, 3)) } else { "–".into() }
}

/// The contestants in the order of the runs.
fn contestants(runs: &[Run]) -> Vec<Contestant> {
    let mut found = Vec::new();
    for run in runs {
        if !found.contains(&run.by) {
            found.push(run.by);
        }
    }
    found
}

/// The cheapest run by `by` of `scene` whose error is at most `level`.
fn cheapest<'a>(runs: &'a [Run], scene: &str, by: Contestant, level: f64) -> Option<&'a Run> {
    runs.iter()
        .filter(|run| run.scene == scene && run.by == by && run.error <= level)
        .min_by(|a, b| a.played.cost.total_cmp(&b.played.cost))
}

/// The whole report.
pub fn report(args: &Args, side: usize, references: &[Reference], runs: &[Run]) -> String {
    let mut text = header("Compared with other engines");
    if !cfg!(feature = "engines") {
        text += "**Built without the feature `engines`: no other engine took part.**\n\n";
    }
    text += &format!(
        "Sheets of {side} × {side} particles{}. Pictures: [compare.svg](compare.svg); all runs: [compare.csv](compare.csv).\n\n",
        if args.quick { " (`--quick`)" } else { "" },
    );
    text += "![Time against error of the largest strain](compare.svg)\n\n";
    text += &equal_error(references, runs);
    text += "## Reference\n\nThe lab's own in f64, independent of the solver. Errors are the distance of the largest strain \
             from its.\n\n";
    let mut table = Table::new(["scene", "largest strain", "how"]);
    for Reference { scene, largest, convergence } in references {
        table.push([(*scene).to_owned(), percent(*largest), convergence.clone()]);
    }
    text + &table.markdown() + "\n## All runs\n\n" + &self::table(runs).markdown() + "\n" + MAPPING
}

/// Time at equal error, and how much longer the better of the other engines takes.
fn equal_error(references: &[Reference], runs: &[Run]) -> String {
    let contestants = contestants(runs);
    let mut columns = vec!["scene".to_owned(), "error at most".to_owned()];
    columns.extend(contestants.iter().map(|by| by.name()));
    columns.push("better engine / default".into());
    let mut table = Table { columns, rows: Vec::new() };
    for reference in references {
        for level in LEVELS {
            let best = |by: &Contestant| cheapest(runs, reference.scene, *by, level);
            let mut row = vec![reference.scene.to_owned(), percent(level)];
            row.extend(contestants.iter().map(|by| {
                best(by).map_or_else(
                    || "–".to_owned(),
                    |run| format!("{} s ({} × {})", number(run.played.cost, 3), run.substeps, run.iterations),
                )
            }));
            let own = contestants.first().and_then(best).map(|run| run.played.cost);
            let theirs = contestants
                .iter()
                .filter(|by| by.is_foreign())
                .filter_map(best)
                .map(|run| run.played.cost)
                .min_by(f64::total_cmp);
            row.push(match (own, theirs) {
                (Some(own), Some(theirs)) => format!("{} ×", number(theirs / own, 3)),
                (Some(_), None) => "no engine gets there".into(),
                (None, Some(_)) => "default does not get there".into(),
                (None, None) => "–".into(),
            });
            table.rows.push(row);
        }
    }
    "## Time at equal error\n\nSeconds on one core for one simulated second, at the cheapest setting tried (substeps × \
     iterations) whose largest strain is off by at most that much.\n\n"
        .to_owned()
        + &table.markdown()
        + "\n"
}

/// Time against error, a panel for each scene.
pub fn figure(runs: &[Run]) -> Figure {
    let contestants = contestants(runs);
    let mut scenes: Vec<&str> = Vec::new();
    runs.iter().for_each(|run| {
        if !scenes.contains(&run.scene) {
            scenes.push(run.scene);
        }
    });
    let panels = scenes.iter().map(|scene| Panel {
        title: (*scene).to_owned(),
        x: Axis::log("s per simulated s, one core"),
        y: Axis::log("error of largest strain"),
        series: contestants.iter().flat_map(|by| curve(runs, scene, *by)).collect(),
        ..Panel::default()
    });
    let panels: Vec<Panel> = panels.collect();
    let (columns, size) =
        if panels.len() > 1 { (2, (MANY.0, 290 * panels.len().div_ceil(2) as u32)) } else { (1, MANY) };
    Figure { title: "This project and other engines".into(), size, columns, panels, classes: Vec::new() }
}

/// All runs of one contestant as points, and a line through those that no cheaper run betters.
fn curve(runs: &[Run], scene: &str, by: Contestant) -> [Series; 2] {
    let mut points: Vec<(f64, f64)> = runs
        .iter()
        .filter(|run| run.scene == scene && run.by == by && run.error.is_finite())
        .map(|run| (run.played.cost, run.error))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut least = f64::INFINITY;
    let front = points.iter().copied().filter(|(_, error)| {
        let better = *error < least;
        least = least.min(*error);
        better
    });
    let front = Series { label: String::new(), look: look(by), stroke: Stroke::Line, points: front.collect() };
    [front, Series { label: by.name(), look: look(by), stroke: Stroke::Points, points }]
}

fn look(by: Contestant) -> Look {
    match by {
        Contestant::Ours(method) => Look::of(method),
        Contestant::Rapier => Look(7),
        Contestant::RapierCloth => Look(8),
        Contestant::RapierClothRigid => Look(9),
    }
}

#[cfg(test)]
mod tests {
    use cloth_solver::Method;

    use super::*;

    #[test]
    fn every_contestant_looks_different() {
        let ours = Method::ALL.iter().map(|method| Contestant::Ours(*method));
        let others = [Contestant::Rapier, Contestant::RapierCloth, Contestant::RapierClothRigid];
        let mut looks: Vec<usize> = ours.chain(others).map(|by| look(by).0 % Look::COUNT).collect();
        looks.sort_unstable();
        assert!(looks.windows(2).all(|pair| pair[0] != pair[1]), "{looks:?}");
    }
}
