//! Replacement of `firmware/src/shared.rs`: the same atomics and queues on top of loom.
//!
//! Constructors are `const` there and not in loom, so each atomic is created at its first access: models access all of them before their
//! threads begin.
//!
//! The queue stands for heapless's, with its two indices and their orderings: each side reads its own index freely, reads the other's with
//! Acquire where it adds or removes an entry and with Relaxed where it only checks, and writes its own with Release. The other side's index
//! is read again only when its last known value is used up, the latest point at which heapless reads it. The storage of the entries in
//! heapless is not modelled: here they are behind a lock, each with a mark set before the entry is published. A thread that sees an entry
//! without its mark could see half an entry.

use std::cell::{Cell, OnceCell};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use loom::sync::atomic::Ordering::{self, Acquire, Relaxed, Release};
use loom::sync::atomic::{self, AtomicUsize};

pub use loom::sync::atomic::fence;

/// Atomic number. Loom explores two orders where a store meets the last access of an atomic, so a thread that reads before it stores hides
/// the reads of others. Every read is therefore preceded by an access to `turn`, all orders of which are explored.
#[derive(Debug, Default)]
pub struct AtomicU32 {
    first: u32,
    cell: OnceLock<(atomic::AtomicU32, atomic::AtomicU32)>,
}

impl AtomicU32 {
    /// Atomic with its initial value.
    pub const fn new(first: u32) -> Self {
        Self { first, cell: OnceLock::new() }
    }

    fn cell(&self) -> &(atomic::AtomicU32, atomic::AtomicU32) {
        self.cell.get_or_init(|| (atomic::AtomicU32::new(self.first), atomic::AtomicU32::new(0)))
    }

    /// Reads the number.
    pub fn load(&self, ordering: Ordering) -> u32 {
        let (number, turn) = self.cell();
        turn.fetch_add(0, Relaxed);
        number.load(ordering)
    }

    /// Stores a number.
    pub fn store(&self, number: u32, ordering: Ordering) {
        self.cell().0.store(number, ordering);
    }
}

/// Atomic flag that its writer never reads.
#[derive(Debug, Default)]
pub struct AtomicBool {
    first: bool,
    cell: OnceLock<atomic::AtomicBool>,
}

impl AtomicBool {
    /// Atomic with its initial value.
    pub const fn new(first: bool) -> Self {
        Self { first, cell: OnceLock::new() }
    }

    fn cell(&self) -> &atomic::AtomicBool {
        self.cell.get_or_init(|| atomic::AtomicBool::new(self.first))
    }

    /// Reads the flag.
    pub fn load(&self, ordering: Ordering) -> bool {
        self.cell().load(ordering)
    }

    /// Stores the flag.
    pub fn store(&self, flag: bool, ordering: Ordering) {
        self.cell().store(flag, ordering);
    }
}

/// Entry and its mark; a byte has no mark, since it cannot be seen in part.
type Entry<T> = (T, Option<Arc<atomic::AtomicBool>>);

/// Numbers of removed and added entries, which do not wrap.
#[derive(Default)]
struct Indices {
    removed: AtomicUsize,
    added: AtomicUsize,
}

/// State shared by both sides.
struct Ring<T> {
    places: usize,
    indices: OnceLock<Indices>,
    entries: Mutex<VecDeque<Entry<T>>>,
}

impl<T> Ring<T> {
    fn indices(&self) -> &Indices {
        self.indices.get_or_init(Indices::default)
    }

    fn entries<R>(&self, visit: impl FnOnce(&mut VecDeque<Entry<T>>) -> R) -> R {
        visit(&mut self.entries.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Queue for one producer and one consumer.
pub struct Queue<T, const PLACES: usize>(Ring<T>);

impl<T, const PLACES: usize> Queue<T, PLACES> {
    /// Empty queue.
    pub const fn new() -> Self {
        let entries = Mutex::new(VecDeque::new());
        Self(Ring { places: PLACES, indices: OnceLock::new(), entries })
    }

    /// Returns both ends.
    pub fn split(&mut self) -> (Producer<'_, T>, Consumer<'_, T>) {
        let ring = &self.0;
        let (removed, added) = (ring.indices().removed.load(Relaxed), ring.indices().added.load(Relaxed));
        (Producer { ring, added, removed }, Consumer { ring, removed, added: Cell::new(added), front: OnceCell::new() })
    }
}

impl<T, const PLACES: usize> Default for Queue<T, PLACES> {
    fn default() -> Self {
        Self::new()
    }
}

/// End for adding entries.
pub struct Producer<'a, T> {
    ring: &'a Ring<T>,
    added: usize,
    /// Number of removed entries, as last seen.
    removed: usize,
}

impl<T> Producer<'_, T> {
    /// Capacity [entries].
    pub fn capacity(&self) -> usize {
        self.ring.places - 1
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.added - self.ring.indices().removed.load(Relaxed)
    }

    /// Returns true if the queue is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns true if there is room for an entry.
    pub fn ready(&self) -> bool {
        self.len() < self.capacity()
    }

    /// Adds an entry, or returns it if the queue is full.
    pub fn enqueue(&mut self, entry: T) -> Result<(), T> {
        if self.added - self.removed == self.capacity() {
            self.removed = self.ring.indices().removed.load(Acquire);
        }
        if self.added - self.removed == self.capacity() {
            return Err(entry);
        }
        let mark = (size_of::<T>() > 1).then(|| {
            let mark = Arc::new(atomic::AtomicBool::new(false));
            mark.store(true, Relaxed);
            mark
        });
        self.ring.entries(|entries| entries.push_back((entry, mark)));
        self.added += 1;
        self.ring.indices().added.store(self.added, Release);
        Ok(())
    }
}

/// End for removing entries.
pub struct Consumer<'a, T> {
    ring: &'a Ring<T>,
    removed: usize,
    /// Number of added entries, as last seen.
    added: Cell<usize>,
    /// First entry, if it was peeked at.
    front: OnceCell<Entry<T>>,
}

impl<T> Consumer<'_, T> {
    /// Capacity [entries].
    pub fn capacity(&self) -> usize {
        self.ring.places - 1
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.ring.indices().added.load(Relaxed) - self.removed
    }

    /// Returns true if the queue is empty.
    pub fn is_empty(&self) -> bool {
        !self.ready()
    }

    /// Returns true if there is an entry.
    pub fn ready(&self) -> bool {
        self.ring.indices().added.load(Relaxed) > self.removed
    }

    /// First entry, not removed.
    pub fn peek(&self) -> Option<&T> {
        self.ready().then(|| self.front())
    }

    fn front(&self) -> &T {
        let (entry, mark) =
            self.front.get_or_init(|| self.ring.entries(VecDeque::pop_front).expect("what was counted is there"));
        assert!(mark.as_ref().is_none_or(|mark| mark.load(Relaxed)), "an entry is looked at before it is whole");
        entry
    }

    /// Removes the first entry.
    pub fn dequeue(&mut self) -> Option<T> {
        if self.removed == self.added.get() {
            self.added.set(self.ring.indices().added.load(Acquire));
        }
        if self.removed == self.added.get() {
            return None;
        }
        self.front();
        let (entry, _) = self.front.take()?;
        self.removed += 1;
        self.ring.indices().removed.store(self.removed, Release);
        Some(entry)
    }
}
