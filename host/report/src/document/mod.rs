//! One kind of document for all reports: what a report says is plain data, and one place each turns it into an HTML page,
//! lines for a terminal or a part of a Markdown file. Figures come from those who know them, pictures from `plot`.
//!
//! `blocks` is a document and its parts, `text` what stands in a line of it, `sheet` a document of names and values.

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
