//! Joint files: TOML with the unit in every key's name, read into `JointParameters`. All problems of a file are found
//! at once, each with its place in the text.
//!
//! `keys` lists every key with its unit, bound and meaning. `table` finds values by such a list and `notes` collects
//! problems, for joint files and other user files. `section` reads a joint's values; one file per section turns them
//! into parameters. `coherence` checks that the gears fit together and `plausible` that the joint can exist. `sheet`
//! converts data-sheet figures. `wording` holds phrases of the messages. `change` sets single values in a file's text.

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
pub mod warnings;
pub mod wording;

pub use change::{Refused, change, change_with_remark, full_key, full_key_in, value};
pub use contents::JointFile;
pub use motion::Profile;
pub use notes::{DERIVED, Notes, Source};
pub use presets::{PRESETS, preset};
pub use problem::{Problem, Problems, Severity};
pub use reader::read;
pub use spelling::nearest;
pub use table::{Key, Keys, Table};
