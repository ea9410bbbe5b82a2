//! Which boards tests are to run on, in which role, and what no board can do. Building and reaching them is left to the
//! parent.

use link::messages::{Role, RunMode};

use crate::failure::{Failure, Outcome};
use crate::target::board::Board;
use crate::trial::plant::PlantName;
use crate::trial::suite::Test;

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

/// Whether a test can run on such a board at all.
pub fn may_run(wish: &BoardWish<'_>, test: &Test, plant: PlantName) -> Outcome<()> {
    let name = &test.name;
    if !test.file.controller.is_ours() {
        let message = format!("{name} tests `{}`, which no board runs", test.file.controller.word());
        return Err(Failure::new(message).with_help("run it with --host"));
    }
    if wish.role == Role::Loop && !test.file.faults.is_empty() {
        return Err(Failure::new(format!("{name} has faults, and a whole loop on a board has none between its parts"))
            .with_help("run it with --role observer, or with --host"));
    }
    if wish.role == Role::Loop && plant == PlantName::Reference {
        return Err(Failure::new("the f64 reference does not run on a board").with_help("leave --plant out"));
    }
    Ok(())
}
