//! Conclusions from the figures: instructions at equal error, error within a board's budget, rounding, host times.

use comparison::method::Method;
use serde::Serialize;

use super::libraries::Time;
use super::method_results::{MethodResult, StepResult};

/// Cycles per instruction where no trace weighs them: a Cortex-M4F without wait states on similar code.
pub const CYCLES_PER_INSTRUCTION: f64 = 1.4;
/// Clock of the board for which budgets are stated [Hz].
pub const CLOCK_RATE: f64 = 168e6;
/// Share of the processor available to the joint.
const PROCESSOR_SHARE: f64 = 0.5;
/// Largest ratio of the worst sample to the budget.
const WORST_SAMPLE_RATIO: f64 = 1.5;
/// Error levels of the comparison.
pub const ERROR_LEVELS: [f64; 2] = [1e-3, 1e-4];

/// Cost of reaching an error.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct AtError {
    /// Case.
    pub case: String,
    /// Method.
    pub name: String,
    /// Error level.
    pub error: f64,
    /// Cost at this error, interpolated between two steps or tolerances; none if it was not reached.
    pub cost: Option<f64>,
    /// Cost over the cost of this step.
    pub ratio: Option<f64>,
}

/// Least error within half a board.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "units are spelled as in every file that this command writes")]
pub struct InBudget {
    /// Case.
    pub case: String,
    /// Method.
    pub name: &'static str,
    /// Samples a second [Hz].
    pub sample_rate_Hz: u32,
    /// Steps a sample; none if no step fits.
    pub steps: Option<u32>,
    /// Error of these steps.
    pub error: Option<f64>,
    /// Mean cycles a sample.
    pub cycles: Option<f64>,
    /// Largest number of cycles a sample.
    pub cycles_most: Option<f64>,
}

/// Sample rates of `StepResult::sample_instructions_most`.
const SAMPLE_RATES: [u32; 3] = [10_000, 20_000, 40_000];

/// Instructions a second of the joint at equal error, method by method.
pub fn at_equal_error(entries: &[MethodResult]) -> Vec<AtError> {
    let cost = |entry: &MethodResult, level: f64| least_cost_at(entry.series(), level);
    let of_step = |case: &str, level: f64| {
        let own = entries.iter().find(|entry| entry.case == case && entry.method == Method::Realtime)?;
        cost(own, level)
    };
    let levels = |entry: &'_ MethodResult| {
        let (case, name) = (entry.case.clone(), entry.name.to_owned());
        ERROR_LEVELS.map(|level| ratio(case.clone(), name.clone(), level, cost(entry, level), of_step(&case, level)))
    };
    entries.iter().filter(|entry| entry.method.has_meshes()).flat_map(levels).collect()
}

