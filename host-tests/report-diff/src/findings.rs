//! Findings of a comparison: differences, number of compared values, and number of values ignored by each rule.

use std::collections::BTreeMap;
use std::fmt;

/// A value that differs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Difference {
    /// File, relative to both trees.
    pub file: String,
    /// Place in the file; empty for the file as a whole.
    pub place: String,
    /// Value in the old tree, if any.
    pub old: Option<String>,
    /// Value in the new tree, if any.
    pub new: Option<String>,
}

/// Values ignored by one rule.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct IgnoredCount {
    /// Number of ignored values.
    pub values: u64,
    /// Number of ignored values that differ.
    pub different: u64,
}

/// Findings so far.
#[derive(Debug, Clone, Default)]
pub struct Findings {
    /// Number of compared files.
    pub files: usize,
    /// Number of compared values, without ignored values.
    pub values: u64,
    /// Values that differ.
    pub differences: Vec<Difference>,
    /// Ignored values by the name of the rule.
    pub ignored_counts: BTreeMap<&'static str, IgnoredCount>,
    file: String,
}

impl Findings {
    /// Attributes the following findings to a file.
    pub fn start_file(&mut self, file: &str) {
        self.files += 1;
        file.clone_into(&mut self.file);
    }

    /// Records a value that differs or is missing on one side.
    pub fn add_difference(&mut self, place: impl Into<String>, old: Option<String>, new: Option<String>) {
        self.values += 1;
        self.differences.push(Difference { file: self.file.clone(), place: place.into(), old, new });
    }

    /// Records an ignored value.
    pub fn count_ignored(&mut self, rule: &'static str, different: bool) {
        let counted = self.ignored_counts.entry(rule).or_default();
        counted.values += 1;
        counted.different += u64::from(different);
    }

    /// Returns true if nothing differs.
    pub fn is_same(&self) -> bool {
        self.differences.is_empty()
    }
}

/// Longest value shown whole [characters].
const SHOWN: usize = 300;

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file)?;
        if !self.place.is_empty() {
            write!(f, ": {}", self.place)?;
        }
        for (side, value) in [("old", &self.old), ("new", &self.new)] {
            match value {
                Some(value) if value.chars().count() > SHOWN => {
                    let start: String = value.chars().take(SHOWN).collect();
                    write!(f, "\n    {side}: {start} ...")?;
                }
                Some(value) => write!(f, "\n    {side}: {value}")?,
                None => write!(f, "\n    {side}: (nothing)")?,
            }
        }
        Ok(())
    }
}

/// Report with at most `shown` differences of each file, then the counts.
pub fn report(findings: &Findings, shown: usize) -> String {
    let mut text = String::new();
    let mut file_counts: BTreeMap<&str, usize> = BTreeMap::new();
    for difference in &findings.differences {
        let count = file_counts.entry(&difference.file).or_default();
        *count += 1;
        if *count <= shown {
            text += &format!("{difference}\n");
        }
    }
    for (file, count) in file_counts.iter().filter(|(_, count)| **count > shown) {
        text += &format!("{file}: {} more\n", count - shown);
    }
    if !findings.ignored_counts.is_empty() {
        let rule_text = |(rule, counted): (&&str, &IgnoredCount)| {
            format!("{rule} {} ({} of them different)", counted.values, counted.different)
        };
        let list: Vec<String> = findings.ignored_counts.iter().map(rule_text).collect();
        text += &format!("ignored: {}\n", list.join(", "));
    }
    let (files, values) = (findings.files, findings.values);
    let word = if files == 1 { "file" } else { "files" };
    match findings.differences.len() {
        0 => text += &format!("same: {values} values in {files} {word}\n"),
        count => {
            text += &format!("different: {count} of {values} values, in {} of {files} {word}\n", file_counts.len());
        }
    }
    text
}
