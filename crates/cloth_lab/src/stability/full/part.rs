//! How much of everything is played.

use std::str::FromStr;

/// The part of all trials and of long simulated times that is played, above 0, up to 1.
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

    /// The values of a sweep: all, or only the outermost where the part is less than a tenth.
    pub fn sweep<T: Copy>(self, values: &[T]) -> Vec<T> {
        match values {
            [first, .., last] if self.0 < 0.1 => vec![*first, *last],
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
