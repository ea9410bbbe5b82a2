//! The host's requests about the memory of what was learnt, between runs: save it, read what is saved, load one, write that
//! one, erase. The flash page is the board's; the role checks a memory in its tick.

use heapless::Vec;
use link::messages::{FromBoard, MEMORY_PARTS, MemoryOutcome, MemoryPart, MemoryRequest, MemoryState, PART_BYTES};

use crate::page::{self, Learnt, Page};
use crate::queues::Order;
use crate::shared::{Consumer, Producer};

/// The immediate reaction to a request.
#[derive(Debug, Clone, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "no allocator to box with")]
pub enum Reaction {
    /// The tick is to be given this order.
    Order(Order),
    /// This is the answer.
    Say(FromBoard),
    /// More parts are to come, or the flash page has work to do.
    Wait,
}

/// Work for the flash page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PageTask {
    Tell(u8),
    Write,
    Erase,
}

/// Outcome of work with the flash page.
pub struct PageOutcome {
    /// The answer to the host.
    pub answer: FromBoard,
    /// Validity of the saved memory, if that has changed.
    pub remembered: Option<MemoryState>,
}

/// Memories on their way between flash page, tick and host.
pub struct MemoryRequests<'a, L> {
    learnt: Consumer<'a, L>,
    remembered: Producer<'a, L>,
    /// The memory that the host loads, part by part.
    received: Option<L>,
    next_part: u8,
    /// The role has found it valid.
    is_good: bool,
    task: Option<PageTask>,
}

impl<'a, L: Learnt> MemoryRequests<'a, L> {
    /// Nothing is under way.
    pub fn new(learnt: Consumer<'a, L>, remembered: Producer<'a, L>) -> Self {
        Self { learnt, remembered, received: L::EMPTY, next_part: 0, is_good: false, task: None }
    }

    /// The flash page has work to do before another frame is read.
    pub fn is_busy(&self) -> bool {
        self.task.is_some() || self.learnt.ready()
    }

    /// Begins a request.
    pub fn begin(&mut self, request: MemoryRequest, running: bool) -> Reaction {
        let task = match request {
            // The tick itself says whether a run goes on, and whether anything is learnt.
            MemoryRequest::Save => return Reaction::Order(Order::SaveMemory),
            _ if self.received.is_none() => return Reaction::Say(FromBoard::MemoryOutcome(MemoryOutcome::Nothing)),
            _ if running => return Reaction::Say(FromBoard::MemoryOutcome(MemoryOutcome::Running)),
            MemoryRequest::Erase => return Reaction::Order(Order::DiscardMemory),
            MemoryRequest::Load(part) => return self.take(&part),
            MemoryRequest::Write if !self.is_good => {
                return Reaction::Say(FromBoard::MemoryOutcome(MemoryOutcome::Nothing));
            }
            MemoryRequest::Write => PageTask::Write,
            MemoryRequest::Read { part } => PageTask::Tell(part),
        };
        self.task = Some(task);
        Reaction::Wait
    }

    fn take(&mut self, part: &MemoryPart) -> Reaction {
        if part.part == 0 {
            (self.next_part, self.is_good) = (0, false);
        }
        let index = usize::from(part.part);
        let place = self.received.as_mut().and_then(|received| {
            let (places, _) = received.memory_mut().as_chunks_mut::<PART_BYTES>();
            places.get_mut(index)
        });
        let (Some(place), true, PART_BYTES) = (place, part.part == self.next_part, part.bytes.len()) else {
            return Reaction::Say(FromBoard::MemoryChecked(MemoryState::NotAMemory));
        };
        place.copy_from_slice(&part.bytes);
        self.next_part += 1;
        if self.next_part < MEMORY_PARTS {
            return Reaction::Wait;
        }
        self.next_part = 0;
        if let Some(received) = &self.received {
            // The tick has taken the one before.
            let _ = self.remembered.enqueue(received.clone());
        }
        Reaction::Order(Order::LoadMemory)
    }

    /// The role has checked what was received.
    pub fn checked(&mut self, state: MemoryState) {
        self.is_good = state == MemoryState::Good;
    }

    /// The role has discarded its memory; the page is to be erased next.
    pub fn discarded(&mut self) {
        self.task = Some(PageTask::Erase);
    }

    /// Does the page's work, if there is any; `writing` wraps what may take a second or two.
    pub fn serve(
        &mut self,
        page: &mut impl Page,
        writing: impl FnOnce(&mut dyn FnMut() -> bool) -> bool,
    ) -> Option<PageOutcome> {
        if let Some(learnt) = self.learnt.dequeue() {
            return Some(PageOutcome::written(writing(&mut || page::keep(page, learnt.memory()))));
        }
        match self.task.take()? {
            PageTask::Tell(part) => {
                let memory = page.read();
                let (parts, _) = memory.as_chunks::<PART_BYTES>();
                let bytes = parts.get(usize::from(part)).map(|bytes| bytes.iter().copied().collect());
                let bytes: Vec<u8, PART_BYTES> = bytes.unwrap_or_default();
                Some(PageOutcome { answer: FromBoard::Memory(MemoryPart { part, bytes }), remembered: None })
            }
            PageTask::Write => {
                let received = self.received.as_ref()?;
                Some(PageOutcome::written(writing(&mut || page::keep(page, received.memory()))))
            }
            PageTask::Erase => {
                let erased = writing(&mut || page::erase(page));
                Some(PageOutcome { remembered: erased.then_some(MemoryState::Nothing), ..PageOutcome::written(erased) })
            }
        }
    }
}

impl PageOutcome {
    fn written(stored: bool) -> Self {
        Self {
            answer: FromBoard::MemoryOutcome(if stored { MemoryOutcome::Stored } else { MemoryOutcome::NotWritten }),
            remembered: stored.then_some(MemoryState::Good),
        }
    }
}
