//! The observer's memory on a board (estimated parameters kept between runs): read from flash, loaded into the
//! controller, written and erased. Its content is passed on as bytes.

use std::time::Duration;

use link::messages::{
    FromBoard, MEMORY_PARTS, MemoryOutcome, MemoryPart, MemoryRequest, MemoryState, PART_BYTES, RunSettings, ToBoard,
};
use model_core::observer::{MEMORY_BYTES, Memory};

use super::{ANSWER_TIMEOUT, Session};
use report::failure::{Failure, Outcome};

/// Longest wait for a flash operation: a large sector takes up to four seconds to erase, and the board is silent
/// meanwhile.
const FLASH_WRITE_TIMEOUT: Duration = Duration::from_secs(10);

impl Session<'_> {
    /// Reads the memory stored in the board's flash.
    pub fn stored_memory(&mut self) -> Outcome<Memory> {
        let mut memory = [0; MEMORY_BYTES];
        for (part, place) in (0..MEMORY_PARTS).zip(memory.as_chunks_mut::<PART_BYTES>().0) {
            let sent = self.request_memory(MemoryRequest::Read { part }, ANSWER_TIMEOUT, |message| match message {
                FromBoard::Memory(sent) if sent.part == part && sent.bytes.len() == PART_BYTES => Some(sent.bytes),
                _ => None,
            })?;
            place.copy_from_slice(&sent);
        }
        Ok(memory)
    }

    /// Loads a memory for the following runs; returns the controller's verdict on it.
    pub fn load_memory(&mut self, memory: &Memory) -> Outcome<MemoryState> {
        let mut parts = (0..MEMORY_PARTS)
            .zip(memory.as_chunks::<PART_BYTES>().0)
            .map(|(part, bytes)| MemoryRequest::Load(MemoryPart { part, bytes: bytes.iter().copied().collect() }));
        let last = parts.next_back();
        for part in parts {
            self.send(&ToBoard::Memory(part))?;
        }
        let last = last.ok_or_else(|| Failure::new("a memory has no part"))?;
        self.request_memory(last, ANSWER_TIMEOUT, |message| {
            if let FromBoard::MemoryChecked(judged) = message { Some(judged) } else { None }
        })
    }

    /// Writes the loaded memory to the board's flash.
    pub fn write_memory(&mut self) -> Outcome<MemoryOutcome> {
        self.write(MemoryRequest::Write)
    }

    /// Writes the estimated parameters to the board's flash.
    pub fn save_memory(&mut self) -> Outcome<MemoryOutcome> {
        self.write(MemoryRequest::Save)
    }

    /// Ends a run, saves its estimated parameters, and starts a run from them. A board without flash slots keeps them
    /// until power is off.
    pub fn restart_from_memory(&mut self) -> Outcome<()> {
        let settings = self.recording.settings.ok_or_else(|| Failure::new("nothing has run yet"))?;
        self.send(&ToBoard::Stop)?;
        self.drain()?;
        self.save_memory()?;
        self.reset(RunSettings { from_memory: true, ..settings })
    }

    /// Erases the estimated parameters, in flash too.
    pub fn erase_memory(&mut self) -> Outcome<MemoryOutcome> {
        self.write(MemoryRequest::Erase)
    }

    fn write(&mut self, request: MemoryRequest) -> Outcome<MemoryOutcome> {
        self.request(&ToBoard::Memory(request), "answer about the memory", FLASH_WRITE_TIMEOUT, memory_outcome)
            .and_then(unless_running)
    }

    /// Sends a request that does not write flash.
    fn request_memory<T>(
        &mut self,
        request: MemoryRequest,
        timeout: Duration,
        answer: impl Fn(FromBoard) -> Option<T>,
    ) -> Outcome<T> {
        let answered =
            self.request(&ToBoard::Memory(request), "answer about the memory", timeout, |message| match message {
                FromBoard::MemoryOutcome(why) => Some(Err(why)),
                other => answer(other).map(Ok),
            })?;
        answered.or_else(|why| {
            unless_running(why)?;
            Err(Failure::new("the board's role has no observer").with_help("flash an image of role observer or loop"))
        })
    }
}

fn memory_outcome(message: FromBoard) -> Option<MemoryOutcome> {
    if let FromBoard::MemoryOutcome(outcome) = message { Some(outcome) } else { None }
}

fn unless_running(outcome: MemoryOutcome) -> Outcome<MemoryOutcome> {
    match outcome {
        MemoryOutcome::Running => {
            Err(Failure::new("the board is running, and its memory can be accessed between runs only")
                .with_help("end the run first, or reset the board"))
        }
        outcome => Ok(outcome),
    }
}
