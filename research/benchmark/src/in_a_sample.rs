//! Best result of each method within the computing time of one control sample: error of output angle and peak mesh force. Only for cases
//! evaluated by the output angle.

use serde::Serialize;

use comparison::method::Method;

use super::method_results::{CaseRecord, MethodResult, StepResult};
use super::verdicts::least_cost_at;

/// Sample rate [Hz].
pub const SAMPLE_RATE: u32 = 10_000;
/// Largest mean number of instructions a sample.
pub const INSTRUCTIONS: f64 = 2_000.0;
/// Required errors of the link angle over the lost motion, RMS and worst, and of the largest mesh force.
pub const REQUIRED: [f64; 3] = [1e-3, 1e-2, 0.1];

/// One method at its best within the cost.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct InASample {
    /// Case.
    pub case: String,
    /// Method.
    pub name: &'static str,
    /// Step with the least RMS error among those that fit; none if none fits or all diverge.
    pub best: Option<Best>,
    /// Instructions a sample at which the method reaches the RMS error of this step; none if it never does.
    pub at_equal_error: Option<f64>,
}

/// Best step of a method.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Best {
    /// Steps a sample, with sub-steps for this step; none where the design chose.
    pub steps: Option<u32>,
    /// Link angle over the lost motion, RMS.
    pub link_rms: f64,
    /// Link angle over the lost motion, worst.
    pub link_worst: f64,
    /// Largest mesh force, relative error.
    pub peak_force: f64,
    /// Mean instructions a sample.
    pub instructions: f64,
    /// Largest number of instructions a sample.
    pub instructions_most: u32,
}

impl Best {
    /// Returns true if all required errors are met.
    pub fn meets_requirements(&self) -> bool {
        [self.link_rms, self.link_worst, self.peak_force].iter().zip(REQUIRED).all(|(found, asked)| *found <= asked)
    }
}

/// Best steps of all methods on all cases evaluated by the output angle.
pub fn in_a_sample(cases: &[CaseRecord], entries: &[MethodResult]) -> Vec<InASample> {
    let judged = |entry: &&MethodResult| cases.iter().any(|case| case.key == entry.case && case.by_link_angle);
    let own = |case: &str| {
        let own = entries.iter().find(|entry| entry.case == case && entry.method == Method::Realtime)?;
        best(own)
    };
    let one = |entry: &MethodResult| InASample {
        case: entry.case.clone(),
        name: entry.name,
        best: best(entry),
        at_equal_error: own(&entry.case)
            .and_then(|own| least_cost_at(entry.series(), own.link_rms))
            .map(|cost| cost / f64::from(SAMPLE_RATE)),
    };
    entries.iter().filter(judged).map(one).collect()
}

fn best(entry: &MethodResult) -> Option<Best> {
    let of = |mark: &StepResult| {
        let steps = mark.rate_Hz / SAMPLE_RATE;
        Some(Best {
            steps: (mark.substeps > 0).then_some(steps * mark.substeps),
            link_rms: mark.link_rms?,
            link_worst: mark.link_worst?,
            peak_force: mark.peak_force?,
            instructions: mark.instructions * f64::from(steps),
            instructions_most: mark.sample_instructions_most[0],
        })
    };
    let whole = entry.marks.iter().filter(|mark| mark.rate_Hz.is_multiple_of(SAMPLE_RATE));
    let fitting = whole.filter_map(of).filter(|best| best.instructions <= INSTRUCTIONS);
    fitting.min_by(|a, b| a.link_rms.total_cmp(&b.link_rms))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mark(steps: u32, instructions: f64, link_rms: f64) -> StepResult {
        StepResult {
            rate_Hz: steps * SAMPLE_RATE,
            substeps: 1,
            step: 1.0,
            error: Some(link_rms),
            error_f64: None,
            link_rms: Some(link_rms),
            link_worst: Some(5.0 * link_rms),
            peak_force: Some(0.05),
            instructions,
            instructions_most: 900,
            sample_instructions_most: [900 * steps, 0, 0],
        }
    }

    fn entry(marks: Vec<StepResult>) -> MethodResult {
        MethodResult { case: "R".into(), method: Method::Euler, name: Method::Euler.name(), marks }
    }

    /// The best step has the least error among those that fit.
    #[test]
    fn best_step_has_the_least_error() {
        let found = best(&entry(vec![mark(1, 600.0, 0.1), mark(3, 600.0, 1e-3), mark(4, 600.0, 1e-4)])).unwrap();
        assert_eq!(found.steps, Some(3));
        assert_eq!(found.instructions_most, 2700);
        assert!(found.meets_requirements());
    }

    /// A method that diverges at every step that fits has no best step.
    #[test]
    fn diverging_method_has_no_best_step() {
        let lost = StepResult { link_rms: None, ..mark(1, 600.0, 1.0) };
        assert_eq!(best(&entry(vec![lost, mark(4, 600.0, 1e-4)])), None);
    }
}
