//! Requests of the host about the memory (estimated parameters) between runs: save, read, load, write, erase. The board
//! provides the flash; the role checks a memory in its tick.

use heapless::Vec;
use link::messages::{FromBoard, MEMORY_PARTS, MemoryOutcome, MemoryPart, MemoryRequest, MemoryState, PART_BYTES};

use crate::kept_memory::{KeptMemory, NOTHING, Slots};
use crate::learnt::Learnt;
use crate::queues::Order;
use crate::shared::{Consumer, Producer};

/// Immediate reaction to a request.
#[derive(Debug, Clone, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "no allocator to box with")]
pub enum Reaction {
    /// Give the tick this order.
    Order(Order),
    /// Send this answer.
    Say(FromBoard),
    /// Wait for further parts or for flash.
    Wait,
}

/// Work for flash.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FlashTask {
    Tell(u8),
    Write,
    Erase,
}

/// Outcome of flash work.
pub struct FlashOutcome {
    /// The answer to the host.
    pub answer: FromBoard,
    /// New validity of the saved memory, if it has changed.
    pub remembered: Option<MemoryState>,
}

/// Memories in transit between flash, tick and host.
pub struct MemoryRequests<'a, L> {
    learnt: Consumer<'a, L>,
    remembered: Producer<'a, L>,
    /// Memory that the host loads, part by part.
    received: Option<L>,
    next_part: u8,
    /// The role has found the received memory valid.
    is_good: bool,
    task: Option<FlashTask>,
}

impl<'a, L: Learnt> MemoryRequests<'a, L> {
    /// State without a pending request.
    pub fn new(learnt: Consumer<'a, L>, remembered: Producer<'a, L>) -> Self {
        Self { learnt, remembered, received: L::EMPTY, next_part: 0, is_good: false, task: None }
    }

    /// Returns `true` if flash work is pending; no frame is read until it is done.
    pub fn is_busy(&self) -> bool {
        self.task.is_some() || self.learnt.ready()
    }

    /// Begins a request.
    pub fn begin(&mut self, request: MemoryRequest, running: bool) -> Reaction {
        let task = match request {
            // The tick itself checks for a run and for estimated parameters.
            MemoryRequest::Save => return Reaction::Order(Order::SaveMemory),
            _ if self.received.is_none() => return Reaction::Say(FromBoard::MemoryOutcome(MemoryOutcome::Nothing)),
            _ if running => return Reaction::Say(FromBoard::MemoryOutcome(MemoryOutcome::Running)),
            MemoryRequest::Erase => return Reaction::Order(Order::DiscardMemory),
            MemoryRequest::Load(part) => return self.take(&part),
            MemoryRequest::Write if !self.is_good => {
                return Reaction::Say(FromBoard::MemoryOutcome(MemoryOutcome::Nothing));
            }
            MemoryRequest::Write => FlashTask::Write,
            MemoryRequest::Read { part } => FlashTask::Tell(part),
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
            // The queue is free: the tick has taken the memory before.
            let _ = self.remembered.enqueue(received.clone());
        }
        Reaction::Order(Order::LoadMemory)
    }

    /// Notes the role's verdict on the received memory.
    pub fn checked(&mut self, state: MemoryState) {
        self.is_good = state == MemoryState::Good;
    }

    /// Schedules the erase of flash after the role has discarded its memory.
    pub fn discarded(&mut self) {
        self.task = Some(FlashTask::Erase);
    }

    /// Does the pending flash work, if there is any; `writing` wraps a write, which may take two seconds.
    pub fn serve(
        &mut self,
        kept: &mut KeptMemory<impl Slots>,
        writing: impl FnOnce(&mut dyn FnMut() -> MemoryOutcome) -> MemoryOutcome,
    ) -> Option<FlashOutcome> {
        if let Some(learnt) = self.learnt.dequeue() {
            return Some(FlashOutcome::written(writing(&mut || kept.store(learnt.memory()))));
        }
        match self.task.take()? {
            FlashTask::Tell(part) => {
                let memory = kept.load().unwrap_or(NOTHING);
                let (parts, _) = memory.as_chunks::<PART_BYTES>();
                let bytes = parts.get(usize::from(part)).map(|bytes| bytes.iter().copied().collect());
                let bytes: Vec<u8, PART_BYTES> = bytes.unwrap_or_default();
                Some(FlashOutcome { answer: FromBoard::Memory(MemoryPart { part, bytes }), remembered: None })
            }
            FlashTask::Write => {
                let received = self.received.as_ref()?;
                Some(FlashOutcome::written(writing(&mut || kept.store(received.memory()))))
            }
            FlashTask::Erase => {
                let erased = FlashOutcome::written(writing(&mut || kept.erase()));
                Some(FlashOutcome { remembered: erased.remembered.map(|_| MemoryState::Nothing), ..erased })
            }
        }
    }
}

impl FlashOutcome {
    fn written(outcome: MemoryOutcome) -> Self {
        let remembered = (outcome == MemoryOutcome::Stored).then_some(MemoryState::Good);
        Self { answer: FromBoard::MemoryOutcome(outcome), remembered }
    }
}
