//! How much of everything is played.

use std::str::FromStr;

/// Parts below this are short.
const SHORT: f64 = 0.1;

/// The part of all random trials that is played, above 0, up to 1. Below a tenth simulated times are shorter, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part(f64);

impl Part {
    /// That part.
    ///
    /// # Errors
    /// What is out of range.
    pub fn new(part: f64) -> Result<Self, String> {
        if part > 0.0 && part <= 1.0 {
            Ok(Self(part))
        } else {
            Err(format!("`--size` is {part}, allowed is above 0, up to 1"))
        }
    }

    /// The number itself.
    pub const fn value(self) -> f64 {
        self.0
    }

    /// That part of `all`, but `least` at least.
    pub fn of(self, all: u64, least: u64) -> u64 {
        ((self.0 * all as f64).round() as u64).clamp(least.min(all), all)
    }

    /// All of a long time from a tenth on, that part of it below.
    pub fn of_time(self, all: u64, least: u64) -> u64 {
        if self.is_short() { self.of(all, least) } else { all }
    }

    /// Whether only the outermost values of sweeps are played, and short times.
    pub fn is_short(self) -> bool {
        self.0 < SHORT
    }

    /// The values of a sweep: all, or only the outermost of a short part.
    pub fn sweep<T: Copy>(self, values: &[T]) -> Vec<T> {
        match values {
            [first, .., last] if self.is_short() => vec![*first, *last],
            _ => values.to_vec(),
        }
    }
}

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        text.parse().map_err(|_| "expected a number above 0, up to 1".to_owned()).and_then(Self::new)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_count_is_never_less_than_the_least() {
        let part = Part::new(0.01).unwrap();
        assert_eq!([part.of(1000, 2), part.of(10, 2), part.of(1, 2)], [10, 2, 1]);
        assert_eq!(Part::new(1.0).unwrap().of(1000, 2), 1000);
        assert_eq!([0.05, 0.1].map(|part| Part::new(part).unwrap().of_time(3600, 60)), [180, 3600]);
    }

    #[test]
    fn what_is_no_part_is_refused_with_value_and_range() {
        for text in ["0", "1.5", "NaN", "-1", "much"] {
            let error = text.parse::<Part>().unwrap_err();
            assert!(error.contains("above 0, up to 1"), "{error}");
        }
        assert_eq!("0.5".parse(), Ok(Part(0.5)));
    }
}
