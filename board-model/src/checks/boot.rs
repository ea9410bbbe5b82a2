//! Boot: from reset to the first answer.

use super::clean;
use crate::boards::Subject;
use crate::scs::SYSTICK;
use crate::talk::Talk;
use crate::wires::{MICROSECOND, SECOND, Time};

/// Ticks are counted over this part of a second.
const COUNTED: u32 = 10;

/// Checks that the tick has its rate, and that no interrupt has its priority or a higher one.
pub fn ticks(talk: &mut Talk<'_>, rate: u32) -> Result<(), String> {
    let count = |talk: &Talk<'_>| talk.board.borrow().machine().scs.taken(SYSTICK);
    let before = count(talk);
    talk.hear(SECOND / Time::from(COUNTED));
    let ticks = count(talk) - before;
    if ticks.abs_diff(rate / COUNTED) > 1 {
        return Err(format!("{ticks} ticks in a tenth of a second, not {}", rate / COUNTED));
    }
    match talk.board.borrow().machine().scs.is_above_all(SYSTICK) {
        true => Ok(()),
        false => Err("an interrupt that is on can hold the tick up: its priority is not below the tick's".into()),
    }
}

/// The board boots, ticks at its rate and states its identity.
pub fn answers(subject: &Subject) -> Result<String, String> {
    let mut talk = Talk::new(subject.start()?);
    let hello = talk.call(2 * SECOND);
    clean(&talk.board.borrow())?;
    let hello = hello.ok_or_else(|| format!("no answer; it was at {}", talk.board.borrow().whereabouts()))?;
    let board = talk.board.borrow();
    let core = board.machine().wires.clocks.core;
    if hello.board != subject.board.name()
        || core != u64::from(subject.board.core_rate())
        || hello.clock.source.is_external() != subject.board.description.clock.frequency().is_some()
    {
        return Err(format!("{} at {core} Hz from {:?} is not {}", hello.board, hello.clock, subject.board.name()));
    }
    let milliseconds = board.now() / (1000 * MICROSECOND);
    drop(board);
    ticks(&mut talk, hello.tick_rate)?;
    Ok(format!("{core} Hz, answered {milliseconds} ms after power came on"))
}
