//! What was learnt for sure: where everything goes back to when the output encoder is given up after it has spoilt what was
//! learnt. Without that, a link that nobody sees would be led by a half-gap and an offset that a failing encoder made up.

use super::learner::Learner;
use super::regressors::{HALF_GAP, OFFSET};
use crate::numbers::Real;

/// What leads a link that is not seen.
const LEADS: [usize; 2] = [HALF_GAP, OFFSET];

/// What was learnt when the half-gap was trusted last.
#[derive(Debug, Clone, Copy)]
pub struct Trusted<T: Real, const P: usize> {
    /// Parameters, in SI.
    values: [T; P],
    /// Variances of half-gap and offset over those beforehand [-].
    variances: [T; 2],
}

impl<T: Real, const P: usize> Trusted<T, P> {
    /// What is learnt now.
    pub fn of(learner: &Learner<T, P>) -> Self {
        Self { values: learner.values, variances: LEADS.map(|parameter| learner.relative_variance(parameter)) }
    }

    /// Back to it: how sure everything else was nobody remembers.
    pub fn restore(&self, learner: &mut Learner<T, P>) {
        learner.values = self.values;
        learner.reopen();
        for (parameter, variance) in LEADS.into_iter().zip(self.variances) {
            learner.set_relative_variance(parameter, variance);
        }
    }
}
