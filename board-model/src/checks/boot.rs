//! From reset to the first answer.

use board::target::board::Board as Kind;
use link::messages::Clock;

use super::clean;
use crate::boards;
use crate::image::Image;
use crate::talk::Talk;
use crate::wires::{MICROSECOND, SECOND};

/// The board boots, ticks at its rate and says who it is.
pub fn answers(kind: Kind, image: &Image) -> Result<String, String> {
    let mut talk = Talk::new(boards::start(kind, image.clone())?);
    let hello = talk.call(2 * SECOND);
    clean(&talk.board.borrow())?;
    let hello = hello.ok_or_else(|| format!("no answer; it was at {}", talk.board.borrow().whereabouts()))?;
    let board = talk.board.borrow();
    let core = board.machine().wires.clocks.core;
    if hello.board != kind.name() || core != u64::from(kind.core_rate()) || hello.clock != Clock::External {
        return Err(format!("{} at {core} Hz from {:?} is not {}", hello.board, hello.clock, kind.name()));
    }
    let milliseconds = board.now() / (1000 * MICROSECOND);
    Ok(format!("{core} Hz, answered {milliseconds} ms after power came on"))
}
