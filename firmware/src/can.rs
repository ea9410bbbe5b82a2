//! CAN line of the role `drive`: the interrupt moves received frames into a queue, and the tick takes them out, sends
//! and watches for bus-off. The drivers of the chips are in `board`.
//!
//! The queue cannot overflow while ticks occur: at 1 Mbit/s a frame takes at least 47 us, with data at 8 Mbit/s at least
//! 30 us, so that at most seven arrive in a tick of 200 us, and [`FRAMES`] fit. A stop is heard in the tick after its
//! last bit.

use drives::Frame;

use crate::shared::{AtomicU32, Consumer, Producer, Queue};
use crate::sized_queue::{SizedConsumer, SizedProducer};
use core::sync::atomic::Ordering::Relaxed;

/// Places of the queue; one stays empty.
const PLACES: usize = 16;
/// Frames that fit the queue.
pub const FRAMES: usize = PLACES - 1;
/// Frames that the FIFO of a peripheral holds at most, which bounds the interrupt.
const FIFO: usize = 3;

/// Receiving half of a CAN peripheral.
pub trait CanReceiver {
    /// Takes the oldest frame of the FIFO.
    fn receive(&mut self) -> Option<Frame>;
    /// Returns `true` if a frame was lost since the last call because the FIFO was full.
    fn overran(&mut self) -> bool;
}

/// Sending half of a CAN peripheral.
pub trait CanSender {
    /// Hands a frame over for sending, behind the frames before it; `false` if there is no room. A frame that the
    /// peripheral cannot send is dropped.
    fn send(&mut self, frame: &Frame) -> bool;
    /// Begins the recovery from bus-off, if the peripheral does not by itself. To be called once a tick.
    fn recover(&mut self);
}

/// Frames between interrupt and tick.
pub struct Received {
    queue: Queue<Frame, PLACES>,
    lost: AtomicU32,
}

impl Default for Received {
    fn default() -> Self {
        Self::new()
    }
}

impl Received {
    /// Empty queue.
    pub const fn new() -> Self {
        Self { queue: Queue::new(), lost: AtomicU32::new(0) }
    }

    /// Ends of the interrupt and of the tick.
    pub fn split<R: CanReceiver>(&mut self, receiver: R) -> (Receiving<'_, R>, Inbox<'_>) {
        let Self { queue, lost } = self;
        let (producer, consumer): (Producer<'_, _>, Consumer<'_, _>) = queue.split();
        let receiving = Receiving { receiver, frames: SizedProducer::new(producer), lost };
        (receiving, Inbox { frames: SizedConsumer::new(consumer), lost })
    }
}

/// Work of the interrupt.
pub struct Receiving<'a, R> {
    receiver: R,
    frames: SizedProducer<'a, Frame, PLACES>,
    lost: &'a AtomicU32,
}

impl<R: CanReceiver> Receiving<'_, R> {
    /// Moves the frames of the FIFO into the queue. A frame that arrives meanwhile raises the interrupt again.
    pub fn service(&mut self) {
        for _ in 0..FIFO {
            let Some(frame) = self.receiver.receive() else { break };
            if self.frames.enqueue(frame).is_err() {
                self.count_loss();
            }
        }
        if self.receiver.overran() {
            self.count_loss();
        }
    }

    fn count_loss(&self) {
        self.lost.store(self.lost.load(Relaxed).wrapping_add(1), Relaxed);
    }
}

/// Frames that the tick takes.
pub struct Inbox<'a> {
    frames: SizedConsumer<'a, Frame, PLACES>,
    lost: &'a AtomicU32,
}

impl Inbox<'_> {
    /// Takes the oldest frame.
    #[inline]
    pub fn take(&mut self) -> Option<Frame> {
        self.frames.take()
    }

    /// Number of losses since power-up, each of one frame or more; wraps.
    pub fn lost(&self) -> u32 {
        self.lost.load(Relaxed)
    }
}
