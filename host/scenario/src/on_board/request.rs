//! Which boards tests shall run on and in which role, and what no board can run.

use link::messages::{Role, RunMode};

use super::faults::quantised;
use crate::controller::ControllerName;
use crate::plant::PlantName;
use crate::suite::Test;
use board::device::board::Board;
use report::failure::{Failure, Outcome};

/// Which boards tests are to run on.
#[derive(Debug, Clone, Copy)]
pub struct BoardRequest<'w> {
    /// What they do.
    pub role: Role,
    /// The port of a real one.
    pub port: Option<&'w str>,
    /// Its speed [baud].
    pub baud: Option<u32>,
    /// What is behind it.
    pub board: &'w Board,
    /// Its image is there already.
    pub no_build: bool,
    /// Its image is built and run although the board has no time for it.
    pub force: bool,
    /// Lockstep or real time, of a whole loop.
    pub mode: Option<RunMode>,
}

/// Refuses a request that no board can meet.
pub fn check_request(request: &BoardRequest<'_>, plant: PlantName) -> Outcome<()> {
    if request.role == Role::Loop && plant == PlantName::Reference {
        return Err(Failure::new("the f64 reference does not run on a board").with_help("leave --plant out"));
    }
    Ok(())
}

/// Refuses a test that such a board cannot run.
pub fn check_test(request: &BoardRequest<'_>, test: &Test) -> Outcome<()> {
    let name = &test.name;
    if !test.file.controller.is_compensation() {
        let message = format!("{name} tests `{}`, which no board runs", test.file.controller.word());
        return Err(Failure::new(message).with_help("run it with --host"));
    }
    if request.role == Role::Loop {
        if test.file.controller == ControllerName::Probe {
            let message = format!("{name} tests `probe`, which the role `loop` does not know");
            return Err(Failure::new(message).with_help("run it with --role observer, or with --host"));
        }
        let seed = test.file.seeds.first().copied().unwrap_or(1);
        if let Some(effect) = test.case(seed)?.truth.surroundings.effects().next() {
            let message =
                format!("{name} asks for `{}`, which the virtual joint of a board does not have", effect.key());
            let help = "run it with --role observer --plant reference, or with --host --plant reference";
            return Err(Failure::new(message).with_help(help));
        }
        quantised(&test.file.faults, 1.0, [1; 2], 0).map_err(|failure| failure.while_doing(name))?;
    }
    Ok(())
}
