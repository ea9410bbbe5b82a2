//! Which boards tests are to run on, in which role, and what no board can do.

use link::messages::{Role, RunMode};

use super::faults::quantised;
use crate::controller::ControllerName;
use crate::plant::PlantName;
use crate::suite::Test;
use board::target::board::Board;
use report::failure::{Failure, Outcome};

/// Which boards tests are to run on.
#[derive(Debug, Clone, Copy)]
pub struct BoardWish<'w> {
    /// What they do.
    pub role: Role,
    /// The port of a real one.
    pub port: Option<&'w str>,
    /// Its speed [baud].
    pub baud: Option<u32>,
    /// What is behind it.
    pub board: Board,
    /// Its image is there already.
    pub no_build: bool,
    /// Who waits for whom, of a whole loop.
    pub mode: Option<RunMode>,
}

/// Whether the wish itself can be met.
pub fn can_be(wish: &BoardWish<'_>, plant: PlantName) -> Outcome<()> {
    if wish.role == Role::Loop && plant == PlantName::Reference {
        return Err(Failure::new("the f64 reference does not run on a board").with_help("leave --plant out"));
    }
    Ok(())
}

/// Whether a test can run on such a board at all.
pub fn may_run(wish: &BoardWish<'_>, test: &Test) -> Outcome<()> {
    let name = &test.name;
    if !test.file.controller.is_ours() {
        let message = format!("{name} tests `{}`, which no board runs", test.file.controller.word());
        return Err(Failure::new(message).with_help("run it with --host"));
    }
    if wish.role == Role::Loop {
        if test.file.controller == ControllerName::Probe {
            let message = format!("{name} tests `probe`, which the role `loop` does not know");
            return Err(Failure::new(message).with_help("run it with --role observer, or with --host"));
        }
        quantised(&test.file.faults, 1.0, [0; 2], 0).map_err(|failure| failure.while_doing(name))?;
    }
    Ok(())
}
