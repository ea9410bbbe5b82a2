//! Which arguments of `joint hil` belong to test files and which to joints; the wrong ones are named rather than
//! ignored. Running tests is left to `trial`.

use link::messages::{Role, RunMode};

use super::plan::{Arguments, Mode, RoleName};
use super::profile::BUILTIN;
use crate::failure::{Failure, Outcome};
use crate::trial::Wanted;
use crate::trial::board::BoardWish;
use crate::trial::plant::PlantName;

/// What is asked of the tests in a file or folder.
pub fn wanted(arguments: &Arguments) -> Outcome<Wanted<'_>> {
    let of_joints = [
        ("mode", arguments.mode.is_some() && (arguments.host || arguments.role == Some(RoleName::Observer))),
        ("duration", arguments.duration.is_some()),
        ("picture", arguments.picture.is_some()),
        ("no-reference", arguments.no_reference),
        ("check", arguments.check),
        ("profile", arguments.profile != BUILTIN[0]),
    ];
    if let Some((name, _)) = of_joints.iter().find(|(_, given)| *given) {
        let message = format!("--{name} is for joints, and {} holds tests", arguments.file.display());
        return Err(Failure::new(message).with_help("write it into the test file: docs/hil-file.md tells its keys"));
    }
    if let (true, Some(port)) = (arguments.host, &arguments.port) {
        return Err(Failure::new(format!("--host runs without a board, and --port {port} names one"))
            .with_help("leave one of them out"));
    }
    let boards = BoardWish {
        role: match arguments.role {
            Some(RoleName::Observer) => Role::Observer,
            Some(RoleName::Loop) | None => Role::Loop,
        },
        port: arguments.port.as_deref(),
        baud: arguments.baud,
        board: arguments.board,
        no_build: arguments.no_build,
        mode: arguments.mode.map(|mode| match mode {
            Mode::Lockstep => RunMode::Lockstep,
            Mode::Realtime => RunMode::Realtime,
        }),
    };
    Ok(Wanted {
        path: &arguments.file,
        seed: arguments.seed,
        plant: arguments.plant.unwrap_or(PlantName::Core),
        boards: (!arguments.host).then_some(boards),
        full: arguments.full,
        out: arguments.out.as_deref(),
        json: arguments.json.as_deref(),
        junit: arguments.junit.as_deref(),
    })
}

/// Complains about arguments of tests when a joint was named.
pub fn refuse_for_joints(arguments: &Arguments) -> Outcome<()> {
    let of_tests = [
        ("host", arguments.host),
        ("role", arguments.role.is_some()),
        ("seed", arguments.seed.is_some()),
        ("plant", arguments.plant.is_some()),
        ("full", arguments.full),
        ("junit", arguments.junit.is_some()),
    ];
    let Some((name, _)) = of_tests.iter().find(|(_, given)| *given) else { return Ok(()) };
    let file = arguments.file.display();
    let message = match arguments.file.exists() || joints::preset(&file.to_string()).is_some() {
        true => format!("--{name} is for test files, and {file} is a joint"),
        false => format!("there is no test file {file}"),
    };
    Err(Failure::new(message)
        .with_help("name a test file such as hil/t2.toml; docs/hil-file.md tells how to write one"))
}
