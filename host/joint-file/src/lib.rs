//! Joint files: TOML with the unit in every key's name, read into `JointParameters` with all problems of a file found
//! at once, each with its place in the text.
//!
//! `keys` lists every key with its unit, bound and meaning; `table` finds values by such a list and `notes` keeps what is
//! wrong with them, here and for other files that users write; `section` takes a joint's values; one file for each section
//! of a joint file turns them into parameters; `coherence` asks whether the gears fit together and
//! `plausible` whether there can be such a joint; `sheet` converts what data sheets state. `wording` is what their
//! complaints share. `change` sets single values in a file's text.

mod bodies;
mod bound;
mod change;
mod coherence;
mod contents;
#[cfg(feature = "diagnostics")]
pub mod diagnostic;
mod drive_train;
mod equivalent;
mod geometry;
mod keys;
mod meshes;
mod motion;
#[cfg(feature = "diagnostics")]
pub mod named;
mod notes;
mod plausible;
mod presets;
mod problem;
mod reader;
mod section;
pub mod sheet;
mod spelling;
mod table;
#[cfg(feature = "diagnostics")]
pub mod warned;
pub mod wording;

pub use change::{Refused, change, change_noting, full_key, full_key_in, value};
pub use contents::JointFile;
pub use motion::Profile;
pub use notes::{DERIVED, Notes, Source};
pub use presets::{PRESETS, preset};
pub use problem::{Problem, Problems, Severity};
pub use reader::read;
pub use spelling::nearest;
pub use table::{Key, Keys, Table};
