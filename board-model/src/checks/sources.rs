//! Other clock sources than the one that the board is sold with.

use link::messages::Clock;

use super::clean;
use crate::boards::{self, Subject};
use crate::talk::Talk;
use crate::wires::{SECOND, Surroundings};

/// The external source is dead: the internal oscillator takes over, and the hello says so.
pub fn dead_crystal(subject: &Subject) -> Result<String, String> {
    let nothing = Surroundings { crystal: None, external_clock: None };
    let mut talk = Talk::new(subject.start_with(nothing)?);
    let hello = talk.call(4 * SECOND);
    clean(&talk.board.borrow())?;
    let hello = hello.ok_or("no answer")?;
    let core = talk.board.borrow().machine().wires.clocks.core;
    if hello.clock != Clock::InternalFallback || core != u64::from(subject.kind.core_rate()) {
        return Err(format!("{core} Hz from {:?}", hello.clock));
    }
    Ok(format!("{core} Hz from the internal oscillator"))
}

/// Crystals that other boards with the chip have: none may take a clock out of its range.
pub fn other_crystals(subject: &Subject) -> Result<String, String> {
    let rates = [8_000_000, 12_000_000, 16_000_000, 24_000_000, 25_000_000];
    let mut wrong = Vec::new();
    for rate in rates {
        let source = match boards::usual_surroundings(subject.kind).crystal {
            Some(_) => Surroundings { crystal: Some(rate), external_clock: None },
            None => Surroundings { crystal: None, external_clock: Some(rate) },
        };
        let mut talk = Talk::new(subject.start_with(source)?);
        let hello = talk.call(SECOND);
        if let Err(why) = clean(&talk.board.borrow()) {
            wrong.push(format!("{rate} Hz:\n{why}"));
        } else if hello.is_none() {
            wrong.push(format!("{rate} Hz: no answer"));
        }
    }
    if wrong.is_empty() { Ok(format!("{} crystals", rates.len())) } else { Err(wrong.join("\n")) }
}
