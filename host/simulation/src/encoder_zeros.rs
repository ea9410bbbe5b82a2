//! Zeros of both encoders. An encoder may be mounted at any angle, so each seed draws the zeros: the controller
//! receives raw counts, and its set-points are on the scale of the raw output encoder.

use super::random::RandomStream;

/// Share of the seeds whose encoder starts close to its wrap [-].
const NEAR_WRAP_SHARE: f64 = 0.25;

/// Largest distance from the wrap in those seeds [turns]: a few counts of 14 bits.
const NEAR_WRAP_DISTANCE: f64 = 3e-4;

/// Readings of both encoders at the start of the joint, as fractions of a turn.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct EncoderZeros {
    /// Readings of the motor encoder and the output encoder [turns].
    turns: [f64; 2],
}

impl EncoderZeros {
    /// Draws the zeros of a seed.
    pub fn draw(seed: u64) -> Self {
        let mut stream = RandomStream::new(seed, "encoder zeros");
        let mut place = || {
            let near_wrap = stream.uniform() < NEAR_WRAP_SHARE;
            let place = stream.uniform();
            if near_wrap { ((2.0 * place - 1.0) * NEAR_WRAP_DISTANCE).rem_euclid(1.0) } else { place }
        };
        Self { turns: [place(), place()] }
    }

    /// Raw readings for given counts per turn: motor, output.
    pub fn counts(&self, counts_per_turn: [i64; 2]) -> [i64; 2] {
        [0, 1].map(|encoder| (self.turns[encoder] * counts_per_turn[encoder] as f64).floor() as i64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_cover_turn_and_wrap() {
        let zeros: Vec<_> = (0..400).map(|seed| EncoderZeros::draw(seed).counts([1 << 14, 1 << 17])).collect();
        for (encoder, bits) in [(0, 14), (1, 17)] {
            let turn = 1_i64 << bits;
            let near = (NEAR_WRAP_DISTANCE * turn as f64) as i64 + 1;
            let within =
                |range: std::ops::Range<i64>| zeros.iter().filter(|counts| range.contains(&counts[encoder])).count();
            assert_eq!(within(0..turn), 400);
            assert!(within(0..near) > 20 && within(turn - near..turn) > 20, "next to the wrap");
            assert!((0..4).all(|part| within(part * turn / 4..(part + 1) * turn / 4) > 50), "in every quarter");
        }
    }
}
