//! Last trusted parameters, restored if the output encoder is excluded after it has corrupted the estimates. Otherwise
//! half-gap and offset from a failing encoder would determine the unobserved link's position.

use super::least_squares::LeastSquares;
use super::regressors::{HALF_GAP, OFFSET};
use crate::numbers::Real;
use crate::numbers::state_words::state_words;

/// Parameters that determine the position of an unobserved link.
const POSITION_PARAMETERS: [usize; 2] = [HALF_GAP, OFFSET];

/// Parameters when the half-gap was last trusted.
#[derive(Debug, Clone, Copy)]
pub struct TrustedParameters<T: Real, const P: usize> {
    /// Values [SI].
    values: [T; P],
    /// Variances of half-gap and offset over their initial variances [-].
    variances: [T; 2],
}
state_words! { struct TrustedParameters<T, P> { values, variances } }

impl<T: Real, const P: usize> TrustedParameters<T, P> {
    /// Copies the present parameters.
    pub fn snapshot(least_squares: &LeastSquares<T, P>) -> Self {
        Self {
            values: least_squares.values,
            variances: POSITION_PARAMETERS.map(|parameter| least_squares.relative_variance(parameter)),
        }
    }

    /// Restores the parameters. The variances of all parameters but half-gap and offset are reset, as no copy of them
    /// exists.
    pub fn restore(&self, least_squares: &mut LeastSquares<T, P>) {
        least_squares.values = self.values;
        least_squares.reset_covariance();
        for (parameter, variance) in POSITION_PARAMETERS.into_iter().zip(self.variances) {
            least_squares.set_relative_variance(parameter, variance);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::regressors::{COMPLIANCE, PLAIN};
    use super::*;
    use crate::observer::test_tables::learner;

    #[test]
    fn restored_parameters_replace_later_ones() {
        let mut least_squares = LeastSquares::<f32, PLAIN>::UNINITIALIZED;
        least_squares.reset(&learner());
        least_squares.values[HALF_GAP] = 80e-6;
        least_squares.set_relative_variance(HALF_GAP, 0.01);
        least_squares.set_relative_variance(COMPLIANCE, 0.02);
        let trusted = TrustedParameters::snapshot(&least_squares);
        least_squares.values[HALF_GAP] = 10e-6;
        least_squares.set_relative_variance(HALF_GAP, 0.001);
        trusted.restore(&mut least_squares);
        assert_eq!(least_squares.value(HALF_GAP), 80e-6);
        assert_eq!(least_squares.relative_variance(HALF_GAP), 0.01);
        assert_eq!(least_squares.relative_variance(COMPLIANCE), 1.0, "no copy of other variances exists");
    }
}
