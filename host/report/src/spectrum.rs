//! Amplitude spectrum of an evenly sampled signal. Frequencies above half the sampling rate are aliased.

use std::f64::consts::TAU;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// Window function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Window {
    /// Equal weights: exact for a whole number of cycles.
    Rectangular,
    /// Hann's window: a frequency between two lines leaks into two neighbouring lines only.
    Hann,
}

/// Mean that is subtracted first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mean {
    /// Mean of the samples.
    Plain,
    /// Mean of the weighted samples, so that the window does not spread it over its neighbours.
    Weighted,
}

/// Half the width of the main lobe of Hann's window [lines].
const HALF_LOBE: usize = 2;
/// Least number of samples of a spectrum.
const MIN_SAMPLES: usize = 16;

/// Amplitudes of the sines with these lines, from frequency zero to half the sampling rate; line k lies at k cycles in
/// the whole signal. Empty for fewer than two samples.
pub fn amplitudes(signal: &[f64], window: Window, mean: Mean) -> Vec<f64> {
    let count = signal.len();
    if count < 2 {
        return Vec::new();
    }
    // The mean of the weights is 1.
    let weight = |index: usize| match window {
        Window::Rectangular => 1.0,
        Window::Hann => 1.0 - (TAU * index as f64 / count as f64).cos(),
    };
    let sum: f64 = match mean {
        Mean::Plain => signal.iter().sum(),
        Mean::Weighted => signal.iter().enumerate().map(|(index, value)| weight(index) * value).sum(),
    };
    let mean = sum / count as f64;
    let mut values: Vec<Complex<f64>> =
        signal.iter().enumerate().map(|(index, value)| Complex::new((value - mean) * weight(index), 0.0)).collect();
    FftPlanner::new().plan_fft_forward(count).process(&mut values);
    let lines = values[..count / 2 + 1].iter().enumerate().map(|(line, value)| {
        // Zero and half the sampling rate have no mirror line to share their amplitude with.
        let single = line == 0 || 2 * line == count;
        value.norm() / count as f64 * if single { 1.0 } else { 2.0 }
    });
    lines.collect()
}

/// Spectrum of a motion that need not be periodic in the window: Hann's window, about the mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Distance of neighbouring frequencies [Hz].
    pub step: f64,
    /// Amplitudes in the unit of the signal, from frequency zero to below half the sampling rate.
    pub amplitudes: Vec<f64>,
}

impl Spectrum {
    /// Spectrum of samples at `rate` [Hz]; `None` with too few samples, or if one is not finite.
    pub fn new(samples: &[f64], rate: f64) -> Option<Self> {
        let count = samples.len();
        if count < MIN_SAMPLES || samples.iter().any(|sample| !sample.is_finite()) {
            return None;
        }
        let mut amplitudes = amplitudes(samples, Window::Hann, Mean::Weighted);
        amplitudes.truncate(count / 2);
        // Only rounding is left at zero. It is weighted like the other lines, so that no line stands out in a signal at
        // rest.
        amplitudes[0] *= 2.0;
        Some(Self { step: rate / count as f64, amplitudes })
    }

    /// Root of the power outside a frequency over the root of the power at it; `None` if the samples cannot resolve it.
    pub fn non_fundamental_ratio(&self, frequency: f64) -> Option<f64> {
        let place = (frequency / self.step).round() as usize;
        if place <= 2 * HALF_LOBE || place + HALF_LOBE >= self.amplitudes.len() {
            return None;
        }
        let power = |from: usize, to: usize| self.amplitudes[from..to].iter().map(|a| a * a).sum::<f64>();
        let own = power(place - HALF_LOBE, place + HALF_LOBE + 1);
        let all = power(HALF_LOBE + 1, self.amplitudes.len());
        (own > 0.0).then(|| ((all - own).max(0.0) / own).sqrt())
    }

    /// Greatest amplitude, with its frequency [Hz].
    pub fn greatest(&self) -> (f64, f64) {
        let (place, amplitude) = self
            .amplitudes
            .iter()
            .enumerate()
            .fold((0, 0.0), |best, (place, &amplitude)| if amplitude > best.1 { (place, amplitude) } else { best });
        (place as f64 * self.step, amplitude)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sines(count: usize) -> Vec<f64> {
        let times = (0..count).map(|index| index as f64 * 0.01);
        times.map(|t| 5.0 + 3.0 * (TAU * 2.0 * t).sin() + 0.5 * (TAU * 7.0 * t).cos()).collect()
    }

    fn samples(wave: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..5000).map(|index| wave(f64::from(index) / 1000.0)).collect()
    }

    #[test]
    fn whole_cycles_give_exact_amplitudes() {
        // 300 samples of 10 ms: three lines a hertz.
        for (line, amplitude) in amplitudes(&sines(300), Window::Rectangular, Mean::Plain).into_iter().enumerate() {
            let expected = match line {
                6 => 3.0,
                21 => 0.5,
                _ => 0.0,
            };
            assert!((amplitude - expected).abs() < 1e-12, "{amplitude} at line {line}");
        }
    }

    #[test]
    fn hann_window_limits_leakage() {
        let lines = amplitudes(&sines(1024), Window::Hann, Mean::Plain);
        let near = |at: f64| {
            let within = |line: usize| (line as f64 / 10.24 - at).abs() < 0.2;
            lines.iter().enumerate().filter(|(line, _)| within(*line)).map(|(_, a)| *a).fold(0.0, f64::max)
        };
        assert!((near(2.0) - 3.0).abs() < 0.45, "{}", near(2.0));
        assert!(near(20.0) < 1e-4, "{}", near(20.0));
    }

    #[test]
    fn empty_signal_has_no_amplitudes() {
        assert!(amplitudes(&[], Window::Hann, Mean::Plain).is_empty());
        assert!(amplitudes(&[1.0], Window::Hann, Mean::Plain).is_empty());
    }

    #[test]
    fn sine_peaks_at_its_frequency() {
        let spectrum = Spectrum::new(&samples(|t| 7.0 + 3.0 * (TAU * 50.0 * t).sin()), 1000.0).expect("long enough");
        let (frequency, amplitude) = spectrum.greatest();
        assert!((frequency - 50.0).abs() < 0.2 && (amplitude - 3.0).abs() < 1e-9, "{frequency} Hz, {amplitude}");
        assert!(spectrum.non_fundamental_ratio(50.0).is_some_and(|rest| rest < 1e-9));
    }

    #[test]
    fn ratio_beside_frequency_follows_power() {
        let wave = |t: f64| (TAU * 60.0 * t).sin() + 2.0 * (TAU * 20.0 * t).sin();
        let beside = Spectrum::new(&samples(wave), 1000.0).and_then(|spectrum| spectrum.non_fundamental_ratio(60.0));
        assert!(beside.is_some_and(|beside| (beside - 2.0).abs() < 1e-6), "{beside:?}");
    }

    #[test]
    fn short_or_diverged_signal_has_no_spectrum() {
        assert!(Spectrum::new(&[1.0; 8], 1000.0).is_none());
        assert!(Spectrum::new(&[f64::NAN; 100], 1000.0).is_none());
    }
}
