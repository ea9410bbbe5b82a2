//! One document model for all reports: a report is plain data, and one renderer each turns it into an HTML page, lines
//! for a terminal or a part of a Markdown file. Pictures come from `plot`.
//!
//! `blocks` is a document and its parts, `text` the inline text, `sheet` a document of names and values.

mod blocks;
mod html;
mod markdown;
mod sheet;
mod terminal;
mod text;

pub use blocks::*;
pub use html::html;
pub use markdown::markdown;
pub use sheet::Sheet;
pub use terminal::terminal;
pub use text::*;
