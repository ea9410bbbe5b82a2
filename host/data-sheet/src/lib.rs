//! Joint file from the numbers of a data sheet. Every line states whether it comes from the sheet, is derived from it
//! or is assumed, and how far a wrong assumption moves the standard test.
//!
//! `arguments` is the command line, `questions` asks for missing numbers, `teeth` finds gears that assemble, `sizes`
//! derives sizes, masses and stiffnesses of a `material`, `swing` limits the link to what the motor can move, `lines`
//! writes the file, `standard_test` measures the assumptions.

mod arguments;
mod lines;
mod material;
mod questions;
mod sizes;
mod standard_test;
mod swing;
mod teeth;

use std::path::{Path, PathBuf};

pub use arguments::Arguments;
use board::device::board::Board;
use board::device::tick_time::RateCheck;
use joint_file::named::Loaded;
use joint_file::{diagnostic, warnings};
use report::failure::{Failure, Outcome};
use report::progress::Progress;
use report::write::write_text;
use simulation::bandwidth::Bandwidth;
use simulation::check;

use arguments::DataSheet;
use lines::{Figures, Line, Origin};
use sizes::{Gears, Sizes};
use swing::Swing;

/// Step rate of the check of the new joint, as in `joint check` and `joint sim` [Hz].
const CHECK_RATE: u32 = 20_000;

/// Makes the joint file; returns the printed text. `may_ask` allows questions for missing figures on a terminal.
pub fn run(arguments: &Arguments, may_ask: bool) -> Outcome<String> {
    let path = arguments.path();
    check_free(&path)?;
    let sheet = questions::complete(arguments, may_ask)?;
    let gears = Gears::derive(&sheet).map_err(|failure| {
        let help = failure.help().unwrap_or_default().to_owned();
        failure.with_help(format!("{help}\n{}", arguments.equivalent_gear_help()))
    })?;
    let seeds = (!arguments.no_measure).then_some(arguments.seeds);
    Progress::during(|progress| write_file(&sheet, &gears, &path, seeds, progress))
}

/// Writes the checked file, measured with `seeds` seeds; returns the printed text.
fn write_file(
    sheet: &DataSheet,
    gears: &Gears,
    path: &Path,
    seeds: Option<u64>,
    progress: &Progress,
) -> Outcome<String> {
    let mut lines = lines::lines(sheet, gears);
    let unmeasured = lines::text(sheet, gears, &lines, None);
    check_text(path, &unmeasured)?;
    let measure = |seeds| standard_test::measure(&unmeasured, &mut lines, seeds, progress);
    let figures = seeds.map(measure).transpose()?;
    let text = lines::text(sheet, gears, &lines, figures.as_ref());
    let loaded = check_text(path, &text)?;
    check_free(path)?;
    write_text(path, &text)?;
    progress.clear();
    warnings::print(&loaded);
    let mut printed = match gears {
        Gears::Planetary(Sizes { teeth, module_mm, .. }) => format!(
            "{}: {} planets, teeth {}, {}, {}, module {module_mm} mm, ratio {:.4} ({:+.2} %)\n",
            path.display(),
            teeth.planets,
            teeth.sun,
            teeth.planet,
            teeth.ring,
            teeth.ratio(),
            100.0 * (teeth.ratio() / sheet.ratio - 1.0)
        ),
        Gears::Equivalent => format!("{}: an equivalent gear, ratio {}\n", path.display(), sheet.ratio),
    };
    if let Some(undercut) = gears.undercut() {
        printed += &format!("{undercut}\n");
    }
    if let Some(Figures { of_file, chance, .. }) = figures {
        let chance = lines::percent(chance);
        printed += &format!(
            "standard test: {of_file:.4} mrad rms, which chance moves by {chance}; assumptions move it most by\n"
        );
        for (key, moved) in most_influential(&lines) {
            printed += &format!("  {key:<55} {moved}\n");
        }
    }
    if let Some(bandwidth) = Bandwidth::for_joint(&loaded.file.parameters, &loaded.file.surroundings) {
        let (usual, widest) = (bandwidth.usual_rad_per_s, bandwidth.widest_in_words());
        printed += &format!("bandwidth: {usual} rad/s if none is asked for, at most {widest}\n");
    }
    let swing = Swing::new(sheet, gears);
    let [limit, balancing] = [swing.limit, sheet.rated_torque / gears.ratio(sheet)];
    if limit < balancing {
        printed += &format!(
            "note: --motor-peak-torque-Nm {limit} acts before --rated-torque-Nm {}: that takes {balancing:.3} N m at the motor\n",
            sheet.rated_torque
        );
    }
    if let Some(warning) = swing.warning(loaded.file.parameters.link_inertia) {
        printed += &format!("note: {warning}\n");
    }
    // A board's computing time is no part of a data sheet: the joint is kept, with a note.
    let board = Board::load(board_file::DEFAULT)?;
    if let Err(failure) = RateCheck::plant(&loaded.file.parameters, &board).check(CHECK_RATE) {
        let help = failure.full_help().map_or(String::new(), |help| format!(" ({help})"));
        printed += &format!("note: {}{help}\n", failure.message());
    }
    printed += &format!("next: joint check {0}; joint sim {0}; joint budget {0}\n", path.display());
    Ok(printed)
}

/// The three most influential assumptions.
fn most_influential(lines: &[Line]) -> Vec<(String, String)> {
    let mut assumed: Vec<(&Line, f64)> =
        lines.iter().filter_map(|line| Some((line, line.moved.as_ref()?.as_ref().ok().copied()?))).collect();
    assumed.sort_by(|one, other| other.1.total_cmp(&one.1));
    assumed.iter().take(3).map(|(line, moved)| (line.path(), lines::percent(*moved))).collect()
}

/// Reads the text like every command, and designs its step.
fn check_text(path: &Path, text: &str) -> Outcome<Loaded> {
    let name = path.display().to_string();
    let file = joint_file::read(text).map_err(|problems| {
        let failure = Failure::from_report(diagnostic::report(&name, text, &problems));
        let options = lines::options_in(failure.message());
        failure.with_help(format!("{name} was not written{options}"))
    })?;
    let loaded = Loaded { name, text: text.to_owned(), file };
    check::summary(&loaded, &Board::load(board_file::DEFAULT)?, CHECK_RATE, None)?;
    Ok(loaded)
}

/// Rejects an existing path.
fn check_free(path: &Path) -> Outcome<()> {
    match path.symlink_metadata() {
        Err(_) => Ok(()),
        Ok(_) => Err(Failure::new(format!("{} exists already and would be lost", path.display()))
            .with_help("give the joint another name, or move that file away")),
    }
}

impl Arguments {
    /// Path of the file: the name with its extension.
    fn path(&self) -> PathBuf {
        match self.name.extension() {
            Some(extension) if extension == "toml" => self.name.clone(),
            _ => self.name.with_added_extension("toml"),
        }
    }
}

impl Line {
    /// Full path of the line's key.
    fn path(&self) -> String {
        if self.section.is_empty() { self.key.to_owned() } else { format!("{}.{}", self.section, self.key) }
    }

    /// Returns true if a wrong value is to be tried.
    fn is_assumed(&self) -> bool {
        matches!(self.origin, Origin::Assumed(_)) && self.moved.is_none()
    }
}
