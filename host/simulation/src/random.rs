//! Random values of a seed, each drawn from a range by a random stream of its own, so that another range in a file
//! leaves the other values unchanged. Noise of motor and encoders is drawn in the drive train.

use model_core::numbers::random::splitmix64;

/// A number, or a range to draw from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NumberOrRange {
    /// One value for every seed.
    Exactly(f64),
    /// Uniform distribution between two ends.
    Between(f64, f64),
}

impl NumberOrRange {
    /// Value for a stream.
    pub fn draw(self, stream: &mut RandomStream) -> f64 {
        match self {
            Self::Exactly(value) => value,
            Self::Between(low, high) => low + (high - low) * stream.uniform(),
        }
    }

    /// Whole number for a stream; all whole numbers of the range are equally likely, ends included.
    pub fn draw_whole(self, stream: &mut RandomStream) -> f64 {
        match self {
            Self::Exactly(value) => value,
            Self::Between(low, high) => {
                let (low, high) = (low.ceil(), high.floor());
                (low + ((high - low + 1.0) * stream.uniform()).floor()).min(high)
            }
        }
    }

    /// Both ends.
    pub fn ends(self) -> [f64; 2] {
        match self {
            Self::Exactly(value) => [value, value],
            Self::Between(low, high) => [low, high],
        }
    }
}

/// Random stream of a seed and a name (splitmix64 after Steele, Lea and Flood, 2014).
#[derive(Debug, Clone)]
pub struct RandomStream(u64);

impl RandomStream {
    /// Stream of a name for a seed.
    pub fn new(seed: u64, name: &str) -> Self {
        // FNV-1a separates the streams of different names.
        let hash = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        let mut stream =
            Self(name.bytes().fold(0xcbf2_9ce4_8422_2325, hash) ^ seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        stream.word();
        stream
    }

    /// 64 random bits.
    pub fn word(&mut self) -> u64 {
        splitmix64(&mut self.0)
    }

    /// Uniform number from 0 to below 1.
    pub fn uniform(&mut self) -> f64 {
        (self.word() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Standard normal deviate, by Box and Muller.
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stream_depends_on_seed_and_name() {
        let draw = |seed, name| NumberOrRange::Between(-2.0, 3.0).draw(&mut RandomStream::new(seed, name));
        assert_eq!(draw(1, "a"), draw(1, "a"));
        assert_ne!(draw(1, "a"), draw(2, "a"));
        assert_ne!(draw(1, "a"), draw(1, "b"));
        let all: Vec<f64> = (0..1000).map(|seed| draw(seed, "x")).collect();
        assert!(all.iter().all(|value| (-2.0..3.0).contains(value)));
        let mean = all.iter().sum::<f64>() / 1000.0;
        assert!((mean - 0.5).abs() < 0.2, "{mean}");
    }

    #[test]
    fn whole_numbers_are_uniform() {
        let bits = NumberOrRange::Between(12.0, 18.0);
        let mut count = [0; 7];
        for seed in 0..7000 {
            count[(bits.draw_whole(&mut RandomStream::new(seed, "bits")) - 12.0) as usize] += 1;
        }
        // Five standard deviations of a count of 1000.
        assert!(count.iter().all(|count: &i32| (count - 1000).abs() < 160), "{count:?}");
    }
}
