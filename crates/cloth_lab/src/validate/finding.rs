//! What a check finds, and the verdict.

use cloth_scene::Scene;
use cloth_solver::{Method, Tick};

use crate::plot::Figure;
use crate::report::number;

/// How far a value may be from what is expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// By this part of the expectation.
    Relative(f64),
    /// By this much.
    Absolute(f64),
    /// It may not be larger.
    AtMost,
    /// It may not be smaller.
    AtLeast,
}

/// What is said of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within its tolerance.
    Pass,
    /// Beyond it, and the method claims it.
    Fail,
    /// Beyond it, and the method does not claim it.
    ByNature,
}

impl Verdict {
    /// As it stands in the table.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "**FAIL**",
            Self::ByNature => "fails by nature",
        }
    }
}

/// One value against what is known of it.
#[derive(Clone, Debug)]
pub struct Finding {
    /// Which check found it.
    pub check: &'static str,
    /// What was measured, with its circumstances and unit.
    pub quantity: String,
    /// The method it was measured with; `None` where no method takes part.
    pub method: Option<Method>,
    /// What was measured.
    pub value: f64,
    /// What is known.
    pub expected: f64,
    /// How far the two may be apart.
    pub bound: Bound,
    /// Whether the method claims it.
    pub claimed: bool,
}

impl Finding {
    /// The verdict; a value that is not finite fails, by nobody's nature.
    pub fn verdict(&self) -> Verdict {
        let apart = (self.value - self.expected).abs();
        let within = match self.bound {
            Bound::Relative(part) => apart <= part * self.expected.abs(),
            Bound::Absolute(much) => apart <= much,
            Bound::AtMost => self.value <= self.expected,
            Bound::AtLeast => self.value >= self.expected,
        };
        match (within, self.claimed) {
            (true, _) => Verdict::Pass,
            (false, false) if self.value.is_finite() => Verdict::ByNature,
            (false, _) => Verdict::Fail,
        }
    }

    /// Its error, as the table tells it.
    pub fn error(&self) -> String {
        match self.bound {
            Bound::Relative(_) => format!("{} %", number(100.0 * (self.value / self.expected - 1.0), 2)),
            Bound::Absolute(_) => number(self.value - self.expected, 2),
            Bound::AtMost | Bound::AtLeast => String::new(),
        }
    }

    /// Its tolerance, as the table tells it.
    pub fn tolerance(&self) -> String {
        match self.bound {
            Bound::Relative(part) => format!("± {} %", number(100.0 * part, 2)),
            Bound::Absolute(much) => format!("± {}", number(much, 2)),
            Bound::AtMost => "at most".into(),
            Bound::AtLeast => "at least".into(),
        }
    }
}

/// Findings and pictures as they come in, and what the checks are run with.
#[derive(Debug)]
pub struct Bench {
    /// Whether to take fewer points and shorter runs.
    pub quick: bool,
    /// The methods asked for.
    pub methods: Vec<Method>,
    /// What was found.
    pub findings: Vec<Finding>,
    /// Pictures, by the stem of their files.
    pub figures: Vec<(&'static str, Figure)>,
}

impl Bench {
    /// Those of `candidates` that are asked for, and the default whether it is among them or not; each once.
    pub fn with_default(&self, candidates: &[Method]) -> Vec<Method> {
        let wanted = |method: &Method| *method == Method::default() || candidates.contains(method);
        self.methods.iter().copied().filter(wanted).collect()
    }

    /// Those of `candidates` that are asked for.
    pub fn only(&self, candidates: &[Method]) -> Vec<Method> {
        self.methods.iter().copied().filter(|method| candidates.contains(method)).collect()
    }

    /// Adds a finding that the method claims.
    pub fn claim(
        &mut self,
        check: &'static str,
        quantity: impl Into<String>,
        method: Method,
        value: f64,
        expected: f64,
        bound: Bound,
    ) {
        self.add(check, quantity.into(), method, value, expected, bound, true);
    }

    /// Adds a finding that no method takes part in.
    pub fn known(&mut self, check: &'static str, quantity: impl Into<String>, value: f64, expected: f64, bound: Bound) {
        let quantity = quantity.into();
        self.findings.push(Finding { check, quantity, method: None, value, expected, bound, claimed: true });
    }

    fn add(
        &mut self,
        check: &'static str,
        quantity: String,
        method: Method,
        value: f64,
        expected: f64,
        bound: Bound,
        claimed: bool,
    ) {
        self.findings.push(Finding { check, quantity, method: Some(method), value, expected, bound, claimed });
    }

    /// Adds a finding about stiffness: shape at rest, and the frequencies of what is taut, which methods whose stiffness
    /// depends on the step do not claim.
    pub fn at_rest(
        &mut self,
        check: &'static str,
        quantity: impl Into<String>,
        method: Method,
        value: f64,
        expected: f64,
        bound: Bound,
    ) {
        let claimed = method == Method::default() || !matches!(method, Method::Pbd | Method::XpbdSweeps);
        self.add(check, quantity.into(), method, value, expected, bound, claimed);
    }
}

/// Methods that hold cloth in shape at the budget of a game: what statics are checked with.
pub const STATIC: &[Method] = &[Method::XpbdLines, Method::XpbdSweeps, Method::Pbd];

/// The tick that a method is checked at: the default's own budget for the default, for the others one of about its cost.
pub fn budget(method: Method) -> Tick {
    let scene = Scene::default();
    let (substeps, iterations) = if method == Method::default() { (scene.substeps, scene.iterations) } else { (10, 1) };
    Tick { iterations, ..Tick::at_least(1.0 / scene.rate, substeps) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(value: f64, expected: f64, bound: Bound, claimed: bool) -> Verdict {
        let quantity = String::new();
        Finding { check: "", quantity, method: None, value, expected, bound, claimed }.verdict()
    }

    #[test]
    fn a_value_passes_within_its_tolerance_and_fails_beyond() {
        assert_eq!(verdict(1.04, 1.0, Bound::Relative(0.05), true), Verdict::Pass);
        assert_eq!(verdict(-1.06, -1.0, Bound::Relative(0.05), true), Verdict::Fail);
        assert_eq!(verdict(1.2, 1.0, Bound::Absolute(0.1), true), Verdict::Fail);
        assert_eq!(verdict(2.0, 1.0, Bound::AtMost, false), Verdict::ByNature);
        assert_eq!(verdict(2.0, 1.0, Bound::AtLeast, false), Verdict::Pass);
    }

    #[test]
    fn what_is_no_number_passes_nothing() {
        for bound in [Bound::Relative(1.0), Bound::Absolute(1.0), Bound::AtMost, Bound::AtLeast] {
            assert_eq!(verdict(f64::NAN, 1.0, bound, true), Verdict::Fail);
            assert_eq!(verdict(f64::NAN, 1.0, bound, false), Verdict::Fail);
        }
    }
}
