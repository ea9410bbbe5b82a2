//! What was learnt, kept in flash: saved, read, found again after a reset, loaded, written, erased. And with a cut of power at
//! every single operation of flash: the board must boot, and have the old memory or the new one.

use link::messages::{FromBoard, MEMORY_PARTS, MemoryOutcome, MemoryPart, MemoryRequest, MemoryState, ToBoard};

use super::clean;
use crate::boards::Subject;
use crate::cpu::Board;
use crate::talk::Talk;
use crate::wires::{Reset, SECOND, Time};

/// Erasing a sector of 128 KiB takes up to two seconds, and the answer comes after that.
const PATIENCE: Time = 6 * SECOND;

/// Saves, finds, loads, writes, erases.
pub fn keeps(subject: &Subject) -> Result<String, String> {
    let mut talk = Talk::new(subject.start()?);
    expect_state(&mut talk, MemoryState::Nothing, "of a new board")?;
    request(&mut talk, MemoryRequest::Save, "saved")?;
    let saved = read(&mut talk)?;
    restart(&mut talk, Reset::Power);
    expect_state(&mut talk, MemoryState::Good, "after it was saved and power was gone")?;
    if read(&mut talk)? != saved {
        return Err("what is read after a restart is not what was saved".into());
    }
    request(&mut talk, MemoryRequest::Erase, "erased")?;
    restart(&mut talk, Reset::Power);
    expect_state(&mut talk, MemoryState::Nothing, "after it was erased")?;
    for part in &saved {
        talk.say(&ToBoard::Memory(MemoryRequest::Load(part.clone())));
    }
    let checked = talk.wait(PATIENCE, |message| match message {
        FromBoard::MemoryChecked(state) => Some(state),
        _ => None,
    });
    if checked != Some(MemoryState::Good) {
        return Err(format!("a memory that was saved is not taken back: {checked:?}"));
    }
    request(&mut talk, MemoryRequest::Write, "written")?;
    if read(&mut talk)? != saved {
        return Err("what is read is not what was written".into());
    }
    clean(&talk.board.borrow())?;
    let operations = talk.board.borrow().machine().wires.flash_operations;
    Ok(format!("{operations} erases and programs"))
}

/// Cuts power at every operation of a save and of an erase.
pub fn survives_cuts(subject: &Subject) -> Result<String, String> {
    let mut tried = 0;
    for (what, wanted) in [("a save", MemoryRequest::Save), ("an erase", MemoryRequest::Erase)] {
        for cut in 1.. {
            let mut talk = Talk::new(subject.start()?);
            let name = |what| format!("{what} cut at operation {cut}");
            expect_state(&mut talk, MemoryState::Nothing, "of a new board")?;
            request(&mut talk, MemoryRequest::Save, "saved")?;
            let old = read(&mut talk)?;
            restart(&mut talk, Reset::Power);
            expect_state(&mut talk, MemoryState::Good, "after it was saved")?;
            if wanted == MemoryRequest::Save {
                // Another memory than the one that is there: the board must not save itself the work.
                request(&mut talk, MemoryRequest::Erase, "erased")?;
            }
            let operations = {
                let mut board = talk.board.borrow_mut();
                let wires = &mut board.machine_mut().wires;
                wires.cut_after = Some(wires.flash_operations + cut);
                wires.flash_operations + cut
            };
            let resets = talk.board.borrow().machine().resets.len();
            let _ = talk.ask(&ToBoard::Memory(wanted.clone()), PATIENCE, outcome);
            if talk.board.borrow().machine().wires.flash_operations < operations {
                break;
            }
            tried += 1;
            talk.board.borrow_mut().machine_mut().wires.cut_after = None;
            let hello = talk.call(2 * SECOND).ok_or_else(|| format!("{}: {}", name(what), stuck(&talk)))?;
            if talk.board.borrow().machine().resets.len() != resets + 1 {
                return Err(format!("{}: it has been reset again since", name(what)));
            }
            let whole = match hello.memory {
                MemoryState::Good => read(&mut talk)? == old,
                state => state == MemoryState::Nothing,
            };
            if !whole {
                return Err(format!("{}: {:?} is left", name(what), hello.memory));
            }
        }
    }
    Ok(format!("{tried} cuts"))
}

fn stuck(talk: &Talk<'_>) -> String {
    let board = talk.board.borrow();
    let resets = board.machine().resets.len();
    let halted = board.machine().halted.clone().unwrap_or_default();
    format!("no answer after that, {resets} resets; it was at {} {halted}", board.whereabouts())
}

fn outcome(message: FromBoard) -> Option<MemoryOutcome> {
    match message {
        FromBoard::MemoryOutcome(outcome) => Some(outcome),
        _ => None,
    }
}

/// Asks for work with the page, and expects it done.
pub fn request(talk: &mut Talk<'_>, request: MemoryRequest, done: &str) -> Result<(), String> {
    match talk.ask(&ToBoard::Memory(request), PATIENCE, outcome) {
        Some(MemoryOutcome::Stored) => Ok(()),
        other => {
            clean(&talk.board.borrow())?;
            Err(format!("the memory is not {done}: {other:?}; {}", stuck(talk)))
        }
    }
}

/// All parts of what is kept.
fn read(talk: &mut Talk<'_>) -> Result<Vec<MemoryPart>, String> {
    let mut parts = Vec::new();
    for part in 0..MEMORY_PARTS {
        let told = talk.ask(&ToBoard::Memory(MemoryRequest::Read { part }), SECOND, |message| match message {
            FromBoard::Memory(told) if told.part == part => Some(told),
            _ => None,
        });
        parts.push(told.ok_or_else(|| format!("part {part} of the memory is not read; {}", stuck(talk)))?);
    }
    Ok(parts)
}

/// A reset from outside.
pub fn restart(talk: &mut Talk<'_>, reset: Reset) {
    let mut board: std::cell::RefMut<'_, Board<'_>> = talk.board.borrow_mut();
    board.machine_mut().wires.reset = Some(reset);
    board.machine_mut().attention = true;
}

fn expect_state(talk: &mut Talk<'_>, wanted: MemoryState, when: &str) -> Result<(), String> {
    match talk.call(2 * SECOND) {
        Some(hello) if hello.memory == wanted => Ok(()),
        Some(hello) => Err(format!("the memory is {:?} {when}, not {wanted:?}", hello.memory)),
        None => {
            clean(&talk.board.borrow())?;
            Err(format!("no answer {when}; {}", stuck(talk)))
        }
    }
}
