//! What was learnt, kept in flash: saved, read, found again after a reset, loaded, written, erased. And with a cut of power at
//! every single operation of flash: the board must boot, and have the old memory or the new one.

use link::messages::{FromBoard, MEMORY_PARTS, MemoryOutcome, MemoryPart, MemoryRequest, MemoryState, ToBoard};

use model_core::numbers::digest;

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
    let other = another(&saved);
    for part in &other {
        talk.say(&ToBoard::Memory(MemoryRequest::Load(part.clone())));
    }
    let checked = talk.wait(PATIENCE, |message| match message {
        FromBoard::MemoryChecked(state) => Some(state),
        _ => None,
    });
    if checked != Some(MemoryState::Good) {
        return Err(format!("a good memory is not taken: {checked:?}"));
    }
    request(&mut talk, MemoryRequest::Write, "written")?;
    if read(&mut talk)? != other {
        return Err("what is read is not what was written".into());
    }
    clean(&talk.board.borrow())?;
    let operations = talk.board.borrow().machine().wires.flash_operations;
    Ok(format!("{operations} erases and programs"))
}

/// What is under way when power goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Work {
    /// The first memory of a board is saved.
    First,
    /// Another memory is written over one.
    Over,
    /// A memory is erased.
    Erase,
}

/// Cuts power at every operation of a first save, of a write over another memory, and of an erase.
pub fn survives_cuts(subject: &Subject) -> Result<String, String> {
    let mut tried = 0;
    for work in [Work::First, Work::Over, Work::Erase] {
        for cut in 1.. {
            let failed = |why: String| format!("{work:?} cut at operation {cut}: {why}");
            match survives(subject, work, cut).map_err(failed)? {
                true => tried += 1,
                false => break,
            }
        }
    }
    Ok(format!("{tried} cuts"))
}

/// Cuts power at an operation; `false` if the work has fewer.
fn survives(subject: &Subject, work: Work, cut: u32) -> Result<bool, String> {
    let mut talk = Talk::new(subject.start()?);
    expect_state(&mut talk, MemoryState::Nothing, "of a new board")?;
    let (mut old, mut new) = (None, None);
    if work != Work::First {
        request(&mut talk, MemoryRequest::Save, "saved")?;
        old = Some(read(&mut talk)?);
    }
    if let (Work::Over, Some(old)) = (work, &old) {
        let other = another(old);
        other.iter().for_each(|part| talk.say(&ToBoard::Memory(MemoryRequest::Load(part.clone()))));
        talk.hear(SECOND / 2);
        new = Some(other);
    }
    let (operations, resets) = {
        let mut board = talk.board.borrow_mut();
        let machine = board.machine_mut();
        let operations = machine.wires.flash_operations + cut;
        machine.wires.cut_after = Some(operations);
        (operations, machine.resets.len())
    };
    let asked = match work {
        Work::First => MemoryRequest::Save,
        Work::Over => MemoryRequest::Write,
        Work::Erase => MemoryRequest::Erase,
    };
    let is_cut = |talk: &Talk<'_>| talk.board.borrow().machine().wires.flash_operations >= operations;
    talk.say(&ToBoard::Memory(asked));
    let end = talk.board.borrow().now() + PATIENCE;
    while !is_cut(&talk) && talk.board.borrow().now() < end {
        if talk.hear(SECOND / 1000).into_iter().any(|message| outcome(message).is_some()) {
            break;
        }
    }
    if !is_cut(&talk) {
        return Ok(false);
    }
    talk.board.borrow_mut().machine_mut().wires.cut_after = None;
    let hello = talk.call(SECOND / 2).ok_or_else(|| stuck(&talk))?;
    if talk.board.borrow().machine().resets.len() != resets + 1 {
        return Err("the board has reset itself since".into());
    }
    let left = match hello.memory {
        MemoryState::Nothing => None,
        MemoryState::Good => Some(read(&mut talk)?),
        state => return Err(format!("the memory is {state:?}")),
    };
    // A first save is whole or not there; what `new` is of it, nobody has seen before.
    let whole = left == old || left == new || work == Work::First;
    whole.then_some(true).ok_or_else(|| "neither the old memory nor the new one is left".into())
}

/// Another memory, that is as good: the place of the encoders' zeros is one further, and the digest is that of it.
fn another(parts: &[MemoryPart]) -> Vec<MemoryPart> {
    let mut bytes: Vec<u8> = parts.iter().flat_map(|part| part.bytes.iter().copied()).collect();
    let end = bytes.len() - 8;
    bytes[16] = bytes[16].wrapping_add(1);
    let sum = bytes[..end].iter().fold(digest::START, |running, byte| digest::chain(running, (*byte).into()));
    bytes[end..].copy_from_slice(&sum.to_le_bytes());
    let chunks = bytes.chunks(bytes.len() / parts.len());
    chunks.zip(0..).map(|(bytes, part)| MemoryPart { part, bytes: bytes.iter().copied().collect() }).collect()
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
