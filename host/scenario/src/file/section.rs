//! Takes values out of one table of a test file by the list of keys: right type, finite, within bounds. What the values
//! mean together is left to the reader of each section.

use std::cell::RefCell;
use std::ops::Range;

use joint_file::{Problem, Severity};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::keys::{self, Key, Kind};
use crate::draw::Quantity;
use report::number::TYPED;

/// Problems of one file, as they are found.
#[derive(Default)]
pub(super) struct Problems(RefCell<Vec<Problem>>);

impl Problems {
    pub fn error(&self, span: Range<usize>, message: impl Into<String>, help: impl Into<String>) {
        let problem = Problem { span, message: message.into(), help: help.into(), severity: Severity::Error };
        self.0.borrow_mut().push(problem);
    }

    /// All of them in the order of the text.
    pub fn into_sorted(self) -> Vec<Problem> {
        let mut problems = self.0.into_inner();
        problems.sort_by_key(|problem| (problem.span.start, problem.span.end));
        problems
    }
}

/// One table of the file.
pub(super) struct Section<'a> {
    /// Whose keys it has.
    schema: &'static str,
    pub header: Range<usize>,
    pub table: &'a DeTable<'a>,
    pub problems: &'a Problems,
}

impl<'a> Section<'a> {
    /// A table; complains about keys that nobody knows.
    pub fn new(schema: &'static str, header: Range<usize>, table: &'a DeTable<'a>, problems: &'a Problems) -> Self {
        let section = Self { schema, header, table, problems };
        for name in table.keys() {
            let word = name.get_ref().as_ref();
            if keys::find(schema, word).is_none() {
                problems.error(name.span(), format!("unknown key `{word}` in {}", section.place()), near(schema, word));
            }
        }
        section
    }

    /// The table `name`; `None` if it is absent or no table.
    pub fn table(&self, name: &str) -> Option<(Range<usize>, &'a DeTable<'a>)> {
        let (value, key) = self.value(name)?;
        match value.get_ref() {
            DeValue::Table(table) => Some((value.span(), table)),
            _ => self.wrong_type(value, key, &format!("a section, [{name}]")),
        }
    }

    /// The tables `[[name]]`.
    pub fn tables(&self, name: &'static str) -> Vec<Section<'a>> {
        let Some((value, key)) = self.value(name) else { return Vec::new() };
        let DeValue::Array(list) = value.get_ref() else {
            let none: Option<()> = self.wrong_type(value, key, &format!("written in double brackets, [[{name}]]"));
            debug_assert!(none.is_none());
            return Vec::new();
        };
        list.iter()
            .filter_map(|item| match item.get_ref() {
                DeValue::Table(table) => Some(Section::new(name, item.span(), table, self.problems)),
                _ => self.wrong_type(item, key, "a table"),
            })
            .collect()
    }

    pub fn has(&self, name: &str) -> bool {
        self.table.get(name).is_some()
    }

    /// Where a key's value stands; the section's header if it does not.
    pub fn span(&self, name: &str) -> Range<usize> {
        self.table.get(name).map_or(self.header.clone(), Spanned::span)
    }

    /// Complains that a key is missing.
    pub fn missing(&self, name: &str) {
        let hint = keys::find(self.schema, name).map_or("", |key| key.hint);
        self.problems.error(self.header.clone(), format!("`{name}` is missing from {}", self.place()), hint);
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

    /// A list of such words.
    pub fn words(&self, name: &str) -> Option<Vec<&'static str>> {
        let (value, key) = self.value(name)?;
        let words: Option<Vec<&'static str>> = match value.get_ref() {
            DeValue::Array(list) => list.iter().map(|item| self.word_of(item, key)).collect(),
            _ => self.wrong_type(value, key, "a list of names"),
        };
        words.iter().for_each(|words| self.refuse_twice(value, words));
        words
    }

