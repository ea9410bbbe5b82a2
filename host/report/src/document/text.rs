//! Inline text of a document: the content of a heading, a sentence or a cell, joined by `+`. Renderers decide how it
//! looks.

use std::ops::{Add, AddAssign};

use crate::number;
use crate::number::Style;
use crate::plot::ink::Ink;

/// A piece of text.
#[derive(Debug, Clone, PartialEq)]
pub enum Span {
    /// As it is.
    Plain(String),
    /// What leads or counts.
    Strong(String),
    /// What belongs to a figure without being it: `of 12`.
    Quiet(String),
    /// Commands, keys and digests.
    Code(String),
    /// An index, as in b_c.
    Sub(String),
    /// Not broken at the end of a line.
    Whole(String),
    /// In the colour of a line of a picture.
    Inked(String, Ink),
    /// A verdict as a small plate.
    Mark(Tone, String),
    /// To a place in the same document or to a file beside it.
    Link {
        /// Where to.
        to: String,
        /// What is shown.
        shown: String,
    },
    /// A number: in pages as [`number::PAGE`] has it, on a terminal by its own style.
    Number {
        /// What.
        value: f64,
        /// On a terminal.
        terminal: Style,
    },
    /// The mark on everything that an emulator measured.
    Emulated,
    /// The next line, where there is room for several.
    Break,
}

/// The colour of a verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tone {
    /// Good.
    Passed,
    /// Bad.
    Failed,
    /// Neither: left open, or to be known.
    Open,
    /// Not judged.
    #[default]
    Plain,
}

/// Inline text.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Text(pub Vec<Span>);

impl Text {
    /// Whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Several with something between them.
    pub fn join(parts: impl IntoIterator<Item = Self>, between: &Self) -> Self {
        let mut all = Self::default();
        for part in parts {
            if !all.is_empty() {
                all += between.clone();
            }
            all += part;
        }
        all
    }
}

impl<T: Into<Text>> Add<T> for Text {
    type Output = Self;

    fn add(mut self, more: T) -> Self {
        self += more;
        self
    }
}

impl<T: Into<Text>> AddAssign<T> for Text {
    fn add_assign(&mut self, more: T) {
        self.0.extend(more.into().0);
    }
}

impl From<Span> for Text {
    fn from(span: Span) -> Self {
        Self(vec![span])
    }
}

impl From<String> for Text {
    fn from(text: String) -> Self {
        if text.is_empty() { Self::default() } else { Span::Plain(text).into() }
    }
}

impl From<&str> for Text {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl From<&String> for Text {
    fn from(text: &String) -> Self {
        text.clone().into()
    }
}

impl From<u32> for Text {
    fn from(count: u32) -> Self {
        count.to_string().into()
    }
}

impl From<usize> for Text {
    fn from(count: usize) -> Self {
        count.to_string().into()
    }
}

impl<T: Into<Text>> From<Option<T>> for Text {
    fn from(text: Option<T>) -> Self {
        text.map_or_else(Self::default, Into::into)
    }
}

/// Text to which more is added.
pub fn text(text: impl Into<Text>) -> Text {
    text.into()
}

/// Text of the author's own with indices of one letter, as in `b_c`.
pub fn indexed(text: &str) -> Text {
    let mut all = Text::default();
    let mut parts = text.split('_');
    all += parts.next();
    for part in parts {
        let mut letters = part.chars();
        match (letters.next(), letters.as_str()) {
            (Some(index), rest) if !rest.starts_with(char::is_alphanumeric) => {
                all = all + sub(index.to_string()) + rest
            }
            _ => all = all + "_" + part,
        }
    }
    all
}

/// What leads or counts.
pub fn strong(text: impl Into<String>) -> Text {
    Span::Strong(text.into()).into()
}

/// What belongs to a figure without being it.
pub fn quiet(text: impl Into<String>) -> Text {
    Span::Quiet(text.into()).into()
}

/// Commands, keys and digests.
pub fn code(text: impl Into<String>) -> Text {
    Span::Code(text.into()).into()
}

/// An index.
pub fn sub(text: impl Into<String>) -> Text {
    Span::Sub(text.into()).into()
}

/// Not broken at the end of a line.
pub fn whole(text: impl Into<String>) -> Text {
    Span::Whole(text.into()).into()
}

/// In the colour of a line of a picture.
pub fn inked(text: impl Into<String>, ink: Ink) -> Text {
    Span::Inked(text.into(), ink).into()
}

/// A verdict as a small plate.
pub fn mark(tone: Tone, word: impl Into<String>) -> Text {
    Span::Mark(tone, word.into()).into()
}

/// To a place in the same document or to a file beside it.
pub fn link(to: impl Into<String>, shown: impl Into<String>) -> Text {
    Span::Link { to: to.into(), shown: shown.into() }.into()
}

/// A number.
pub fn number(value: f64) -> Text {
    number_as(value, number::TERMINAL)
}

/// A number that a terminal writes in its own style.
pub fn number_as(value: f64, terminal: Style) -> Text {
    Span::Number { value, terminal }.into()
}

/// The next line, where there is room for several.
pub fn line_break() -> Text {
    Span::Break.into()
}

/// The mark on what an emulator measured, if it did.
pub fn emulated(emulated: bool) -> Text {
    emulated.then_some(Span::Emulated).into()
}
