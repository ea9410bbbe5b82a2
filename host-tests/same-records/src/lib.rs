//! Are two trees of records the same? A tree is a folder in which everything is kept that some commands have said and
//! written: before a change of the sources, and after it. Whatever differs is named with its file, its place, the old and
//! the new value; what was not compared is in one list, [`ignored`], and is counted.
//!
//! Each kind of file is read into one form, a [`listing`] of values and their places, and that is compared: [`json`],
//! [`csv`], [`text`], [`html`], [`xml`], [`log`] for MCAP; all others are compared byte by byte. How records are made, and
//! whether a difference is meant, is for the caller.

pub mod csv;
pub mod findings;
pub mod html;
pub mod ignored;
pub mod json;
pub mod listing;
pub mod log;
pub mod markup;
pub mod mask;
pub mod page;
pub mod ros;
pub mod text;
pub mod tree;
pub mod xml;

pub use findings::{Difference, Findings};
pub use tree::{Options, compare};
