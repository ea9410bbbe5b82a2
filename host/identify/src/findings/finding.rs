//! One identified parameter with its interval and its key in the joint file, or the reason why the log does not
//! determine it.

use report::number::ESTIMATE;
use schemars::JsonSchema;
use serde::Serialize;

use crate::estimate::Estimate;

/// A value counts as found if half of its interval is at most this share of the value.
pub(crate) const FOUND_INTERVAL_SHARE: f64 = 0.5;
/// Reason for an unknown that is confounded with others.
pub(super) const CONFOUNDED: &str = "in this motion it goes with something else, as in a sine of one strength; reverse torques of \
                                   three or four different strengths, and swing slowly too";
/// Model error of two inertias on a spring, relative; widens every interval. Measured on simulated logs of the presets,
/// where the scatter alone gave too narrow intervals.
const MODEL_ERROR: f64 = 0.003;

/// One parameter.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Finding {
    /// Name of the parameter.
    pub name: String,
    /// Unit of the numbers.
    pub unit: String,
    /// Key of the joint file, if it has one.
    pub key: Option<String>,
    /// Best value; absent if the log does not determine it.
    pub value: Option<f64>,
    /// Lower and upper end of the 95 % interval; without a value, zero and an upper bound if the log gives one.
    pub interval: Option<[f64; 2]>,
    /// Reason for a missing value, or a remark on the value.
    pub note: String,
    /// The value is the joint file's, not contradicted by the log.
    #[serde(skip)]
    pub(crate) repeats: bool,
}

/// Finding of an estimate in the unit of its key.
pub(crate) fn finding(name: &str, unit: &str, key: &str, estimate: Estimate) -> Finding {
    let Estimate { value, half } = estimate;
    let half = half + MODEL_ERROR * value.abs();
    Finding {
        name: name.into(),
        unit: unit.into(),
        key: (!key.is_empty()).then(|| key.to_owned()),
        value: Some(value),
        interval: Some([value - half, value + half]),
        note: String::new(),
        repeats: false,
    }
}

impl Finding {
    /// Removes the value, with the reason, unless `so` is true and the value is finite.
    pub(crate) fn only_if(self, so: bool, why: &str) -> Self {
        let finite = self.value.is_some_and(f64::is_finite)
            && self.interval.is_some_and(|ends| ends.iter().all(|end| end.is_finite()));
        // A value missing for another reason keeps that reason.
        if so && (finite || self.value.is_none()) {
            return self;
        }
        Self { value: None, interval: None, note: format!("not identifiable from this log: {why}"), ..self }
    }

    /// Adds an upper bound to a missing value.
    pub(crate) fn with_upper_bound(self, bound: f64) -> Self {
        if self.value.is_some() || !bound.is_finite() {
            return self;
        }
        let note = format!("at most {} {}; {}", ESTIMATE.write(bound), self.unit, self.note);
        Self { interval: Some([0.0, bound]), note, ..self }
    }

    pub(crate) fn with_note(self, note: impl Into<String>) -> Self {
        if self.value.is_none() { self } else { Self { note: note.into(), ..self } }
    }

    /// Marks the value as the joint file's, not contradicted by the log.
    pub(super) fn unchanged(self) -> Self {
        Self { repeats: true, ..self }
    }

    /// Returns true if the log adds to the joint file.
    pub(crate) fn adds_information(&self) -> bool {
        self.value.is_some() && !self.repeats
    }

    /// Limits value and interval to zero and above; an interval entirely below zero is kept, for the check of the log.
    pub(crate) fn not_negative(mut self) -> Self {
        if self.interval.is_some_and(|[_, high]| high < 0.0) {
            return self;
        }
        self.value = self.value.map(|value| value.max(0.0));
        self.interval = self.interval.map(|ends| ends.map(|end| end.max(0.0)));
        self
    }

    /// Returns true for a friction.
    pub(crate) fn is_friction(&self) -> bool {
        self.key.as_deref().is_some_and(|key| key.contains("friction"))
    }

    /// Replaces a friction below zero by zero, up to half of its interval; for frictions that chance explains.
    pub(crate) fn with_clamped_friction(self) -> Self {
        match self.interval {
            Some([low, high]) if high < 0.0 && self.is_friction() => {
                Self { value: Some(0.0), interval: Some([0.0, 0.5 * (high - low)]), ..self }
            }
            _ => self,
        }
    }
}
