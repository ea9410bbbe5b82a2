//! Running 64-bit digest over words, cheap enough for the whole state in every tick. Once one word differs, two digests
//! stay different over equal words. The digest detects mistakes and mix-ups, not attacks.

/// Odd multiplier: the bits of the golden ratio.
const MULTIPLIER: u64 = 0x9e37_79b9_7f4a_7c15;

/// Initial value of a digest.
pub const START: u64 = 0x6a6f_696e_742d_3031;

/// Adds a word to the digest. For a given word the result is a bijection of `running`, so a difference persists.
#[inline]
pub const fn chain(running: u64, word: u64) -> u64 {
    (running.rotate_left(5) ^ word).wrapping_mul(MULTIPLIER)
}
