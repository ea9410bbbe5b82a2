//! The record of a replay, for JSON and the report. docs/reference/replay.md explains the keys.

use serde::Serialize;

use crate::pass::{Pass, SourceChange};
use crate::samples::ReplaySamples;
use crate::wiring::WiringFinding;
use identify::findings::Finding;
use joint_file::named::Loaded;
use report::provenance;

/// Name and version of the format.
const SCHEMA: &str = "joint-replay/1";

/// Record of a replay.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ReplayRecord {
    /// Name and version of the format.
    pub schema: String,
    /// Version of the host command.
    pub host_version: String,
    /// Name of the observer's joint.
    pub joint: String,
    /// Name of the log.
    pub log: String,
    /// Control periods of the log.
    pub periods: usize,
    /// Control periods a second [Hz].
    #[serde(rename = "control_rate_Hz")]
    pub control_rate: f64,
    /// Time from the first to the last control period [s].
    pub duration_s: f64,
    /// True if counts were computed from angles, by the resolution of the joint file's encoders.
    pub counts_from_angles: bool,
    /// Changes to the rows of the log, a sentence each.
    pub log_notes: Vec<String>,
    /// Comparison with the run that wrote the log; absent for any other log.
    pub repeats: Option<Repeats>,
    /// Share of the time with both encoders trusted [%].
    pub both_encoders_percent: f64,
    /// Share of the time with a valid gap coordinate [%].
    pub gap_valid_percent: f64,
    /// Changes of the estimates' source.
    pub sources: Vec<SourceChange>,
    /// Changes missing in the list.
    pub sources_left_out: usize,
    /// Control periods with a notice on their samples, by its name.
    pub notices: std::collections::BTreeMap<String, usize>,
    /// Agreement of signs, counts, ratio, torque, rate and clock with the joint file.
    pub wiring: Vec<WiringFinding>,
    /// Estimated parameters at the end.
    pub learnt: Vec<Finding>,
}

/// Comparison of a replay with its run.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Repeats {
    /// True if all estimates of all control periods agree in every bit.
    pub every_bit: bool,
    /// Control periods compared.
    pub periods: usize,
    /// Control periods that differ.
    pub differing_periods: usize,
    /// First difference.
    pub first_difference: Option<Difference>,
}

/// First difference between a replay and its run.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Difference {
    /// First control period that differs in any bit.
    pub period: usize,
    /// Start of this control period [s].
    pub time_s: f64,
    /// First control period with logged values that differ.
    pub values_period: Option<usize>,
    /// Start of that control period [s].
    pub values_time_s: Option<f64>,
    /// Values that differ.
    pub values: Vec<ValueDifference>,
}

/// Value that differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ValueDifference {
    /// Name in the log.
    pub name: String,
    /// Value in the log.
    pub recorded: f64,
    /// Value of the replay.
    pub replayed: f64,
}

impl ReplayRecord {
    /// Record of a pass.
    pub fn new(
        log: &str,
        loaded: &Loaded,
        samples: &ReplaySamples,
        pass: &Pass,
        learnt: Vec<Finding>,
        repeats: Option<Repeats>,
        wiring: Vec<WiringFinding>,
    ) -> Self {
        let percent = |count: usize| 100.0 * count as f64 / samples.len().max(1) as f64;
        Self {
            schema: SCHEMA.to_owned(),
            host_version: provenance::VERSION.to_owned(),
            joint: loaded.file.parameters.name.to_string(),
            log: log.to_owned(),
            periods: samples.len(),
            control_rate: 1.0 / samples.period,
            duration_s: samples.time.last().copied().unwrap_or_default(),
            counts_from_angles: samples.from_angles,
            log_notes: samples.log_notes.clone(),
            repeats,
            both_encoders_percent: percent(pass.both),
            gap_valid_percent: percent(pass.gap_valid),
            sources: pass.sources.clone(),
            sources_left_out: pass.sources_left_out,
            notices: pass.notices.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect(),
            wiring,
            learnt,
        }
    }
}

impl Repeats {
    /// The comparison in one sentence.
    pub fn sentence(&self) -> String {
        let Some(first) = &self.first_difference else {
            return match self.every_bit {
                true => format!("the observer repeats the run: {} control periods, every bit", self.periods),
                false => format!("{} control periods of the run are not in its log", self.differing_periods),
            };
        };
        let Difference { period, time_s, values, .. } = first;
        let mut sentence = format!(
            "the observer does not repeat the run: the first difference is in control period {period}, t = {time_s:.4} s"
        );
        if let (Some(value), Some(time)) = (values.first(), first.values_time_s) {
            let ValueDifference { name, recorded, replayed } = value;
            sentence += &format!("; {name} at t = {time:.4} s is {recorded:e} in the log, {replayed:e} here");
        }
        sentence
    }
}
