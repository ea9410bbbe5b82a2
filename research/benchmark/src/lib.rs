//! `joint bench`: the core's step against common methods, error by cost, on the emulated core and on the host. `method_results` runs the
//! fixed-step methods, through `emulated_runs` on the emulated core, `libraries` times the libraries available to a host program,
//! `verdicts` and `in_a_sample` draw the conclusions; all of it is the `record`, and `page` and `document` present it.

mod document;
mod emulated_runs;
mod in_a_sample;
mod libraries;
mod method_results;
mod page;
mod pictures;
mod record;
#[cfg(test)]
mod schema;
mod verdicts;

pub use record::{BenchmarkRecord, Origin};
use std::path::{Path, PathBuf};

use comparison::case::Case;
use comparison::catalogue;

use board::device::emulator;
use board::device::toolchain::Toolchain;
use joint_file::{named, warnings};
use report::document::{Medium, html, markdown};
use report::failure::{Failure, Outcome};
use report::progress::Progress;
use report::seeds::Seeds;
use report::write::write_text;
use report::{folder, interruption, output};

/// Description of the command in a line of its help.
pub const ABOUT: &str =
    "Compare the step with what people use: error against cost, on the emulated core and on the host";

/// Arguments of `joint bench`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  joint bench                                 all named cases, board and host
  joint bench --case A,Q --html bench.html    two cases, with pictures
  joint bench joints/l1.toml --json -         a joint from a file, figures as JSON
  joint bench --random 1-30                   random joints by seed: 3 to 5 planets, light and heavy
  joint bench --document docs/reference/error-against-cost.md
                                              rewrites the comparison in that file

Error is that of the mesh deflections (RMS over their standard deviation), the worst over 8 phases of the
excitation; where meshes rattle chaotically, that of the link angle over the lost motion, in windows:
wherever a torque jumps, every method restarts from the reference's state.
Instructions are counted exactly on the emulated Cortex-M4F; host times are processor time of one process.")]
pub struct Arguments {
    /// Joint file (TOML) or preset to compare on, instead of the named cases
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    /// Named cases to run, all by default: A, Q, R, B, F, L
    #[arg(long, value_name = "KEYS", value_delimiter = ',', conflicts_with = "file")]
    case: Vec<String>,
    /// Random joints of these seeds, instead of the named cases; equivalent gears among them are skipped
    #[arg(long, value_name = "N|FROM-TO", conflicts_with_all = ["file", "case"])]
    random: Option<Seeds>,
    /// Skips the host libraries; a joint file never runs on them
    #[arg(long, conflicts_with = "file")]
    no_libraries: bool,
    /// Writes all figures as JSON ("-" is standard output, in place of the tables)
    #[arg(long, value_name = "OUT")]
    json: Option<PathBuf>,
    /// Writes a page with pictures of error against cost
    #[arg(long, value_name = "OUT")]
    html: Option<PathBuf>,
    /// Writes the comparison into this Markdown file, between its two marks
    #[arg(long, value_name = "FILE")]
    document: Option<PathBuf>,
}

/// Runs the comparison.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    let wanted = [("json", &arguments.json), ("html", &arguments.html), ("document", &arguments.document)];
    let read: Vec<&Path> = arguments.file.as_deref().into_iter().collect();
    folder::check_files(&wanted.map(|(option, file)| (option, file.as_deref())), &read)?;
    arguments.document.as_deref().map_or(Ok(()), |document| document::read(document).map(drop))?;
    let progress = Progress::new();
    let figures = interruption::explain(gather(arguments, &progress));
    progress.clear();
    let figures = figures?;
    let document = page::document(&figures);
    if let Some(path) = &arguments.html {
        write_text(path, &html(&document))?;
    }
    if let Some(path) = &arguments.document {
        document::update(path, &figures, &document)?;
    }
    let text = markdown(&document, Medium::Terminal);
    output::deliver(&figures, &text, arguments.json.as_deref(), &read)
}

fn gather(arguments: &Arguments, progress: &Progress) -> Outcome<BenchmarkRecord> {
    let cases = cases(arguments)?;
    let keys: Vec<String> = cases.iter().map(|case| case.key.clone()).collect();
    let say = |line: &str| progress.print_message(line);
    progress.stage("preparing the toolchain");
    let toolchain = Toolchain::prepare(&say)?;
    let emulator = emulator::ensure(&say)?;
    let (cases, methods) = method_results::run(cases, &toolchain, progress, &say)?;
    progress.stage("host libraries");
    // Libraries run the named cases only, which the program behind them contains.
    let host = match arguments.no_libraries || arguments.file.is_some() || arguments.random.is_some() {
        true => None,
        false => Some(libraries::run(&keys, &say)?),
    };
    Ok(BenchmarkRecord {
        schema: record::SCHEMA,
        origin: document::origin(&toolchain, emulator),
        at_equal_error: verdicts::at_equal_error(&methods),
        in_a_sample: in_a_sample::in_a_sample(&cases, &methods),
        in_budget: verdicts::in_budget(&methods),
        rounding: verdicts::rounding(&methods),
        host_at_equal_error: host.as_ref().map(|host| verdicts::host_at_equal_error(&host.times)).unwrap_or_default(),
        cases,
        methods,
        host,
    })
}

/// Requested cases.
fn cases(arguments: &Arguments) -> Outcome<Vec<Case>> {
    if let Some(file) = &arguments.file {
        let loaded = named::load(file)?;
        warnings::print(&loaded);
        if loaded.file.parameters.equivalent_gear().is_some() {
            return Err(Failure::new(format!(
                "{} is an equivalent gear: the comparison needs planet meshes",
                loaded.name
            ))
            .with_help("name a joint with teeth; `joint budget` says what the step of an equivalent gear costs"));
        }
        return Ok(vec![catalogue::for_joint(&loaded.file.parameters)]);
    }
    if let Some(seeds) = arguments.random {
        let cases: Vec<Case> = seeds.each().filter_map(catalogue::for_seed).collect();
        let none =
            || Failure::new(format!("--random {seeds}: all of these joints are equivalent gears, without meshes"));
        return if cases.is_empty() { Err(none().with_help("name more seeds, as in 1-30")) } else { Ok(cases) };
    }
    let all = catalogue::cases();
    let known = |key: &String| all.iter().any(|case| case.key == *key);
    if let Some(unknown) = arguments.case.iter().find(|key| !known(key)) {
        let names: Vec<&str> = all.iter().map(|case| case.key.as_str()).collect();
        return Err(Failure::new(format!("--case {unknown}: there is no such case"))
            .with_help(format!("cases are {}; a joint file is named without --case", names.join(", "))));
    }
    let wanted = |case: &Case| arguments.case.is_empty() || arguments.case.contains(&case.key);
    Ok(all.into_iter().filter(wanted).collect())
}
