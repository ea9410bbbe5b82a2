//! RAM in use: statics, by the linker's symbols, and stack, by the paint of the start-up code. The stack is not
//! guarded; it grows down towards the statics.

use cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    static _ram_start: u32;
    static _stack_end: u32;
    static _stack_start: u32;
}

/// RAM taken by statics [byte].
pub fn static_ram() -> u32 {
    (&raw const _stack_end as u32) - (&raw const _ram_start as u32)
}

/// Deepest stack so far [byte].
pub fn deepest() -> u32 {
    let end = &raw const _stack_start;
    let mut place = &raw const _stack_end;
    // SAFETY: the linker lays out aligned RAM between the two symbols; volatile, since the stack is in use.
    while place < end && unsafe { place.read_volatile() } == STACK_PAINT_VALUE {
        // SAFETY: still below the end.
        place = unsafe { place.add(1) };
    }
    end as u32 - place as u32
}
