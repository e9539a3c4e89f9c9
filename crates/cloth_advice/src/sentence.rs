//! An advice in a sentence.

use std::fmt;

use crate::advise::{Advice, Report};
use crate::change::Change;

/// A share of the time below this is within the noise of a clock.
const NOISE: f64 = 0.03;

impl fmt::Display for Advice {
    /// One sentence with its figures.
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let figure = self.figure;
        let without = match self.change {
            Change::NoBending => format!("Bending holds {} of the elastic energy: without it", percent(figure)),
            Change::NoShear => format!("Shear holds {} of the elastic energy: without it", percent(figure)),
            Change::NoSelfContact if figure == 0.0 => "It does not touch itself: without self-contact".into(),
            Change::NoSelfContact => format!("It touches itself in {figure:.0} places: without self-contact"),
            Change::NoTearing if !self.can_go => {
                return write!(to, "Its threads carry up to {} of their strength: they may tear.", percent(figure));
            }
            Change::NoTearing => {
                format!("Its threads carry at most {} of their strength: without tearing", percent(figure))
            }
            Change::NoAir => "Without the air".into(),
            Change::Coarser(times) => format!("With 1/{times} of the cells along each side"),
            Change::Budget { substeps: 1, .. } => format!("With 1 substep instead of {figure:.0}"),
            Change::Budget { substeps, .. } => format!("With {substeps} substeps instead of {figure:.0}"),
            _ => format!("Without {}", self.change.name()),
        };
        let moved = millimetres(self.difference.most);
        if !self.can_go {
            return write!(to, "{without} a point moves by {moved}.");
        }
        let saved = match self.saves {
            saves if saves.abs() < NOISE => "a tick takes as long".into(),
            saves if saves < 0.0 => format!("a tick takes {} longer", percent(-saves)),
            saves => format!("a tick takes {} less", percent(saves)),
        };
        write!(to, "{without} no point moves by more than {moved} and {saved}.")
    }
}

impl Report {
    /// What was measured, in a sentence.
    pub fn basis(&self) -> String {
        let time = format!("A tick takes {:.2} ms.", self.time);
        let bar = millimetres(self.bar);
        match (self.by_mean, self.bar > self.tolerance) {
            (false, _) => time,
            (true, false) => format!("{time} It flutters, so mean shapes are compared."),
            (true, true) => format!(
                "{time} It flutters, so mean shapes are compared. With twice the substeps a point is {bar} away: less \
                 cannot be told from chance."
            ),
        }
    }
}

fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    match percent {
        _ if percent < 0.05 => "less than 0.1 %".into(),
        _ if percent < 10.0 => format!("{percent:.1} %"),
        _ => format!("{percent:.0} %"),
    }
}

fn millimetres(metres: f64) -> String {
    let mm = 1e3 * metres;
    match mm {
        _ if !mm.is_finite() => "any distance".into(),
        _ if mm < 0.05 => "0.1 mm".into(),
        _ if mm < 10.0 => format!("{mm:.1} mm"),
        _ => format!("{mm:.0} mm"),
    }
}

#[cfg(test)]
mod tests {
    use cloth_solver::Method;

    use super::*;
    use crate::shape::Difference;

    fn advice(change: Change, most: f64, saves: f64, can_go: bool, figure: f64) -> String {
        Advice { change, difference: Difference { rms: most, most }, saves, can_go, figure }.to_string()
    }

    #[test]
    fn each_advice_is_one_sentence_with_its_figures() {
        assert_eq!(
            advice(Change::NoBending, 0.002, 0.12, true, 0.003),
            "Bending holds 0.3 % of the elastic energy: without it no point moves by more than 2.0 mm and a tick takes 12 % less."
        );
        assert_eq!(
            advice(Change::NoBending, 0.08, 0.12, false, 0.6),
            "Bending holds 60 % of the elastic energy: without it a point moves by 80 mm."
        );
        assert_eq!(
            advice(Change::NoTearing, 0.0, 0.1, true, 0.02),
            "Its threads carry at most 2.0 % of their strength: without tearing no point moves by more than 0.1 mm and a tick \
             takes 10 % less."
        );
        let budget = Change::Budget { method: Method::default(), substeps: 5, iterations: 1 };
        assert_eq!(
            advice(budget, 0.004, 0.01, true, 10.0),
            "With 5 substeps instead of 10 no point moves by more than 4.0 mm and a tick takes as long."
        );
    }
}
