//! Results of an observer's pass over a log: counts of its states, and points for pictures.

use std::collections::BTreeMap;

use model_core::observer::{Estimate, Estimates, Source};
use scenario::estimate_fields::{WORD_FIELDS, notices};
use serde::Serialize;

use crate::samples::ReplaySamples;
use report::contacts::Contact;

/// Points kept for pictures at most.
const POINTS_MAX: usize = 200_000;
/// Changes of source listed at most.
const CHANGES_MAX: usize = 50;
/// Half of a 95 % interval over the standard deviation.
const NORMAL_QUANTILE: f64 = 1.96;

/// Source of the estimates from a time on.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SourceChange {
    /// Time since the first control period [s].
    pub time_s: f64,
    /// `both`, `motor_only` or `nothing`.
    pub estimates_from: String,
    /// Fault of an encoder, such as `output_frozen`; `none` otherwise.
    pub encoder_fault: String,
}

/// Value with half of its interval.
#[derive(Debug, Clone, Copy, Default)]
pub struct Interval {
    /// Best guess.
    pub value: f64,
    /// Half of the 95 % interval.
    pub half: f64,
}

/// Point of the pictures.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// Time [s].
    pub time: f64,
    /// Commanded motor torque [N m].
    pub torque: f64,
    /// Gap coordinate [m].
    pub gap: Interval,
    /// True if the gap coordinate is valid.
    pub gap_valid: bool,
    /// Estimated half-backlash [m].
    pub half_backlash: Interval,
    /// Load torque [N m].
    pub load_torque: Interval,
    /// Flank that carries.
    pub side: Contact,
    /// True if the flank is valid.
    pub side_valid: bool,
    /// True if both encoders are used.
    pub both: bool,
}

/// Pass of an observer over a log.
pub struct Pass<'s> {
    samples: &'s ReplaySamples,
    every: usize,
    /// Points of the pictures.
    pub points: Vec<Point>,
    /// Periods in which both encoders were trusted.
    pub both: usize,
    /// Periods in which the gap was valid.
    pub gap_valid: usize,
    /// First changes of source.
    pub sources: Vec<SourceChange>,
    /// Number of further changes.
    pub sources_left_out: usize,
    /// Periods with a notice, by its name.
    pub notices: BTreeMap<&'static str, usize>,
    source: Option<Source>,
}

impl<'s> Pass<'s> {
    /// Empty pass, before the first samples.
    pub fn new(samples: &'s ReplaySamples) -> Self {
        Self {
            samples,
            every: samples.len().div_ceil(POINTS_MAX).max(1),
            points: Vec::new(),
            both: 0,
            gap_valid: 0,
            sources: Vec::new(),
            sources_left_out: 0,
            notices: BTreeMap::new(),
            source: None,
        }
    }

    /// Adds the estimates of a period.
    pub fn add(&mut self, index: usize, of: &Estimates<f32>) {
        let time = self.samples.time[index];
        self.both += usize::from(of.source == Source::Both);
        self.gap_valid += usize::from(of.gap.valid);
        notices(of).into_iter().for_each(|name| *self.notices.entry(name).or_default() += 1);
        if self.source.replace(of.source) != Some(of.source) {
            let [estimates_from, encoder_fault] =
                ["estimates_from", "encoder_fault"].map(|name| word(name, of).to_owned());
            if self.sources.len() < CHANGES_MAX {
                self.sources.push(SourceChange { time_s: time, estimates_from, encoder_fault });
            } else {
                self.sources_left_out += 1;
            }
        }
        if index.is_multiple_of(self.every) {
            self.points.push(Point {
                time,
                torque: self.samples.torque[index],
                gap: interval(of.gap),
                gap_valid: of.gap.valid,
                half_backlash: interval(of.half_backlash),
                load_torque: interval(of.load_torque),
                side: Contact::try_from(of.reported_contact.code()).unwrap_or(Contact::Separated),
                side_valid: of.contact_valid,
                both: of.source == Source::Both,
            });
        }
    }
}

fn word(name: &str, of: &Estimates<f32>) -> &'static str {
    WORD_FIELDS.iter().find(|field| field.name == name).map_or("", |field| (field.word)(of))
}

fn interval(of: Estimate<f32>) -> Interval {
    Interval { value: of.value.into(), half: NORMAL_QUANTILE * f64::from(of.variance.max(0.0)).sqrt() }
}
