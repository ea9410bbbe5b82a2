//! Reads values of one table of a test file by the list of keys: right type, finite, within bounds.

use std::ops::{Deref, Range};

use joint_file::{Notes, Table};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::keys::{Key, Kind};
use crate::random::NumberOrRange;
use report::number::TYPED;
use report::seeds::MAX_SEEDS;

/// One table of the file.
pub(super) struct Section<'a>(Table<'a, Kind>);

impl<'a> Deref for Section<'a> {
    type Target = Table<'a, Kind>;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<'a> Section<'a> {
    /// Table of the given schema; reports unknown keys as problems.
    pub fn new(schema: &'static str, header: Range<usize>, table: &'a DeTable<'a>, notes: &'a Notes<'a>) -> Self {
        Self(Table::new(schema.to_owned(), schema, header, table, notes))
    }

    /// Sub-table `name`; `None` if it is absent or no table.
    pub fn table(&self, name: &str) -> Option<(Range<usize>, &'a DeTable<'a>)> {
        let (value, key) = self.value(name)?;
        match value.get_ref() {
            DeValue::Table(table) => Some((value.span(), table)),
            _ => self.wrong_type(value, key, &format!("a section, [{name}]")),
        }
    }

    /// Sub-tables `[[name]]`.
    pub fn tables(&self, name: &'static str) -> Vec<Section<'a>> {
        let Some((value, key)) = self.value(name) else { return Vec::new() };
        let DeValue::Array(list) = value.get_ref() else {
            let none: Option<()> = self.wrong_type(value, key, &format!("written in double brackets, [[{name}]]"));
            debug_assert!(none.is_none());
            return Vec::new();
        };
        list.iter()
            .filter_map(|item| match item.get_ref() {
                DeValue::Table(table) => Some(Section::new(name, item.span(), table, self.notes)),
                _ => self.wrong_type(item, key, "a table"),
            })
            .collect()
    }

    /// Reads a required value; reports a missing key.
    pub fn required<T>(&self, name: &str, read: impl Fn(&Self, &str) -> Option<T>) -> Option<T> {
        if !self.has(name) {
            self.missing(name);
        }
        read(self, name)
    }

    /// Reads a value, or returns the default for a missing key; `None` only if the value is wrong.
    pub fn or<T>(&self, name: &str, read: impl Fn(&Self, &str) -> Option<T>, default: T) -> Option<T> {
        if self.has(name) { read(self, name) } else { Some(default) }
    }

    pub fn text(&self, name: &str) -> Option<String> {
        let (value, key) = self.value(name)?;
        match value.get_ref() {
            DeValue::String(text) => Some(text.to_string()),
            _ => self.wrong_type(value, key, "a string"),
        }
    }

    pub fn flag(&self, name: &str) -> Option<bool> {
        let (value, key) = self.value(name)?;
        match value.get_ref() {
            DeValue::Boolean(flag) => Some(*flag),
            _ => self.wrong_type(value, key, "true or false"),
        }
    }

    /// One of the words that the key may hold.
    pub fn word(&self, name: &str) -> Option<&'static str> {
        let (value, key) = self.value(name)?;
        self.word_of(value, key)
    }

