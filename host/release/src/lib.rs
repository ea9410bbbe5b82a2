//! `joint release`: builds every file that users are given, with a list of digests and an SBOM. A program of its own, so
//! that neither the command nor the wheel carries what only maintainers run. Equal commits give equal
//! bytes: `paths` and `source` remove folders of the machine and times from the builds. The builds themselves are those
//! of the other commands, of maturin and of mdbook.

pub mod command;
pub mod contents;
pub mod parts;
mod paths;
mod sbom;
pub mod source;
mod tools;

pub use command::{ABOUT, Arguments, run};
