//! Reads `[known]` and `[plant]`: keys of the joint file with new values, in nested sections or with dots. The
//! joint-file reader checks the values once the joint is known.

use std::ops::Range;

use joint_file::Notes;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::section::{Section, number};
use crate::random::NumberOrRange;

/// One changed value of the joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Full path of the key, which names its random draws.
    pub key: String,
    /// Key as typed; the joint's kind of gears decides the meaning of a short key.
    pub typed: String,
    /// New value.
    pub value: NewValue,
    /// Place in the test file.
    pub span: Range<usize>,
}

/// New value of a key.
#[derive(Debug, Clone, PartialEq)]
pub enum NewValue {
    /// Number in the key's unit.
    Number(NumberOrRange),
    /// Old value times a number.
    Times(NumberOrRange),
    /// Text as typed: a word, or a list for the planets.
    Text(String),
}

/// Keys that a controller must know to read its encoders and to keep time.
const ALWAYS_KNOWN: [&str; 7] =
    ["bits", "counts_per_turn", "control_rate_Hz", "sun_teeth", "planet_teeth", "ring_teeth", "planets"];

/// Reads the section of that name.
pub(super) fn read(top: &Section<'_>, name: &'static str) -> Vec<Change> {
    let mut changes = Vec::new();
    if let Some((_, table)) = top.table(name) {
        collect(table, "", name, top.notes, &mut changes);
    }
    changes
}

fn collect(table: &DeTable<'_>, path: &str, section: &str, notes: &Notes<'_>, changes: &mut Vec<Change>) {
    for (name, value) in table {
        let path = match path {
            "" => name.get_ref().to_string(),
            path => format!("{path}.{}", name.get_ref()),
        };
        if let DeValue::Table(inner) = value.get_ref() {
            if let Some(times) = inner.get("times").filter(|_| inner.len() == 1) {
                if let Some(factor) = quantity(times, notes) {
                    add_change(&path, NewValue::Times(factor), name.span(), section, notes, changes);
                }
            } else {
                collect(inner, &path, section, notes, changes);
            }
            continue;
        }
        let new = match value.get_ref() {
            DeValue::String(text) if text.trim().parse::<f64>().is_ok() => {
                notes.error(value.span(), format!("\"{text}\" is a text"), "write the number without quotes");
                None
            }
            DeValue::String(text) => Some(NewValue::Text(text.to_string())),
            // Two numbers are a range; there are at least three planets.
            DeValue::Array(list) if list.len() != 2 => {
                let numbers: Option<Vec<String>> =
                    list.iter().map(|item| number(item).map(|number| number.to_string())).collect();
                numbers.map(|numbers| NewValue::Text(format!("[{}]", numbers.join(", "))))
            }
            _ => quantity(value, notes).map(NewValue::Number),
        };
        if let Some(new) = new {
            add_change(&path, new, name.span(), section, notes, changes);
        }
    }
}

fn add_change(
    path: &str,
    value: NewValue,
    span: Range<usize>,
    section: &str,
    notes: &Notes<'_>,
    changes: &mut Vec<Change>,
) {
    match joint_file::full_key(path) {
        Err(refused) => notes.error(span, refused.message, refused.help),
        Ok(key) => {
            let last = key.rsplit('.').next().unwrap_or(&key);
            if section == "plant" && ALWAYS_KNOWN.contains(&last) {
                let message = format!("no controller can do without knowing `{last}`");
                notes.error(span, message, "write it in [known]: plant and controllers then agree on it");
            } else {
                changes.push(Change { key, typed: path.to_owned(), value, span });
            }
        }
    }
}

/// Parses a number, or [least, greatest].
fn quantity(value: &Spanned<DeValue<'_>>, notes: &Notes<'_>) -> Option<NumberOrRange> {
    const HELP: &str = "write a number, [least, greatest] for one drawn by every seed, or { times = 1.3 }";
    let found = match value.get_ref() {
        DeValue::Array(list) => match list.iter().map(number).collect::<Option<Vec<f64>>>().as_deref() {
            Some([low, high]) if low <= high => Some(NumberOrRange::Between(*low, *high)),
            _ => None,
        },
        _ => number(value).map(NumberOrRange::Exactly),
    };
    if found.is_none() {
        notes.error(value.span(), "this is neither a number nor a range", HELP);
    }
    found
}
