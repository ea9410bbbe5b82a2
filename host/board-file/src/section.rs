//! Reads values of one table of a board file by the list of keys: right type, within bounds, each with its origin.

use std::ops::Deref;

use joint_file::wording::{kind, listed_as};
use joint_file::{Keys, Notes, Table};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::keys::{Key, Kind};
use crate::pin::Pin;

/// Table of the file.
pub(crate) struct Section<'a>(Table<'a, Kind>);

impl<'a> Deref for Section<'a> {
    type Target = Table<'a, Kind>;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<'a> Section<'a> {
    /// Top of the file.
    pub fn top(table: &'a DeTable<'a>, notes: &'a Notes<'a>) -> Self {
        Self(Table::new(String::new(), "", notes.top(), table, notes))
    }

    /// Table `name` as parsed; `None` if it is absent or no table.
    pub fn table(&self, name: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        let value = self.table.get(name)?;
        if let DeValue::Table(_) = value.get_ref() {
            return Some(value);
        }
        let hint = format!("write a section, [{name}], with its keys below it");
        self.notes.error(value.span(), format!("`{name}` must be a section, not {}", kind(value)), hint);
        None
    }

    /// Section `name`; `None` if it is absent or no table.
    pub fn section(&self, name: &'static str) -> Option<Self> {
        let value = self.table(name)?;
        let DeValue::Table(table) = value.get_ref() else { return None };
        // Both encoders have the keys of `encoder.motor`.
        let schema = if self.schema == "encoder" { "encoder.motor" } else { name };
        Some(Self(Table::new(self.full(name), schema, value.span(), table, self.notes)))
    }

    /// Section `name`, which is required.
    pub fn required_section(&self, name: &'static str) -> Option<Self> {
        if !self.has(name) {
            let hint = Kind::find("", name).map_or("", |key| key.hint);
            self.notes.error(self.header.clone(), format!("the section [{name}] is missing"), hint);
        }
        self.section(name)
    }

    /// Value that is required.
    pub fn required<T>(&self, name: &str, read: impl Fn(&Self, &str) -> Option<T>) -> Option<T> {
        if !self.has(name) {
            self.missing(name);
        }
        read(self, name)
    }

    pub fn text(&self, name: &str) -> Option<String> {
        let (value, key) = self.value(name)?;
        match value.get_ref() {
            DeValue::String(text) => Some(text.to_string()),
            _ => self.wrong_type(value, key, "a string"),
        }
    }

    /// Text with its origin.
    pub fn text_with_source(&self, name: &str) -> Option<String> {
        self.source(name);
        self.text(name)
    }

    /// Word out of the key's list.
    pub fn choice(&self, name: &str) -> Option<&'static str> {
        let (value, key) = self.value(name)?;
        let Kind::Choice(words) = key.kind else { return None };
        self.source(name);
        let DeValue::String(text) = value.get_ref() else { return self.wrong_type(value, key, "a string") };
        words.iter().find(|word| **word == *text).copied().or_else(|| {
            let message = format!("`{name}` must be {}, not \"{text}\"", listed_as(words, '"', "or"));
            self.refuse(value, key, message)
        })
    }

    pub fn whole(&self, name: &str) -> Option<u32> {
        let (value, key) = self.value(name)?;
        let Kind::Whole(low, high) = key.kind else { return None };
        self.source(name);
        let DeValue::Integer(integer) = value.get_ref() else { return self.wrong_type(value, key, "a whole number") };
        let number = i64::from_str_radix(integer.as_str(), integer.radix()).ok().and_then(|n| u32::try_from(n).ok());
        let within = number.filter(|number| (low..=high).contains(number));
        within.or_else(|| self.refuse(value, key, format!("`{name}` must be between {low} and {high}, not {integer}")))
    }

    pub fn pin(&self, name: &str) -> Option<Pin> {
        let (value, key) = self.value(name)?;
        self.source(name);
        let DeValue::String(text) = value.get_ref() else { return self.wrong_type(value, key, "a pin as a string") };
        text.parse().ok().or_else(|| {
            let message = format!("`{name}` must be a pin such as \"PA9\", not \"{text}\"");
            self.refuse(value, key, message)
        })
    }

    /// Records the comment behind a value.
    fn source(&self, name: &str) {
        if let Some(value) = self.table.get(name) {
            self.notes.source(self.full(name), &value.span());
        }
    }

    fn wrong_type<T>(&self, value: &Spanned<DeValue<'_>>, key: &Key, wanted: &str) -> Option<T> {
        self.refuse(value, key, format!("`{}` must be {wanted}, not {}", key.name, kind(value)))
    }
}
