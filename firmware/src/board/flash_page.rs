//! A page of a board's flash: unlocked, erased, written word by word and locked again, every wait bounded. Which page, and
//! its registers, each board's file says. The result is verified by reading back, which also detects a board
//! without flash, such as the emulated one.

use core::ptr::{read_volatile, write_volatile};

use cortex_m::asm::{dsb, isb};
use model_core::observer::{MEMORY_BYTES, Memory};

use super::bounded_wait::wait_longer;
use crate::page::Page;

/// Keys of every family.
pub const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];
/// Bytes of a word.
const WORD: usize = 4;

/// The flash controller of a board.
pub trait Flash {
    /// First byte of the page, outside of what an image may take.
    const ADDRESS: usize;
    /// Words that are written at a time.
    const TOGETHER: usize;
    /// Lets its registers be changed, and forgets errors.
    fn unlock(&mut self);
    /// Begins to erase the page.
    fn erase(&mut self);
    /// Takes writes to the page from now on, or no more.
    fn take_writes(&mut self, on: bool);
    /// Still at it.
    fn is_busy(&self) -> bool;
    /// No more changes, and no cache with what was there before.
    fn lock(&mut self);
}

/// The page.
pub struct FlashPage<F>(pub F);

impl<F: Flash> Page for FlashPage<F> {
    fn read(&self) -> Memory {
        let mut memory = [0; MEMORY_BYTES];
        for (index, bytes) in memory.chunks_exact_mut(WORD).enumerate() {
            // SAFETY: the page is flash, aligned, and longer than a memory.
            let word = unsafe { read_volatile((F::ADDRESS as *const u32).add(index)) };
            bytes.copy_from_slice(&word.to_le_bytes());
        }
        memory
    }

    fn write(&mut self, memory: &Memory) {
        let flash = &mut self.0;
        let done = |flash: &F| wait_longer(|| !flash.is_busy());
        flash.unlock();
        flash.erase();
        if done(flash) {
            flash.take_writes(true);
            // It takes them before the first one comes.
            dsb();
            isb();
            for (index, bytes) in memory.chunks_exact(WORD).enumerate() {
                let word = bytes.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte));
                // SAFETY: within the page, which nothing else uses; the controller has been told to take it.
                unsafe { write_volatile((F::ADDRESS as *mut u32).add(index), word) };
                if (index + 1).is_multiple_of(F::TOGETHER) {
                    // A store that is still on its way has not made it busy yet.
                    dsb();
                    if !done(flash) {
                        break;
                    }
                }
            }
            flash.take_writes(false);
        }
        flash.lock();
    }
}