    /// A word in place of a section, or a key of a section.
    pub fn word_of(&self, value: &Spanned<DeValue<'_>>, key: &Key) -> Option<&'static str> {
        let (Kind::Word(words) | Kind::Words(words)) = key.kind else { return None };
        let DeValue::String(text) = value.get_ref() else { return self.wrong_type(value, key, "a word in quotes") };
        let found = words.iter().find(|word| **word == *text).copied();
        if found.is_none() {
            let help = match joint_file::nearest(text, words.iter().copied()) {
                Some(near) => format!("did you mean \"{near}\"? known: {}", words.join(", ")),
                None => format!("{}: {}", key.hint, words.join(", ")),
            };
            self.problems.error(value.span(), format!("\"{text}\" is no {} of {}", key.name, self.place()), help);
        }
        found
    }

    pub fn number(&self, name: &str) -> Option<f64> {
        let (value, key) = self.value(name)?;
        self.bounded(value, key)
    }

    /// A number, or a range of which every seed draws one.
    pub fn range(&self, name: &str) -> Option<Quantity> {
        let (value, key) = self.value(name)?;
        let DeValue::Array(list) = value.get_ref() else { return self.bounded(value, key).map(Quantity::Exactly) };
        let numbers: Vec<f64> = list.iter().filter_map(|item| self.bounded(item, key)).collect();
        self.pair(value, &numbers)
    }

    /// Two numbers as a range, the lower one first.
    pub fn pair(&self, value: &Spanned<DeValue<'_>>, numbers: &[f64]) -> Option<Quantity> {
        match numbers {
            [low, high] if low <= high => Some(Quantity::Between(*low, *high)),
            _ => {
                let help = "write [least, greatest]: every seed draws one value between them";
                self.problems.error(value.span(), "this is no range", help);
                None
            }
        }
    }

    /// So many seeds from 1 on, or a list.
    pub fn seeds(&self, name: &str) -> Option<Vec<u64>> {
        let (value, key) = self.value(name)?;
        let seed = |value: &Spanned<DeValue<'_>>| match value.get_ref() {
            DeValue::Integer(integer) => u64::from_str_radix(integer.as_str(), integer.radix()).ok(),
            _ => None,
        };
        let seeds = match value.get_ref() {
            DeValue::Array(list) => list.iter().map(seed).collect::<Option<Vec<u64>>>(),
            _ => seed(value).filter(|count| *count <= 10_000).map(|count| (1..=count).collect()),
        };
        let good = seeds.filter(|seeds| !seeds.is_empty());
        match &good {
            None => self.problems.error(value.span(), format!("`{name}` names no seeds"), key.hint),
            Some(seeds) => self.refuse_twice(value, seeds),
        }
        good
    }

    /// Complains about what a list names more than once.
    fn refuse_twice<T: PartialEq + std::fmt::Display>(&self, value: &Spanned<DeValue<'_>>, list: &[T]) {
        if let Some((_, twice)) = list.iter().enumerate().find(|(place, item)| list[..*place].contains(item)) {
            self.problems.error(value.span(), format!("{twice} is named twice"), "name it once: the same runs once");
        }
    }

    pub fn bounded(&self, value: &Spanned<DeValue<'_>>, key: &Key) -> Option<f64> {
        let (Kind::Number(low, high) | Kind::Range(low, high)) = key.kind else { return None };
        let Some(number) = number(value) else { return self.wrong_type(value, key, "a number") };
        if !(low..=high).contains(&number) {
            let message = format!("`{}` must be between {low} and {high}, not {}", key.name, TYPED.write(number));
            self.problems.error(value.span(), message, key.hint);
            return None;
        }
        Some(number)
    }

    /// How a reader calls the section.
    pub fn place(&self) -> String {
        if self.schema.is_empty() { "a test file".to_owned() } else { format!("[{}]", self.schema) }
    }

    fn value(&self, name: &str) -> Option<(&'a Spanned<DeValue<'a>>, &'static Key)> {
        Some((self.table.get(name)?, keys::find(self.schema, name)?))
    }

    fn wrong_type<T>(&self, value: &Spanned<DeValue<'_>>, key: &Key, wanted: &str) -> Option<T> {
        self.problems.error(value.span(), format!("`{}` must be {wanted}", key.name), key.hint);
        None
    }
}

/// A number as TOML has it; NaN is none.
pub(super) fn number(value: &Spanned<DeValue<'_>>) -> Option<f64> {
    let parsed = match value.get_ref() {
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|n| n as f64),
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => None,
    };
    parsed.filter(|number: &f64| !number.is_nan())
}

/// What to say to an unknown key.
fn near(schema: &str, word: &str) -> String {
    if let Some(near) = joint_file::nearest(word, keys::of(schema).map(|key| key.name)) {
        let hint = keys::find(schema, near).map_or("", |key| key.hint);
        return format!("did you mean `{near}`? {hint}");
    }
    if schema.is_empty() && joint_file::full_key(word).is_ok() {
        return "this is a key of the joint file: write it in [known] or in [plant]".to_owned();
    }
    if let Some(key) = keys::KEYS.iter().find(|key| key.name == word) {
        return match key.section {
            "" => "it belongs at the top of the file, above all sections".to_owned(),
            section => format!("it belongs in [{section}]"),
        };
    }
    let known: Vec<String> = keys::of(schema).map(|key| format!("`{}`", key.name)).collect();
    format!("known here: {}", known.join(", "))
}
