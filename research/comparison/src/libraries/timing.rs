//! Processor time of libraries and fixed-step methods in one process, in turn, so that all see the same machine: the least of several
//! rounds for each, the mean over phases, beside the worst error over phases.

use cpu_time::ThreadTime;
use model_core::gears::Scales;
use serde::Serialize;

use super::{Equations, Library};
use crate::case::Case;
use crate::curve::Scalar;
use crate::method::Method;
use crate::run;
use crate::trajectory::{Errors, ReferenceTrajectory};

/// Number of rounds; the least time of each method counts.
const ROUNDS: usize = 3;

/// Time and error of one method at one setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Time {
    /// Case.
    pub case: String,
    /// Method.
    pub name: String,
    /// Tolerance, or step h omega_n.
    pub setting: f64,
    /// Trajectory error, worst over the phases; `None` if the method failed.
    pub error: Option<f64>,
    /// Processor seconds for a second of the joint.
    pub cost: f64,
}

/// Times every method on a case at its phases; `None` if libraries cannot run the case.
pub fn times<const N: usize, const D: usize>(
    phases: &[(Case, ReferenceTrajectory)],
    tolerances: &[f64],
    rates: &[(u32, u32)],
) -> Option<Vec<Time>> {
    let first = &phases.first()?.0;
    let equations: Vec<Equations<N, D>> = phases.iter().map(|(case, _)| Equations::new(case)).collect::<Option<_>>()?;
    let frequency = Scales::new(&first.joint).frequency;
    let count = (first.duration() * f64::from(first.sample_rate)).floor() as usize;
    let sample_times: Vec<f64> =
        (0..=count).map(|sample| sample as f64 / f64::from(first.sample_rate) * frequency).collect();
    let mut all = Vec::new();
    for &library in Library::ALL {
        for &tolerance in tolerances {
            all.push(timed(first, library.name(), tolerance, phases.len(), |phase| {
                let start = now();
                let states = library.solve(&equations[phase], &sample_times, tolerance).ok()?;
                let seconds = now() - start;
                let readings =
                    states.iter().zip(&sample_times).map(|(state, time)| equations[phase].read(*time, state));
                Some((seconds, phases[phase].1.errors(&readings.enumerate().collect::<Vec<_>>())))
            }));
        }
    }
    for (method, scalar, name) in [
        (Method::Realtime, Scalar::Single, "this step, f32"),
        (Method::Realtime, Scalar::Double, "this step, f64"),
        (Method::RungeKutta4, Scalar::Single, "RK4, f32"),
        (Method::RungeKutta4, Scalar::Double, "RK4, f64"),
    ] {
        for &(rate, substeps) in rates {
            // Other methods than the core's step have no sub-steps: they take as many steps.
            let rate = if method == Method::Realtime { (rate, substeps) } else { (rate * substeps, 1) };
            let step = frequency / f64::from(rate.0 * rate.1);
            all.push(timed(first, name, step, phases.len(), |phase| {
                let (case, trajectory) = &phases[phase];
                let done = match scalar {
                    Scalar::Single => run::run::<f32, N>(case, trajectory.restarts(), method, rate, &now),
                    Scalar::Double => run::run::<f64, N>(case, trajectory.restarts(), method, rate, &now),
                };
                let done = done.ok()?;
                Some((done.seconds, trajectory.errors(&done.readings)))
            }));
        }
    }
    Some(all)
}

/// Processor time of this thread [s].
fn now() -> f64 {
    ThreadTime::now().as_duration().as_secs_f64()
}

/// Runs all phases in rounds; `work` returns time and errors.
fn timed(case: &Case, name: &str, setting: f64, phases: usize, work: impl Fn(usize) -> Option<(f64, Errors)>) -> Time {
    let mut least = f64::INFINITY;
    let mut error = None;
    for _ in 0..ROUNDS {
        let round: Option<(f64, Errors)> = (0..phases).try_fold((0.0, Errors::NONE), |(spent, worst), phase| {
            let (seconds, errors) = work(phase)?;
            Some((spent + seconds, worst.worst_of(&errors)))
        });
        let Some((spent, worst)) = round else { break };
        least = least.min(spent);
        error = Some(worst.deflections).filter(|error| error.is_finite());
    }
    let cost = least / (phases as f64 * case.duration());
    Time { case: case.key.clone(), name: name.into(), setting, error, cost }
}
