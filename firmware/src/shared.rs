//! What tick, serial interrupt and idle share is made of, in one place: atomics, single-producer queues, and the fence between
//! two looks at them. A model of all their interleavings is built of the same sources with another file in place of this one.

/// Keeps the compiler from moving a look at memory across it: all three are on one core, which does no more than that.
pub use core::sync::atomic::compiler_fence as fence;
pub use core::sync::atomic::{AtomicBool, AtomicU32};

pub use heapless::spsc::{Consumer, Producer, Queue};
