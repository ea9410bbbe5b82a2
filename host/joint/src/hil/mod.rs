//! `joint hil`: runs a joint on a board (crate `joint-run`), or tests of observer and compensation (crate `scenario`);
//! the file decides.

mod arguments;
mod tests;

pub use arguments::Arguments;
use board::line_options::LineOptions;
use image_proof::everything;
use report::failure::{Failure, Outcome};
use report::output;
use report::progress::Progress;
use scenario::suite;

/// Runs a joint or test files; fails if a check fails.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    output::keep_for_json(arguments.json.as_deref());
    // Before any image is built.
    arguments.live.view.check()?;
    Progress::during(|progress| {
        if suite::holds_tests(&arguments.tests()) {
            return scenario::run(&tests::test_request(arguments)?, progress);
        }
        tests::reject_test_arguments(arguments)?;
        let joint = joint_run::run(&arguments.request(), progress);
        if arguments.check {
            return joint.and_then(|()| everything::check(arguments.rate(), progress));
        }
        match (&arguments.file, &arguments.line.port) {
            (Some(_), _) => joint,
            (None, Some(_)) => joint.and_then(|()| print_test_command(&arguments.line)),
            (None, None) => run_default_tests(arguments, joint, progress),
        }
    })
}

/// Runs the tests of observer and compensation after the joint's own run. A failed check of the joint does not prevent
/// the tests; any other failure does.
fn run_default_tests(arguments: &Arguments, joint: Outcome<()>, progress: &Progress) -> Outcome<()> {
    let check_failed = Failure::check_failed("").exit_code();
    if let Err(failure) = joint.as_ref()
        && failure.exit_code() != check_failed
    {
        return joint;
    }
    output::print("\n")?;
    let tests = scenario::run(&tests::default_test_request(arguments), progress);
    if !arguments.full {
        let left = tests::skipped_tests()?.len();
        output::print(&format!("`joint hil --full` runs {left} more tests, and every test with all its seeds\n"))?;
    }
    match (joint, tests) {
        (Ok(()), Ok(())) => output::print("passed:  the joint on the board, observer and compensation\n"),
        (Err(joint), Err(tests)) if tests.exit_code() == check_failed => {
            Err(Failure::check_failed(format!("{}; {}", joint.message(), tests.message()))
                .with_help("the reports list the failed checks first"))
        }
        (joint, tests) => tests.and(joint),
    }
}

/// Prints the command that tests observer and compensation on a real board. A real board keeps its image until the user
/// flashes another one, so the tests cannot follow at once.
fn print_test_command(line: &LineOptions) -> Outcome<()> {
    output::print(&format!(
        "tests of observer and compensation need another image; build it with\n\
         joint hil hil/t2.toml --role loop{}\n",
        line.repeated_options()
    ))
}
