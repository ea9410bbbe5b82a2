//! Arguments of `joint hil` that belong to test files only, or to joints only; an argument of the other kind is an
//! error.

use std::path::{Path, PathBuf};

use link::messages::Role;

use super::arguments::{Arguments, TESTS};
use board::line_options::RoleName;
use report::command_line::{program, quoted};
use report::failure::{Failure, Outcome};
use report::input;
use report::workspace::workspace;
use scenario::on_board::BoardRequest;
use scenario::plant::PlantName;
use scenario::suite;
use scenario::suite::Choice;
use scenario::{TaskOptions, TestGroup, TestRequest};

/// Request for the tests in a file or folder; rejects arguments that belong to joints.
pub fn test_request(arguments: &Arguments) -> Outcome<TestRequest<'_>> {
    let joint_arguments = [
        ("duration", arguments.duration.is_some(), "write duration_s into the test file"),
        ("profile", arguments.profile.is_some(), "write profile into the test file"),
        ("rate", arguments.rate.is_some(), "write drive_train.control_rate_Hz into [known] of the test file"),
        ("decimation", arguments.decimation.is_some(), "leave it out: the log of a run has a fixed rate"),
        ("picture", arguments.picture.is_some(), "leave it out: the report has pictures"),
        ("no-reference", arguments.no_reference, "leave it out: --plant says what is controlled"),
        ("check", arguments.check, "leave FILE out, or name a joint"),
    ];
    if let Some((name, _, remedy)) = joint_arguments.iter().find(|(_, given, _)| *given) {
        let message = format!("--{name} is for joints, and {} holds tests", arguments.file().display());
        return Err(Failure::new(message).with_help(*remedy));
    }
    if arguments.mode.is_some() && (arguments.host || arguments.role == Some(RoleName::Observer)) {
        return Err(Failure::new("--mode is for a whole loop on a board: all other tests run in lockstep")
            .with_help("leave it out, or run on a board with --role loop"));
    }
    if arguments.full && arguments.seed.is_some() && !arguments.tests().is_dir() {
        return Err(
            Failure::new("--full runs the full list of seeds, and --seed one seed").with_help("leave one of them out")
        );
    }
    if let (true, Some(port)) = (arguments.host, &arguments.line.port) {
        return Err(Failure::new(format!("--host runs without a board, and --port {port} names one"))
            .with_help("leave one of them out"));
    }
    let role = arguments.role.map_or(Role::Loop, Role::from);
    if arguments.live.view.is_wanted() && !arguments.host && role == Role::Loop {
        return Err(Failure::new(
            "a live view shows plants on this machine, and with --role loop the plant is on the board",
        )
        .with_help("add --host or --role observer"));
    }
    check_tasks(arguments)?;
    let path = arguments.tests();
    // The bounds of the tests that come with the program are stated around the reference.
    let default_plant = if arguments.file.is_none() { PlantName::Reference } else { PlantName::Core };
    let group = TestGroup {
        choice: if arguments.full { Choice::Full } else { Choice::Short },
        plant: arguments.plant.unwrap_or(default_plant),
        boards: (!arguments.host).then(|| board_request(arguments, role)),
        path,
    };
    let name = group.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let tasks = task_options(arguments, &group);
    Ok(TestRequest { tasks, ..request_of_groups(arguments, vec![group], name, arguments.out.clone()) })
}

