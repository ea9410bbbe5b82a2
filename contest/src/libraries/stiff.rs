//! diffsol: its BDF with an analytic Jacobian and dense LU, and its explicit Tsitouras method, both stepping over the
//! kinks under error control and interpolating at the wanted times. Its root finding would restart the BDF at order one
//! at each of eleven crossings a mesh period.

use diffsol::{NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverMethod, OdeSolverStopReason, Vector, VectorHost};

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

/// Steps as the method likes, and reads its interpolant.
fn follow<'a, Eqn, S, const D: usize>(mut solver: S, times: &[f64]) -> Result<Vec<[f64; D]>, String>
where
    Eqn: diffsol::OdeEquations<T = f64> + 'a,
    Eqn::V: VectorHost<T = f64>,
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
        while let Some(time) = wanted.next_if(|time| *time <= now) {
            solver.interpolate_inplace(time, &mut state).map_err(|error| error.to_string())?;
            let mut entries = [0.0; D];
            entries.copy_from_slice(state.as_slice());
            states.push(entries);
        }
        if !matches!(reason, OdeSolverStopReason::InternalTimestep) {
            // The last time may be the stop time rounded.
            while wanted.next().is_some() {
                let mut entries = [0.0; D];
                entries.copy_from_slice(solver.state().y.as_slice());
                states.push(entries);
            }
            return Ok(states);
        }
    }
}
