//! Error against step: a method on a case at several rates, as the envelope over excitation phases, so that no step benefits from a lucky
//! phase.

use model_core::gears::Scales;
use model_core::gears::design::DesignError;
use model_core::numbers::Real;
use rayon::prelude::*;
use reference::joint::ReferenceError;

use crate::case::Case;
use crate::method::Method;
use crate::run::{self, Run};
use crate::trajectory::{Errors, ReferenceTrajectory, Restart};

/// Phases in the envelope.
pub const PHASES: usize = 8;

/// A case at all its excitation phases, with the reference's trajectories.
pub struct PhaseEnvelope {
    /// Case at its own phase, which is the first.
    pub case: Case,
    phases: Vec<(Case, ReferenceTrajectory)>,
}

/// Scalar type of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scalar {
    /// Single precision, as on a board.
    Single,
    /// Double precision.
    Double,
}

/// A method at one rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Step rate [Hz].
    pub rate: u32,
    /// Sub-steps of each step; [`run::AS_DESIGNED`] for the design's choice.
    pub substeps: u32,
    /// Step h omega_n: of a sub-step, or of the whole step where the design chooses.
    pub step: f64,
    /// Worst errors over the phases.
    pub errors: Errors,
    /// Digest that a board must reach, at the first phase.
    pub digest: u64,
}

impl PhaseEnvelope {
    /// Runs the reference through a case at `phases` phases.
    pub fn new(case: Case, phases: usize) -> Result<Self, ReferenceError> {
        let phases: Result<Vec<_>, _> = (0..phases)
            .into_par_iter()
            .map(|index| {
                let shifted = case.shifted(index as f64 / phases as f64);
                ReferenceTrajectory::new(&shifted).map(|trajectory| (shifted, trajectory))
            })
            .collect();
        Ok(Self { case, phases: phases? })
    }

    /// Motion of the reference at the case's own phase.
    pub fn trajectory(&self) -> &ReferenceTrajectory {
        &self.phases[0].1
    }

    /// The case at each phase, with the reference's motion.
    pub fn phases(&self) -> &[(Case, ReferenceTrajectory)] {
        &self.phases
    }

    /// Error of the reference itself if its start is moved by a millionth of b_c: no integrator can be expected to be better in single
    /// precision.
    pub fn sensitivity(&self) -> Result<Errors, ReferenceError> {
        let (case, trajectory) = &self.phases[0];
        let moved = ReferenceTrajectory::from(case, &case.displaced_start(1e-6))?;
        let samples: Vec<_> = moved.samples().iter().cloned().enumerate().collect();
        Ok(trajectory.errors(&samples))
    }

    /// Errors of a method at a rate; `substeps` applies to the core's step.
    pub fn point(&self, method: Method, scalar: Scalar, rate: u32, substeps: u32) -> Result<Point, DesignError> {
        let runs: Result<Vec<(Errors, u64)>, DesignError> = self
            .phases
            .par_iter()
            .map(|(case, trajectory)| {
                let run = match scalar {
                    Scalar::Single => run_any::<f32>(case, trajectory.restarts(), method, (rate, substeps)),
                    Scalar::Double => run_any::<f64>(case, trajectory.restarts(), method, (rate, substeps)),
                }?;
                Ok((trajectory.errors(&run.readings), run.digest))
            })
            .collect();
        let runs = runs?;
        let errors = runs.iter().fold(Errors::NONE, |worst, (errors, _)| worst.worst_of(errors));
        let step = Scales::new(&self.case.joint).frequency / (f64::from(rate) * f64::from(substeps.max(1)));
        Ok(Point { rate, substeps, step, errors, digest: runs.first().map_or(0, |run| run.1) })
    }
}

fn run_any<T: Real>(case: &Case, restarts: &[Restart], method: Method, rate: (u32, u32)) -> Result<Run, DesignError> {
    match case.joint.geometry.planets {
        3 => run::run::<T, 3>(case, restarts, method, rate, &|| 0.0),
        4 => run::run::<T, 4>(case, restarts, method, rate, &|| 0.0),
        5 => run::run::<T, 5>(case, restarts, method, rate, &|| 0.0),
        given => Err(parameters::ParameterError::PlanetCount { given }.into()),
    }
}
