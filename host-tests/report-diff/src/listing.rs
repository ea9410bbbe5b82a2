//! Content of a file as a flat list: rows of values, each value with its place. Every kind of file is read into this form and compared in
//! this form.
//!
//! Rows have an order: lines, lines of a table, tags, messages. After the common beginning and end of both lists, rows are compared pair by
//! pair if their numbers agree; otherwise rows that exist in one list only are reported, so that a missing row is one difference and not
//! one for every row behind it. Within a row, values are matched by name.

use std::collections::HashMap;
use std::rc::Rc;

use crate::findings::Findings;
use crate::mask::{Hidden, masked};

/// Values of one line, tag or message.
#[derive(Debug, Default)]
pub struct Row {
    /// Place in the file; it may have moved.
    pub place: String,
    /// Values by name; a value without a name is the whole row, or is named by the row's place.
    pub values: Vec<(Rc<str>, String)>,
}

/// Content of a file.
#[derive(Debug, Default)]
pub struct Listing {
    /// Rows in the file's order.
    pub rows: Vec<Row>,
    /// Ignored values with their rules.
    pub hidden: Vec<Hidden>,
}

impl Row {
    /// Row without values.
    pub fn at(place: impl Into<String>) -> Self {
        Self { place: place.into(), values: Vec::new() }
    }

    /// Adds a value.
    pub fn push(&mut self, name: impl Into<Rc<str>>, value: impl Into<String>) {
        self.values.push((name.into(), value.into()));
    }

    fn place_of(&self, name: &str) -> String {
        [&self.place, name].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ")
    }

    /// Place of the whole row, or of its value if it has only one.
    fn whole_place(&self) -> String {
        self.place_of(if let [(name, _)] = &self.values[..] { name } else { "" })
    }

    fn whole(&self) -> String {
        self.values.iter().map(|(_, value)| value.as_str()).collect::<Vec<_>>().join(",")
    }
}

impl Listing {
    /// Listing of one row.
    pub fn from_row(row: Row) -> Self {
        Self { rows: vec![row], hidden: Vec::new() }
    }

    /// Text without ignored words, which are recorded.
    pub fn masked(&mut self, text: &str) -> String {
        let (text, hidden) = masked(text);
        self.hidden.extend(hidden);
        text
    }
}

/// Compares two listings.
pub fn compare([old, new]: [&Listing; 2], findings: &mut Findings) {
    let count = |rows: &mut dyn Iterator<Item = &Row>| rows.map(|row| row.values.len() as u64).sum::<u64>();
    let pairs = differing_pairs(&old.rows, &new.rows);
    findings.values += count(&mut old.rows.iter()) - count(&mut pairs.iter().filter_map(|pair| pair.0));
    for pair in pairs {
        match pair {
            (Some(old), Some(new)) => compare_rows(old, new, findings),
            (Some(old), None) => findings.add_difference(old.whole_place(), Some(old.whole()), None),
            (None, Some(new)) => findings.add_difference(new.whole_place(), None, Some(new.whole())),
            (None, None) => {}
        }
    }
    let mut hidden = new.hidden.iter();
    old.hidden.iter().for_each(|old| findings.count_ignored(old.0, hidden.next() != Some(old)));
    hidden.for_each(|new| findings.count_ignored(new.0, true));
}

fn compare_rows(old: &Row, new: &Row, findings: &mut Findings) {
    let mut others: HashMap<&str, &String> = new.values.iter().map(|(name, value)| (&**name, value)).collect();
    for (name, value) in &old.values {
        match others.remove(&**name) {
            Some(other) if other == value => findings.values += 1,
            other => findings.add_difference(old.place_of(name), Some(value.clone()), other.cloned()),
        }
    }
    for (name, value) in new.values.iter().filter(|(name, _)| others.contains_key(&**name)) {
        findings.add_difference(new.place_of(name), None, Some(value.clone()));
    }
}

/// Rows that differ: two at the same position, or one that exists on one side only.
fn differing_pairs<'a>(old: &'a [Row], new: &'a [Row]) -> Vec<(Option<&'a Row>, Option<&'a Row>)> {
    let same = |(a, b): &(&Row, &Row)| a.values == b.values;
    let head = old.iter().zip(new).take_while(same).count();
    let tail = old[head..].iter().rev().zip(new[head..].iter().rev()).take_while(same).count();
    let (old, new) = (&old[head..old.len() - tail], &new[head..new.len() - tail]);
    if old.len() == new.len() {
        return old.iter().zip(new).filter(|pair| !same(pair)).map(|(a, b)| (Some(a), Some(b))).collect();
    }
    let gone = surplus(old, new).into_iter().map(|row| (Some(row), None));
    gone.chain(surplus(new, old).into_iter().map(|row| (None, Some(row)))).collect()
}

/// Rows of one list that the other does not have, or not as often: the last ones of several equal rows.
fn surplus<'a>(rows: &'a [Row], others: &[Row]) -> Vec<&'a Row> {
    let mut counts: HashMap<&[(Rc<str>, String)], usize> = HashMap::new();
    others.iter().for_each(|row| *counts.entry(&row.values).or_default() += 1);
    let is_surplus = |row: &&Row| match counts.get_mut(&row.values[..]).filter(|count| **count > 0) {
        Some(count) => {
            *count -= 1;
            false
        }
        None => true,
    };
    rows.iter().filter(is_surplus).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A missing row is one difference, not one for each row behind it.
    #[test]
    fn missing_row_is_one_difference() {
        let places = |old: &str, new: &str| {
            let row = |value: &str| Row { place: String::new(), values: vec![("".into(), value.to_owned())] };
            let listing = |text: &str| Listing { rows: text.split_whitespace().map(row).collect(), hidden: Vec::new() };
            let [old, new] = [old, new].map(listing);
            let mut findings = Findings::default();
            compare([&old, &new], &mut findings);
            let sides = findings.differences.into_iter().map(|found| (found.old, found.new));
            sides.map(|(old, new)| old.unwrap_or_default() + "|" + &new.unwrap_or_default()).collect::<Vec<_>>()
        };
        assert_eq!(places("1 2 3 4 5", "1 2 4 5"), ["3|"]);
        assert_eq!(places("1 1 1", "1 1 1 1"), ["|1"]);
        assert_eq!(places("1 2 3 4", "1 9 8 4"), ["2|9", "3|8"]);
        assert_eq!(places("", ""), [""; 0]);
        assert_eq!(places("1 2 3 4 5", "1 9 3 5"), ["2|", "4|", "|9"]);
    }
}
