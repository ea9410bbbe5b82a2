//! `joint merge`: merges the shards of a sweep into one result, once all are complete.

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

/// Merges shards and prints the path of the result.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    output::print(&sweep::merge(&arguments.folders, arguments.out.as_deref())?)
}
