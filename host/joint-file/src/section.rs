//! Reads values of one table of a joint file by the list of keys: right type, finite, within bounds, in SI.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::bound::{Bound, Unit};
use crate::keys::{Key, Kind};
use crate::notes::Notes;
use crate::table::{Keys, Table};
use crate::wording::{kind, listed, listed_as, shown};

/// One table of the file.
pub(crate) type Section<'a> = Table<'a, Kind>;

/// One number for every planet, or a list.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum PerPlanetValue {
    One(f64),
    List(Vec<f64>),
}

impl<'a> Section<'a> {
    /// Top of the file.
    pub(crate) fn top(table: &'a DeTable<'a>, notes: &'a Notes<'a>) -> Self {
        Self::new(String::new(), "", notes.top(), table, notes)
    }

    /// Table `name` with the keys of `schema`; `None` if it is absent or no table.
    pub(crate) fn section(&self, name: &str, schema: &'static str) -> Option<Section<'a>> {
        let value = self.table.get(name)?;
        let DeValue::Table(table) = value.get_ref() else {
            let header = self.full(name);
            let hint = format!("write a section, [{header}], with its keys below it");
            self.notes.error(value.span(), format!("`{name}` must be a section, not {}", kind(value)), hint);
            return None;
        };
        Some(Self::new(self.full(name), schema, value.span(), table, self.notes))
    }

    /// Table `name`, noted if missing.
    pub(crate) fn required_section(&self, name: &str, schema: &'static str) -> Option<Section<'a>> {
        if self.table.get(name).is_none() {
            let hint = Kind::find(self.schema, name).map_or("", |key| key.hint);
            self.notes.error(self.header.clone(), format!("the section [{}] is missing", self.full(name)), hint);
        }
        self.section(name, schema)
    }

    /// One of two or three keys in the section. Several of them are an error, and none as well if `needed`.
    pub(crate) fn one_of(&self, names: &[&'static str], needed: bool) -> Option<&'static str> {
        let mut held = names.iter().copied().filter(|name| self.has(name));
        let first = held.next();
        match (first, held.next()) {
            (Some(first), Some(second)) => {
                let message = format!("`{first}` and `{second}` state one quantity twice");
                self.notes.error(self.place(second), message, format!("keep one of {}", listed(names)));
            }
            (None, _) if needed => {
                let message = format!("[{}] needs one of {}", self.path, listed(names));
                let hint = Kind::find(self.schema, names[0]).map_or("", |key| key.hint);
                self.notes.error(self.header.clone(), message, hint);
            }
            _ => {}
        }
        first
    }

    pub(crate) fn text(&self, name: &str) -> Option<String> {
        let (value, key) = self.value(name)?;
        match value.get_ref() {
            DeValue::String(text) => Some(text.to_string()),
            _ => self.wrong_type(value, key, "a string"),
        }
    }

    /// One of the allowed words of the key.
    pub(crate) fn choice(&self, name: &str) -> Option<&'static str> {
        let (value, key) = self.value(name)?;
        let Kind::Choice(words) = key.kind else { return None };
        let DeValue::String(text) = value.get_ref() else { return self.wrong_type(value, key, "a string") };
        words.iter().find(|word| **word == *text).copied().or_else(|| {
            let message = format!("`{name}` must be {}, not \"{text}\"", listed_as(words, '"', "or"));
            self.refuse(value, key, message)
        })
    }

    pub(crate) fn whole(&self, name: &str) -> Option<u32> {
        let (value, key) = self.value(name)?;
        let Kind::Whole(low, high) = key.kind else { return None };
        let DeValue::Integer(integer) = value.get_ref() else { return self.wrong_type(value, key, "a whole number") };
        self.source(name, value);
        let number = i64::from_str_radix(integer.as_str(), integer.radix()).ok().and_then(|n| u32::try_from(n).ok());
        let within = number.filter(|number| (low..=high).contains(number));
        within.or_else(|| self.refuse(value, key, format!("`{name}` must be between {low} and {high}, not {integer}")))
    }

    /// Number in SI.
    pub(crate) fn number(&self, name: &str) -> Option<f64> {
        let (value, key) = self.value(name)?;
        let Kind::Number(unit, bound) = key.kind else { return None };
        self.source(name, value);
        self.bounded(value, key, unit, bound)
    }

    /// Number in SI, noted if missing.
    pub(crate) fn required_number(&self, name: &str) -> Option<f64> {
        if !self.has(name) {
            self.missing(name);
        }
        self.number(name)
    }

    /// Whole number, noted if missing.
    pub(crate) fn required_whole(&self, name: &str) -> Option<u32> {
        if !self.has(name) {
            self.missing(name);
        }
        self.whole(name)
    }

    /// One number, or a list with a number per planet, in SI. Any length is accepted while `planets` is unknown.
    pub(crate) fn per_planet(&self, name: &str, planets: Option<usize>) -> Option<PerPlanetValue> {
        let (value, key) = self.value(name)?;
        let Kind::PerPlanet(unit, bound) = key.kind else { return None };
        self.source(name, value);
        let DeValue::Array(list) = value.get_ref() else {
            return self.bounded(value, key, unit, bound).map(PerPlanetValue::One);
        };
        if let Some(planets) = planets.filter(|planets| *planets != list.len()) {
            let message = format!("`{name}` lists {} values for {planets} planets", list.len());
            let help = format!("give {planets} values, or one number for all planets");
            self.notes.error(value.span(), message, help);
        }
        let numbers: Vec<_> = list.iter().map(|item| self.bounded(item, key, unit, bound)).collect();
        numbers.into_iter().collect::<Option<_>>().map(PerPlanetValue::List)
    }

    fn bounded(&self, value: &Spanned<DeValue<'_>>, key: &Key, unit: Unit, bound: Bound) -> Option<f64> {
        let number = match value.get_ref() {
            DeValue::Integer(integer) => {
                i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|number| number as f64)
            }
            DeValue::Float(float) => float.as_str().parse().ok(),
            _ => return self.wrong_type(value, key, "a number"),
        };
        let number = number.unwrap_or(f64::INFINITY);
        if bound.holds(number) {
            return Some(unit.to_si(number));
        }
        let limits = if number.is_finite() { bound.text() } else { "a finite number".to_owned() };
        self.refuse(value, key, format!("`{}` must be {limits}, not {}", key.name, shown(value)))
    }

    fn source(&self, name: &str, value: &Spanned<DeValue<'_>>) {
        self.notes.source(self.full(name), &value.span());
    }

    fn wrong_type<T>(&self, value: &Spanned<DeValue<'_>>, key: &Key, wanted: &str) -> Option<T> {
        self.refuse(value, key, format!("`{}` must be {wanted}, not {}", key.name, kind(value)))
    }
}
