//! From the seeds' metrics to verdicts: one for each assertion. An assertion whose metric could not be computed fails.

use super::controller::ControllerName;
use super::file::{Aggregate, Assertion, TestFile};
use super::record::AssertionRecord;
use super::values::MetricValues;
use report::checks::{Bound, Verdict};
use report::number::PAGE;

/// Metrics of all runs of a test.
pub struct Results<'r> {
    /// Seeds that were to run.
    pub seeds: &'r [u64],
    /// By seed and controller.
    pub of: &'r dyn Fn(u64, ControllerName) -> Option<MetricValues>,
}

/// Judges every assertion of a file.
pub fn judge(file: &TestFile, results: &Results<'_>) -> Vec<AssertionRecord> {
    file.assertions.iter().map(|assertion| one(file, assertion, results)).collect()
}

fn one(file: &TestFile, assertion: &Assertion, results: &Results<'_>) -> AssertionRecord {
    let value = |seed: u64| {
        let own = (results.of)(seed, file.controller)?;
        own.of_named(&assertion.metric, |other| (results.of)(seed, other))
    };
    let figures: Vec<(u64, Option<f64>)> = results.seeds.iter().map(|seed| (*seed, value(*seed))).collect();
    let missing: Vec<u64> = figures.iter().filter(|(_, figure)| figure.is_none()).map(|(seed, _)| *seed).collect();
    let had: Vec<(u64, f64)> = figures.iter().filter_map(|(seed, figure)| Some((*seed, (*figure)?))).collect();
    let worst =
        had.iter().copied().reduce(|a, b| if off(assertion.bound, b.1) > off(assertion.bound, a.1) { b } else { a });
    let figure = match assertion.aggregate {
        Aggregate::Worst => worst.map(|(_, figure)| figure),
        Aggregate::Median => median(had.iter().map(|(_, figure)| *figure).collect()),
        Aggregate::Mean => (!had.is_empty()).then(|| had.iter().map(|(_, f)| f).sum::<f64>() / had.len() as f64),
    };
    let holds = missing.is_empty() && figure.is_some_and(|figure| assertion.bound.holds(figure));
    let mut note = assertion.metric.base().meaning.to_owned();
    if let Some(other) = assertion.rival() {
        note += &format!("; against {}", other.label());
    }
    if had.len() > 1 {
        let all = || had.iter().map(|(_, figure)| *figure);
        let (least, greatest) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        note += &format!("; {} seeds from {} to {}", had.len(), PAGE.write(least), PAGE.write(greatest));
    }
    if let Some(first) = missing.first() {
        let why = absence(assertion.metric.base().stem);
        note = format!("could not be had with seed {first}: {why}; {note}");
    }
    AssertionRecord {
        name: assertion.name.clone(),
        aggregate: assertion.aggregate.word().to_owned(),
        figure,
        unit: match assertion.rival() {
            None => assertion.metric.base().printed_unit().to_owned(),
            Some(_) => String::new(),
        },
        bound: assertion.bound,
        verdict: if holds { Verdict::Passed } else { Verdict::Failed },
        seed: missing.first().copied().or(worst.map(|(seed, _)| seed)),
        note,
    }
}

/// Why a run has no such figure.
fn absence(stem: &str) -> &'static str {
    match stem {
        "gap_error_valid" | "gap_surprise" => "the observer never vouched for the gap, or the run broke off",
        "landing_delay_median" | "landing_delay_p95" => "no landing was reported, or the run broke off",
        "reversal_error" => "the wanted motion has no reversal after settle_s, or the run broke off",
        "probe_error" => "the width probe refused, or the run broke off",
        "probe_time" | "probe_refused" => "the run ended before the width probe did",
        _ => "the run has no such figure, or broke off",
    }
}

/// How far a figure is on the wrong side of a bound.
fn off(bound: Bound, figure: f64) -> f64 {
    match bound {
        Bound::AtMost(bound) => figure - bound,
        Bound::AtLeast(bound) => bound - figure,
        Bound::Exactly(wanted) => (figure - wanted).abs(),
        Bound::None => 0.0,
    }
}

fn median(mut figures: Vec<f64>) -> Option<f64> {
    figures.sort_by(f64::total_cmp);
    let middle = figures.len() / 2;
    match figures.len() {
        0 => None,
        count if count % 2 == 1 => Some(figures[middle]),
        _ => Some(0.5 * (figures[middle - 1] + figures[middle])),
    }
}
