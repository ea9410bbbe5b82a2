//! Run of a joint on a board: driven through a torque profile, compared with twin and reference, judged and reported.
//!
//! Order of a run: `plan` checks the request, and the folder is tested. `board` builds the image, finds the board,
//! drives it and receives its samples. `comparison` computes the run by the f64 reference, `evaluation` fills the
//! `record`, `checks` judges it, `page` shows it, `files` writes it.

pub mod checks;
pub mod comparison;
mod evaluation;
pub mod files;
mod log_file;
mod origin;
pub mod page;
pub mod plan;
pub mod record;

use std::path::Path;

use board::connection::Connection;
use board::device::board::Board;
use board::device::image::{self, Image};
use board::device::toolchain::Toolchain;
use board::recording::Recording;
use board::session::Session;
use evaluation::FinishedRun;
use link::messages::Role;
use plan::{RunPlan, RunRequest};
use record::RunRecord;
use report::checks::all_hold;
use report::failure::Outcome;
use report::folder::{self, Folder};
use report::interruption::UninterruptedWork;
use report::output;
use report::progress::Progress;

/// Runs a joint on a board; succeeds only if every check holds.
pub fn run(request: &RunRequest<'_>, progress: &Progress) -> Outcome<()> {
    let plan = RunPlan::new(request)?;
    let wanted = [("json", request.json), ("picture", request.picture)];
    folder::check_files(&wanted, &[&plan.path, Path::new(request.profile)])?;
    let folder = Folder::prepare(request.out, "hil", &plan.expected.joint, &files::ALL_FILES)?;
    let connection = prepare(request, &plan, progress)?;
    // A run stopped by the user is kept and reported up to that point.
    let _uninterrupted = UninterruptedWork::begin();
    let mut record = origin::record(request, &plan, &connection.transport);
    let image = connection.image.clone();
    record.identity.image = image.as_ref().map(origin::image);
    let references = (!request.no_reference).then(|| evaluation::start_references(&plan));
    let (outcome, recording) = run_session(connection, &plan, progress);
    progress.stage("comparing with twin and reference");
    let finished = FinishedRun { plan: &plan, recording: &recording, image: image.as_ref(), outcome: &outcome };
    let evaluated = evaluation::evaluate(&mut record, &finished, references);
    progress.stage("writing the report");
    let report = files::write(&folder, request.json, &record);
    progress.clear();
    evaluated?;
    print_checks(&record)?;
    match (outcome, report) {
        (Ok(()), Ok(report)) => {
            output::print(&format!("report: {}\n", report.display()))?;
            let picture = request.picture.map_or(Ok(()), |path| page::write_picture(&record, path));
            all_hold(&record.checks, "the report shows the deviations from the expected run").and(picture)
        }
        (Err(failure), Ok(report)) => {
            let kept = format!("the recording up to tick {} is in {}", recording.last_tick(), report.display());
            let help = failure.help().map_or_else(|| kept.clone(), |help| format!("{help}\n{kept}"));
            Err(failure.with_help(help))
        }
        (Err(failure), Err(unwritten)) => {
            let help = format!("also: {unwritten}");
            Err(failure.with_help(help))
        }
        (Ok(()), Err(unwritten)) => Err(unwritten),
    }
}

/// Whole session with the board; returns the recording after a failure too.
fn run_session(connection: Connection, plan: &RunPlan, progress: &Progress) -> (Outcome<()>, Recording) {
    let Connection { line, supervisor, timeout, .. } = connection;
    let mut session = Session::new(line, supervisor);
    progress.stage("calling the board");
    let outcome = session.connect(&plan.expected, timeout).and_then(|_| session.reset(plan.settings));
    let outcome = outcome.and_then(|()| {
        progress.run("running", plan.profile.ticks);
        session.stream(&plan.profile, &mut |ticks| progress.set_position(ticks))
    });
    let outcome = outcome.and_then(|()| session.finish(plan.profile.ticks));
    if outcome.is_err() {
        session.abandon();
    }
    (outcome, std::mem::take(&mut session.recording))
}

/// Prints the checks, unless nothing was run.
fn print_checks(record: &RunRecord) -> Outcome<()> {
    if record.samples.is_empty() {
        return Ok(());
    }
    output::print(&(page::render_lines(record) + "\n"))
}

/// Builds the image and finds the board. A port is opened first, so that its faults appear before a build.
fn prepare(request: &RunRequest<'_>, plan: &RunPlan, progress: &Progress) -> Outcome<Connection> {
    match &request.line.port {
        None => Connection::emulated(progress, |board| build(request, plan, board, progress)),
        Some(path) => Connection::on_port(path, request.line.baud_rate(), || match request.no_build {
            true => Ok(None),
            false => build(request, plan, request.line.board(), progress).map(Some),
        }),
    }
}

fn build(request: &RunRequest<'_>, plan: &RunPlan, board: &Board, progress: &Progress) -> Outcome<Image> {
    progress.stage("preparing the toolchain");
    let toolchain = Toolchain::prepare(&|line| progress.print_message(line))?;
    progress.stage("building the firmware");
    image::build_image(&toolchain, &plan.path, board, Role::Plant, request.rate, request.force, &|line| {
        progress.print_message(line)
    })
}
