//! Pins: exactly those that the board's file names are set up, in particular none that it forbids.

use std::collections::BTreeSet;

use board_file::Level;

use super::clean;
use super::outputs::start_run;
use crate::boards::{Subject, pin};
use crate::wires::{MICROSECOND, Mode, Pin, Time};

/// Duration of the run.
const RUN: Time = 20_000 * MICROSECOND;

/// Boots and runs: no forbidden pin is ever set up, and of the others exactly those that the file names.
pub fn only_those_of_the_file(subject: &Subject) -> Result<String, String> {
    let mut talk = start_run(subject)?;
    talk.hear(RUN);
    clean(&talk.board.borrow())?;
    let board = &subject.board.description;
    let set_up = talk.board.borrow().machine().wires.set_up.clone();
    let mode = |pin| talk.board.borrow().machine().wires.mode(pin);
    let without_use = board.unused_line_pins();
    let forbidden = board.never_driven.iter().map(|(left, why)| (*left, why.as_str()));
    let forbidden: Vec<_> = forbidden.chain(without_use.iter().map(|(key, left)| (*left, *key))).collect();
    let driven: Vec<_> = forbidden
        .iter()
        .filter(|(left, _)| set_up.contains(&pin(*left)))
        .map(|(left, why)| format!("{} ({why}), now {:?}", named(pin(*left)), mode(pin(*left))))
        .collect();
    if !driven.is_empty() {
        return Err(format!("pins that the board's file forbids were set up: {}", driven.join(", ")));
    }
    let lines = [board.serial.send, board.serial.receive];
    let lines = lines.map(|line| (pin(line.pin), Mode::Alternate(line.function.into())));
    let outputs: Vec<_> =
        board.supply.iter().chain(&board.enable).chain(&board.light).map(|output| pin(output.pin)).collect();
    let wanted: BTreeSet<_> = lines.iter().map(|(pin, _)| *pin).chain(outputs.iter().copied()).collect();
    if set_up != wanted {
        return Err(format!("{} are set up, and the file names {}", list(&set_up), list(&wanted)));
    }
    if let Some((pin, function)) = lines.into_iter().find(|(pin, function)| mode(*pin) != *function) {
        return Err(format!("{} is {:?}, not {function:?}", named(pin), mode(pin)));
    }
    if let Some(pin) = outputs.into_iter().find(|pin| !matches!(mode(*pin), Mode::Output(_))) {
        return Err(format!("{} is {:?}, not an output", named(pin), mode(pin)));
    }
    if let Some(supply) = board.supply {
        let (pin, held) = (pin(supply.pin), Mode::Output(supply.on == Level::High));
        if mode(pin) != held {
            return Err(format!("{} is {:?} and lets the supply go", named(pin), mode(pin)));
        }
    }
    Ok(format!("{} are set up, {} left alone", list(&wanted), forbidden.len()))
}

fn named(Pin(port, number): Pin) -> String {
    format!("P{port}{number}")
}

fn list(pins: &BTreeSet<Pin>) -> String {
    pins.iter().map(|pin| named(*pin)).collect::<Vec<_>>().join(", ")
}
