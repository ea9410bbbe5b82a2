//! `cargo run -p sensitivity`: the sensitivity of every threshold of observer and compensation.
//!
//! Each threshold is halved and raised by half; each value runs a fixed set of closed loops (`runs`) in a child process,
//! because a threshold gets its factor at process start (`model_core::numbers::sensitivity`). `change` finds the figure
//! that moved most relative to its bound; `unit_tests` finds the core's unit tests that fail under a factor; `page` keeps
//! the table.

mod change;
mod page;
mod runs;
mod unit_tests;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Command, FromArgMatches};
use model_core::numbers::sensitivity::{FACTORS, Threshold};
use report::failure::{Failure, Outcome};
use report::interruption::{self, UninterruptedWork};
use report::output;
use report::progress::Progress;
use report::workspace::workspace;
use report::write::write_text;

use page::{Page, Row};
use runs::Figures;
use unit_tests::UnitTests;

/// Arguments of the program.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  cargo run -p sensitivity                              every threshold that the page lacks
  cargo run -p sensitivity -- --only CONTACT.persistence --again
  cargo run -p sensitivity -- --unit-tests              after new unit tests: the thresholds that none holds yet")]
struct Arguments {
    /// Measures only this threshold; may be repeated
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Number of seeds of each test file
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=100))]
    seeds: u64,
    /// Page with the table [default: docs/reference/sensitivity.md]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Measures again what the page already has
    #[arg(long)]
    again: bool,
    /// Runs only the unit tests, for thresholds that no unit test holds yet; keeps the results of closed loops
    #[arg(long, conflicts_with = "seeds")]
    unit_tests: bool,
    /// Runs the test files into this folder; for the child processes of this program
    #[arg(long, value_name = "FOLDER", hide = true)]
    run_into: Option<PathBuf>,
}

fn main() -> ExitCode {
    let command = Arguments::augment_args(Command::new("sensitivity"))
        .about("Measure what moves when each threshold of observer and compensation is halved and raised by half");
    report::command_line::main(command, Arguments::from_arg_matches, |arguments| match &arguments.run_into {
        Some(folder) => runs::run_all(folder, arguments.seeds),
        None => Progress::during(|progress| study(arguments, progress)),
    })
}

fn study(arguments: &Arguments, progress: &Progress) -> Outcome<()> {
    // Ctrl-C ends the child process as well; the table with the finished rows is on disk after each row.
    let _uninterrupted = UninterruptedWork::begin();
    // No test file runs the wiring check.
    let thresholds: Vec<Threshold> =
        model_core::thresholds().into_iter().filter(|threshold| threshold.folder != "wiring").collect();
    let is_threshold = |name: &String| thresholds.iter().any(|threshold| threshold.name == name);
    if let Some(name) = arguments.only.iter().find(|name| !is_threshold(name)) {
        return Err(Failure::new(format!("`{name}` is no threshold of observer or compensation"))
            .with_help("docs/reference/sensitivity.md lists the names"));
    }
    let path = arguments.out.clone().unwrap_or_else(|| workspace().join("docs/reference/sensitivity.md"));
    let is_wanted = |name: &str| arguments.only.is_empty() || arguments.only.iter().any(|only| only == name);
    let work: Vec<&Threshold> = thresholds.iter().filter(|threshold| is_wanted(threshold.name)).collect();
    if arguments.unit_tests {
        let mut page = Page::open_without_runs(&path, &thresholds)?;
        let is_unheld = |row: Row| arguments.again || row.lacks_unit_tests() || row.unit_tests == unit_tests::NONE;
        let unheld = work.into_iter().filter(|threshold| is_unheld(page.row(threshold.name))).collect();
        run_unit_tests(&mut page, &path, unheld, progress)?;
        progress.clear();
        return output::print(&format!("table: {}\n", path.display()));
    }
    progress.stage("runs with the tuned thresholds");
    let base = runs::measure(None, arguments.seeds)?;
    let mut page = Page::open(&path, &thresholds, &base, arguments.seeds);
    if arguments.again {
        work.iter().for_each(|threshold| page.set(threshold.name, Row::default()));
    }
    let lacks = |page: &Page, lacks: fn(&Row) -> bool| -> Vec<&Threshold> {
        work.iter().copied().filter(|threshold| lacks(&page.row(threshold.name))).collect()
    };
    // The unit tests first: all of them take as long as the closed loops of a few thresholds.
    let untested = lacks(&page, Row::lacks_unit_tests);
    run_unit_tests(&mut page, &path, untested, progress)?;
    let unrun = lacks(&page, Row::lacks_loops);
    progress.run("closed loops", unrun.len() as u64);
    for threshold in unrun {
        let row = Row { loops: measure_loops(threshold, &base, arguments.seeds)?, ..page.row(threshold.name) };
        progress.print_above(&format!("{}: {}; {}", threshold.name, row.loops[0], row.loops[1]));
        page.set(threshold.name, row);
        write_text(&path, &page.text())?;
        progress.advance(1);
    }
    write_text(&path, &page.text())?;
    progress.clear();
    output::print(&format!("table: {}\n", path.display()))
}

/// Finds the unit tests that fail under each of the thresholds; the page is on disk after each threshold.
fn run_unit_tests(page: &mut Page, path: &Path, thresholds: Vec<&Threshold>, progress: &Progress) -> Outcome<()> {
    if thresholds.is_empty() {
        return Ok(());
    }
    progress.stage("unit tests with the tuned thresholds");
    let tests = UnitTests::build()?;
    progress.run("unit tests", thresholds.len() as u64);
    for threshold in thresholds {
        let row = Row { unit_tests: tests.cell(threshold)?, ..page.row(threshold.name) };
        progress.print_above(&format!("{}: {}", threshold.name, row.unit_tests));
        page.set(threshold.name, row);
        write_text(path, &page.text())?;
        progress.advance(1);
    }
    Ok(())
}

/// Cells of the closed loops under a threshold, one for each factor.
fn measure_loops(threshold: &Threshold, base: &Figures, seeds: u64) -> Outcome<[String; 2]> {
    let mut cells = [const { String::new() }; 2];
    for (cell, (factor, value)) in cells.iter_mut().zip(FACTORS.into_iter().zip(&threshold.scaled)) {
        *cell = if *value == threshold.value {
            format!("stays {value}: rounded")
        } else {
            change::cell(base, &runs::measure(Some((threshold.name, factor)), seeds)?)
        };
        if interruption::requested() {
            return Err(Failure::interrupted("stopped by the user"));
        }
    }
    Ok(cells)
}
