//! Structure of the workspace, read from its sources and from Cargo; `tests/workspace.rs` states the rules.
//!
//! [`imports`] finds cycles between the folders of a crate, [`members`] checks imports between crates, [`page`] compares
//! them with the tables in ARCHITECTURE.md, [`drawing`] draws them, [`size`] counts lines. [`links`] follows the links of the Markdown pages,
//! [`equations`] compares numbered equations of docs/theory with the code, [`unsafe_code`] compares every `unsafe` with its
//! list, [`dependencies`] checks third-party packages, [`features`] checks that builds share packages. [`cargo`] asks Cargo.
//!
//! `cargo test -p structure -- --nocapture` also prints the table of crates.

pub mod cargo;
pub mod dependencies;
pub mod drawing;
pub mod equations;
pub mod features;
pub mod imports;
pub mod links;
pub mod members;
pub mod page;
pub mod size;
pub mod unsafe_code;
