//! `report-diff OLD NEW` compares two trees of records. The comparison is in the library.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use report_diff::{Options, compare, findings, ignored};

/// Compares two trees of records value by value, or two files
#[derive(Parser)]
#[command(after_help = "Exit code: 0 if both are the same, 1 if not, 2 for bad usage or what cannot be read.")]
struct Asked {
    /// What is compared: two folders or two files
    #[arg(num_args = 2, value_names = ["OLD", "NEW"], required_unless_present = "ignored")]
    trees: Vec<PathBuf>,
    #[command(flatten)]
    options: Options,
    /// Differences shown of each file
    #[arg(long, value_name = "N", default_value_t = 20)]
    shown: usize,
    /// Lists what is not compared, and ends
    #[arg(long)]
    ignored: bool,
}

fn main() -> ExitCode {
    let Asked { trees, options, shown, ignored } = Asked::parse();
    if ignored {
        print!("{}", ignored::list());
        return ExitCode::SUCCESS;
    }
    match compare(&trees[0], &trees[1], options) {
        Ok(found) => {
            print!("{}", findings::report(&found, shown));
            ExitCode::from(u8::from(!found.all_same()))
        }
        Err(why) => {
            eprintln!("error: {why}");
            ExitCode::from(2)
        }
    }
}
