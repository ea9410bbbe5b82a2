//! Producer and consumer of a heapless queue with its number of places in the type, for the tick. heapless takes remainders
//! by a number that it reads from memory: where the compiler cannot tell that it is not zero, the tick could panic, and
//! would divide where a mask is enough. The queues themselves are in `queues`.

use core::sync::atomic::Ordering::Acquire;

use crate::shared::{Consumer, Producer, fence};

/// Puts entries in.
pub struct SizedProducer<'a, T, const PLACES: usize>(Producer<'a, T>);

/// Takes entries out.
pub struct SizedConsumer<'a, T, const PLACES: usize>(Consumer<'a, T>);

impl<'a, T, const PLACES: usize> SizedProducer<'a, T, PLACES> {
    /// The end of a queue of so many places; with another number of places nothing could be given.
    pub fn new(end: Producer<'a, T>) -> Self {
        Self(end)
    }

    /// Adds an entry, or hands it back if there is no room.
    #[inline]
    pub fn give(&mut self, entry: T) -> Result<(), T> {
        // Holds always, and tells the compiler the number of places.
        if self.0.capacity() == PLACES - 1 { self.0.enqueue(entry) } else { Err(entry) }
    }

    /// Whether there is room.
    #[inline]
    pub fn has_room(&self) -> bool {
        self.0.capacity() == PLACES - 1 && self.0.ready()
    }
}

impl<'a, T, const PLACES: usize> SizedConsumer<'a, T, PLACES> {
    /// The end of a queue of so many places; with another number of places nothing could be taken.
    pub fn new(end: Consumer<'a, T>) -> Self {
        Self(end)
    }

    /// Takes the first entry.
    #[inline]
    pub fn take(&mut self) -> Option<T> {
        // Holds always, and tells the compiler the number of places.
        if self.0.capacity() == PLACES - 1 { self.0.dequeue() } else { None }
    }

    /// Looks at the first entry. heapless looks whether there is one without keeping the look at it behind: the fence does.
    #[inline]
    pub fn peek(&self) -> Option<&T> {
        if !self.0.ready() {
            return None;
        }
        fence(Acquire);
        self.0.peek()
    }

    /// How many entries there are.
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
    fn entries_come_out_as_they_went_in_until_there_is_no_room() {
        let mut queue = Queue::<u8, 4>::new();
        let (entry, exit) = queue.split();
        let (mut giver, mut taker) = (SizedProducer::<_, 4>::new(entry), SizedConsumer::<_, 4>::new(exit));
        for round in 0..3 {
            assert_eq!([0, 1, 2].map(|entry| giver.give(entry + round)), [Ok(()); 3]);
            assert!(!giver.has_room());
            assert_eq!((giver.give(9), taker.count(), taker.peek()), (Err(9), 3, Some(&round)));
            assert_eq!([taker.take(), taker.take(), taker.take()], [0, 1, 2].map(|entry| Some(entry + round)));
            assert_eq!(taker.take(), None);
        }
    }
}
