//! What a command writes: Markdown with its circumstances, tables, CSV.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::Command;
use std::time::{Duration, SystemTime};

use crate::LabError;

/// Where the results go.
#[derive(clap::Args, Clone, Debug)]
pub struct Output {
    /// Folder the results are written to; made where it is missing.
    #[arg(long, default_value = "docs/lab", value_name = "DIR")]
    pub out: PathBuf,
}

impl Output {
    /// Writes `text` to a file of that name.
    ///
    /// # Errors
    /// The file and why it could not be written.
    pub fn write(&self, name: &str, text: &str) -> Result<(), LabError> {
        self.make()?;
        let path = self.out.join(name);
        std::fs::write(&path, text).map_err(|error| LabError::File { path, error })
    }

    /// Path of a picture without its extension, in a folder that exists.
    ///
    /// # Errors
    /// The folder and why it could not be made.
    pub fn picture(&self, stem: &str) -> Result<PathBuf, LabError> {
        self.make()?;
        Ok(self.out.join(stem))
    }

    fn make(&self) -> Result<(), LabError> {
        std::fs::create_dir_all(&self.out).map_err(|error| LabError::File { path: self.out.clone(), error })
    }
}

/// Heading and circumstances of a report: CPU, cores, compiler, date and the command that wrote it.
pub fn header(title: &str) -> String {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    format!(
        "# {title}\n\nWritten by `cargo run --release -p cloth_lab -- {}` on {} with {}, on {}, {} cores.\n\n",
        arguments.join(" "),
        date(SystemTime::now()),
        compiler(),
        cpu(),
        std::thread::available_parallelism().map_or(1, usize::from),
    )
}

/// The processor as it names itself; its family and model where it has no name.
fn cpu() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |name: &str| {
        let line = text.lines().find(|line| line.split(':').next().is_some_and(|key| key.trim() == name))?;
        let value = line.split_once(':')?.1.trim();
        (!value.is_empty() && value != "unknown").then(|| value.to_owned())
    };
    field("model name").unwrap_or_else(|| {
        let part = |name| field(name).unwrap_or_else(|| "?".into());
        format!("a CPU without a name ({}, family {}, model {})", part("vendor_id"), part("cpu family"), part("model"))
    })
}

/// The compiler that is installed here.
fn compiler() -> String {
    let output = Command::new("rustc").arg("--version").output().ok().filter(|output| output.status.success());
    let text = output.and_then(|output| String::from_utf8(output.stdout).ok());
    text.map_or_else(|| "an unknown rustc".into(), |text| text.trim().to_owned())
}

/// A day as year-month-day, UTC (days to civil date after Hinnant 2013).
fn date(time: SystemTime) -> String {
    let days = time.duration_since(SystemTime::UNIX_EPOCH).unwrap_or(Duration::ZERO).as_secs() / 86_400 + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (month, next) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    format!("{:04}-{month:02}-{day:02}", year + 400 * era + next)
}

/// Rows of text under headings.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Headings.
    pub columns: Vec<String>,
    /// Rows, each with one entry for each heading.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// No rows yet.
    pub fn new<'a>(columns: impl IntoIterator<Item = &'a str>) -> Self {
        Self { columns: columns.into_iter().map(str::to_owned).collect(), rows: Vec::new() }
    }

    /// Adds a row.
    pub fn push(&mut self, row: impl IntoIterator<Item = String>) {
        self.rows.push(row.into_iter().collect());
    }

    /// As a Markdown table, columns aligned for the eye of who reads the source.
    pub fn markdown(&self) -> String {
        let clean = |entry: &String| entry.replace('|', "\\|").replace('\n', " ");
        let rows: Vec<Vec<String>> =
            std::iter::once(&self.columns).chain(&self.rows).map(|row| row.iter().map(clean).collect()).collect();
        let widest = |column: usize| rows.iter().filter_map(|row| row.get(column)).map(|e| e.chars().count()).max();
        let widths: Vec<usize> = (0..self.columns.len()).map(|column| widest(column).unwrap_or(0).max(3)).collect();
        let mut text = String::new();
        for (index, row) in rows.iter().enumerate() {
            for (column, width) in widths.iter().enumerate() {
                let entry = row.get(column).map_or("", String::as_str);
                let _ = write!(text, "| {entry}{} ", " ".repeat(width - entry.chars().count()));
            }
            text.push_str("|\n");
            if index == 0 {
                widths.iter().for_each(|width| {
                    let _ = write!(text, "|{}", "-".repeat(width + 2));
                });
                text.push_str("|\n");
            }
        }
        text
    }

    /// As comma-separated values (RFC 4180).
    pub fn csv(&self) -> String {
        let quote = |entry: &String| {
            if entry.contains([',', '"', '\n', '\r']) {
                format!("\"{}\"", entry.replace('"', "\"\""))
            } else {
                entry.clone()
            }
        };
        let line = |row: &Vec<String>| row.iter().map(quote).collect::<Vec<_>>().join(",") + "\n";
        std::iter::once(&self.columns).chain(&self.rows).map(line).collect()
    }
}

/// A number with `digits` significant digits, plain from 0.001 to 100,000 and with a power of ten beyond; `–` for what is
/// not finite.
pub fn number(value: f64, digits: usize) -> String {
    let digits = digits.max(1);
    if !value.is_finite() {
        return "–".into();
    }
    if value == 0.0 {
        return "0".into();
    }
    if (1e-3..1e5).contains(&value.abs()) {
        let before = value.abs().log10().floor() as i32 + 1;
        format!("{value:.*}", (digits as i32 - before).max(0) as usize)
    } else {
        format!("{value:.*e}", digits - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_told_as_the_calendar_has_them() {
        let at = |seconds| date(SystemTime::UNIX_EPOCH + Duration::from_secs(seconds));
        assert_eq!(at(0), "1970-01-01");
        assert_eq!(at(951_782_400), "2000-02-29");
        assert_eq!(at(1_735_689_599), "2024-12-31");
        assert_eq!(at(4_102_444_800), "2100-01-01");
    }

    #[test]
    fn a_table_survives_separators_in_its_entries() {
        let mut table = Table::new(["a", "b"]);
        table.push(["x|y".into(), "1,\"2\"".into()]);
        assert_eq!(table.csv(), "a,b\nx|y,\"1,\"\"2\"\"\"\n");
        assert_eq!(table.markdown(), "| a    | b     |\n|------|-------|\n| x\\|y | 1,\"2\" |\n");
    }

    #[test]
    fn numbers_keep_the_digits_asked_for() {
        let told = [0.0, 0.012_345, 12.345, 12_345.6, 1.5e-7, f64::NAN].map(|value| number(value, 3));
        assert_eq!(told, ["0", "0.0123", "12.3", "12346", "1.50e-7", "–"]);
    }
}
