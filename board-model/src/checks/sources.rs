//! Other clock sources than the one that the board is sold with: every usual rate, by crystal and by clock, none at all, and
//! one that dies in a run. Either the tick has the rate that the hello says, or the hello says that it has not.

use std::collections::BTreeMap;

use link::messages::{ClockSource, Hello};

use super::outputs::{is_enabled, start_run};
use super::{boot, clean};
use crate::boards::{Subject, usual_surroundings};
use crate::talk::Talk;
use crate::wires::{MICROSECOND, SECOND, Surroundings, Time};

/// What crystals and clocks of boards with these chips have [Hz].
const RATES: [u64; 6] = [8_000_000, 12_000_000, 16_000_000, 24_000_000, 25_000_000, 26_000_000];
/// How far the internal oscillator is off at room temperature, by the data sheets of all chips [thousandths].
const INTERNAL_OFF: i64 = 10;
/// Without its clock a board has this long until its outputs are off: the watchdog's half second and its spread.
const OUTPUTS_OFF: Time = SECOND * 6 / 10;

/// The external source is dead: the internal oscillator takes over, and the hello says so.
pub fn dead_crystal(subject: &Subject) -> Result<String, String> {
    let mut talk = Talk::new(subject.start_with(Surroundings::default())?);
    let hello = talk.call(4 * SECOND);
    clean(&talk.board.borrow())?;
    let hello = hello.ok_or("no answer")?;
    let core = talk.board.borrow().machine().wires.clocks.core;
    if hello.clock.source != ClockSource::DidNotStart || core != u64::from(subject.board.core_rate()) {
        return Err(format!("{core} Hz from {:?}", hello.clock));
    }
    boot::ticks(&mut talk, hello.tick_rate)?;
    Ok(format!("{core} Hz from the internal oscillator"))
}

/// Crystals and clocks that other boards with the chip have: none may take a clock out of its range, or the line away, and the
/// hello tells the truth about the tick.
pub fn other_crystals(subject: &Subject) -> Result<String, String> {
    let (mut said, mut wrong) = (BTreeMap::new(), Vec::new());
    for rate in RATES {
        let off = |internal_off| Surroundings { internal_off, ..of_usual_kind(subject, rate) };
        for (kind, source) in [
            ("crystal", Surroundings::crystal(rate)),
            ("clock", Surroundings::clock(rate)),
            ("source by an internal oscillator that is too fast,", off(INTERNAL_OFF)),
            ("source by an internal oscillator that is too slow,", off(-INTERNAL_OFF)),
        ] {
            let mut talk = Talk::new(subject.start_with(source)?);
            match truthful(&mut talk) {
                Ok(hello) => *said.entry(format!("{:?}", hello.clock)).or_insert(0) += 1,
                Err(why) => wrong.push(format!("a {kind} of {rate} Hz: {why}")),
            }
        }
    }
    let said: Vec<String> = said.iter().map(|(clock, times)| format!("{times} times {clock}")).collect();
    if wrong.is_empty() { Ok(said.join(", ")) } else { Err(wrong.join("\n")) }
}

/// A source of the kind that the board is sold with.
fn of_usual_kind(subject: &Subject, rate: u64) -> Surroundings {
    match usual_surroundings(&subject.board).crystal {
        Some(_) => Surroundings::crystal(rate),
        None => Surroundings::clock(rate),
    }
}

/// The board answers, and what it says about its tick is so.
fn truthful(talk: &mut Talk<'_>) -> Result<Hello, String> {
    let hello = talk.call(SECOND / 2);
    clean(&talk.board.borrow())?;
    let hello = hello.ok_or("no answer")?;
    if hello.clock.source != ClockSource::Failed {
        boot::ticks(talk, hello.tick_rate)?;
    }
    Ok(hello)
}

/// The external source dies in a run: the outputs go off, and the next hello names another source.
pub fn dies_in_a_run(subject: &Subject) -> Result<String, String> {
    let mut talk = start_run(subject)?;
    let start = talk.board.borrow().now();
    talk.board.borrow_mut().machine_mut().wires.surroundings.dies_at = Some(start + MICROSECOND);
    while is_enabled(&talk, subject) && talk.board.borrow().now() < start + OUTPUTS_OFF {
        talk.hear(100 * MICROSECOND);
    }
    let off = talk.board.borrow().now() - start;
    if is_enabled(&talk, subject) {
        return Err(format!("the enable output is on {} ms after the clock is gone", off / (1000 * MICROSECOND)));
    }
    talk.hear(SECOND / 2);
    let hello = truthful(&mut talk)?;
    match hello.clock.source {
        source if source.is_external() => Err("the hello names the source that is dead".into()),
        clock if subject.board.description.enable.is_none() => Ok(format!("then {clock:?}")),
        clock => Ok(format!("off after {:.1} ms, then {clock:?}", off as f64 / (1000 * MICROSECOND) as f64)),
    }
}
