//! One table of a user's file, checked against the list of its keys: places of values, missing keys, unknown keys.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::notes::Notes;
use crate::spelling;

/// One key of a file.
#[derive(Debug)]
pub struct Key<K> {
    /// Section of the key; empty at the top of the file.
    pub section: &'static str,
    /// Name of the key.
    pub name: &'static str,
    /// Type of its value.
    pub kind: K,
    /// Hint for a wrong or missing value.
    pub hint: &'static str,
}

/// Keys of a kind of file, and the types of their values.
pub trait Keys: 'static + Sized {
    /// Name of the kind of file in messages.
    const FILE: &'static str;
    /// All keys, in the order of the documentation.
    const ALL: &'static [Key<Self>];

    /// Help for an unknown key without a similar known key.
    fn stray(section: &str, word: &str) -> String;

    /// Keys of one section.
    fn of(section: &str) -> impl Iterator<Item = &'static Key<Self>> {
        Self::ALL.iter().filter(move |key| key.section == section)
    }

    /// Key by its name; readers ask for listed keys only.
    fn find(section: &str, name: &str) -> Option<&'static Key<Self>> {
        Self::ALL.iter().find(|key| key.section == section && key.name == name)
    }

    /// Help for a key of another section.
    fn belongs(word: &str) -> Option<String> {
        let key = Self::ALL.iter().find(|key| key.name == word)?;
        Some(match key.section {
            "" => "it belongs at the top of the file, above all sections".to_owned(),
            section => format!("it belongs in [{section}]"),
        })
    }
}

/// One table of the file.
pub struct Table<'a, K> {
    /// Path as typed between brackets; empty at the top of the file.
    pub path: String,
    /// Section whose keys the table has, as in [`Key::section`].
    pub schema: &'static str,
    /// Place of the header.
    pub header: Range<usize>,
    /// Content of the table.
    pub table: &'a DeTable<'a>,
    /// Notes for its problems.
    pub notes: &'a Notes<'a>,
    kinds: std::marker::PhantomData<K>,
}

impl<'a, K: Keys> Table<'a, K> {
    /// Table of the file; notes unknown keys as problems.
    pub fn new(
        path: String,
        schema: &'static str,
        header: Range<usize>,
        table: &'a DeTable<'a>,
        notes: &'a Notes<'a>,
    ) -> Self {
        let section = Self { path, schema, header, table, notes, kinds: std::marker::PhantomData };
        for name in table.keys() {
            let word = name.get_ref().as_ref();
            if notes.is_full() {
                break;
            }
            if K::find(schema, word).is_none() {
                let help = match spelling::nearest(word, K::of(schema).map(|key| key.name)) {
                    Some(near) => {
                        format!("did you mean `{near}`? {}", K::find(schema, near).map_or("", |key| key.hint))
                    }
                    None => K::stray(schema, word),
                };
                notes.error(name.span(), format!("unknown key `{word}` in {}", section.called()), help);
            }
        }
        section
    }

    /// Name of the table in messages.
    pub fn called(&self) -> String {
        if self.path.is_empty() { K::FILE.to_owned() } else { format!("[{}]", self.path) }
    }

    /// Names of all keys in the table.
    pub fn keys(&self) -> impl Iterator<Item = &'a str> {
        self.table.keys().map(|name| name.get_ref().as_ref())
    }

    /// Returns true if the key is present.
    pub fn has(&self, name: &str) -> bool {
        self.table.get(name).is_some()
    }

    /// Place of a key's value, or of the header without one.
    pub fn place(&self, name: &str) -> Range<usize> {
        self.table.get(name).map_or(self.header.clone(), Spanned::span)
    }

    /// Full path of a key.
    pub fn full(&self, name: &str) -> String {
        if self.path.is_empty() { name.to_owned() } else { format!("{}.{name}", self.path) }
    }

    /// Value with its key, if present.
    pub fn value(&self, name: &str) -> Option<(&'a Spanned<DeValue<'a>>, &'static Key<K>)> {
        let value = self.table.get(name)?;
        self.notes.place(self.full(name), value.span());
        let key = K::find(self.schema, name);
        debug_assert!(key.is_some(), "`{name}` of [{}] is read, but not listed", self.schema);
        Some((value, key?))
    }

    /// Notes a missing key.
    pub fn missing(&self, name: &str) {
        let hint = K::find(self.schema, name).map_or("", |key| key.hint);
        let place = if self.path.is_empty() { "the top of the file".to_owned() } else { format!("[{}]", self.path) };
        self.notes.error(self.header.clone(), format!("`{name}` is missing from {place}"), hint);
    }

    /// Notes a wrong value.
    pub fn refuse<T>(&self, value: &Spanned<DeValue<'_>>, key: &Key<K>, message: String) -> Option<T> {
        self.notes.error(value.span(), message, key.hint);
        None
    }
}
