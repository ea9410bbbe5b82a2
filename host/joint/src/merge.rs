//! `joint merge`: puts the shards of a sweep together into one result, once none is missing.

use std::path::PathBuf;

use report::failure::Outcome;
use report::output;
use simulation::sweep;

/// Arguments of `joint merge`.
#[derive(Debug, Clone, clap::Args)]
pub struct Arguments {
    /// Folders that hold shards of one sweep
    #[arg(value_name = "DIR", required = true)]
    pub folders: Vec<PathBuf>,
    /// Folder for the result [default: the first of the folders]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Merges shards and says where the result is.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    output::print(&sweep::merge(&arguments.folders, arguments.out.as_deref())?)
}
