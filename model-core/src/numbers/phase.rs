//! Sine and cosine of a phase in 2^-32 turns: integer reduction to an eighth of a turn, then two short polynomials.
//! libm's `sinf` costs about thirty times as much on a core with single-precision hardware only.

use crate::numbers::real::Real;

/// Returns (sin, cos) of 2 pi phase / 2^32; error below 1e-7.
#[inline]
pub fn sine_cosine<T: Real>(phase: u32) -> (T, T) {
    // Nearest quarter turn, and the rest: at most an eighth of a turn in either direction.
    let quarter = phase.wrapping_add(1 << 29) >> 30;
    let rest = phase.wrapping_sub(quarter << 30) as i32;
    let turns = T::from_i32(rest) * T::PHASE_UNIT;
    let square = turns * turns;
    let [s0, s1, s2, s3] = T::SINE;
    let sine = turns * (s0 + square * (s1 + square * (s2 + square * s3)));
    let [c0, c1, c2, c3, c4] = T::COSINE;
    let cosine = c0 + square * (c1 + square * (c2 + square * (c3 + square * c4)));
    match quarter & 3 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}
