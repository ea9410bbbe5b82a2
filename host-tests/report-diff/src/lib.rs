//! Compares two trees of records. A tree is a folder with everything that some commands have printed and written, before a change of the
//! sources and after it. Every difference is reported with its file, its place, the old and the new value; ignored values are listed in one
//! place, [`ignored`], and counted.
//!
//! Each kind of file is read into one form, a [`listing`] of values and their places, which is compared: [`json`], [`csv`], [`text`],
//! [`html`], [`xml`], [`log`] for MCAP; all others are compared byte by byte.

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