/// Processor time at equal error, library by library; this step with the faster of its two scalars.
pub fn host_at_equal_error(times: &[Time]) -> Vec<AtError> {
    let mut names: Vec<(&str, &str)> = Vec::new();
    for time in times {
        let name = (time.case.as_str(), time.name.as_str());
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let curve = |case: &str, name: &str| curve(times, case, name);
    let own = |case: &str, level: f64| {
        let both = names.iter().filter(|name| name.0 == case && name.1.starts_with("this step"));
        both.filter_map(|name| cost_at(&curve(case, name.1), level)).min_by(f64::total_cmp)
    };
    let level = |(case, name): &(&str, &str), level: f64| {
        ratio((*case).into(), (*name).into(), level, cost_at(&curve(case, name), level), own(case, level))
    };
    names.iter().flat_map(|name| ERROR_LEVELS.map(|error| level(name, error))).collect()
}

/// Cost and error of a method on the host.
pub fn curve(times: &[Time], case: &str, name: &str) -> Vec<(f64, f64)> {
    let of = times.iter().filter(|time| time.case == case && time.name == name);
    pareto_front(of.filter_map(|time| Some((time.cost, time.error?))).collect())
}

fn ratio(case: String, name: String, error: f64, cost: Option<f64>, own: Option<f64>) -> AtError {
    AtError { case, name, error, cost, ratio: cost.zip(own).map(|(cost, own)| cost / own) }
}

/// Pareto front: points that no other point undercuts in both cost and error, from cheap to expensive.
pub fn pareto_front(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut least = f64::INFINITY;
    points.retain(|point| {
        let better = point.1 < least;
        least = least.min(point.1);
        better
    });
    points
}

/// Least cost at an error over several curves.
pub fn least_cost_at(curves: Vec<Vec<(f64, f64)>>, error: f64) -> Option<f64> {
    curves.iter().filter_map(|curve| cost_at(curve, error)).min_by(f64::total_cmp)
}

/// Cost at which a curve, from cheap to expensive, first reaches an error: interpolated linearly in logarithms.
fn cost_at(curve: &[(f64, f64)], error: f64) -> Option<f64> {
    let first = curve.iter().position(|point| point.1 <= error)?;
    let (cost, below) = curve[first];
    let Some((dearer, above)) = first.checked_sub(1).map(|before| curve[before]) else { return Some(cost) };
    let part = (above / error).ln() / (above / below).ln();
    Some((dearer.ln() + part * (cost / dearer).ln()).exp())
}

/// Least error of every method within half a 168 MHz Cortex-M4F, for each sample rate.
pub fn in_budget(entries: &[MethodResult]) -> Vec<InBudget> {
    let one = |entry: &MethodResult, index: usize| {
        let sample_rate = SAMPLE_RATES[index];
        let budget = PROCESSOR_SHARE * CLOCK_RATE / f64::from(sample_rate);
        let ticks = |mark: &StepResult| mark.rate_Hz / sample_rate;
        let cycles = |mark: &StepResult| CYCLES_PER_INSTRUCTION * mark.instructions * f64::from(ticks(mark));
        let most = |mark: &StepResult| CYCLES_PER_INSTRUCTION * f64::from(mark.sample_instructions_most[index]);
        let fitting = entry.marks.iter().filter(|mark| {
            mark.rate_Hz.is_multiple_of(sample_rate)
                && cycles(mark) <= budget
                && most(mark) <= WORST_SAMPLE_RATIO * budget
        });
        let with_error = fitting.filter_map(|mark| Some((mark, mark.error?)));
        let best = with_error.min_by(|a, b| a.1.total_cmp(&b.1));
        InBudget {
            case: entry.case.clone(),
            name: entry.name,
            sample_rate_Hz: sample_rate,
            steps: best.map(|(mark, _)| ticks(mark) * mark.substeps.max(1)),
            error: best.map(|(_, error)| error),
            cycles: best.map(|(mark, _)| cycles(mark)),
            cycles_most: best.map(|(mark, _)| most(mark)),
        }
    };
    let rates = |entry| [0, 1, 2].map(|index| one(entry, index));
    entries.iter().filter(|entry| entry.method.has_meshes()).flat_map(rates).collect()
}

/// f32 against f64 by step: error added by rounding.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Rounding {
    /// Case.
    pub case: String,
    /// h omega_n.
    pub step: f64,
    /// Error in f32.
    pub single: f64,
    /// Error in f64.
    pub double: f64,
    /// Part of the f32 error due to rounding, if both parts add as independent errors.
    pub rounding: f64,
}

/// Steps at which rounding is evaluated: at coarser steps the method's own error hides it.
const ROUNDING_STEPS: (f64, f64) = (0.04, 0.3);

/// Rounding of this step; steps with the motion of another step, since contact held, appear once.
pub fn rounding(entries: &[MethodResult]) -> Vec<Rounding> {
    let mut all: Vec<Rounding> = Vec::new();
    for entry in entries.iter().filter(|entry| entry.method == Method::Realtime) {
        // The shortest ticks with several numbers of sub-steps suffice: rounding depends on the sub-step.
        let stated = || entry.marks.iter().filter(|mark| mark.substeps > 1);
        let series = |rate: &u32| stated().filter(|mark| mark.rate_Hz == *rate).count() > 1;
        let ticks = stated().map(|mark| mark.rate_Hz).filter(series).max().unwrap_or_default();
        let inside =
            |mark: &&StepResult| mark.rate_Hz == ticks && (ROUNDING_STEPS.0..=ROUNDING_STEPS.1).contains(&mark.step);
        for mark in entry.marks.iter().filter(inside) {
            let (Some(single), Some(double)) = (mark.error, mark.error_f64) else { continue };
            let like = |other: &Rounding| other.case == entry.case && (other.double / double - 1.0).abs() < 0.01;
            if !all.iter().any(like) {
                let rounding = (single * single - double * double).max(0.0).sqrt();
                all.push(Rounding { case: entry.case.clone(), step: mark.step, single, double, rounding });
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cost at an error is interpolated in logarithms.
    #[test]
    fn cost_is_interpolated_in_logarithms() {
        let curve = [(1.0, 1e-2), (10.0, 1e-4), (100.0, 1e-6)];
        let cost = cost_at(&curve, 1e-3).unwrap();
        assert!((cost - 10f64.sqrt()).abs() < 1e-12, "{cost}");
        let at_a_point = cost_at(&curve, 1e-4).unwrap();
        assert!((at_a_point - 10.0).abs() < 1e-12, "{at_a_point}");
    }

    /// A point that another point undercuts is not on the front.
    #[test]
    fn undercut_points_leave_the_front() {
        assert_eq!(pareto_front(vec![(3.0, 1.0), (1.0, 9.0), (2.0, 10.0), (4.0, 2.0)]), [(1.0, 9.0), (3.0, 1.0)]);
    }

    /// An unreached error has no cost.
    #[test]
    fn unreached_error_has_no_cost() {
        assert_eq!(cost_at(&[(1.0, 1e-2)], 1e-3), None);
        assert_eq!(cost_at(&[(1.0, 1e-4)], 1e-3), Some(1.0));
    }
}
