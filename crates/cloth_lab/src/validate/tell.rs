//! The findings as text.

use cloth_solver::Method;

use crate::report::{Table, header, number};

use super::finding::{Bench, Verdict};

/// What cannot be told from the table.
const NOTES: &str = "\
## How it is measured

- **Budgets.** The default is checked at the default budget of a scene, implicit Euler and projective dynamics at 10 substeps
  of 2 iterations in a tick of 1/60 s, the others at 10 substeps. Explicit methods are checked for order and stability:
  woven cloth is far too stiff for them at the budget of a game.
- **Order.** A cell of 1 × 1 m held by its top bobs at exactly 1 Hz. Its motion is fitted by `x[n+k] = p x[n] + q x[n−k]`,
  which a linear method obeys exactly; p and q are its frequency and growth. Symplectic Euler and Verlet err by (ωh)²/24 in
  phase, Runge–Kutta by (ωh)⁴/120. Implicit Euler, and XPBD on a single spring, fade by (1 + ω²h²)^(−1/2) a step.
- **Pendulum.** The same cell swings with all its free mass 1 m below its hinge. Projection (PBD) loses energy: known too.
- **Hanging strip.** The elongation σgL²/(2Y) holds at the nodes of a lumped grid exactly.
- **Cantilever.** The curve is the heavy elastica, solved by shooting. Two columns are clamped; a rectangle, whose
  rows bend at their particles, is free from halfway between them. The mesh turned by 45° is a general mesh of diamonds,
  whose bending is that of triangles; it is free from where the clamped columns end.
- **Membrane.** Expected are the frequencies of the grid of 20 cells; the continuous ones are 5.0000, 7.9057, 10.0000 Hz.
- **Stiffness in the plane.** A free square is pulled at its border. The energies are those of a membrane without Poisson
  effect: 1/E(45°) = (1/Y_u + 1/Y_v + 1/G)/4, and across it (1/Y_u + 1/Y_v − 1/G)/4.
- **Fire** burns strips that do not move, lit over a whole end; rates are slopes of place over time past the first quarter.
  Expected is what was measured on hanging cotton; the preheat lengths were taken from there, so that what is checked is
  whether meshes, ticks, slopes and masses change it. The 45° test is that of 16 CFR 1610. Acceleration upward is not modelled.
- **Fan.** The free round jet on its axis, across, and integrated over its cross-section; the force is that on a
  panel of cloth.
- **Gusts.** Means over many places; divergence and gradient by differences over 1 cm.
- **Momentum and energy** are taken in the middle of the last substep, where velocities are those of. A crumpled sheet's
  momenta are told in parts of the sums of its particles' amounts. A rise of energy is the largest from any tick to one within
  a second after it; the flag's first fall ends where its centre of mass first rises again.
- **Frame rates** need no check here: the solver takes ticks of a fixed length and knows no frame.
- **\"Fails by nature\"**: projection's stiffness is that of its steps, and one sweep of XPBD leaves a compliance of h²/m.

";

/// All findings as rows.
pub fn table(bench: &Bench) -> Table {
    let mut table = Table::new(["check", "quantity", "method", "value", "expected", "error", "tolerance", "verdict"]);
    for finding in &bench.findings {
        table.push([
            finding.check.to_owned(),
            finding.quantity.clone(),
            finding.method.map_or("–".to_owned(), |method| method.name().to_owned()),
            number(finding.value, 5),
            number(finding.expected, 5),
            finding.error(),
            finding.tolerance(),
            finding.verdict().name().to_owned(),
        ]);
    }
    table
}

/// How many findings of the default (and of what needs no method) have the verdict.
pub fn of_default(bench: &Bench, verdict: Verdict) -> usize {
    let is_default = |method: Option<Method>| method.is_none_or(|method| method == Method::default());
    bench.findings.iter().filter(|finding| is_default(finding.method) && finding.verdict() == verdict).count()
}

/// The whole report.
pub fn report(bench: &Bench) -> String {
    let mut text = header("Known answers");
    let (passed, failed) = (of_default(bench, Verdict::Pass), of_default(bench, Verdict::Fail));
    text += &format!(
        "The default method, `{}`, passes {passed} of {} checks.\n\n",
        Method::default().name(),
        passed + failed
    );
    let mut summary = Table::new(["method", "pass", "fail", "fails by nature"]);
    for method in &bench.methods {
        let count = |verdict| {
            let own = |f: &&super::finding::Finding| f.method == Some(*method) && f.verdict() == verdict;
            bench.findings.iter().filter(own).count().to_string()
        };
        summary.push([method.name().to_owned(), count(Verdict::Pass), count(Verdict::Fail), count(Verdict::ByNature)]);
    }
    text += &summary.markdown();
    text += "\n![Droop of a cantilever](validate-cantilever.svg)\n\n![Order of convergence](validate-order.svg)\n\n";
    text + &table(bench).markdown() + "\n" + NOTES
}
