//! Inline text of a document: the content of a heading, a sentence or a cell, joined by `+`. Renderers decide the
//! appearance.

use std::ops::{Add, AddAssign};

use crate::number;
use crate::number::Style;
use crate::plot::ink::Ink;

/// A piece of text.
#[derive(Debug, Clone, PartialEq)]
pub enum Span {
    /// Plain text.
    Plain(String),
    /// Strong text.
    Strong(String),
    /// Text that belongs to a figure: `of 12`.
    Quiet(String),
    /// Commands, keys and digests.
    Code(String),
    /// A subscript, as in b_c.
    Sub(String),
    /// Text without line breaks.
    Whole(String),
    /// Text in the colour of a line of a picture.
    Inked(String, Ink),
    /// A verdict as a badge.
    Mark(Tone, String),
    /// Link within the document or to a file beside it.
    Link {
        /// Target.
        to: String,
        /// Shown text.
        shown: String,
    },
    /// A number: on pages in [`number::PAGE`], on a terminal in its own style.
    Number {
        /// Value.
        value: f64,
        /// Style on a terminal.
        terminal: Style,
    },
    /// Mark of figures that an emulator measured.
    Emulated,
    /// Line break, if the medium has lines.
    Break,
}

/// Colour of a verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tone {
    /// Good.
    Passed,
    /// Bad.
    Failed,
    /// Undecided, or for information.
    Open,
    /// Without a verdict.
    #[default]
    Plain,
}

/// Inline text.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Text(pub Vec<Span>);

impl Text {
    /// Returns true for empty text.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Joins texts with a separator.
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

/// Converts to text.
pub fn text(text: impl Into<Text>) -> Text {
    text.into()
}

/// Text with subscripts of one letter, as in `b_c`.
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

/// Strong text.
pub fn strong(text: impl Into<String>) -> Text {
    Span::Strong(text.into()).into()
}

/// Text that belongs to a figure.
pub fn quiet(text: impl Into<String>) -> Text {
    Span::Quiet(text.into()).into()
}

/// Commands, keys and digests.
pub fn code(text: impl Into<String>) -> Text {
    Span::Code(text.into()).into()
}

/// A subscript.
pub fn sub(text: impl Into<String>) -> Text {
    Span::Sub(text.into()).into()
}

/// Text without line breaks.
pub fn whole(text: impl Into<String>) -> Text {
    Span::Whole(text.into()).into()
}

/// Text in the colour of a line of a picture.
pub fn inked(text: impl Into<String>, ink: Ink) -> Text {
    Span::Inked(text.into(), ink).into()
}

/// A verdict as a badge.
pub fn mark(tone: Tone, word: impl Into<String>) -> Text {
    Span::Mark(tone, word.into()).into()
}

/// Link within the document or to a file beside it.
pub fn link(to: impl Into<String>, shown: impl Into<String>) -> Text {
    Span::Link { to: to.into(), shown: shown.into() }.into()
}

/// A number.
pub fn number(value: f64) -> Text {
    number_as(value, number::TERMINAL)
}

/// A number with its own style on a terminal.
pub fn number_as(value: f64, terminal: Style) -> Text {
    Span::Number { value, terminal }.into()
}

/// Line break, if the medium has lines.
pub fn line_break() -> Text {
    Span::Break.into()
}

/// Mark of figures that an emulator measured, if it did.
pub fn emulated(emulated: bool) -> Text {
    emulated.then_some(Span::Emulated).into()
}
