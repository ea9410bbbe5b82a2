//! Noise of an encoder's readings including quantisation, block by block, from fourth differences, which the joint's
//! motion hardly affects.

/// Samples of a block.
const BLOCK_LENGTH: usize = 256;
/// Sum of the squares of 1, -4, 6, -4, 1.
const DIFFERENCE_GAIN: f64 = 70.0;

/// Variance of readings by block.
#[derive(Debug, Clone, PartialEq)]
pub struct Noise(Vec<f64>);

impl Noise {
    /// Noise of readings at even times; `is_whole(from, to)` is true if nothing is lost from one place to before
    /// another.
    pub fn measure(readings: &[f64], is_whole: impl Fn(usize, usize) -> bool) -> Self {
        let difference = |w: &[f64]| w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4];
        let windows = readings.windows(5).enumerate();
        let differences: Vec<Option<f64>> =
            windows.map(|(place, window)| is_whole(place, place + 5).then(|| difference(window))).collect();
        let mut last = 0.0;
        let mut variance = |block: &[Option<f64>]| {
            let (mut sum, mut count) = (0.0, 0_u32);
            for difference in block.iter().flatten() {
                sum += difference * difference;
                count += 1;
            }
            if count > 0 {
                last = sum / (DIFFERENCE_GAIN * f64::from(count));
            }
            last
        };
        Self(differences.chunks(BLOCK_LENGTH).map(&mut variance).collect())
    }

    /// Mean variance of all blocks.
    pub fn mean(&self) -> f64 {
        self.0.iter().sum::<f64>() / self.0.len().max(1) as f64
    }

    /// Variance of the block of a sample.
    pub fn at(&self, sample: usize) -> f64 {
        self.0.get(sample / BLOCK_LENGTH).or(self.0.last()).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whole counts of a motion scatter by 1/12 of a count squared.
    #[test]
    fn quantisation_noise_is_a_twelfth() {
        let angle = |sample: usize| 40.0 * (1e-2 * sample as f64).sin() + 0.7 * sample as f64;
        let counts: Vec<f64> = (0..4096).map(|sample| angle(sample).round()).collect();
        let mean = (0..16).map(|block| Noise::measure(&counts, |_, _| true).at(256 * block)).sum::<f64>() / 16.0;
        assert!((12.0 * mean - 1.0).abs() < 0.1, "{mean}");
        let smooth: Vec<f64> = (0..4096).map(angle).collect();
        assert!(Noise::measure(&smooth, |_, _| true).at(1000) < 1e-6);
    }
}
