//! Explicit methods of the crate `differential-equations`, with its dense output at the wanted times. Its event detection is not used: the
//! methods step over the kinks under error control.

use differential_equations::prelude::*;

use super::equations::Equations;
use super::library::Library;

impl<const N: usize, const D: usize> ODE<f64, [f64; D]> for Equations<N, D> {
    #[inline]
    fn diff(&self, time: f64, state: &[f64; D], rates: &mut [f64; D]) {
        self.rates(time, state, rates);
    }
}

/// Largest number of steps of a run.
const STEPS_MAX: usize = 10_000_000;

pub(super) fn solve<const N: usize, const D: usize>(
    library: Library,
    equations: &Equations<N, D>,
    times: &[f64],
    tolerance: f64,
) -> Result<Vec<[f64; D]>, String> {
    let end = times.last().copied().unwrap_or_default();
    let problem = IVP::ode(equations, 0.0, end, *equations.start()).t_eval(times);
    let solution = match library {
        Library::Dop853 => {
            problem.method(ExplicitRungeKutta::dop853().rtol(tolerance).atol(tolerance).max_steps(STEPS_MAX)).solve()
        }
        Library::CashKarp => {
            problem.method(ExplicitRungeKutta::cash_karp().rtol(tolerance).atol(tolerance).max_steps(STEPS_MAX)).solve()
        }
        _ => problem.method(ExplicitRungeKutta::dopri5().rtol(tolerance).atol(tolerance).max_steps(STEPS_MAX)).solve(),
    };
    solution.map(|solution| solution.y).map_err(|error| format!("{error:?}"))
}
