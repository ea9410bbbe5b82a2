//! Columns of numbers under names, from CSV: what is missing or no number is named. What the columns mean is the log's
//! business.

use std::path::Path;

use crate::failure::{Failure, Outcome};

/// Larger files are taken for a mistake.
const LARGEST_FILE: u64 = 2 << 30;
/// What to write in the first line.
const HEADER_HELP: &str = "the first line names the columns: time_s,motor_counts,output_counts,motor_torque_N_m and, if it \
                           was measured, output_torque_N_m";

/// Columns by name.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    names: Vec<String>,
    /// One list for each name.
    values: Vec<Vec<f64>>,
    /// Line of each row.
    lines: Vec<usize>,
}

impl Columns {
    /// Reads a file by what it is.
    pub fn read(path: &Path) -> Outcome<Self> {
        let failed = |what: &str| {
            Failure::new(format!("cannot read the log {}: {what}", path.display()))
                .with_help("`joint identify LOG --simulate` makes one without hardware")
        };
        let data = std::fs::metadata(path).map_err(|error| failed(&error.to_string()))?;
        if data.is_dir() {
            return Err(failed("it is a folder"));
        }
        if data.len() > LARGEST_FILE {
            return Err(failed("it is larger than 2 GB"));
        }
        let bytes = std::fs::read(path).map_err(|error| failed(&error.to_string()))?;
        let text = String::from_utf8(bytes).map_err(|_| failed("it is not text (UTF-8): export it as CSV"))?;
        Self::parse(&text).map_err(|failure| failure.while_doing(path.display()))
    }

    /// Of CSV text.
    pub fn parse(text: &str) -> Outcome<Self> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let lines = (1..).zip(text.lines().map(str::trim));
        let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let (_, header) = lines.next().ok_or_else(|| Failure::new("the log is empty").with_help(HEADER_HELP))?;
        let names: Vec<String> = header.split(',').map(|name| name.trim().trim_matches('"').to_owned()).collect();
        if names.iter().all(|name| name.parse::<f64>().is_ok()) {
            return Err(Failure::new("the first line has numbers in place of names").with_help(HEADER_HELP));
        }
        let mut columns = Self { values: vec![Vec::new(); names.len()], names, lines: Vec::new() };
        for (line, text) in lines {
            let mut cells = text.split(',');
            for values in &mut columns.values {
                // A cell that is no number matters only in a column that is used.
                values.push(cells.next().and_then(|cell| cell.trim().parse().ok()).unwrap_or(f64::NAN));
            }
            columns.lines.push(line);
        }
        Ok(columns)
    }

    /// Where a row stands.
    pub fn place(&self, row: usize) -> String {
        format!("line {}", self.lines.get(row).copied().unwrap_or_default())
    }

    /// Time in seconds, in whichever unit it stands.
    pub fn time(&self) -> Outcome<Vec<f64>> {
        let (name, mut values) = self.named(&["time_s", "time_ms", "time_us"])?;
        let second = match name {
            "time_ms" => 1e-3,
            "time_us" => 1e-6,
            _ => 1.0,
        };
        values.iter_mut().for_each(|time| *time *= second);
        Ok(values)
    }

    /// The values of the first of these names that is there.
    pub fn one_of(&self, names: &[&'static str]) -> Outcome<Vec<f64>> {
        self.named(names).map(|(_, values)| values)
    }

    /// The same, with the name.
    pub fn named<'n>(&self, names: &[&'n str]) -> Outcome<(&'n str, Vec<f64>)> {
        for &name in names {
            if let Some(values) = self.maybe(name)? {
                return Ok((name, values));
            }
        }
        let wanted = names.first().copied().unwrap_or_default();
        let near = joints::nearest(wanted, self.names.iter().map(String::as_str));
        let there = near.map_or(String::new(), |near| format!("; was `{near}` meant for it?"));
        Err(Failure::new(format!("there is no column `{wanted}`{there}")).with_help(HEADER_HELP))
    }

    /// The values under a name, all of them finite.
    pub fn maybe(&self, name: &str) -> Outcome<Option<Vec<f64>>> {
        let Some(place) = self.names.iter().position(|known| known == name) else { return Ok(None) };
        let values = &self.values[place];
        match values.iter().position(|value| !value.is_finite()) {
            Some(row) => Err(Failure::new(format!("{} has no finite number for `{name}`", self.place(row)))
                .with_help("write a number with a point in every row, or cut the log there")),
            None => Ok(Some(values.clone())),
        }
    }
}
