//! The host's wishes about what was learnt, between runs: keep it, tell what is kept, take what it brings, write that, erase.
//! The page itself is a board's, what a memory is worth the role judges in its tick.

use heapless::Vec;
use heapless::spsc::{Consumer, Producer};
use link::messages::{FromBoard, MEMORY_PARTS, MemoryOutcome, MemoryPart, MemoryRequest, MemoryState, PART_BYTES};

use crate::page::{self, Learnt, Page};
use crate::queues::Order;

/// What a wish comes to at once.
#[derive(Debug, Clone, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "no allocator to box with")]
pub enum Step {
    /// The tick is to be asked.
    Order(Order),
    /// This is the answer.
    Say(FromBoard),
    /// There is more to come, or the page has to be asked.
    Wait,
}

/// What is to be done with the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Errand {
    Tell(u8),
    Write,
    Erase,
}

/// What the page came to.
pub struct Served {
    /// To be said.
    pub answer: FromBoard,
    /// What is kept from now on, if that has changed.
    pub remembered: Option<MemoryState>,
}

/// Memories under way between page, tick and host.
pub struct Keeping<'a, L> {
    learnt: Consumer<'a, L>,
    remembered: Producer<'a, L>,
    /// What the host brings, part by part.
    brought: Option<L>,
    next_part: u8,
    /// The role has found it good.
    is_good: bool,
    errand: Option<Errand>,
}

impl<'a, L: Learnt> Keeping<'a, L> {
    /// Nothing is under way.
    pub fn new(learnt: Consumer<'a, L>, remembered: Producer<'a, L>) -> Self {
        Self { learnt, remembered, brought: L::EMPTY, next_part: 0, is_good: false, errand: None }
    }

    /// The page has to be asked before more is listened to.
    pub fn is_busy(&self) -> bool {
        self.errand.is_some() || self.learnt.ready()
    }

    /// Begins what a wish asks for.
    pub fn begin(&mut self, wish: MemoryRequest, running: bool) -> Step {
        let errand = match wish {
            // The tick itself says whether a run goes on, and whether anything is learnt.
            MemoryRequest::Save => return Step::Order(Order::Keep),
            _ if self.brought.is_none() => return Step::Say(FromBoard::MemoryOutcome(MemoryOutcome::Nothing)),
            _ if running => return Step::Say(FromBoard::MemoryOutcome(MemoryOutcome::Running)),
            MemoryRequest::Erase => return Step::Order(Order::Forget),
            MemoryRequest::Load(part) => return self.take(&part),
            MemoryRequest::Write if !self.is_good => {
                return Step::Say(FromBoard::MemoryOutcome(MemoryOutcome::Nothing));
            }
            MemoryRequest::Write => Errand::Write,
            MemoryRequest::Read { part } => Errand::Tell(part),
        };
        self.errand = Some(errand);
        Step::Wait
    }

    fn take(&mut self, part: &MemoryPart) -> Step {
        if part.part == 0 {
            (self.next_part, self.is_good) = (0, false);
        }
        let index = usize::from(part.part);
        let place = self.brought.as_mut().and_then(|brought| {
            let (places, _) = brought.memory_mut().as_chunks_mut::<PART_BYTES>();
            places.get_mut(index)
        });
        let (Some(place), true, PART_BYTES) = (place, part.part == self.next_part, part.bytes.len()) else {
            return Step::Say(FromBoard::MemoryChecked(MemoryState::NotAMemory));
        };
        place.copy_from_slice(&part.bytes);
        self.next_part += 1;
        if self.next_part < MEMORY_PARTS {
            return Step::Wait;
        }
        self.next_part = 0;
        if let Some(brought) = &self.brought {
            // The tick has taken the one before.
            let _ = self.remembered.enqueue(brought.clone());
        }
        Step::Order(Order::Remember)
    }

    /// The role has judged what was brought.
    pub fn judged(&mut self, judgement: MemoryState) {
        self.is_good = judgement == MemoryState::Good;
    }

    /// The role has forgotten; so shall the page.
    pub fn forgotten(&mut self) {
        self.errand = Some(Errand::Erase);
    }

    /// Has the page do what is to be done, if anything is; `writing` wraps what may take a second or two.
    pub fn serve(
        &mut self,
        page: &mut impl Page,
        writing: impl FnOnce(&mut dyn FnMut() -> bool) -> bool,
    ) -> Option<Served> {
        if let Some(learnt) = self.learnt.dequeue() {
            return Some(Served::written(writing(&mut || page::keep(page, learnt.memory()))));
        }
        match self.errand.take()? {
            Errand::Tell(part) => {
                let memory = page.read();
                let (parts, _) = memory.as_chunks::<PART_BYTES>();
                let bytes = parts.get(usize::from(part)).map(|bytes| bytes.iter().copied().collect());
                let bytes: Vec<u8, PART_BYTES> = bytes.unwrap_or_default();
                Some(Served { answer: FromBoard::Memory(MemoryPart { part, bytes }), remembered: None })
            }
            Errand::Write => {
                let brought = self.brought.as_ref()?;
                Some(Served::written(writing(&mut || page::keep(page, brought.memory()))))
            }
            Errand::Erase => {
                let erased = writing(&mut || page::erase(page));
                Some(Served { remembered: erased.then_some(MemoryState::Nothing), ..Served::written(erased) })
            }
        }
    }
}

impl Served {
    fn written(stored: bool) -> Self {
        Self {
            answer: FromBoard::MemoryOutcome(if stored { MemoryOutcome::Stored } else { MemoryOutcome::NotWritten }),
            remembered: stored.then_some(MemoryState::Good),
        }
    }
}
