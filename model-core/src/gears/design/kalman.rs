//! Steady-state Kalman filter of a small linear system: flow over a step, gain and covariance, by precise integration
//! and the Riccati recursion. Independent of gears. The gains G of (O2) and of (O4) come from here.

use nalgebra::{DMatrix, DVector};

use super::exponential::{exponential_minus_identity, flow};

/// Steps of the recursion: settled for every filter whose slowest pole is faster than a thousandth of the step rate.
const STEPS: usize = 20_000;

/// System x' = A x + B u + w with the measurement y = x_0 + v at every step.
#[derive(Clone)]
pub(crate) struct System {
    /// A.
    pub dynamics: DMatrix<f64>,
    /// B.
    pub inputs: DMatrix<f64>,
    /// Spectral density of w per state.
    pub process_noise: DVector<f64>,
    /// Variance of v.
    pub measurement_noise: f64,
}

/// Filter for one step length.
pub(crate) struct Filter {
    /// State response to an input held over the step.
    pub response: DMatrix<f64>,
    /// Gain of each state per unit of innovation, after the step.
    pub gain: DVector<f64>,
    /// Variance of each state after the correction.
    pub variance: DVector<f64>,
    /// Noise variance of each state while the last state is constant, without the lag behind changes.
    pub quiet: DVector<f64>,
}

impl System {
    /// Computes the filter for a step.
    pub fn filter(&self, step: f64) -> Filter {
        let n = self.dynamics.nrows();
        let over_step = flow(&self.dynamics, &self.inputs, step, 1);
        let transition = &over_step.transition + DMatrix::identity(n, n);
        let noise = self.noise_over(step, &transition);
        let mut covariance = DMatrix::from_diagonal(&self.process_noise) * step;
        let mut gain = DVector::zeros(n);
        for _ in 0..STEPS {
            let ahead = &transition * &covariance * transition.transpose() + &noise;
            gain = ahead.column(0) / (ahead[(0, 0)] + self.measurement_noise);
            let next = &ahead - &gain * ahead.row(0);
            // Keep the covariance symmetric under rounding.
            covariance = (&next + next.transpose()) * 0.5;
        }
        let mut still = self.process_noise.clone();
        still[n - 1] = 0.0;
        let noise = Self { process_noise: still, ..self.clone() }.noise_over(step, &transition);
        let mut quiet = DMatrix::zeros(n, n);
        for _ in 0..STEPS {
            let ahead = &transition * &quiet * transition.transpose() + &noise;
            let kept = DMatrix::identity(n, n)
                - &gain * DVector::from_fn(n, |row, _| if row == 0 { 1.0 } else { 0.0 }).transpose();
            quiet = &kept * ahead * kept.transpose() + &gain * gain.transpose() * self.measurement_noise;
        }
        let response = over_step.input_integrals[0].clone();
        Filter { response, gain, variance: covariance.diagonal(), quiet: quiet.diagonal() }
    }

    /// Covariance added by the process noise over a step: exponential of the doubled system (Van Loan).
    fn noise_over(&self, step: f64, transition: &DMatrix<f64>) -> DMatrix<f64> {
        let n = self.dynamics.nrows();
        let mut doubled = DMatrix::zeros(2 * n, 2 * n);
        doubled.view_mut((0, 0), (n, n)).copy_from(&-&self.dynamics);
        doubled.view_mut((0, n), (n, n)).copy_from(&DMatrix::from_diagonal(&self.process_noise));
        doubled.view_mut((n, n), (n, n)).copy_from(&self.dynamics.transpose());
        let exponential = exponential_minus_identity(&doubled, step);
        transition * exponential.view((0, n), (n, n))
    }
}
