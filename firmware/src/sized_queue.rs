//! Producer and consumer of a heapless queue with the number of places in the type, for the tick. heapless divides by a
//! capacity read from memory: if the compiler cannot exclude zero, the tick contains a panic, and a division where a
//! mask would do. The queues are in `queues`.

use core::sync::atomic::Ordering::Acquire;

use crate::shared::{Consumer, Producer, fence};

/// Producer of a queue.
pub struct SizedProducer<'a, T, const PLACES: usize>(Producer<'a, T>);

/// Consumer of a queue.
pub struct SizedConsumer<'a, T, const PLACES: usize>(Consumer<'a, T>);

impl<'a, T, const PLACES: usize> SizedProducer<'a, T, PLACES> {
    /// Producer of a queue with `PLACES` places; with another number of places every entry would be handed back.
    pub fn new(end: Producer<'a, T>) -> Self {
        Self(end)
    }

    /// Adds an entry, or hands it back if there is no room.
    #[inline]
    pub fn enqueue(&mut self, entry: T) -> Result<(), T> {
        // Always true; tells the compiler the number of places.
        if self.0.capacity() == PLACES - 1 { self.0.enqueue(entry) } else { Err(entry) }
    }

    /// Returns `true` if there is room.
    #[inline]
    pub fn has_room(&self) -> bool {
        self.0.capacity() == PLACES - 1 && self.0.ready()
    }
}

impl<'a, T, const PLACES: usize> SizedConsumer<'a, T, PLACES> {
    /// Consumer of a queue with `PLACES` places; with another number of places no entry could be taken.
    pub fn new(end: Consumer<'a, T>) -> Self {
        Self(end)
    }

    /// Takes the first entry.
    #[inline]
    pub fn take(&mut self) -> Option<T> {
        // Always true; tells the compiler the number of places.
        if self.0.capacity() == PLACES - 1 { self.0.dequeue() } else { None }
    }

    /// Returns the first entry without taking it. heapless checks for an entry with a relaxed load; the fence orders
    /// the access to the entry after this check.
    #[inline]
    pub fn peek(&self) -> Option<&T> {
        if !self.0.ready() {
            return None;
        }
        fence(Acquire);
        self.0.peek()
    }

    /// Number of entries.
    #[inline]
    pub fn count(&self) -> usize {
        if self.0.capacity() == PLACES - 1 { self.0.len() } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use crate::shared::Queue;

    use super::*;

    #[test]
    fn entries_returned_in_order_until_full() {
        let mut queue = Queue::<u8, 4>::new();
        let (entry, exit) = queue.split();
        let (mut giver, mut taker) = (SizedProducer::<_, 4>::new(entry), SizedConsumer::<_, 4>::new(exit));
        for round in 0..3 {
            assert_eq!([0, 1, 2].map(|entry| giver.enqueue(entry + round)), [Ok(()); 3]);
            assert!(!giver.has_room());
            assert_eq!((giver.enqueue(9), taker.count(), taker.peek()), (Err(9), 3, Some(&round)));
            assert_eq!([taker.take(), taker.take(), taker.take()], [0, 1, 2].map(|entry| Some(entry + round)));
            assert_eq!(taker.take(), None);
        }
    }
}
