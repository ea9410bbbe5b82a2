//! Other clock sources than the board's own: every common rate, by crystal and by signal, no source, and a source that
//! fails in a run. The tick must have the rate stated in the hello, or the hello must report the deviation.

use std::collections::BTreeMap;

use link::messages::{ClockSource, Hello};

use super::outputs::{is_enabled, start_run};
use super::{boot, clean};
use crate::boards::{Subject, usual_surroundings};
use crate::talk::Talk;
use crate::wires::{MICROSECOND, SECOND, Surroundings, Time};

/// Common rates of crystals and clock signals [Hz].
const RATES: [u64; 6] = [8_000_000, 12_000_000, 16_000_000, 24_000_000, 25_000_000, 26_000_000];
/// Largest frequency error of the internal oscillator at room temperature, from the data sheets of all chips
/// [thousandths].
const INTERNAL_OFF: i64 = 10;
/// Longest time from the loss of the clock until the outputs are off: the watchdog's half second and its tolerance.
const OUTPUTS_OFF: Time = SECOND * 6 / 10;

/// Dead external source: the internal oscillator takes over, and the hello reports it.
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

/// Crystals and clock signals of other boards with the chip: none may drive a clock out of its range or break the line,
/// and the hello must be right about the tick.
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

/// Source of the board's own kind, at another rate.
fn of_usual_kind(subject: &Subject, rate: u64) -> Surroundings {
    match usual_surroundings(&subject.board).crystal {
        Some(_) => Surroundings::crystal(rate),
        None => Surroundings::clock(rate),
    }
}

/// The board answers, and its statement about the tick is true.
fn truthful(talk: &mut Talk<'_>) -> Result<Hello, String> {
    let hello = talk.call(SECOND / 2);
    clean(&talk.board.borrow())?;
    let hello = hello.ok_or("no answer")?;
    if hello.clock.source != ClockSource::Failed {
        boot::ticks(talk, hello.tick_rate)?;
    }
    Ok(hello)
}

/// The external source fails in a run: the outputs go off, and the next hello names another source.
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
