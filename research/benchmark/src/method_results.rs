//! Every method on every case over a range of step sizes: error from the host, instructions from the emulated core.

use comparison::case::{Case, Measure};
use comparison::curve::{PHASES, PhaseEnvelope, Point, Scalar};
use comparison::method::Method;
use comparison::run::AS_DESIGNED;
use comparison::trajectory::Errors;
use serde::Serialize;

use super::emulated_runs::{self, InstructionCount, Job};
use board::device::Say;
use board::device::toolchain::Toolchain;
use report::failure::{Failure, Outcome};
use report::progress::Progress;

/// Step rates over a quarter of the case's sample rate, where the phase is prescribed.
const MULTIPLES: [u32; 15] = [1, 2, 3, 4, 6, 8, 10, 12, 16, 20, 24, 32, 40, 48, 64];
/// Steps a tick where torques change tick by tick.
const STEPS_A_TICK: [u32; 11] = [1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 32];
/// Sub-steps of the core's step in a tick, and tick rates over a quarter of the case's sample rate: a tick has a cost of its own, which is
/// all of the cost while contact holds.
const SUBSTEPS: [u32; 10] = [1, 2, 3, 4, 5, 6, 8, 10, 12, 16];
const SUBSTEPS_OF_LONG_RUNS: [u32; 6] = [1, 2, 3, 4, 6, 8];
const TICKS: [u32; 3] = [1, 2, 4];

/// One method on one case.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MethodResult {
    /// Case.
    pub case: String,
    /// Method.
    pub method: Method,
    /// Name in tables and pictures.
    pub name: &'static str,
    /// Steps from coarse to fine.
    pub marks: Vec<StepResult>,
}

/// One step size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "units are spelled as in every file that this command writes")]
pub struct StepResult {
    /// Step rate; for the core's step the tick rate.
    pub rate_Hz: u32,
    /// Sub-steps of each step; 0 for the design's choice for a board.
    pub substeps: u32,
    /// Step h omega_n: of a sub-step, or of the whole tick where the design chooses.
    pub step: f64,
    /// Error by the case's measure, worst over the phases; none if the motion diverged.
    pub error: Option<f64>,
    /// Error in double precision, where computed.
    pub error_f64: Option<f64>,
    /// Link angle over the lost motion, RMS.
    pub link_rms: Option<f64>,
    /// Link angle over the lost motion, worst.
    pub link_worst: Option<f64>,
    /// Largest mesh force, relative error.
    pub peak_force: Option<f64>,
    /// Mean instructions a step.
    pub instructions: f64,
    /// Largest number of instructions of a step.
    pub instructions_most: u32,
    /// Largest number of instructions in a sample of 10, 20 and 40 kHz; 0 where steps do not fit.
    pub sample_instructions_most: [u32; 3],
}

impl MethodResult {
    /// Cost and error, from coarse to fine, in series whose entries differ in the step only.
    pub fn series(&self) -> Vec<Vec<(f64, f64)>> {
        // Tick rates form series for the core's step only; the design's choice is a series of its own.
        let ticks = |mark: &StepResult| match self.method {
            Method::Realtime if mark.substeps != AS_DESIGNED => mark.rate_Hz,
            _ => 0,
        };
        let mut found: Vec<u32> = self.marks.iter().map(ticks).collect();
        found.sort_unstable();
        found.dedup();
        let one = |of: u32| {
            let marks = self.marks.iter().filter(move |mark| ticks(mark) == of);
            marks.filter_map(|mark| Some((mark.cost(), mark.error?))).collect()
        };
        found.into_iter().map(one).collect()
    }
}

impl StepResult {
    /// Instructions for a second of the joint.
    pub fn cost(&self) -> f64 {
        self.instructions * f64::from(self.rate_Hz)
    }
}

/// A case as it was run.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "units are spelled as in every file that this command writes")]
pub struct CaseRecord {
    /// Short name.
    pub key: String,
    /// Title.
    pub title: String,
    /// Error measure.
    pub measure: &'static str,
    /// True if the measure is the output angle.
    pub by_link_angle: bool,
    /// Length [s].
    pub duration_s: f64,
    /// Phases in the envelope.
    pub phases: usize,
    /// Number of windows of the evaluation, each starting in the reference's state.
    pub windows: usize,
    /// Error of the reference itself if its start is moved by a millionth of b_c, without windows.
    pub sensitivity: f64,
}

