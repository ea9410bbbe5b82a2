//! Error by step: a method over a case at one rate after another, as the envelope over excitation phases, so that no
//! lucky step counts.

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
    /// The case as stated: the first phase.
    pub case: Case,
    phases: Vec<(Case, ReferenceTrajectory)>,
}

/// Which scalar moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scalar {
    /// As on a board.
    Single,
    /// Double precision.
    Double,
}

/// A method at one rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Steps in a second [Hz].
    pub rate: u32,
    /// Sub-steps of each; [`run::AS_DESIGNED`] for those that the design chooses.
    pub substeps: u32,
    /// h omega_n, of a sub-step; of the whole step where the design chooses.
    pub step: f64,
    /// Worst over the phases.
    pub errors: Errors,
    /// What a board must reach, at the first phase.
    pub digest: u64,
}

impl PhaseEnvelope {
    /// Follows the reference through a case at so many phases.
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

    /// The reference's motion at the case's own phase.
    pub fn trajectory(&self) -> &ReferenceTrajectory {
        &self.phases[0].1
    }

    /// The case at each phase, with the reference's motion.
    pub fn phases(&self) -> &[(Case, ReferenceTrajectory)] {
        &self.phases
    }

    /// Error of the reference itself if its start is moved by a millionth of b_c: what no integrator can be
    /// expected to undercut in single precision.
    pub fn sensitivity(&self) -> Result<Errors, ReferenceError> {
        let (case, trajectory) = &self.phases[0];
        let moved = ReferenceTrajectory::from(case, &case.moved_start(1e-6))?;
        let samples: Vec<_> = moved.samples().iter().cloned().enumerate().collect();
        Ok(trajectory.errors(&samples))
    }

    /// A method at a rate; the core's step at so many sub-steps, too.
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
        let errors = runs.iter().fold(Errors::NONE, |worst, (errors, _)| worst.or_worse(errors));
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
