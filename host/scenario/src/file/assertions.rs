//! Reads `[assert]`: named figures and their bounds, by default for the worst seed.

use std::ops::Range;

use joint_file::Notes;
use toml::Spanned;
use toml::de::DeValue;

use super::motion::MotionProfile;
use super::section::{Section, number};
use crate::controller::ControllerName;
use crate::metrics::{NamedMetric, Relation, Requirement as Scope, assertable_names, rival_names};
use report::checks::Bound;

/// One bound on one figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Assertion {
    /// Figure.
    pub metric: NamedMetric,
    /// Name of the figure as typed.
    pub name: String,
    /// Aggregate over the seeds.
    pub aggregate: Aggregate,
    /// Bound.
    pub bound: Bound,
}

/// Aggregate of a figure over the seeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Aggregate {
    /// Figure farthest on the wrong side of the bound.
    Worst,
    /// Median.
    Median,
    /// Mean.
    Mean,
    /// Worst figure after this share of the worst seeds has been left out [%].
    AllBut(f64),
}

/// Key of the share of the seeds that may exceed a bound.
const ALL_BUT: &str = "all_but_percent";

/// Properties of a test that decide which figures it has.
pub(super) struct TestTraits<'a> {
    pub controller: Option<ControllerName>,
    pub gains: bool,
    pub profile: Option<&'a MotionProfile>,
}

impl Aggregate {
    /// Name of the aggregate.
    pub fn word(self) -> String {
        match self {
            Self::Worst => "worst".to_owned(),
            Self::Median => "median".to_owned(),
            Self::Mean => "mean".to_owned(),
            Self::AllBut(percent) => format!("all but {percent} %"),
        }
    }
}

impl Assertion {
    /// Controller that must run for comparison, if the figure needs one.
    pub fn rival(&self) -> Option<ControllerName> {
        match self.metric.relation {
            Relation::Own => None,
            Relation::GainOver(rival) | Relation::RatioTo(rival) | Relation::Of(rival) => Some(rival),
        }
    }
}

/// Reads the section.
pub(super) fn read(top: &Section<'_>, test: &TestTraits<'_>) -> Vec<Assertion> {
    let mut assertions = Vec::new();
    let Some((_, table)) = top.table("assert") else { return assertions };
    for (name, value) in table {
        let word = name.get_ref().as_ref();
        let Some(metric) = NamedMetric::find(word, test.gains) else {
            let help = suggestion(word, test.gains);
            top.notes.error(name.span(), format!("there is no figure `{word}` in this test"), help);
            continue;
        };
        if let Some((message, help)) = unavailable(&metric, test) {
            top.notes.error(name.span(), format!("`{word}` {message}"), help);
            continue;
        }
        let mut add = |aggregate, value: &Spanned<DeValue<'_>>| {
            if let Some(bound) = bound(value, top.notes) {
                assertions.push(Assertion { metric, name: word.to_owned(), aggregate, bound });
            }
        };
        match value.get_ref() {
            DeValue::Table(inner) if inner.contains_key(ALL_BUT) => {
                let percent = inner.get(ALL_BUT).and_then(number).filter(|percent| (0.0..100.0).contains(percent));
                match (percent, inner.get("bound").filter(|_| inner.len() == 2)) {
                    (Some(percent), Some(bound)) => add(Aggregate::AllBut(percent), bound),
                    _ => top.notes.error(
                        value.span(),
                        format!("`{ALL_BUT}` takes a bound and a part of the seeds in percent, from 0 to below 100"),
                        "write { bound = \">= 1\", all_but_percent = 0.5 }",
                    ),
                }
            }
            DeValue::Table(inner) => {
                if inner.is_empty() {
                    let message = format!("`{word}` has no bound");
                    top.notes.error(value.span(), message, "write a bound, such as { median = \">= 3\" }");
                }
                for (aggregate, value) in inner {
                    match aggregate.get_ref().as_ref() {
                        "worst" => add(Aggregate::Worst, value),
                        "median" => add(Aggregate::Median, value),
                        "mean" => add(Aggregate::Mean, value),
                        other => top.notes.error(
                            aggregate.span(),
                            format!("`{other}` cannot be made of the seeds' figures"),
                            "write worst, median or mean, as in { median = \">= 3\", worst = \">= 1\" }, or bound with \
                             all_but_percent",
                        ),
                    }
                }
            }
            _ => add(Aggregate::Worst, value),
        }
    }
    assertions
}

/// Help for an unknown figure: the most likely name.
fn suggestion(word: &str, impedance: bool) -> String {
    let whom = word.split_once("_gain_over_").or(word.split_once("_ratio_to_"));
    let words: Vec<&str> = rival_names(impedance).into_iter().map(|(word, _)| word).collect();
    if let Some((_, whom)) = whom.filter(|(_, whom)| !words.contains(whom)) {
        return format!("`{whom}` does not run in this test; there are {}", words.join(", "));
    }
    match joint_file::nearest(word, assertable_names(impedance).iter().map(String::as_str)) {
        Some(near) => format!("did you mean `{near}`?"),
        None => "docs/reference/hil-file.md lists all figures, such as rms_mrad and rms_gain_over_pid".to_owned(),
    }
}

/// Reason and help if a figure is not available in a test.
fn unavailable(metric: &NamedMetric, test: &TestTraits<'_>) -> Option<(&'static str, &'static str)> {
    match metric.base().requires {
        Scope::Motion => None,
        Scope::Impedance => {
            (!test.gains).then_some(("is for impedances", "write mode = \"impedance\" in [controller]"))
        }
        Scope::Observer => test.controller.is_some_and(|controller| !controller.is_compensation()).then_some((
            "is about the observer, and this controller has none",
            "write mode = \"preview\", \"no_preview\" or \"impedance\" in [controller]",
        )),
        Scope::Probe => test
            .controller
            .is_some_and(|controller| controller != ControllerName::Probe)
            .then_some(("is about the width probe", "write mode = \"probe\" in [controller], or profile = \"held\"")),
        Scope::Loop => test
            .profile
            .is_some_and(|profile| profile.kind != "hysteresis")
            .then_some(("is read off a loop of a slow torque", "write profile = \"hysteresis\"")),
    }
}

/// Parses `>= 8`, `<= 0.8` or `== 0`.
fn bound(value: &Spanned<DeValue<'_>>, notes: &Notes<'_>) -> Option<Bound> {
    const HELP: &str = "write a bound as a string, such as \">= 8\", \"<= 0.8\" or \"== 0\"";
    let refuse = |span: Range<usize>| -> Option<Bound> {
        notes.error(span, "not a bound", HELP);
        None
    };
    let DeValue::String(text) = value.get_ref() else { return refuse(value.span()) };
    let Some((sign, number)) = text.trim().split_at_checked(2) else { return refuse(value.span()) };
    let Some(number) = number.trim().parse().ok().filter(|number: &f64| number.is_finite()) else {
        return refuse(value.span());
    };
    match sign {
        ">=" => Some(Bound::AtLeast(number)),
        "<=" => Some(Bound::AtMost(number)),
        "==" => Some(Bound::Exactly(number)),
        _ => refuse(value.span()),
    }
}
