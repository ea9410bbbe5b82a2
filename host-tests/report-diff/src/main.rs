//! `report-diff OLD NEW` compares two trees of records. The comparison is in the library.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use report_diff::{Options, compare, findings, ignored};

/// Compares two trees of records value by value, or two files
#[derive(Parser)]
#[command(after_help = "Exit code: 0 if both are equal, 1 if they differ, 2 for bad usage or unreadable files.")]
struct Arguments {
    /// Two folders or two files to compare
    #[arg(num_args = 2, value_names = ["OLD", "NEW"], required_unless_present = "ignored")]
    trees: Vec<PathBuf>,
    #[command(flatten)]
    options: Options,
    /// Number of differences shown for each file
    #[arg(long, value_name = "N", default_value_t = 20)]
    shown: usize,
    /// List the ignored values and exit
    #[arg(long)]
    ignored: bool,
}

fn main() -> ExitCode {
    let Arguments { trees, options, shown, ignored } = Arguments::parse();
    if ignored {
        print!("{}", ignored::list());
        return ExitCode::SUCCESS;
    }
    match compare(&trees[0], &trees[1], options) {
        Ok(found) => {
            print!("{}", findings::report(&found, shown));
            ExitCode::from(u8::from(!found.is_same()))
        }
        Err(reason) => {
            eprintln!("error: {reason}");
            ExitCode::from(2)
        }
    }
}
