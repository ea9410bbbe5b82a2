//! In place of `firmware/src/shared.rs`: the same atomics and queues, watched by loom.
//!
//! Constructors are constant there, loom's are not, so each is made at the first look at it: models look at all of them
//! before their threads begin.
//!
//! The queue stands for heapless's, with its two indices and their orderings: each side reads its own as it likes, the
//! other's with Acquire where it takes or gives and Relaxed where it only looks, and writes its own with Release. An index
//! of the other side is read again only when the last reading of it is used up, which heapless may be as late to see. How
//! heapless keeps its entries is its own affair: here they lie behind a lock, and each has a mark that was set before the
//! entry was handed over. Whoever can see the entry without the mark could see half an entry.

use std::cell::{Cell, OnceCell};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use loom::sync::atomic::Ordering::{self, Acquire, Relaxed, Release};
use loom::sync::atomic::{self, AtomicUsize};

pub use loom::sync::atomic::fence;

/// A number. Loom tries two orders where a store meets the last look at the same atomic: whoever looks itself before it
/// stores hides the looks of others. So every look is preceded by a turn, of which all orders are tried.
#[derive(Debug, Default)]
pub struct AtomicU32 {
    first: u32,
    watched: OnceLock<(atomic::AtomicU32, atomic::AtomicU32)>,
}

impl AtomicU32 {
    /// With its first value.
    pub const fn new(first: u32) -> Self {
        Self { first, watched: OnceLock::new() }
    }

    fn watched(&self) -> &(atomic::AtomicU32, atomic::AtomicU32) {
        self.watched.get_or_init(|| (atomic::AtomicU32::new(self.first), atomic::AtomicU32::new(0)))
    }

    /// Looks at it.
    pub fn load(&self, ordering: Ordering) -> u32 {
        let (number, turn) = self.watched();
        turn.fetch_add(0, Relaxed);
        number.load(ordering)
    }

    /// Changes it.
    pub fn store(&self, number: u32, ordering: Ordering) {
        self.watched().0.store(number, ordering);
    }
}

/// A flag, which nobody looks at who sets it.
#[derive(Debug, Default)]
pub struct AtomicBool {
    first: bool,
    watched: OnceLock<atomic::AtomicBool>,
}

impl AtomicBool {
    /// With its first value.
    pub const fn new(first: bool) -> Self {
        Self { first, watched: OnceLock::new() }
    }

    fn watched(&self) -> &atomic::AtomicBool {
        self.watched.get_or_init(|| atomic::AtomicBool::new(self.first))
    }

    /// Looks at it.
    pub fn load(&self, ordering: Ordering) -> bool {
        self.watched().load(ordering)
    }

    /// Changes it.
    pub fn store(&self, flag: bool, ordering: Ordering) {
        self.watched().store(flag, ordering);
    }
}

/// An entry and its mark; a byte has none, since there is no half of it.
type Entry<T> = (T, Option<Arc<atomic::AtomicBool>>);

/// They count entries, and do not wrap.
#[derive(Default)]
struct Indices {
    taken: AtomicUsize,
    given: AtomicUsize,
}

/// What both sides see.
struct Ring<T> {
    places: usize,
    indices: OnceLock<Indices>,
    entries: Mutex<VecDeque<Entry<T>>>,
}

impl<T> Ring<T> {
    fn indices(&self) -> &Indices {
        self.indices.get_or_init(Indices::default)
    }

    fn entries<R>(&self, look: impl FnOnce(&mut VecDeque<Entry<T>>) -> R) -> R {
        look(&mut self.entries.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// A queue for one producer and one consumer.
pub struct Queue<T, const PLACES: usize>(Ring<T>);

impl<T, const PLACES: usize> Queue<T, PLACES> {
    /// Empty.
    pub const fn new() -> Self {
        let entries = Mutex::new(VecDeque::new());
        Self(Ring { places: PLACES, indices: OnceLock::new(), entries })
    }

    /// Hands out its ends.
    pub fn split(&mut self) -> (Producer<'_, T>, Consumer<'_, T>) {
        let ring = &self.0;
        let (taken, given) = (ring.indices().taken.load(Relaxed), ring.indices().given.load(Relaxed));
        (Producer { ring, given, taken }, Consumer { ring, taken, given: Cell::new(given), front: OnceCell::new() })
    }
}

impl<T, const PLACES: usize> Default for Queue<T, PLACES> {
    fn default() -> Self {
        Self::new()
    }
}

/// The end that entries go into.
pub struct Producer<'a, T> {
    ring: &'a Ring<T>,
    given: usize,
    /// As last seen.
    taken: usize,
}

impl<T> Producer<'_, T> {
    /// Most entries.
    pub fn capacity(&self) -> usize {
        self.ring.places - 1
    }

    /// Entries that are there.
    pub fn len(&self) -> usize {
        self.given - self.ring.indices().taken.load(Relaxed)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether there is room.
    pub fn ready(&self) -> bool {
        self.len() < self.capacity()
    }

    /// Puts an entry in, or gives it back.
    pub fn enqueue(&mut self, entry: T) -> Result<(), T> {
        if self.given - self.taken == self.capacity() {
            self.taken = self.ring.indices().taken.load(Acquire);
        }
        if self.given - self.taken == self.capacity() {
            return Err(entry);
        }
        let mark = (size_of::<T>() > 1).then(|| {
            let mark = Arc::new(atomic::AtomicBool::new(false));
            mark.store(true, Relaxed);
            mark
        });
        self.ring.entries(|entries| entries.push_back((entry, mark)));
        self.given += 1;
        self.ring.indices().given.store(self.given, Release);
        Ok(())
    }
}

/// The end that entries come out of.
pub struct Consumer<'a, T> {
    ring: &'a Ring<T>,
    taken: usize,
    /// As last seen.
    given: Cell<usize>,
    /// The first, if it was looked at.
    front: OnceCell<Entry<T>>,
}

impl<T> Consumer<'_, T> {
    /// Most entries.
    pub fn capacity(&self) -> usize {
        self.ring.places - 1
    }

    /// Entries that are there.
    pub fn len(&self) -> usize {
        self.ring.indices().given.load(Relaxed) - self.taken
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        !self.ready()
    }

    /// Whether there is one.
    pub fn ready(&self) -> bool {
        self.ring.indices().given.load(Relaxed) > self.taken
    }

    /// Looks at the first.
    pub fn peek(&self) -> Option<&T> {
        self.ready().then(|| self.front())
    }

    fn front(&self) -> &T {
        let (entry, mark) =
            self.front.get_or_init(|| self.ring.entries(VecDeque::pop_front).expect("what was counted is there"));
        assert!(mark.as_ref().is_none_or(|mark| mark.load(Relaxed)), "an entry is looked at before it is whole");
        entry
    }

    /// Takes the first out.
    pub fn dequeue(&mut self) -> Option<T> {
        if self.taken == self.given.get() {
            self.given.set(self.ring.indices().given.load(Acquire));
        }
        if self.taken == self.given.get() {
            return None;
        }
        self.front();
        let (entry, _) = self.front.take()?;
        self.taken += 1;
        self.ring.indices().taken.store(self.taken, Release);
        Some(entry)
    }
}
