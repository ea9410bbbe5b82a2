//! Verdicts from the metrics of the seeds, one for each assertion. An assertion whose metric could not be computed
//! fails.

use super::controller::ControllerName;
use super::file::{Aggregate, Assertion, TestFile};
use super::metrics::Relation;
use super::record::AssertionRecord;
use super::values::MetricValues;
use report::checks::{Bound, Verdict};
use report::number::PAGE;

/// Largest number of seeds beyond a bound that are listed.
const MAX_LISTED_SEEDS: usize = 12;

/// Metrics of all runs of a test.
pub struct Results<'r> {
    /// Seeds of the test.
    pub seeds: &'r [u64],
    /// Metrics by seed and controller.
    pub values_of: &'r dyn Fn(u64, ControllerName) -> Option<MetricValues>,
}

/// Verdicts of every assertion of a file.
pub fn check_assertions(file: &TestFile, results: &Results<'_>) -> Vec<AssertionRecord> {
    file.assertions.iter().map(|assertion| check_assertion(file, assertion, results)).collect()
}

fn check_assertion(file: &TestFile, assertion: &Assertion, results: &Results<'_>) -> AssertionRecord {
    let value = |seed: u64| {
        let own = (results.values_of)(seed, file.controller)?;
        own.named_value(&assertion.metric, |other| (results.values_of)(seed, other))
    };
    let figures: Vec<(u64, Option<f64>)> = results.seeds.iter().map(|seed| (*seed, value(*seed))).collect();
    let missing: Vec<u64> = figures.iter().filter(|(_, figure)| figure.is_none()).map(|(seed, _)| *seed).collect();
    let had: Vec<(u64, f64)> = figures.iter().filter_map(|(seed, figure)| Some((*seed, (*figure)?))).collect();
    let worst = had
        .iter()
        .copied()
        .reduce(|a, b| if excess(assertion.bound, b.1) > excess(assertion.bound, a.1) { b } else { a });
    let figure = match assertion.aggregate {
        Aggregate::Worst => worst.map(|(_, figure)| figure),
        Aggregate::Median => median(had.iter().map(|(_, figure)| *figure).collect()),
        Aggregate::AllBut(percent) => {
            all_but(percent, assertion.bound, had.iter().map(|(_, figure)| *figure).collect())
        }
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
    note += &seeds_beyond(assertion.bound, &had);
    if let Some(first) = missing.first() {
        let why = missing_reason(assertion.metric.base().stem);
        note = format!("could not be had with seed {first}: {why}; {note}");
    }
    AssertionRecord {
        name: assertion.name.clone(),
        aggregate: assertion.aggregate.word(),
        figure,
        unit: match assertion.rival().filter(|_| !matches!(assertion.metric.relation, Relation::Of(_))) {
            None => assertion.metric.base().printed_unit().to_owned(),
            Some(_) => String::new(),
        },
        bound: assertion.bound,
        verdict: if holds { Verdict::Passed } else { Verdict::Failed },
        seed: missing.first().copied().or(worst.map(|(seed, _)| seed)),
        note,
    }
}

/// List of seeds beyond a bound, worst first, so that each can be repeated.
fn seeds_beyond(bound: Bound, figures: &[(u64, f64)]) -> String {
    let mut beyond: Vec<(u64, f64)> = figures.iter().copied().filter(|(_, figure)| !bound.holds(*figure)).collect();
    if beyond.is_empty() || figures.len() < 2 {
        return String::new();
    }
    beyond.sort_by(|a, b| excess(bound, b.1).total_cmp(&excess(bound, a.1)));
    let share = 100.0 * beyond.len() as f64 / figures.len() as f64;
    let named: Vec<String> = beyond
        .iter()
        .take(MAX_LISTED_SEEDS)
        .map(|(seed, figure)| format!("{seed} ({})", PAGE.write(*figure)))
        .collect();
    let more = if beyond.len() > MAX_LISTED_SEEDS { " ..." } else { "" };
    format!("; beyond the bound {} of them ({} %): seeds {}{more}", beyond.len(), PAGE.write(share), named.join(", "))
}

/// Figure farthest on the wrong side of a bound after the worst share has been left out.
fn all_but(percent: f64, bound: Bound, mut figures: Vec<f64>) -> Option<f64> {
    figures.sort_by(|a, b| excess(bound, *b).total_cmp(&excess(bound, *a)));
    let left_out = (0.01 * percent * figures.len() as f64 + 1e-9) as usize;
    figures.get(left_out).copied()
}

/// Reason for a missing figure.
fn missing_reason(stem: &str) -> &'static str {
    match stem {
        "gap_error_valid" | "gap_surprise" => "the observer never vouched for the gap, or the run broke off",
        "landing_delay_median" | "landing_delay_p95" => "no landing was reported, or the run broke off",
        "reversal_error" => "the wanted motion has no reversal after settle_s, or the run broke off",
        "probe_error" => "the width probe refused, or the run broke off",
        "probe_time" | "probe_refused" => "the run ended before the width probe did",
        _ => "the run has no such figure, or broke off",
    }
}

/// Distance of a figure on the wrong side of a bound.
fn excess(bound: Bound, figure: f64) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn worst_share_left_out_and_listed() {
        let gains: Vec<f64> = (0..200).map(|seed| f64::from(seed) / 100.0).collect();
        assert_eq!(all_but(0.0, Bound::AtLeast(1.0), gains.clone()), Some(0.0));
        assert_eq!(all_but(0.5, Bound::AtLeast(1.0), gains.clone()), Some(0.01));
        assert_eq!(all_but(0.5, Bound::AtMost(1.0), gains.clone()), Some(1.98));
        assert_eq!(all_but(0.4, Bound::AtMost(1.0), gains), Some(1.99));
        let named = seeds_beyond(Bound::AtLeast(1.0), &[(7, 0.8), (8, 2.0), (9, 0.5), (10, 1.0)]);
        assert_eq!(named, "; beyond the bound 2 of them (50 %): seeds 9 (0.5), 7 (0.8)");
    }
}
