//! Fourier series of the mesh stiffness over a mesh period (S3): harmonic wave of eq. 7 or rectangular wave of Fig. 3.
//!
//! Equations: (P4) in docs/theory/paper.md.

use parameters::StiffnessWave;

/// Fourier series of a stiffness wave.
///
/// ```
/// use core::f64::consts::PI;
/// use model_core::gears::StiffnessSeries;
/// use parameters::StiffnessWave;
///
/// // Two pairs of teeth carry for half of each mesh period: a square wave, whose harmonics are odd.
/// let wave = StiffnessWave::Rectangular { stiffness_ratio: 0.15, contact_ratio: 1.5, order: 5 };
/// let (sine, cosine) = wave.coefficients(1);
/// assert!((sine - 4.0 * 0.15 / PI).abs() < 1e-12 && cosine.abs() < 1e-12);
/// let (sine, cosine) = wave.coefficients(2);
/// assert!(sine.abs() < 1e-12 && cosine.abs() < 1e-12);
/// assert!(wave.swing() < 1.0, "the stiffness stays positive");
/// ```
pub trait StiffnessSeries {
    /// Upper bound on the deviation from the mean, relative to the mean: sum of the harmonics' amplitudes.
    fn swing(&self) -> f64;

    /// Fourier coefficients (a_m, b_m) of harmonic m >= 1: K/K_m = 1 + sum a_m sin(m phase) + b_m cos(m phase).
    ///
    /// The rectangular wave (Fig. 3) is high for a fraction d of the period, centred at phase pi/2 so that d = 1/2
    /// rises at phase 0 as the sine of eq. 7 does; levels are placed so that the mean is 1.
    fn coefficients(&self, harmonic: usize) -> (f64, f64);
}

impl StiffnessSeries for StiffnessWave {
    fn swing(&self) -> f64 {
        (1..=self.order()).map(|harmonic| self.coefficients(harmonic)).map(|(a, b)| libm::hypot(a, b)).sum()
    }

    fn coefficients(&self, harmonic: usize) -> (f64, f64) {
        match *self {
            Self::Harmonic { stiffness_ratio } => (if harmonic == 1 { stiffness_ratio } else { 0.0 }, 0.0),
            Self::Rectangular { stiffness_ratio, contact_ratio, .. } => {
                let duty = contact_ratio - libm::floor(contact_ratio);
                let m = harmonic as f64;
                let amplitude =
                    4.0 * stiffness_ratio * libm::sin(core::f64::consts::PI * m * duty) / (core::f64::consts::PI * m);
                // cos(m (phase - pi/2)) split into sine and cosine of m phase.
                let (sine, cosine) = libm::sincos(m * core::f64::consts::FRAC_PI_2);
                (amplitude * sine, amplitude * cosine)
            }
        }
    }
}
