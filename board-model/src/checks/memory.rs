//! Estimated parameters in flash: saved, read, found after a reset, loaded, written, erased. With a power cut before
//! and within every operation of flash, the board must boot, hold the old memory or the new one, and accept another.

use link::messages::{FromBoard, MEMORY_PARTS, MemoryOutcome, MemoryPart, MemoryRequest, MemoryState, ToBoard};

use model_core::numbers::digest;

use super::clean;
use crate::boards::Subject;
use crate::cpu::Board;
use crate::talk::Talk;
use crate::wires::{Cut, HowFar, Operation, Reset, SECOND, Time};

/// Longest wait for an answer: erasing a sector of 128 KiB takes up to two seconds before it.
const PATIENCE: Time = 6 * SECOND;

/// The memory can be saved, found after a reset, loaded, written and erased.
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
    load(&mut talk, &other)?;
    request(&mut talk, MemoryRequest::Write, "written")?;
    if read(&mut talk)? != other {
        return Err("what is read is not what was written".into());
    }
    clean(&talk.board.borrow())?;
    let operations = talk.board.borrow().machine().wires.flash_operations.len();
    Ok(format!("{operations} erases and programs"))
}

/// A G474 with single-bank flash keeps the saved memory, or reports that it does not.
pub fn one_bank(subject: &Subject) -> Result<String, String> {
    let board = subject.start()?;
    let mut talk = Talk::new(board);
    talk.board.borrow_mut().machine_mut().wires.single_bank = true;
    expect_state(&mut talk, MemoryState::Nothing, "of a new board")?;
    let told = talk.ask(&ToBoard::Memory(MemoryRequest::Save), PATIENCE, outcome);
    clean(&talk.board.borrow())?;
    restart(&mut talk, Reset::Power);
    let (expected, found) = match told {
        Some(MemoryOutcome::Stored) => (MemoryState::Good, "kept"),
        Some(MemoryOutcome::NotWritten) => (MemoryState::Nothing, "not kept, and that is said"),
        other => return Err(format!("the memory is not saved: {other:?}; {}", stuck(&talk))),
    };
    expect_state(&mut talk, expected, "after a save")?;
    clean(&talk.board.borrow())?;
    Ok(found.into())
}

/// Flash work that a power cut interrupts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Work {
    /// Write of a memory, after a number of others.
    Write(usize),
    /// Erase, after a number of writes.
    Erase(usize),
}

/// All different cases: two memories may lie beside each other, so the third one overwrites one of them, and an erase
/// clears two.
const WORKS: [Work; 5] = [Work::Write(0), Work::Write(1), Work::Write(2), Work::Erase(1), Work::Erase(2)];
/// Limit of reported failures per work.
const TOLD: usize = 2;

/// Memories and flash operations of a work.
#[derive(Debug, Clone)]
struct Course {
    work: Work,
    memories: Vec<Vec<MemoryPart>>,
    operations: Vec<Operation>,
}

impl Course {
    fn held(&self) -> Option<&Vec<MemoryPart>> {
        match self.work {
            Work::Write(before) => before.checked_sub(1).map(|last| &self.memories[last]),
            Work::Erase(before) => self.memories.get(before - 1),
        }
    }

    fn wanted(&self) -> Option<&Vec<MemoryPart>> {
        match self.work {
            Work::Write(before) => self.memories.get(before),
            Work::Erase(_) => None,
        }
    }

    /// Starts a board that holds the earlier memories, and requests the work.
    fn begin<'a>(&self, subject: &Subject, cut: Option<Cut>) -> Result<Talk<'a>, String> {
        let mut talk = Talk::new(subject.start()?);
        expect_state(&mut talk, MemoryState::Nothing, "of a new board")?;
        let (Work::Write(before) | Work::Erase(before)) = self.work;
        for memory in &self.memories[..before] {
            load(&mut talk, memory)?;
            request(&mut talk, MemoryRequest::Write, "written")?;
        }
        let asked = match self.work {
            Work::Write(before) => {
                load(&mut talk, &self.memories[before])?;
                MemoryRequest::Write
            }
            Work::Erase(_) => MemoryRequest::Erase,
        };
        {
            let mut board = talk.board.borrow_mut();
            let wires = &mut board.machine_mut().wires;
            let done = wires.flash_operations.len();
            wires.cut = cut.map(|cut| Cut { operation: done + cut.operation, ..cut });
        }
        talk.say(&ToBoard::Memory(asked));
        Ok(talk)
    }
}

/// Power is cut before and within every operation of every work.
pub fn survives_cuts(subject: &Subject) -> Result<String, String> {
    survive(subject, |_, _| true)
}

/// Power is cut at the first, a middle and the last program of each work, and at all erases.
pub fn survives_some_cuts(subject: &Subject) -> Result<String, String> {
    survive(subject, |operations, number| {
        let programs = |range: &[Operation]| range.iter().filter(|other| **other == Operation::Program).count();
        let (before, all) = (programs(&operations[..number]), programs(operations));
        operations[number] == Operation::Erase || [0, all / 2, all - 1].contains(&before)
    })
}

