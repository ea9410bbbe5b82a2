//! A document of names and values under headings, built row by row.

use std::fmt::Display;

use super::blocks::{Block, Document, Section, section_everywhere};
use super::text::Text;

/// A sheet under construction.
pub struct Sheet(Document);

impl Sheet {
    /// Sheet with a heading and no rows.
    pub fn new(about: impl Into<Text>) -> Self {
        let heading = about.into();
        Self(Document { line: heading.clone(), heading, ..Document::default() })
    }

    /// Adds a heading for the following rows.
    pub fn heading(&mut self, text: &str) {
        self.0.blocks.push(section_everywhere(text, vec![Block::Facts(Vec::new())]));
    }

    /// Adds a name and its value below the last heading.
    pub fn row(&mut self, name: &str, value: impl Display) {
        if let Some(Block::Section(Section { blocks, .. })) = self.0.blocks.last_mut()
            && let Some(Block::Facts(rows)) = blocks.last_mut()
        {
            rows.push((name.into(), value.to_string().into()));
        }
    }

    /// The finished document.
    pub fn document(self) -> Document {
        self.0
    }
}
