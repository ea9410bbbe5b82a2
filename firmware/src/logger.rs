//! Sink of defmt's log: encoded bytes go into a queue that idle empties into frames. Logging masks the interrupts below
//! the tick's priority, never the tick. The tick must not log; bytes that it logs are counted as lost.

use core::cell::UnsafeCell;
use core::sync::atomic::Ordering::Relaxed;
use core::sync::atomic::{AtomicBool, AtomicU8, AtomicU32};

use cortex_m::register::{basepri, basepri_max};
use defmt::Encoder;
use heapless::spsc::{Consumer, Producer, Queue};

use crate::board::pac::NVIC_PRIO_BITS;

/// Capacity for log bytes that wait for idle.
const CAPACITY: usize = 1024;
/// BASEPRI that leaves only the highest priority unmasked.
const BELOW_THE_TICK: u8 = 1 << (8 - NVIC_PRIO_BITS);

/// Queue between the log and idle.
pub type LogQueue = Queue<u8, CAPACITY>;

static SINK: Sink = Sink {
    encoder: UnsafeCell::new(Encoder::new()),
    queue: UnsafeCell::new(None),
    taken: AtomicBool::new(false),
    refused: AtomicBool::new(false),
    masked_before: AtomicU8::new(0),
    lost: AtomicU32::new(0),
};

struct Sink {
    encoder: UnsafeCell<Encoder>,
    queue: UnsafeCell<Option<Producer<'static, u8>>>,
    taken: AtomicBool,
    refused: AtomicBool,
    masked_before: AtomicU8,
    lost: AtomicU32,
}

// SAFETY: `encoder` and `queue` are accessed only between `acquire` and `release`, by the one context that has set
// `taken` and has masked all others that may log; and by `start`, once, before interrupts are on.
unsafe impl Sync for Sink {}

/// Opens the log; called once, from init. Earlier log bytes are lost and counted.
pub fn start(queue: &'static mut LogQueue) -> Consumer<'static, u8> {
    let (producer, consumer) = queue.split();
    cortex_m::interrupt::free(|_| {
        // SAFETY: with all interrupts off and `taken` clear there is no other access to the queue.
        unsafe { *SINK.queue.get() = Some(producer) };
    });
    consumer
}

/// Bytes dropped so far because the queue was full or the log not open.
pub fn lost_bytes() -> u32 {
    SINK.lost.load(Relaxed)
}

fn count_lost(bytes: usize) {
    SINK.lost.fetch_add(bytes as u32, Relaxed);
}

impl Sink {
    fn push(&self, bytes: &[u8]) {
        // SAFETY: see `Sync`.
        let queue = unsafe { &mut *self.queue.get() };
        let mut lost = bytes.len();
        if let Some(queue) = queue {
            lost -= bytes.iter().take_while(|&&byte| queue.enqueue(byte).is_ok()).count();
        }
        if lost > 0 {
            count_lost(lost);
        }
    }
}

#[defmt::global_logger]
struct Logger;

// SAFETY: `acquire` masks every context that may log, and refuses any other; `write` and `release` follow `acquire` in
// the same context.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        let before = basepri::read();
        basepri_max::write(BELOW_THE_TICK);
        if SINK.taken.swap(true, Relaxed) {
            SINK.refused.store(true, Relaxed);
            return;
        }
        SINK.masked_before.store(before, Relaxed);
        // SAFETY: see `Sync`.
        unsafe { &mut *SINK.encoder.get() }.start_frame(|bytes| SINK.push(bytes));
    }

    unsafe fn flush() {}

    unsafe fn write(bytes: &[u8]) {
        if SINK.refused.load(Relaxed) {
            return count_lost(bytes.len());
        }
        // SAFETY: see `Sync`.
        unsafe { &mut *SINK.encoder.get() }.write(bytes, |bytes| SINK.push(bytes));
    }

    unsafe fn release() {
        if SINK.refused.swap(false, Relaxed) {
            return;
        }
        // SAFETY: see `Sync`.
        unsafe { &mut *SINK.encoder.get() }.end_frame(|bytes| SINK.push(bytes));
        SINK.taken.store(false, Relaxed);
        // SAFETY: restores the mask from before `acquire`.
        unsafe { basepri::write(SINK.masked_before.load(Relaxed)) };
    }
}

defmt::timestamp!("{=u64:us}", crate::clock::microseconds());
