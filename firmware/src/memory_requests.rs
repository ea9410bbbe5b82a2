//! The host's requests about the memory of what was learnt, between runs: save it, read what is saved, load one, write that
//! one, erase. Flash is the board's; the role checks a memory in its tick.

use heapless::Vec;
use link::messages::{FromBoard, MEMORY_PARTS, MemoryOutcome, MemoryPart, MemoryRequest, MemoryState, PART_BYTES};

use crate::kept_memory::{KeptMemory, NOTHING, Slots};
use crate::learnt::Learnt;
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
    /// More parts are to come, or flash has work to do.
    Wait,
}

/// Work for flash.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FlashTask {
    Tell(u8),
    Write,
    Erase,
}

/// Outcome of work with flash.
pub struct FlashOutcome {
    /// The answer to the host.
    pub answer: FromBoard,
    /// Validity of the saved memory, if that has changed.
    pub remembered: Option<MemoryState>,
}

/// Memories on their way between flash, tick and host.
pub struct MemoryRequests<'a, L> {
    learnt: Consumer<'a, L>,
    remembered: Producer<'a, L>,
    /// The memory that the host loads, part by part.
    received: Option<L>,
    next_part: u8,
    /// The role has found it valid.
    is_good: bool,
    task: Option<FlashTask>,
}

impl<'a, L: Learnt> MemoryRequests<'a, L> {
    /// Nothing is under way.
    pub fn new(learnt: Consumer<'a, L>, remembered: Producer<'a, L>) -> Self {
        Self { learnt, remembered, received: L::EMPTY, next_part: 0, is_good: false, task: None }
    }

    /// Flash has work to do before another frame is read.
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
            // The tick has taken the one before.
            let _ = self.remembered.enqueue(received.clone());
        }
        Reaction::Order(Order::LoadMemory)
    }

    /// The role has checked what was received.
    pub fn checked(&mut self, state: MemoryState) {
        self.is_good = state == MemoryState::Good;
    }

    /// The role has discarded its memory; flash is to forget it next.
    pub fn discarded(&mut self) {
        self.task = Some(FlashTask::Erase);
    }

    /// Does the work with flash, if there is any; `writing` wraps what may take a second or two.
    pub fn serve(
        &mut self,
        kept: &mut KeptMemory<impl Slots>,
        writing: impl FnOnce(&mut dyn FnMut() -> MemoryOutcome) -> MemoryOutcome,
    ) -> Option<FlashOutcome> {
        if let Some(learnt) = self.learnt.dequeue() {
            return Some(FlashOutcome::written(writing(&mut || kept.keep(learnt.memory()))));
        }
        match self.task.take()? {
            FlashTask::Tell(part) => {
                let memory = kept.recall().unwrap_or(NOTHING);
                let (parts, _) = memory.as_chunks::<PART_BYTES>();
                let bytes = parts.get(usize::from(part)).map(|bytes| bytes.iter().copied().collect());
                let bytes: Vec<u8, PART_BYTES> = bytes.unwrap_or_default();
                Some(FlashOutcome { answer: FromBoard::Memory(MemoryPart { part, bytes }), remembered: None })
            }
            FlashTask::Write => {
                let received = self.received.as_ref()?;
                Some(FlashOutcome::written(writing(&mut || kept.keep(received.memory()))))
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
