//! The amplitude spectrum of an evenly sampled signal, and how much of it is not the mesh frequency's. Only what the
//! samples hold is in it: what is faster than half their rate is folded back.

use std::f64::consts::TAU;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// Amplitudes over frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Distance of neighbouring frequencies [Hz].
    pub step: f64,
    /// Amplitudes in the unit of the signal, from frequency zero.
    pub amplitudes: Vec<f64>,
}

/// Half the width of the window's main lobe, in bins.
const LOBE: usize = 2;

impl Spectrum {
    /// Of samples at `rate` [Hz], about their mean, under a Hann window.
    pub fn of(samples: &[f64], rate: f64) -> Option<Self> {
        let count = samples.len();
        if count < 16 || samples.iter().any(|sample| !sample.is_finite()) {
            return None;
        }
        let window = |index: usize| 0.5 - 0.5 * (TAU * index as f64 / count as f64).cos();
        // The mean under the window, so that the window does not smear it over its neighbours.
        let mean = samples.iter().enumerate().map(|(index, sample)| window(index) * sample).sum::<f64>()
            / (0.5 * count as f64);
        let mut values: Vec<Complex<f64>> = samples
            .iter()
            .enumerate()
            .map(|(index, sample)| Complex::new(window(index) * (sample - mean), 0.0))
            .collect();
        FftPlanner::new().plan_fft_forward(count).process(&mut values);
        // A sine of amplitude 1 gives count / 4 through a Hann window.
        let amplitudes = values.iter().take(count / 2).map(|value| value.norm() * 4.0 / count as f64).collect();
        Some(Self { step: rate / count as f64, amplitudes })
    }

    /// Root of the power beside a frequency over the root of its own; none where the samples cannot tell.
    pub fn beside(&self, frequency: f64) -> Option<f64> {
        let place = (frequency / self.step).round() as usize;
        if place <= 2 * LOBE || place + LOBE >= self.amplitudes.len() {
            return None;
        }
        let power = |from: usize, to: usize| self.amplitudes[from..to].iter().map(|a| a * a).sum::<f64>();
        let own = power(place - LOBE, place + LOBE + 1);
        let all = power(LOBE + 1, self.amplitudes.len());
        (own > 0.0).then(|| ((all - own).max(0.0) / own).sqrt())
    }

    /// The greatest amplitude and its frequency [Hz].
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

    fn samples(wave: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..5000).map(|index| wave(f64::from(index) / 1000.0)).collect()
    }

    #[test]
    fn a_sine_has_its_amplitude_at_its_frequency() {
        let spectrum = Spectrum::of(&samples(|t| 7.0 + 3.0 * (TAU * 50.0 * t).sin()), 1000.0).expect("long enough");
        let (frequency, amplitude) = spectrum.greatest();
        assert!((frequency - 50.0).abs() < 0.2 && (amplitude - 3.0).abs() < 1e-9, "{frequency} Hz, {amplitude}");
        assert!(spectrum.beside(50.0).is_some_and(|rest| rest < 1e-9));
    }

    #[test]
    fn what_is_beside_the_mesh_frequency_is_told_by_its_power() {
        let wave = |t: f64| (TAU * 60.0 * t).sin() + 2.0 * (TAU * 20.0 * t).sin();
        let beside = Spectrum::of(&samples(wave), 1000.0).and_then(|spectrum| spectrum.beside(60.0));
        assert!(beside.is_some_and(|beside| (beside - 2.0).abs() < 1e-6), "{beside:?}");
    }

    #[test]
    fn too_few_samples_or_a_motion_that_diverged_have_no_spectrum() {
        assert!(Spectrum::of(&[1.0; 8], 1000.0).is_none());
        assert!(Spectrum::of(&[f64::NAN; 100], 1000.0).is_none());
    }
}
