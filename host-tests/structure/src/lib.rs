//! The workspace's structure, read from its sources and from Cargo: imports among the files of a crate, imports among
//! crates, sizes, and the links of its pages. `tests/workspace.rs` states what must hold of this workspace; `cargo test -p structure -- --nocapture`
//! prints the table of crates as well.
//!
//! From sources to findings: [`sources`] walks the modules of a target and keeps every name and path, [`resolve`] finds
//! the file that defines what a path names, [`graph`] ties files by that, [`rules`] judges the ties. [`members`] judges
//! the crates, [`page`] compares them with the table in ARCHITECTURE.md, [`size`] counts their lines. [`links`] follows the
//! links of the Markdown pages, [`unsafe_code`] compares every `unsafe` with its list, [`dependencies`] judges what is
//! not of this workspace.
//!
//! What it cannot see: methods and trait implementations (a value can be used without a path to its type), code that
//! macros generate, names in strings (captured in formats, `serde(with = "...")`), `path` within `cfg_attr`. Every module
//! is walked whatever its `cfg`, so that no feature hides a circle.

pub mod dependencies;
pub mod graph;
pub mod links;
pub mod members;
pub mod page;
pub mod resolve;
pub mod rules;
pub mod size;
pub mod sources;
pub mod unsafe_code;

mod tokens;
