//! Last trusted parameters, restored if the output encoder is excluded after it has corrupted the estimates. Otherwise
//! half-gap and offset from a failing encoder would determine the unobserved link's position.

use super::learner::Learner;
use super::regressors::{HALF_GAP, OFFSET};
use crate::numbers::Real;

/// Parameters that determine the position of an unobserved link.
const LEADS: [usize; 2] = [HALF_GAP, OFFSET];

/// Parameters when the half-gap was last trusted.
#[derive(Debug, Clone, Copy)]
pub struct Trusted<T: Real, const P: usize> {
    /// Values [SI].
    values: [T; P],
    /// Variances of half-gap and offset over their initial variances [-].
    variances: [T; 2],
}

impl<T: Real, const P: usize> Trusted<T, P> {
    /// Copies the present parameters.
    pub fn of(learner: &Learner<T, P>) -> Self {
        Self { values: learner.values, variances: LEADS.map(|parameter| learner.relative_variance(parameter)) }
    }

    /// Restores the parameters. The variances of all parameters but half-gap and offset are reset, as no copy of them
    /// exists.
    pub fn restore(&self, learner: &mut Learner<T, P>) {
        learner.values = self.values;
        learner.reopen();
        for (parameter, variance) in LEADS.into_iter().zip(self.variances) {
            learner.set_relative_variance(parameter, variance);
        }
    }
}
