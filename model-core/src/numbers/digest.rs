//! A running 64-bit digest over words, cheap enough to take over the whole state in every tick: two states that
//! differ in one bit have different digests from then on. It guards against mistakes and mix-ups, not against malice.

/// Odd multiplier: the bits of the golden ratio.
const MULTIPLIER: u64 = 0x9e37_79b9_7f4a_7c15;

/// Where a chain starts.
pub const START: u64 = 0x6a6f_696e_742d_3031;

/// The digest after one more word. For a given word this is a bijection of `running`, so a difference never heals.
#[inline]
pub const fn chain(running: u64, word: u64) -> u64 {
    (running.rotate_left(5) ^ word).wrapping_mul(MULTIPLIER)
}
