//! `joint identify --quasi-static`: lost motion, hysteresis, error map and friction from a log of slow sweeps, without
//! a joint file. docs/reference/identify.md defines each figure.
//!
//! `options` are the command line's options. `samples` puts both encoders on one scale. `passes` are the motor's
//! motions between turning points, `profiles` their means by place. `loading` determines the flank that carries.
//! `results` are the figures, with the error `map` and the `prediction`; `page` and `pictures` write them.

mod curves;
mod loading;
mod map;
mod options;
mod page;
pub(crate) mod passes;
mod pictures;
mod prediction;
mod profiles;
mod results;
mod samples;

use std::path::{Path, PathBuf};

pub use options::Options;

use log_reader::column_map::ColumnMap;
use log_reader::columns::{Columns, DIFFERENCE};
use log_reader::log_file;
pub use page::Record as SlowRecord;
use report::document::{html, terminal};
use report::failure::{Failure, Outcome};
use report::folder::{self, Folder};
use report::output;
use report::progress::Progress;
use report::write::write_text;
use results::Results;
use samples::Samples;

/// Files of the results.
const REPORT: &str = "report.html";
const FINDINGS: &str = "findings.json";
const PICTURES: &str = "*.svg";

/// Arguments common to all modes of the command.
#[derive(Debug, Clone, Copy)]
pub struct Common<'a> {
    /// Path of the log.
    pub log: &'a Path,
    /// Topic of an MCAP log.
    pub topic: Option<&'a str>,
    /// Names and units of columns.
    pub map: &'a ColumnMap,
    /// Folder for the results.
    pub out: Option<&'a Path>,
    /// File for a copy of the findings.
    pub json: Option<&'a PathBuf>,
}

/// Reads a slow log, writes the results and returns the printed text.
pub fn run(common: Common<'_>, options: &Options, progress: &Progress) -> Outcome<String> {
    let path = common.log;
    check_halves(&options.halves)?;
    folder::check_files(&[("json", common.json.map(PathBuf::as_path))], &[path])?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let folder = Folder::choose(common.out, "identify", &format!("{name} slow"), &[REPORT, FINDINGS, PICTURES])?;
    progress.stage("reading");
    let ratio = options.gear_ratio.unwrap_or(1.0);
    let mut columns = log_file::read(path, common.topic, common.map, ratio, has_both_encoders)?;
    let at_path = |failure: Failure| failure.while_doing(path.display());
    let samples = Samples::from_columns(&mut columns, options);
    let explained = |failure: Failure| at_path(columns.with_notes(failure));
    let samples = samples.map_err(explained)?;
    let results = Results::evaluate(&samples, &options.halves).map_err(explained)?;
    check_ratio(options.gear_ratio, &results).map_err(explained)?;
    folder.make()?;
    let pictures = pictures::all(&results);
    for (file, figure) in &pictures {
        folder.write_text(file, &figure.to_file())?;
    }
    let figures = pictures.into_iter().map(|(_, figure)| figure).collect();
    let document = page::document(&name, &samples, &results, figures);
    let json = output::json("findings", &SlowRecord::of(&name, &samples, &results))?;
    folder.write_text(REPORT, &html(&document))?;
    folder.write_text(FINDINGS, &json)?;
    common.json.map_or(Ok(()), |path| write_text(path, &json))?;
    progress.clear();
    Ok(format!("{}\nreport: {}\n", terminal(&document), folder.file(REPORT).display()))
}

/// Largest relative error of a stated gear ratio against the log; widths are off by as much.
const RATIO_TOLERANCE: f64 = 0.003;
/// Rise of an error map over its curvature from which it is no encoder error.
const STRAIGHTNESS_MAX: f64 = 3.0;

/// Compares a stated ratio with the travel of motor and output.
fn check_ratio(stated: Option<f64>, results: &Results) -> Outcome<()> {
    let (map, places) = (&results.map, &results.profiles.places);
    let output_per_motor = map.output_per_motor();
    let is_other = (output_per_motor - 1.0).abs() > RATIO_TOLERANCE && map.straightness(places) > STRAIGHTNESS_MAX;
    let Some(stated) = stated.filter(|_| is_other) else { return Ok(()) };
    Err(Failure::new(format!(
        "the output turns {output_per_motor:.4} times as far as the motor and the ratio of {stated} say: widths would be off by as much"
    ))
    .with_help(format!(
        "it is {:.2} in this log: `--gear-ratio`; or an encoder has another number of counts a turn, or its angle another unit: `--unit`",
        stated / output_per_motor
    )))
}

fn check_halves(halves: &[(f64, f64)]) -> Outcome<()> {
    match halves {
        [] => Ok(()),
        [(from, to), (other_from, other_to)] if to <= other_from || other_to <= from => Ok(()),
        [_, _] => Err(Failure::new("the two halves overlap").with_help("the load has one direction at a time")),
        halves => Err(Failure::new(format!("--half is given {} times", halves.len()))
            .with_help("give it twice: for the sweeps that are loaded one way, and for those loaded the other way")),
    }
}

/// Returns true if the columns contain both encoders.
fn has_both_encoders(columns: &Columns) -> bool {
    let has = |wanted: &[&str]| columns.names().any(|name| wanted.contains(&name));
    has(&["output_counts", "output_angle_rad", "output_angle"])
        && has(&["motor_counts", "motor_angle_rad", "motor_angle", DIFFERENCE])
}
