//! What a comparison has found: differences, how many values were compared, and what was left out by which rule.

use std::collections::BTreeMap;
use std::fmt;

/// One value that is not the same.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Difference {
    /// File, relative to both trees.
    pub file: String,
    /// Where in it; empty for the file as a whole.
    pub place: String,
    /// What stands in the old tree; none if nothing does.
    pub old: Option<String>,
    /// What stands in the new tree; none if nothing does.
    pub new: Option<String>,
}

/// Values that one rule has left out.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LeftOut {
    /// All of them.
    pub values: u64,
    /// Those that were not the same.
    pub different: u64,
}

/// Everything found so far.
#[derive(Debug, Clone, Default)]
pub struct Findings {
    /// Files compared.
    pub files: usize,
    /// Values compared, those that were left out not counted.
    pub values: u64,
    /// What is not the same.
    pub differences: Vec<Difference>,
    /// By the name of the rule.
    pub left_out: BTreeMap<&'static str, LeftOut>,
    file: String,
}

impl Findings {
    /// What follows belongs to this file.
    pub fn begin(&mut self, file: &str) {
        self.files += 1;
        file.clone_into(&mut self.file);
    }

    /// A value differs, or one side does not have it.
    pub fn differs(&mut self, place: impl Into<String>, old: Option<String>, new: Option<String>) {
        self.values += 1;
        self.differences.push(Difference { file: self.file.clone(), place: place.into(), old, new });
    }

    /// A value was left out.
    pub fn leave_out(&mut self, rule: &'static str, different: bool) {
        let counted = self.left_out.entry(rule).or_default();
        counted.values += 1;
        counted.different += u64::from(different);
    }

    /// Whether nothing differs.
    pub fn all_same(&self) -> bool {
        self.differences.is_empty()
    }
}

/// Longest value that is shown whole.
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

/// The report: at most `shown` differences of each file, then the counts.
pub fn report(findings: &Findings, shown: usize) -> String {
    let mut text = String::new();
    let mut of_file: BTreeMap<&str, usize> = BTreeMap::new();
    for difference in &findings.differences {
        let count = of_file.entry(&difference.file).or_default();
        *count += 1;
        if *count <= shown {
            text += &format!("{difference}\n");
        }
    }
    for (file, count) in of_file.iter().filter(|(_, count)| **count > shown) {
        text += &format!("{file}: {} more\n", count - shown);
    }
    if !findings.left_out.is_empty() {
        let of_rule = |(rule, counted): (&&str, &LeftOut)| {
            format!("{rule} {} ({} of them different)", counted.values, counted.different)
        };
        let list: Vec<String> = findings.left_out.iter().map(of_rule).collect();
        text += &format!("left out: {}\n", list.join(", "));
    }
    let (files, values) = (findings.files, findings.values);
    let word = if files == 1 { "file" } else { "files" };
    match findings.differences.len() {
        0 => text += &format!("same: {values} values in {files} {word}\n"),
        count => {
            text += &format!("different: {count} of {values} values, in {} of {files} {word}\n", of_file.len());
        }
    }
    text
}
