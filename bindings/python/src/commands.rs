//! Commands of `joint`: the whole command line, and single commands as functions, whose results lie in a folder.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use board::device::board::Board;
use board::device::image::DEFAULT_TICK_RATE;
use clap::Parser;
use joint_file::named;
use log_reader::column_map::{self, ColumnMap};
use log_reader::log_file::LogFile;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use report::failure::{Failure, Outcome};
use report::progress::Progress;
use report::seeds::Seeds;
use report::{output, workspace};
use scenario::plant::PlantName;
use scenario::suite::Choice;
use scenario::{TestGroup, TestRequest};
use simulation::check::summary;

use crate::work;

/// Arguments of one command by themselves.
#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
struct Line<A: clap::Args> {
    #[command(flatten)]
    arguments: A,
}

/// Parses the arguments of a command.
fn parse<A: clap::Args>(words: Vec<OsString>) -> Outcome<A> {
    Line::try_parse_from(words).map(|line| line.arguments).map_err(|error| {
        let text = error.render().to_string();
        Failure::new(text.trim().trim_start_matches("error: ").to_owned())
    })
}

/// Runs the command `joint` with a command line, the program's name first; `data` has the tests that come with it.
/// Returns the exit code.
#[pyfunction]
pub fn run_command(py: Python<'_>, arguments: Vec<OsString>, data: PathBuf) -> u8 {
    workspace::set_installed(data);
    py.detach(|| joint::run(&arguments))
}

/// `joint identify`: writes report.html, joint.toml and findings.json to the folder of `--out`.
#[pyfunction]
pub fn identify(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<()> {
    work::run(py, move || {
        let arguments: ::identify::Arguments = parse(arguments)?;
        choose_joint(arguments.map.as_deref(), arguments.map_joint.as_deref())?;
        let progress = Progress::new();
        let outcome = ::identify::run(&arguments, &progress);
        progress.clear();
        outcome.map(|_| ())
    })
}

/// Refuses a column map of several joints without the name of one of them.
fn choose_joint(map: Option<&Path>, chosen: Option<&str>) -> Outcome<()> {
    let names: Vec<String> = column_map::joints(map)?.into_iter().map(|it| it.name).collect();
    match chosen {
        None if !names.is_empty() => Err(Failure::new(format!("the map has several joints: {}", names.join(", ")))
            .with_help(format!("choose one of them with map_joint=\"{}\"", names[0]))),
        _ => Ok(()),
    }
}

/// `joint new`: writes a joint file from the figures of a data sheet, and never asks on the terminal. Returns the printed
/// text.
#[pyfunction]
pub fn joint_from_data_sheet(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<String> {
    work::run(py, move || data_sheet::run(&parse(arguments)?, false))
}

/// `joint check`: figures of a joint as JSON.
#[pyfunction]
pub fn check(py: Python<'_>, name: String, text: String) -> PyResult<String> {
    work::short(py, || {
        let loaded = named::read_changed(name, text, &[])?;
        output::json("figures", &summary(&loaded, &Board::emulated(), DEFAULT_TICK_RATE, None)?)
    })
}

/// `joint hil --host`: runs a test file or a folder of them; writes record.json, report.html and logs to `out`. True if
/// every test passed.
#[pyfunction]
pub fn run_tests(
    py: Python<'_>,
    path: PathBuf,
    seeds: Option<String>,
    plant: String,
    full: bool,
    out: PathBuf,
) -> PyResult<bool> {
    work::run(py, move || {
        let plant = <PlantName as clap::ValueEnum>::from_str(&plant, true)
            .map_err(|_| Failure::new(format!("`{plant}` is no plant")).with_help("`reference` or `core`"))?;
        let seed = seeds.as_deref().map(str::parse::<Seeds>).transpose().map_err(Failure::new)?;
        let choice = if full { Choice::Full } else { Choice::Short };
        let request = TestRequest {
            groups: vec![TestGroup { path, choice, plant, boards: None }],
            seed,
            full,
            save_memories: false,
            name: "tests".to_owned(),
            out: Some(out),
            json: None,
            junit: None,
            live: live::PacedLiveOptions::default(),
            tasks: None,
        };
        let progress = Progress::new();
        let outcome = scenario::run(&request, &progress);
        progress.clear();
        match outcome {
            Err(failure) if failure.exit_code() == report::failure::EXIT_CHECK_FAILED => Ok(false),
            outcome => outcome.map(|()| true),
        }
    })
}

/// Columns of a log: names and arrays of numbers in SI. `topic` names a topic of an MCAP log.
#[pyfunction]
pub fn log_columns<'py>(
    py: Python<'py>,
    path: PathBuf,
    topic: Option<String>,
    map: Option<PathBuf>,
    map_joint: Option<String>,
    ratio: f64,
) -> PyResult<Vec<(String, Bound<'py, PyArray1<f64>>)>> {
    let columns = work::run(py, move || {
        choose_joint(map.as_deref(), map_joint.as_deref())?;
        let log = LogFile::open(&path)?;
        let columns = match &topic {
            Some(topic) => log.topic(topic)?,
            None => {
                log.columns(None, &ColumnMap::new(map.as_deref(), map_joint.as_deref(), &[], &[])?, ratio, |_| true)?
            }
        };
        let names: Vec<String> = columns.names().map(str::to_owned).collect();
        let values = |name: String| columns.column(&name).map(|values| (name.clone(), values.to_vec()));
        Ok(names.into_iter().filter_map(values).collect::<Vec<_>>())
    })?;
    Ok(columns.into_iter().map(|(name, values)| (name, values.into_pyarray(py))).collect())
}
