//! `joint hil`: a joint simulated on a board, driven and checked from here. Toolchain, images and the emulator's
//! process are left to `target`, pictures to `report`, files of tests to `trial`.
//!
//! The order of a run: `plan` finds everything that is wrong with the request, `files` that the report can be written,
//! `bench` builds the image and finds the board; `session` talks to it over a `transport` line and keeps a `recording`;
//! `twin` and `comparison` compute the same run here, `checks` judges, `table` prints.

pub mod bench;
pub mod checks;
pub mod comparison;
mod evaluation;
pub mod everything;
pub mod fault;
mod files;
mod line_options;
pub mod logs;
pub(crate) mod origin;
mod plan;
pub mod profile;
mod progress;
pub mod recording;
pub mod session;
pub(crate) mod table;
mod tests;
pub mod transport;
pub mod twin;

use std::path::Path;

use bench::Bench;
use evaluation::Ran;
use files::Files;
pub use line_options::LineOptions;
use plan::Plan;
pub use plan::{Arguments, Mode, RoleName};
pub use progress::Progress;
use recording::Recording;
use session::Session;

use crate::failure::{Failure, Outcome};
use crate::record::{RunRecord, all_hold};
use crate::{folder, output, report, trial};

/// Runs a joint on a board; succeeds only if every check held.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    Progress::during(|progress| {
        if trial::suite::is_of_tests(arguments.file()) {
            return trial::run(&tests::wanted(arguments)?, progress);
        }
        tests::refuse_for_joints(arguments)?;
        let joint = run_once(arguments, progress);
        if arguments.check {
            return joint.and_then(|()| everything::check(arguments.rate, progress));
        }
        match (&arguments.file, &arguments.line.port) {
            (Some(_), _) => joint,
            (None, Some(port)) => joint.and_then(|()| say_how_to_go_on(port, arguments.line.board.name())),
            (None, None) => run_tests(arguments, joint, progress),
        }
    })
}

/// The tests of observer and compensation after the joint's own checks: what failed there does not keep them from running.
fn run_tests(arguments: &Arguments, joint: Outcome<()>, progress: &Progress) -> Outcome<()> {
    let check_failed = Failure::check_failed("").exit_code();
    if let Err(failure) = joint.as_ref()
        && failure.exit_code() != check_failed
    {
        return joint;
    }
    output::print("\n")?;
    let tests = trial::run(&tests::wanted_of_all(arguments), progress);
    if !arguments.full {
        let left = tests::left_out()?.len();
        output::print(&format!("left to `joint hil --full`: {left} more tests, all of them with all their seeds\n"))?;
    }
    match (joint, tests) {
        (Ok(()), Ok(())) => output::print("passed:  the joint on the board, observer and compensation\n"),
        (Err(joint), Err(tests)) if tests.exit_code() == check_failed => {
            Err(Failure::check_failed(format!("{}; {}", joint.message(), tests.message()))
                .with_help("the reports lead with what failed"))
        }
        (joint, tests) => tests.and(joint),
    }
}

/// A real board keeps the image that it has until the user flashes another one.
fn say_how_to_go_on(port: &str, board: &str) -> Outcome<()> {
    output::print(&format!(
        "tests of observer and compensation take an image of their own, which is built and named by\n\
         joint hil hil/t2.toml --role loop --port {port} --board {board}\n"
    ))
}

fn run_once(arguments: &Arguments, progress: &Progress) -> Outcome<()> {
    let plan = Plan::new(arguments)?;
    let wanted = [("json", arguments.json.as_deref()), ("picture", arguments.picture.as_deref())];
    folder::check_files(&wanted, &[&plan.path, Path::new(&arguments.profile)])?;
    let files = Files::prepare(arguments.out.as_deref(), arguments.json.as_deref(), &plan.expected.joint)?;
    let bench = Bench::prepare(arguments, &plan, progress)?;
    let mut record = origin::record(arguments, &plan, &bench.transport);
    let image = bench.image.clone();
    record.identity.image = image.as_ref().map(origin::image);
    let references = (!arguments.no_reference).then(|| evaluation::start_references(&plan));
    let (outcome, recording) = converse(bench, &plan, progress);
    progress.stage("comparing with twin and reference");
    let ran = Ran { plan: &plan, recording: &recording, image: image.as_ref(), outcome: &outcome };
    let evaluated = evaluation::evaluate(&mut record, &ran, references);
    progress.stage("writing the report");
    let report = files.write(&record);
    progress.clear();
    evaluated?;
    show(&record)?;
    match (outcome, report) {
        (Ok(()), Ok(report)) => {
            output::print(&format!("report: {}\n", report.display()))?;
            let picture = arguments.picture.as_deref().map_or(Ok(()), |path| report::write_picture(&record, path));
            all_hold(&record.checks, "the report shows where the run departs from what was expected").and(picture)
        }
        (Err(failure), Ok(report)) => {
            let kept = format!("what was recorded until tick {} is in {}", recording.last_tick(), report.display());
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

/// The whole conversation with the board; what was heard is there whatever became of it.
fn converse(bench: Bench, plan: &Plan, progress: &Progress) -> (Outcome<()>, Recording) {
    let Bench { line, surroundings, patience, .. } = bench;
    let mut session = Session::new(line, surroundings);
    progress.stage("calling the board");
    let outcome = session.connect(&plan.expected, patience).and_then(|_| session.reset(plan.settings));
    let outcome = outcome.and_then(|()| {
        progress.run("running", plan.profile.ticks);
        session.stream(&plan.profile, &mut |ticks| progress.at(ticks))
    });
    let outcome = outcome.and_then(|()| session.finish(plan.profile.ticks));
    if outcome.is_err() {
        session.abandon();
    }
    (outcome, std::mem::take(&mut session.recording))
}

/// The table, unless nothing has been run.
fn show(record: &RunRecord) -> Outcome<()> {
    if record.samples.is_empty() {
        return Ok(());
    }
    let identity = &record.identity;
    let head = format!("{} on {} ({})\n\n", identity.joint, identity.board, identity.transport);
    output::print(&(head + &table::table(&record.checks, identity.emulated) + "\n"))
}
