//! diffsol: its BDF with an analytic Jacobian and dense LU, and its explicit Tsitouras method, both stepping over the kinks under error
//! control and interpolating at the wanted times. Its root finding would restart the BDF at order one at each of eleven crossings a mesh
//! period.

use diffsol::Vector;
use diffsol::{NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquations, OdeSolverMethod, OdeSolverStopReason};

use super::Equations;

type Matrix = NalgebraMat<f64>;

pub(super) fn bdf<const N: usize, const D: usize>(
    equations: &Equations<N, D>,
    times: &[f64],
    tolerance: f64,
) -> Result<Vec<[f64; D]>, String> {
    let problem = OdeBuilder::<Matrix>::new()
        .rtol(tolerance)
        .atol([tolerance])
        .rhs_implicit(
            |state: &[f64], _: &[f64], time: f64, rates: &mut [f64]| equations.rates(time, state, rates),
            |state: &[f64], _: &[f64], time: f64, vector: &[f64], product: &mut [f64]| {
                equations.jacobian_times(time, state, vector, product);
            },
        )
        .init(|_: &[f64], _: f64, state: &mut [f64]| state.copy_from_slice(equations.start()), D)
        .build()
        .map_err(|error| error.to_string())?;
    let solver = problem.bdf::<NalgebraLU<f64>>().map_err(|error| error.to_string())?;
    follow(solver, times)
}

pub(super) fn tsit45<const N: usize, const D: usize>(
    equations: &Equations<N, D>,
    times: &[f64],
    tolerance: f64,
) -> Result<Vec<[f64; D]>, String> {
    let problem = OdeBuilder::<Matrix>::new()
        .rtol(tolerance)
        .atol([tolerance])
        .rhs(|state: &[f64], _: &[f64], time: f64, rates: &mut [f64]| equations.rates(time, state, rates))
        .init(|_: &[f64], _: f64, state: &mut [f64]| state.copy_from_slice(equations.start()), D)
        .build()
        .map_err(|error| error.to_string())?;
    let solver = problem.tsit45().map_err(|error| error.to_string())?;
    follow(solver, times)
}

/// Runs a solver with its own steps and interpolates at the wanted times.
fn follow<'a, Eqn, S, const D: usize>(mut solver: S, times: &[f64]) -> Result<Vec<[f64; D]>, String>
where
    Eqn: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a,
    S: OdeSolverMethod<'a, Eqn>,
{
    let end = times.last().copied().unwrap_or_default();
    solver.set_stop_time(end).map_err(|error| error.to_string())?;
    let mut wanted = times.iter().copied().peekable();
    let mut states = Vec::with_capacity(times.len());
    let mut state = solver.state().y.clone();
    loop {
        let reason = solver.step().map_err(|error| error.to_string())?;
        let now = solver.state().t;
        let ended = !matches!(reason, OdeSolverStopReason::InternalTimestep);
        // The stop time is reached except for rounding.
        while let Some(time) = wanted.next_if(|time| ended || *time <= now) {
            solver.interpolate_inplace(time.min(now), &mut state).map_err(|error| error.to_string())?;
            states.push(std::array::from_fn(|entry| state.get_index(entry)));
        }
        if ended {
            return Ok(states);
        }
    }
}
