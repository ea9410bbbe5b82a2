//! Smoothing kernel of all signals of a fit, with its exact derivatives: a linear relation between signals holds
//! between their smoothed forms too.

/// Four boxes of equal width convolved, and its first and second difference.
#[derive(Debug, Clone, PartialEq)]
pub struct Kernel {
    /// Weights of the value, the first and the second derivative, of one odd length.
    weights: [Vec<f64>; 3],
    half: usize,
}

impl Kernel {
    /// Kernel of boxes of `samples` samples, `period` apart [s].
    pub fn new(samples: usize, period: f64) -> Self {
        let samples = samples.max(1);
        let mut smooth = vec![1.0];
        for _ in 0..4 {
            let mut wider = vec![0.0; smooth.len() + samples - 1];
            for (place, weight) in smooth.iter().enumerate() {
                wider[place..place + samples].iter_mut().for_each(|sum| *sum += weight / samples as f64);
            }
            smooth = wider;
        }
        // Four convolved boxes have an odd length, 4 (n - 1) + 1, for even n as well.
        let padded = [&[0.0], &smooth[..], &[0.0]].concat();
        let around = |place: usize, offset: isize| {
            place.checked_add_signed(offset).and_then(|place| padded.get(place)).copied().unwrap_or(0.0)
        };
        let first = |place: usize| (around(place, -1) - around(place, 1)) / (2.0 * period);
        let second = |place: usize| (around(place, -1) - 2.0 * padded[place] + around(place, 1)) / (period * period);
        // Second differences smooth by themselves; these weights smooth the value alike (Numerov).
        let value = |place: usize| (around(place, -1) + 10.0 * padded[place] + around(place, 1)) / 12.0;
        let weights = [
            (0..padded.len()).map(value).collect(),
            (0..padded.len()).map(first).collect(),
            (0..padded.len()).map(second).collect(),
        ];
        Self { half: padded.len() / 2, weights }
    }

    /// Samples on either side of a smoothed value.
    pub fn half(&self) -> usize {
        self.half
    }

    /// Sums of products of the weights of two orders: covariance of the smoothed values for independent errors of
    /// single samples.
    pub fn weight_products(&self) -> [[f64; 3]; 3] {
        let product = |one: usize, other: usize| -> f64 {
            self.weights[one].iter().zip(&self.weights[other]).map(|(one, other)| one * other).sum()
        };
        [0, 1, 2].map(|one| [0, 1, 2].map(|other| product(one, other)))
    }

    /// Smoothed derivative of order 0, 1 or 2 at a sample at least `half` away from either end.
    pub fn derivative(&self, signal: impl Fn(usize) -> f64, sample: usize, order: usize) -> f64 {
        let from = sample - self.half;
        self.weights[order].iter().enumerate().map(|(place, weight)| weight * signal(from + place)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The kernel's derivatives of a parabola are exact for any box.
    #[test]
    fn kernel_derivatives_of_parabola_exact() {
        let period = 1e-4;
        for samples in [1, 2, 5, 10] {
            let kernel = Kernel::new(samples, period);
            let signal = |sample: usize| {
                let time = sample as f64 * period;
                3.0 + 5.0 * time + 7.0 * time * time
            };
            let time = 200.0 * period;
            assert!((kernel.derivative(signal, 200, 1) - 5.0 - 14.0 * time).abs() < 1e-9);
            assert!((kernel.derivative(signal, 200, 2) - 14.0).abs() < 1e-4);
            assert!((kernel.derivative(|_| 2.0, 200, 0) - 2.0).abs() < 1e-12);
        }
    }
}
