//! CAN line of the role `drive`: the receive interrupt moves frames into a queue, and the tick takes them out and sends.
//! The drivers of the chips are in `board`.
//!
//! The receive interrupt preempts the tick, since the FIFO of three frames would overflow in a tick of more than 100 us:
//! a frame of 11 bits without data takes 47 us at 1 Mbit/s. The timer's interrupt has the priority of the receive
//! interrupt and calls [`Receiving::begin_period`]: frames that arrive later, even before the tick's first instruction,
//! are left to the next tick. Each frame is thus handled in a definite period, as in the twin, even if a full bus makes
//! ticks so long that one runs after the next period has begun: a tick that is late is made up for, up to [`PERIODS`].
//!
//! At control rates of 5 kHz and above the queue of [`FRAMES`] cannot overflow while ticks occur: a frame takes 47 us at
//! 1 Mbit/s at least, 30 us with data at 8 Mbit/s, so that at most 14 arrive in two periods of 200 us.

use core::sync::atomic::Ordering::{Acquire, Relaxed, Release};

use drives::Frame;

use crate::shared::{AtomicU32, Consumer, Producer, Queue};
use crate::sized_queue::{SizedConsumer, SizedProducer};

/// Places of the queue; one stays empty.
const PLACES: usize = 16;
/// Frames that fit the queue.
pub const FRAMES: usize = PLACES - 1;
/// Periods that may have begun before their ticks have run.
pub const PERIODS: usize = 4;
/// Frames that the FIFO of a peripheral holds at most, which bounds the interrupt.
const FIFO: usize = 3;

/// Receiving half of a CAN peripheral.
pub trait CanReceiver {
    /// Clears the interrupt request; a frame that arrives afterwards raises it again.
    fn acknowledge(&mut self);
    /// Takes the oldest frame of the FIFO.
    fn receive(&mut self) -> Option<Frame>;
}

/// Sending half of a CAN peripheral.
pub trait CanSender {
    /// Hands a frame over for sending, behind the frames before it; `false` if there is no room. A frame that the
    /// peripheral cannot send is dropped.
    fn send(&mut self, frame: &Frame) -> bool;
    /// Returns whether the peripheral is off the bus after too many errors. To be called once a tick: begins the
    /// recovery if the peripheral does not by itself.
    fn is_off(&mut self) -> bool;
}

/// Frames between interrupt and tick.
pub struct Received {
    queue: Queue<Frame, PLACES>,
    periods: Periods,
}

/// Periods that have begun.
struct Periods {
    /// Number of periods since power-up; wraps.
    begun: AtomicU32,
    /// Frames that had arrived at the begin of the last periods, by the number of the period; wraps.
    due: [AtomicU32; PERIODS],
}

impl Periods {
    const fn new() -> Self {
        Self { begun: AtomicU32::new(0), due: [const { AtomicU32::new(0) }; PERIODS] }
    }

    fn due(&self, period: u32) -> &AtomicU32 {
        &self.due[period as usize % PERIODS]
    }
}

impl Default for Received {
    fn default() -> Self {
        Self::new()
    }
}

impl Received {
    /// Empty queue.
    pub const fn new() -> Self {
        Self { queue: Queue::new(), periods: Periods::new() }
    }

    /// Ends of the interrupts and of the tick.
    pub fn split<R: CanReceiver>(&mut self, receiver: R) -> (Receiving<'_, R>, Inbox<'_>) {
        let Self { queue, periods } = self;
        let (producer, consumer): (Producer<'_, _>, Consumer<'_, _>) = queue.split();
        let receiving = Receiving { receiver, frames: SizedProducer::new(producer), count: 0, periods };
        (receiving, Inbox { frames: SizedConsumer::new(consumer), count: 0, due: 0, done: 0, periods })
    }
}

/// Work of the interrupts of receiver and timer.
pub struct Receiving<'a, R> {
    receiver: R,
    frames: SizedProducer<'a, Frame, PLACES>,
    /// Frames put into the queue since power-up; wraps.
    count: u32,
    periods: &'a Periods,
}

impl<R: CanReceiver> Receiving<'_, R> {
    /// Moves the frames of the FIFO into the queue. A frame is lost if the queue is full.
    pub fn service(&mut self) {
        self.receiver.acknowledge();
        for _ in 0..FIFO {
            let Some(frame) = self.receiver.receive() else { break };
            if self.frames.enqueue(frame).is_ok() {
                self.count = self.count.wrapping_add(1);
            }
        }
    }

    /// Begins a period: its tick handles the frames that are in the queue now.
    pub fn begin_period(&mut self) {
        let period = self.periods.begun.load(Relaxed);
        self.periods.due(period).store(self.count, Relaxed);
        self.periods.begun.store(period.wrapping_add(1), Release);
    }
}

/// Frames that the tick takes.
pub struct Inbox<'a> {
    frames: SizedConsumer<'a, Frame, PLACES>,
    /// Frames taken since power-up; wraps.
    count: u32,
    /// Frames that had arrived when the period of the present tick began; wraps.
    due: u32,
    /// Periods whose ticks have begun; wraps.
    done: u32,
    periods: &'a Periods,
}

impl Inbox<'_> {
    /// Begins the tick of the oldest period without one; `false` if there is none. Of more than [`PERIODS`] periods only
    /// the last one gets its tick.
    #[inline]
    pub fn begin_tick(&mut self) -> bool {
        let behind = self.behind();
        if behind == 0 {
            return false;
        }
        if behind > PERIODS as u32 {
            self.done = self.done.wrapping_add(behind - 1);
        }
        self.due = self.periods.due(self.done).load(Relaxed);
        self.done = self.done.wrapping_add(1);
        true
    }

    /// Returns the number of periods that have begun without a tick.
    #[inline]
    pub fn behind(&self) -> u32 {
        self.periods.begun.load(Acquire).wrapping_sub(self.done)
    }

    /// Returns the number of frames that arrived before this period and were not taken.
    #[inline]
    pub fn count(&self) -> usize {
        (self.due.wrapping_sub(self.count) as usize).min(FRAMES)
    }

    /// Takes the oldest frame.
    #[inline]
    pub fn take(&mut self) -> Option<Frame> {
        let frame = self.frames.take()?;
        self.count = self.count.wrapping_add(1);
        Some(frame)
    }
}
