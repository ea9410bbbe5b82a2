//! Noise of an encoder's readings, quantisation included, block by block: from fourth differences, which the joint's
//! motion does not reach.

/// Samples of a block.
const BLOCK_LENGTH: usize = 256;
/// Sum of the squares of 1, -4, 6, -4, 1.
const GAIN: f64 = 70.0;

/// Variance of readings by block.
#[derive(Debug, Clone, PartialEq)]
pub struct Noise(Vec<f64>);

impl Noise {
    /// Of readings that are evenly spaced.
    pub fn of(readings: &[f64]) -> Self {
        let differences: Vec<f64> =
            readings.windows(5).map(|w| w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]).collect();
        let variance = |block: &[f64]| block.iter().map(|d| d * d).sum::<f64>() / (GAIN * block.len() as f64);
        Self(differences.chunks(BLOCK_LENGTH).map(variance).collect())
    }

    /// Around a sample.
    pub fn at(&self, sample: usize) -> f64 {
        self.0.get(sample / BLOCK_LENGTH).or(self.0.last()).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_counts_of_a_motion_scatter_by_a_twelfth_of_a_count_squared() {
        let angle = |sample: usize| 40.0 * (1e-2 * sample as f64).sin() + 0.7 * sample as f64;
        let counts: Vec<f64> = (0..4096).map(|sample| angle(sample).round()).collect();
        let mean = (0..16).map(|block| Noise::of(&counts).at(256 * block)).sum::<f64>() / 16.0;
        assert!((12.0 * mean - 1.0).abs() < 0.1, "{mean}");
        let smooth: Vec<f64> = (0..4096).map(angle).collect();
        assert!(Noise::of(&smooth).at(1000) < 1e-6);
    }
}