    /// List of words that the key may hold.
    pub fn words(&self, name: &str) -> Option<Vec<&'static str>> {
        let (value, key) = self.value(name)?;
        let words: Option<Vec<&'static str>> = match value.get_ref() {
            DeValue::Array(list) => list.iter().map(|item| self.word_of(item, key)).collect(),
            _ => self.wrong_type(value, key, "a list of names"),
        };
        words.iter().for_each(|words| self.reject_repeats(value, words));
        words
    }

    /// Word in place of a section, or word of a key.
    pub fn word_of(&self, value: &Spanned<DeValue<'_>>, key: &Key) -> Option<&'static str> {
        let (Kind::Word(words) | Kind::Words(words)) = key.kind else { return None };
        let DeValue::String(text) = value.get_ref() else { return self.wrong_type(value, key, "a word in quotes") };
        let found = words.iter().find(|word| **word == *text).copied();
        if found.is_none() {
            let help = match joint_file::nearest(text, words.iter().copied()) {
                Some(near) => format!("did you mean \"{near}\"? known: {}", words.join(", ")),
                None => format!("{}: {}", key.hint, words.join(", ")),
            };
            self.notes.error(
                value.span(),
                format!("\"{text}\" is not a valid {} of {}", key.name, self.called()),
                help,
            );
        }
        found
    }

    pub fn number(&self, name: &str) -> Option<f64> {
        let (value, key) = self.value(name)?;
        self.bounded(value, key)
    }

    /// A number, or a range from which every seed draws.
    pub fn range(&self, name: &str) -> Option<NumberOrRange> {
        let (value, key) = self.value(name)?;
        let DeValue::Array(list) = value.get_ref() else { return self.bounded(value, key).map(NumberOrRange::Exactly) };
        let numbers: Vec<f64> = list.iter().filter_map(|item| self.bounded(item, key)).collect();
        self.pair(value, &numbers)
    }

    /// Two numbers as a range, the lower one first.
    pub fn pair(&self, value: &Spanned<DeValue<'_>>, numbers: &[f64]) -> Option<NumberOrRange> {
        match numbers {
            [low, high] if low <= high => Some(NumberOrRange::Between(*low, *high)),
            _ => {
                let help = "write [least, greatest]: every seed draws one value between them";
                self.notes.error(value.span(), "not a range", help);
                None
            }
        }
    }

    /// Seeds from 1 up to a count, or a list of seeds.
    pub fn seeds(&self, name: &str) -> Option<Vec<u64>> {
        let (value, key) = self.value(name)?;
        let seed = |value: &Spanned<DeValue<'_>>| match value.get_ref() {
            DeValue::Integer(integer) => u64::from_str_radix(integer.as_str(), integer.radix()).ok(),
            _ => None,
        };
        let seeds = match value.get_ref() {
            DeValue::Array(list) => list.iter().map(seed).collect::<Option<Vec<u64>>>(),
            _ => {
                let count = seed(value);
                if let Some(count) = count.filter(|count| *count > MAX_SEEDS) {
                    let message = format!("`{name}`: {count} seeds are too many, at most {MAX_SEEDS} are possible");
                    self.notes.error(value.span(), message, key.hint);
                    return None;
                }
                count.map(|count| (1..=count).collect())
            }
        };
        let good = seeds.filter(|seeds| !seeds.is_empty());
        match &good {
            None => self.notes.error(value.span(), format!("`{name}` names no seeds"), key.hint),
            Some(seeds) => self.reject_repeats(value, seeds),
        }
        good
    }

    /// Rejects a list with repeated items.
    fn reject_repeats<T: PartialEq + std::fmt::Display>(&self, value: &Spanned<DeValue<'_>>, list: &[T]) {
        if let Some((_, twice)) = list.iter().enumerate().find(|(place, item)| list[..*place].contains(item)) {
            self.notes.error(value.span(), format!("{twice} is named twice"), "name it once: the same runs once");
        }
    }

    pub fn bounded(&self, value: &Spanned<DeValue<'_>>, key: &Key) -> Option<f64> {
        let (Kind::Number(low, high) | Kind::Range(low, high)) = key.kind else { return None };
        let Some(number) = number(value) else { return self.wrong_type(value, key, "a number") };
        if !(low..=high).contains(&number) {
            let message = format!("`{}` must be between {low} and {high}, not {}", key.name, TYPED.write(number));
            return self.refuse(value, key, message);
        }
        Some(number)
    }

    fn wrong_type<T>(&self, value: &Spanned<DeValue<'_>>, key: &Key, wanted: &str) -> Option<T> {
        self.refuse(value, key, format!("`{}` must be {wanted}", key.name))
    }
}

/// Parses a TOML number; rejects NaN.
pub(super) fn number(value: &Spanned<DeValue<'_>>) -> Option<f64> {
    let parsed = match value.get_ref() {
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|n| n as f64),
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => None,
    };
    parsed.filter(|number: &f64| !number.is_nan())
}
