//! Motor-enable output and the events that switch it off: silence of the host, a fault, the watchdog.

use board_file::Level;
use link::messages::{Command, FromBoard, RunMode, RunSettings, Schedule, ToBoard, Trip};

use super::memory::restart;
use super::{boot, clean};
use crate::boards::{Subject, pin};
use crate::talk::Talk;
use crate::wires::{MICROSECOND, Mode, Pin, Reset, SECOND, Time};

/// Ticks without a host message before the safe state.
const TIMEOUT: u32 = 2000;
const TICK: Time = SECOND / 20_000;
/// Time for which a debugger holds the core.
const HELD: Time = 2 * SECOND;

/// Pin of the motor-enable output, and true if high is on.
fn enable(subject: &Subject) -> Result<(Pin, bool), String> {
    let output = subject.board.description.enable.ok_or("the board has no enable output")?;
    Ok((pin(output.pin), output.on == Level::High))
}

fn level(talk: &Talk<'_>, subject: &Subject) -> Option<Mode> {
    let (pin, _) = enable(subject).ok()?;
    Some(talk.board.borrow().machine().wires.mode(pin))
}

/// Returns whether the pin is an output in the on or off state.
fn is_switched(talk: &Talk<'_>, subject: &Subject, on: bool) -> bool {
    enable(subject).is_ok_and(|(_, high)| level(talk, subject) == Some(Mode::Output(on == high)))
}

/// Returns whether the output is on.
pub fn is_enabled(talk: &Talk<'_>, subject: &Subject) -> bool {
    is_switched(talk, subject, true)
}

/// Starts a run in real time whose last command holds for long, and checks the enable output if there is one.
pub fn start_run<'a>(subject: &Subject) -> Result<Talk<'a>, String> {
    let mut talk = Talk::new(subject.start()?);
    talk.call(2 * SECOND).ok_or("no answer")?;
    let has_output = subject.board.description.enable.is_some();
    if has_output && !is_switched(&talk, subject, false) {
        return Err(format!("the enable output is {:?} before any run", level(&talk, subject)));
    }
    let settings =
        RunSettings { mode: RunMode::Realtime, decimation: 1000, command_timeout: TIMEOUT, from_memory: false };
    talk.start_run(settings)?;
    let commands = [Command { tick: 0, drive_torque: 0.1, load_torque: 0.0 }].into_iter().collect();
    talk.say(&ToBoard::Schedule(Schedule { sequence: 0, horizon: 10 * TIMEOUT, commands }));
    talk.hear(5000 * MICROSECOND);
    if has_output && !is_enabled(&talk, subject) {
        return Err(format!("the enable output is {:?} in a run", level(&talk, subject)));
    }
    Ok(talk)
}

/// Silence of the host: enable goes off within the timeout, and the board reports a trip, with or without that output.
pub fn silence(subject: &Subject) -> Result<String, String> {
    let mut talk = start_run(subject)?;
    let start = talk.board.borrow().now();
    let (mut gone, mut trip) = (None, None);
    while trip.is_none() && talk.board.borrow().now() < start + 3 * Time::from(TIMEOUT) * TICK {
        for message in talk.hear(TICK) {
            if let FromBoard::Tripped(why) = message {
                trip = Some(why);
            }
        }
        let is_off = if subject.board.description.enable.is_some() {
            is_switched(&talk, subject, false)
        } else {
            trip.is_some()
        };
        if gone.is_none() && is_off {
            gone = Some(talk.board.borrow().now() - start);
        }
    }
    clean(&talk.board.borrow())?;
    match (gone, trip) {
        (Some(gone), Some(Trip::CommandLoss { .. })) if gone <= (Time::from(TIMEOUT) + 2) * TICK => {
            Ok(format!("off {} ms after the last word", gone / (1000 * MICROSECOND)))
        }
        other => Err(format!("enable went after {:?} fs by {:?}", other.0, other.1)),
    }
}

/// The ticks stop: the watchdog resets in time, the output is off, and the next hello reports the watchdog.
pub fn watchdog(subject: &Subject) -> Result<String, String> {
    let mut talk = start_run(subject)?;
    let start = talk.board.borrow().now();
    let resets = talk.board.borrow().machine().resets.len();
    {
        // Control register of SysTick, written from outside.
        let mut board = talk.board.borrow_mut();
        board.machine_mut().write(0xe000_e010, 4, 0);
    }
    while talk.board.borrow().machine().resets.len() == resets && talk.board.borrow().now() < start + SECOND {
        talk.hear(1000 * MICROSECOND);
    }
    let Some((Reset::Watchdog, at)) = talk.board.borrow().machine().resets.get(resets).copied() else {
        return Err("no reset by the watchdog within a second".into());
    };
    if is_enabled(&talk, subject) {
        return Err("the enable output is still on after the reset".into());
    }
    let hello = talk.call(2 * SECOND).ok_or("no answer after the reset")?;
    clean(&talk.board.borrow())?;
    if !hello.watchdog_reset {
        return Err("the hello does not say that the watchdog has reset the board".into());
    }
    restart(&mut talk, Reset::Software);
    let hello = talk.call(2 * SECOND).ok_or("no answer after a second reset")?;
    if hello.watchdog_reset {
        return Err("the watchdog is blamed for a reset that the software asked for".into());
    }
    let late = at.saturating_sub(start);
    match late {
        late if late < SECOND * 6 / 10 => Ok(format!("reset after {} ms", late / (1000 * MICROSECOND))),
        late => Err(format!("the watchdog took {} ms", late / (1000 * MICROSECOND))),
    }
}

/// A debugger holds the core for longer than the watchdog's period and lets it continue: nothing is reset, and the tick
/// continues.
pub fn held_by_debugger(subject: &Subject) -> Result<String, String> {
    let mut talk = Talk::new(subject.start()?);
    talk.call(2 * SECOND).ok_or("no answer")?;
    let resets = talk.board.borrow().machine().resets.len();
    talk.board.borrow_mut().hold_for(HELD);
    let hello = talk.call(2 * SECOND).ok_or("no answer after that")?;
    clean(&talk.board.borrow())?;
    if talk.board.borrow().machine().resets.len() > resets {
        return Err("the watchdog resets the board whose core a debugger holds".into());
    }
    boot::ticks(&mut talk, hello.tick_rate)?;
    Ok(format!("held for {} s", HELD / SECOND))
}

/// Bus fault in a run: a reset, the output off, and a message in the next hello.
pub fn fault(subject: &Subject) -> Result<String, String> {
    let mut talk = start_run(subject)?;
    let resets = talk.board.borrow().machine().resets.len();
    {
        let mut board = talk.board.borrow_mut();
        board.machine_mut().wires.bus_fault = Some(0);
        board.machine_mut().attention = true;
    }
    let start = talk.board.borrow().now();
    while talk.board.borrow().machine().resets.len() == resets && talk.board.borrow().now() < start + SECOND {
        talk.hear(100 * MICROSECOND);
    }
    let reset = talk.board.borrow().machine().resets.get(resets).copied();
    if !matches!(reset, Some((Reset::Software, _))) || is_enabled(&talk, subject) {
        return Err(format!("after a fault: reset {reset:?}, enable {:?}", level(&talk, subject)));
    }
    let hello = talk.call(2 * SECOND).ok_or("no answer after a fault")?;
    clean(&talk.board.borrow())?;
    hello.last_panic.map(|message| format!("`{message}`")).ok_or_else(|| "the fault has left no message".into())
}
