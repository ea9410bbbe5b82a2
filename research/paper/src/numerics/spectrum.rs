//! Amplitude spectrum of an evenly sampled signal. Where the samples come from and which lines mean what is the
//! caller's business.

use std::f64::consts::TAU;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// How samples are weighted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Window {
    /// All alike: exact for a whole number of cycles.
    Rectangular,
    /// Hann's: what does not fit the stretch leaks into two neighbouring lines instead of everywhere.
    Hann,
}

/// Amplitudes by frequency.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Spectrum {
    /// In cycles per unit of the sampling interval.
    pub frequency: Vec<f64>,
    /// Amplitude of the sine that would show the same line.
    pub amplitude: Vec<f64>,
}

impl Spectrum {
    /// Of a signal, its mean taken off, up to half the sampling rate. Nothing of fewer than two samples.
    pub fn of(signal: &[f64], interval: f64, window: Window) -> Self {
        let count = signal.len();
        if count < 2 {
            return Self::default();
        }
        let mean = signal.iter().sum::<f64>() / count as f64;
        let weight = |index: usize| match window {
            Window::Rectangular => 1.0,
            Window::Hann => 1.0 - (TAU * index as f64 / count as f64).cos(),
        };
        let mut values: Vec<Complex<f64>> =
            signal.iter().enumerate().map(|(index, value)| Complex::new((value - mean) * weight(index), 0.0)).collect();
        FftPlanner::new().plan_fft_forward(count).process(&mut values);
        let lines = count / 2 + 1;
        let amplitude = values[..lines].iter().enumerate().map(|(line, value)| {
            // Zero and half the sampling rate have no mirror image to share their amplitude with.
            let single = line == 0 || 2 * line == count;
            value.norm() / count as f64 * if single { 1.0 } else { 2.0 }
        });
        let frequency = (0..lines).map(|line| line as f64 / (count as f64 * interval));
        Self { frequency: frequency.collect(), amplitude: amplitude.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sines(count: usize, interval: f64) -> Vec<f64> {
        (0..count)
            .map(|i| i as f64 * interval)
            .map(|t| 5.0 + 3.0 * (TAU * 2.0 * t).sin() + 0.5 * (TAU * 7.0 * t).cos())
            .collect()
    }

    #[test]
    fn whole_cycles_have_their_amplitudes_and_nothing_else() {
        let spectrum = Spectrum::of(&sines(300, 0.01), 0.01, Window::Rectangular);
        for (frequency, amplitude) in spectrum.frequency.iter().zip(&spectrum.amplitude) {
            let expected = match frequency.round() {
                f if (frequency - f).abs() > 1e-9 => 0.0,
                2.0 => 3.0,
                7.0 => 0.5,
                _ => 0.0,
            };
            assert!((amplitude - expected).abs() < 1e-12, "{amplitude} at {frequency}");
        }
    }

    #[test]
    fn hanns_window_keeps_amplitudes_and_contains_leaks() {
        let spectrum = Spectrum::of(&sines(1024, 0.01), 0.01, Window::Hann);
        let near = |at: f64| {
            let lines = spectrum.frequency.iter().zip(&spectrum.amplitude);
            lines.filter(|(f, _)| (*f - at).abs() < 0.2).map(|(_, a)| *a).fold(0.0, f64::max)
        };
        assert!((near(2.0) - 3.0).abs() < 0.45, "{}", near(2.0));
        assert!(near(20.0) < 1e-4, "{}", near(20.0));
    }

    #[test]
    fn nothing_gives_nothing() {
        assert_eq!(Spectrum::of(&[], 0.1, Window::Hann), Spectrum::default());
        assert_eq!(Spectrum::of(&[1.0], 0.1, Window::Hann), Spectrum::default());
    }
}
