//! Choice of boards and role for tests, and the tests that no board can run.

use link::messages::{Role, RunMode};

use super::faults::quantised_faults;
use crate::controller::ControllerName;
use crate::plant::PlantName;
use crate::suite::Test;
use board::device::board::Board;
use report::failure::{Failure, Outcome};

/// Boards for the tests.
#[derive(Debug, Clone, Copy)]
pub struct BoardRequest<'w> {
    /// Role of the board.
    pub role: Role,
    /// Port of a real board.
    pub port: Option<&'w str>,
    /// Baud rate.
    pub baud: Option<u32>,
    /// Board behind the port.
    pub board: &'w Board,
    /// Uses the image that is already on the board.
    pub no_build: bool,
    /// Builds and runs an image even if the worst-case tick exceeds the period.
    pub force: bool,
    /// Pacing of a whole loop: lockstep or real time.
    pub mode: Option<RunMode>,
}

/// Rejects a request that no board can meet.
pub fn check_request(request: &BoardRequest<'_>, plant: PlantName) -> Outcome<()> {
    if request.role == Role::Loop && plant == PlantName::Reference {
        return Err(Failure::new("the f64 reference does not run on a board").with_help("leave --plant out"));
    }
    Ok(())
}

/// Rejects a test that the board cannot run.
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
        quantised_faults(&test.file.faults, 1.0, [1; 2], 0).map_err(|failure| failure.while_doing(name))?;
    }
    Ok(())
}
