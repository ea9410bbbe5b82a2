//! Primitives shared by tick, serial interrupt and idle: atomics, single-producer queues, and the fence between two
//! memory accesses. A model of all interleavings compiles the same sources with another file in place of this one.

/// Compiler fence, sufficient here since tick, interrupt and idle run on one core.
pub use core::sync::atomic::compiler_fence as fence;
pub use core::sync::atomic::{AtomicBool, AtomicU32};

pub use heapless::spsc::{Consumer, Producer, Queue};