/// Runs the cases.
pub fn run(
    cases: Vec<Case>,
    toolchain: &Toolchain,
    progress: &Progress,
    say: Say<'_>,
) -> Outcome<(Vec<CaseRecord>, Vec<MethodResult>)> {
    let (mut figures, mut entries) = (Vec::new(), Vec::new());
    for case in cases {
        progress.stage(&format!("case {}: reference", case.key));
        let failed = |error: &dyn std::fmt::Display| Failure::new(format!("case {}: {error}", case.key));
        // For a chaotic motion a few phases are as informative as many.
        let phases = if case.measure == Measure::LinkAngle { 2 } else { PHASES };
        let envelope = PhaseEnvelope::new(case.clone(), phases).map_err(|error| failed(&error))?;
        let sensitivity = envelope.sensitivity().map_err(|error| failed(&error))?;
        figures.push(CaseRecord {
            key: case.key.clone(),
            title: case.title.clone(),
            measure: measure(&case),
            by_link_angle: case.measure == Measure::LinkAngle,
            duration_s: case.duration(),
            phases,
            windows: 1 + case.restarts.len(),
            sensitivity: case_error(&case, &sensitivity),
        });
        progress.stage(&format!("case {}: methods on the host", case.key));
        let found = points(&envelope);
        let jobs: Vec<Job<'_>> = found
            .iter()
            .map(|(method, point, _)| {
                let lost = finite(point.errors.link_rms).is_none();
                let digest = (!lost).then_some(point.digest);
                let restarts = envelope.trajectory().restarts();
                let (rate, substeps) = (point.rate, point.substeps);
                Job { case: &envelope.case, restarts, method: *method, rate, substeps, digest }
            })
            .collect();
        progress.stage(&format!("case {}: methods on the emulated core", case.key));
        let counts = emulated_runs::run(&jobs, toolchain, say)?;
        for method in Method::ALL {
            let of_method = found.iter().zip(&counts).filter(|((which, ..), _)| *which == method);
            let marks =
                of_method.map(|((_, point, double), count)| mark(&case, point, double.as_ref(), count)).collect();
            entries.push(MethodResult { case: case.key.clone(), method, name: method.name(), marks });
        }
    }
    Ok((figures, entries))
}

/// All methods at all rates that they support; this step in double precision too.
fn points(envelope: &PhaseEnvelope) -> Vec<(Method, Point, Option<Point>)> {
    let case = &envelope.case;
    let constant = case.torques.len() <= 1;
    let unit = if constant { case.sample_rate / 4 } else { case.tick_rate };
    let multiples: &[u32] = if constant { &MULTIPLES } else { &STEPS_A_TICK };
    let substeps = if constant { &SUBSTEPS[..] } else { &SUBSTEPS_OF_LONG_RUNS };
    let designed = TICKS.map(|ticks| (ticks * unit, AS_DESIGNED));
    let stated = TICKS.iter().flat_map(|ticks| substeps.iter().map(move |substeps| (ticks * unit, *substeps)));
    let fine: &[(u32, u32)] = if constant { &[(8 * unit, 16), (16 * unit, 16)] } else { &[] };
    let own: Vec<(u32, u32)> = designed.into_iter().chain(stated).chain(fine.iter().copied()).collect();
    let mut found = Vec::new();
    for method in Method::ALL {
        let steps: Vec<(u32, u32)> = match method {
            Method::Realtime => own.clone(),
            _ => multiples.iter().map(|multiple| (multiple * unit, 1)).collect(),
        };
        for (rate, substeps) in steps {
            // The design rejects steps without tables.
            let Ok(point) = envelope.point(method, Scalar::Single, rate, substeps) else { continue };
            let double = (method == Method::Realtime)
                .then(|| envelope.point(method, Scalar::Double, rate, substeps).ok())
                .flatten();
            found.push((method, point, double));
        }
    }
    found
}

fn measure(case: &Case) -> &'static str {
    match case.measure {
        Measure::Deflections => "mesh deflections, RMS over their standard deviation",
        Measure::LinkAngle => "link angle, RMS over the lost motion",
    }
}

fn case_error(case: &Case, errors: &Errors) -> f64 {
    match case.measure {
        Measure::Deflections => errors.deflections,
        Measure::LinkAngle => errors.link_rms,
    }
}

/// Error, or `None` if the motion diverged.
fn finite(error: f64) -> Option<f64> {
    (error.is_finite() && error < 1e6).then_some(error)
}

fn mark(case: &Case, point: &Point, double: Option<&Point>, count: &InstructionCount) -> StepResult {
    StepResult {
        rate_Hz: point.rate,
        substeps: point.substeps,
        step: point.step,
        error: finite(case_error(case, &point.errors)),
        error_f64: double.and_then(|double| finite(case_error(case, &double.errors))),
        link_rms: finite(point.errors.link_rms),
        link_worst: finite(point.errors.link_worst),
        peak_force: finite(point.errors.peak_force),
        instructions: count.mean,
        instructions_most: count.most,
        sample_instructions_most: count.samples,
    }
}
