//! `joint merge` of older versions merged the shards of a sweep; it only names its successor.

use std::ffi::OsString;

use report::failure::{Failure, Outcome};

/// Arguments of `joint merge`, of any kind.
#[derive(Debug, Clone, clap::Args)]
pub struct Arguments {
    /// Arguments of the older version
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    rest: Vec<OsString>,
}

/// Refuses the command with its successor.
pub fn run(_: &Arguments) -> Outcome<()> {
    Err(Failure::new("joint merge was removed: a sweep has no shards, its tasks lie in one folder").with_help(
        "run the sweep's own command again: it collects the results of all tasks, whichever engine ran them",
    ))
}