/// Options of the command line that run the seeds as tasks.
fn task_arguments(arguments: &Arguments) -> [(&'static str, bool); 3] {
    let engine = &arguments.engine;
    [("dask", engine.dask.is_some()), ("slurm", engine.slurm), ("resume", arguments.resume)]
}

/// Rejects tasks on a board, and a live view of tasks.
fn check_tasks(arguments: &Arguments) -> Outcome<()> {
    let Some((name, _)) = task_arguments(arguments).into_iter().find(|(_, given)| *given) else { return Ok(()) };
    if !arguments.host {
        return Err(Failure::new(format!("--{name} runs tests as tasks, which have no board"))
            .with_help(format!("add --host, or leave --{name} out")));
    }
    if arguments.live.view.is_wanted() {
        return Err(Failure::new(format!("a live view shows runs of this process, and --{name} keeps them as tasks"))
            .with_help("leave one of them out"));
    }
    Ok(())
}

/// Options of runs as tasks, with the command that goes on with them.
fn task_options(arguments: &Arguments, group: &TestGroup<'_>) -> Option<TaskOptions> {
    task_arguments(arguments).iter().any(|(_, given)| *given).then(|| {
        let mut repeat = format!(
            "{} hil {} --host --plant {} --resume",
            program(),
            quoted(&group.path.display().to_string()),
            group.plant.word()
        );
        arguments.seed.iter().for_each(|seed| repeat += &format!(" --seed {seed}"));
        let flags = [("full", arguments.full), ("memory", arguments.memory)];
        flags.iter().filter(|(_, given)| *given).for_each(|(name, _)| repeat += &format!(" --{name}"));
        let files = [("out", &arguments.out), ("json", &arguments.json), ("junit", &arguments.junit)];
        for (name, file) in files {
            file.iter().for_each(|file| repeat += &format!(" --{name} {}", quoted(&file.display().to_string())));
        }
        TaskOptions { engine: arguments.engine.clone(), repeat }
    })
}

/// Request for the tests that come with the program, if no file is named: the tests marked for the board run on the
/// board; `--full` adds every test around the f64 reference, where the bounds are stated.
pub fn default_test_request(arguments: &Arguments) -> TestRequest<'_> {
    let group = |choice, plant, boards| TestGroup { path: folder(), choice, plant, boards };
    let on_board = |role, plant| group(Choice::OnBoard(role), plant, Some(board_request(arguments, role)));
    let mut groups = vec![on_board(Role::Loop, PlantName::Core), on_board(Role::Observer, PlantName::Reference)];
    if arguments.full {
        groups.push(group(Choice::Full, PlantName::Reference, None));
    }
    request_of_groups(arguments, groups, "all".to_owned(), arguments.out.as_ref().map(|out| out.join("tests")))
}

/// Test files that a run without `--full` leaves out.
pub fn skipped_tests() -> Outcome<Vec<PathBuf>> {
    suite::skipped_without_full(&folder())
}

/// Folder of the tests that come with the program; the relative path `hil` if it leads to the same folder.
fn folder() -> PathBuf {
    let whole = workspace().join(TESTS);
    let short = Path::new(TESTS);
    let same = short.canonicalize().is_ok_and(|short| whole.canonicalize().is_ok_and(|whole| short == whole));
    if same { short.to_owned() } else { whole }
}

fn request_of_groups<'a>(
    arguments: &'a Arguments,
    groups: Vec<TestGroup<'a>>,
    name: String,
    out: Option<PathBuf>,
) -> TestRequest<'a> {
    TestRequest {
        groups,
        seed: arguments.seed,
        full: arguments.full,
        save_memories: arguments.memory,
        name,
        out,
        json: arguments.json.as_deref().filter(|_| arguments.file.is_some() || arguments.host),
        junit: arguments.junit.as_deref(),
        live: arguments.live.clone(),
        tasks: None,
    }
}

fn board_request(arguments: &Arguments, role: Role) -> BoardRequest<'_> {
    BoardRequest {
        role,
        port: arguments.line.port.as_deref(),
        baud: arguments.line.baud,
        board: arguments.line.board(),
        no_build: arguments.no_build,
        force: arguments.force,
        mode: arguments.mode.map(Into::into),
    }
}

/// Rejects arguments of test files if a joint is named.
pub fn reject_test_arguments(arguments: &Arguments) -> Outcome<()> {
    // `joint hil` without a file, a port or `--check` also runs the bundled tests; only then do `--full` and `--junit`
    // apply to a joint.
    let alone = arguments.file.is_some() || arguments.line.port.is_some() || arguments.check;
    let test_arguments = [
        ("host", arguments.host),
        ("role", arguments.role.is_some()),
        ("seed", arguments.seed.is_some()),
        ("plant", arguments.plant.is_some()),
        ("full", arguments.full && alone),
        ("junit", arguments.junit.is_some() && alone),
        ("resume", arguments.resume),
        ("dask", arguments.engine.dask.is_some()),
        ("slurm", arguments.engine.slurm),
        ("live", arguments.live.view.live.is_some() && alone),
        ("live-udp", arguments.live.view.live_udp.is_some() && alone),
    ];
    let Some((name, _)) = test_arguments.iter().find(|(_, given)| *given) else { return Ok(()) };
    let file = arguments.file().display();
    let message = match (joint_file::preset(&file.to_string()), input::text(arguments.file(), input::LARGEST_TYPED)) {
        (Some(_), _) | (_, Ok(_)) => format!("--{name} is for test files, and {file} is a joint"),
        (None, Err(why)) => format!("cannot read the test file {file}: {why}"),
    };
    Err(Failure::new(message)
        .with_help("name a test file such as hil/t2.toml; docs/reference/hil-file.md describes the format"))
}
