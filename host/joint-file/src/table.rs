//! One table of a file that users write, by the list of keys that such a file may hold: where its values stand, what is
//! missing, what nobody knows.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::notes::Notes;
use crate::spelling;

/// One key of a file.
#[derive(Debug)]
pub struct Key<K> {
    /// The section that it stands in; empty at the top of the file.
    pub section: &'static str,
    /// Its name.
    pub name: &'static str,
    /// What it holds.
    pub kind: K,
    /// Shown when the value is refused or missing.
    pub hint: &'static str,
}

/// What the keys of a kind of file hold, and which keys there are.
pub trait Keys: 'static + Sized {
    /// How a reader calls such a file.
    const FILE: &'static str;
    /// All keys, in the order of the documentation.
    const ALL: &'static [Key<Self>];

    /// What to say to a key of a section that is none and looks like none.
    fn stray(section: &str, word: &str) -> String;

    /// The keys of one section.
    fn of(section: &str) -> impl Iterator<Item = &'static Key<Self>> {
        Self::ALL.iter().filter(move |key| key.section == section)
    }

    /// The key of that name; readers ask for listed keys only.
    fn find(section: &str, name: &str) -> Option<&'static Key<Self>> {
        Self::ALL.iter().find(|key| key.section == section && key.name == name)
    }

    /// Where a key of another section belongs.
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
    /// As typed between brackets; empty at the top of the file.
    pub path: String,
    /// Whose keys it has, as in [`Key::section`].
    pub schema: &'static str,
    /// Where it begins.
    pub header: Range<usize>,
    /// What it holds.
    pub table: &'a DeTable<'a>,
    /// Where what is wrong with it is noted.
    pub notes: &'a Notes<'a>,
    kinds: std::marker::PhantomData<K>,
}

impl<'a, K: Keys> Table<'a, K> {
    /// A table; reports unknown keys as problems.
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

    /// How a reader calls it.
    pub fn called(&self) -> String {
        if self.path.is_empty() { K::FILE.to_owned() } else { format!("[{}]", self.path) }
    }

    /// The names of all that it holds.
    pub fn keys(&self) -> impl Iterator<Item = &'a str> {
        self.table.keys().map(|name| name.get_ref().as_ref())
    }

    /// Whether a key is there.
    pub fn has(&self, name: &str) -> bool {
        self.table.get(name).is_some()
    }

    /// Where a key's value stands; the section's header if it does not.
    pub fn place(&self, name: &str) -> Range<usize> {
        self.table.get(name).map_or(self.header.clone(), Spanned::span)
    }

    /// The full path of a key.
    pub fn full(&self, name: &str) -> String {
        if self.path.is_empty() { name.to_owned() } else { format!("{}.{name}", self.path) }
    }

    /// A value with its key, if it is there.
    pub fn value(&self, name: &str) -> Option<(&'a Spanned<DeValue<'a>>, &'static Key<K>)> {
        let value = self.table.get(name)?;
        self.notes.place(self.full(name), value.span());
        let key = K::find(self.schema, name);
        debug_assert!(key.is_some(), "`{name}` of [{}] is read, but not listed", self.schema);
        Some((value, key?))
    }

    /// Complains that a key is missing.
    pub fn missing(&self, name: &str) {
        let hint = K::find(self.schema, name).map_or("", |key| key.hint);
        let place = if self.path.is_empty() { "the top of the file".to_owned() } else { format!("[{}]", self.path) };
        self.notes.error(self.header.clone(), format!("`{name}` is missing from {place}"), hint);
    }

    /// Complains about what a key holds.
    pub fn refuse<T>(&self, value: &Spanned<DeValue<'_>>, key: &Key<K>, message: String) -> Option<T> {
        self.notes.error(value.span(), message, key.hint);
        None
    }
}