fn survive(subject: &Subject, is_tried: impl Fn(&[Operation], usize) -> bool) -> Result<String, String> {
    let memories = memories(subject)?;
    let (mut tried, mut told) = (0, Vec::new());
    for work in WORKS {
        let mut course = Course { work, memories: memories.clone(), operations: Vec::new() };
        course.operations = operations(subject, &course).map_err(|why| format!("{work:?}: {why}"))?;
        let numbers = (0..course.operations.len()).filter(|number| is_tried(&course.operations, *number));
        let cuts = numbers.flat_map(|operation| {
            HowFar::of(course.operations[operation]).iter().map(move |how_far| Cut { operation, how_far: *how_far })
        });
        let failed = cuts.filter_map(|cut| {
            tried += 1;
            let why = survives(subject, &course, cut).err()?;
            let operation = course.operations[cut.operation];
            Some(format!("{work:?}, cut {:?} {operation:?} {}: {why}", cut.how_far, cut.operation))
        });
        told.extend(failed.take(TOLD));
    }
    if told.is_empty() { Ok(format!("{tried} cuts")) } else { Err(told.join("\n")) }
}

/// Memory saved by a new board, and other valid ones.
fn memories(subject: &Subject) -> Result<Vec<Vec<MemoryPart>>, String> {
    let mut talk = Talk::new(subject.start()?);
    expect_state(&mut talk, MemoryState::Nothing, "of a new board")?;
    request(&mut talk, MemoryRequest::Save, "saved")?;
    let first = read(&mut talk)?;
    Ok(std::iter::successors(Some(first), |parts| Some(another(parts))).take(4).collect())
}

/// Flash operations of a work without a cut.
fn operations(subject: &Subject, course: &Course) -> Result<Vec<Operation>, String> {
    let mut talk = course.begin(subject, None)?;
    let before = talk.board.borrow().machine().wires.flash_operations.len();
    match talk.wait(PATIENCE, outcome) {
        Some(MemoryOutcome::Stored) => {}
        other => return Err(format!("is not done: {other:?}; {}", stuck(&talk))),
    }
    clean(&talk.board.borrow())?;
    Ok(talk.board.borrow().machine().wires.flash_operations[before..].to_vec())
}

/// Cuts power once; the board must then boot, hold the old memory or the new one, and accept another.
fn survives(subject: &Subject, course: &Course, cut: Cut) -> Result<(), String> {
    let mut talk = course.begin(subject, Some(cut))?;
    let resets = talk.board.borrow().machine().resets.len();
    let end = talk.board.borrow().now() + PATIENCE;
    let is_cut = |talk: &Talk<'_>| talk.board.borrow().machine().resets.len() > resets;
    while !is_cut(&talk) && talk.board.borrow().now() < end {
        talk.hear(SECOND / 1000);
    }
    if !is_cut(&talk) {
        return Err("power was not cut".into());
    }
    let mut hello = None;
    while hello.is_none() && talk.board.borrow().now() < end {
        hello = talk.call(SECOND / 10);
        if talk.board.borrow().machine().resets.len() != resets + 1 {
            return Err(format!("the board has reset itself since; {}", stuck(&talk)));
        }
    }
    let hello = hello.ok_or_else(|| stuck(&talk))?;
    let left = match hello.memory {
        // An interrupted memory counts as no memory, however it is reported.
        MemoryState::Nothing | MemoryState::NotAMemory | MemoryState::Damaged => None,
        MemoryState::Good => Some(read(&mut talk)?),
        state => return Err(format!("the memory is {state:?}")),
    };
    if left.as_ref() != course.held() && left.as_ref() != course.wanted() {
        let found = left.and_then(|left| course.memories.iter().position(|memory| *memory == left));
        return Err(format!(
            "neither the old memory nor the new one is left, but {found:?}, and the hello says {:?}",
            hello.memory
        ));
    }
    let other = course.memories.last().ok_or("no other memory")?;
    load(&mut talk, other)?;
    request(&mut talk, MemoryRequest::Write, "written after the cut")?;
    restart(&mut talk, Reset::Power);
    expect_state(&mut talk, MemoryState::Good, "after it was written anew")?;
    if read(&mut talk)? != *other {
        return Err("what is read is not what was written after the cut".into());
    }
    request(&mut talk, MemoryRequest::Erase, "erased after the cut")?;
    restart(&mut talk, Reset::Power);
    expect_state(&mut talk, MemoryState::Nothing, "after it was erased")?;
    clean(&talk.board.borrow())
}

/// Loads a memory into the board, which must report it as good.
fn load(talk: &mut Talk<'_>, memory: &[MemoryPart]) -> Result<(), String> {
    for part in memory {
        talk.say(&ToBoard::Memory(MemoryRequest::Load(part.clone())));
    }
    let checked = talk.wait(PATIENCE, |message| match message {
        FromBoard::MemoryChecked(state) => Some(state),
        _ => None,
    });
    match checked {
        Some(MemoryState::Good) => Ok(()),
        other => Err(format!("a good memory is not taken: {other:?}")),
    }
}

/// Another valid memory: one bit pattern of the encoders' zeros differs, and the digest is updated.
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

/// Requests flash work, and expects success.
pub fn request(talk: &mut Talk<'_>, request: MemoryRequest, done: &str) -> Result<(), String> {
    match talk.ask(&ToBoard::Memory(request), PATIENCE, outcome) {
        Some(MemoryOutcome::Stored) => Ok(()),
        other => {
            clean(&talk.board.borrow())?;
            Err(format!("the memory is not {done}: {other:?}; {}", stuck(talk)))
        }
    }
}

/// Reads all parts of the stored memory.
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

/// Resets the board from outside.
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
