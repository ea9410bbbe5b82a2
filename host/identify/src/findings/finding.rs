//! One identified parameter with its interval and its key in the joint file, or the reason why it could not be
//! identified.

use report::number::ESTIMATE;
use serde::Serialize;

use crate::estimate::Estimate;

/// A value counts as found if half of its interval is at most this share of it.
pub(crate) const SHARE: f64 = 0.5;
/// Why an unknown is not found that goes with others.
pub(super) const TOGETHER: &str = "in this motion it goes with something else, as in a sine of one strength; reverse torques of \
                                   three or four different strengths, and swing slowly too";
/// What two inertias on a spring leave out of a joint, as a share of a value: widens every interval. Found on simulated
/// logs of the presets, where the scatter alone promised more than the reference keeps.
const MODEL_SHARE: f64 = 0.003;

/// One parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(any(test, feature = "schema"), derive(schemars::JsonSchema))]
pub struct Finding {
    /// What it is.
    pub name: String,
    /// Unit of the numbers.
    pub unit: String,
    /// Key of the joint file that it belongs to.
    pub key: Option<String>,
    /// Best value; absent if the log does not show it.
    pub value: Option<f64>,
    /// Lower and upper end of the 95 % interval; without a value zero and what it is at most, if the log shows that.
    pub interval: Option<[f64; 2]>,
    /// Why the log does not show it, or what to know about the value.
    pub note: String,
    /// The value is the joint file's, which the log only does not contradict.
    #[serde(skip)]
    pub(crate) repeats: bool,
}

/// What an estimate in the unit of its key comes to.
pub(crate) fn finding(name: &str, unit: &str, key: &str, estimate: Estimate) -> Finding {
    let Estimate { value, half } = estimate;
    let half = half + MODEL_SHARE * value.abs();
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
    /// Nothing, for a reason, unless it is so.
    pub(crate) fn if_so(self, so: bool, why: &str) -> Self {
        let finite = self.value.is_some_and(f64::is_finite)
            && self.interval.is_some_and(|ends| ends.iter().all(|end| end.is_finite()));
        // What is not found for another reason keeps it.
        if so && (finite || self.value.is_none()) {
            return self;
        }
        Self { value: None, interval: None, note: format!("not identifiable from this log: {why}"), ..self }
    }

    /// With an upper bound of what is not found.
    pub(crate) fn at_most(self, bound: f64) -> Self {
        if self.value.is_some() || !bound.is_finite() {
            return self;
        }
        let note = format!("at most {} {}; {}", ESTIMATE.write(bound), self.unit, self.note);
        Self { interval: Some([0.0, bound]), note, ..self }
    }

    pub(crate) fn noted(self, note: impl Into<String>) -> Self {
        if self.value.is_none() { self } else { Self { note: note.into(), ..self } }
    }

    /// What the joint file says, since the log does not contradict it.
    pub(super) fn repeated(self) -> Self {
        Self { repeats: true, ..self }
    }

    /// Whether the log says something that the joint file alone does not.
    pub(crate) fn is_news(&self) -> bool {
        self.value.is_some() && !self.repeats
    }

    /// What cannot be negative, and with it its interval; one that is surely below zero keeps what it is, for who judges the log.
    pub(crate) fn not_negative(mut self) -> Self {
        if self.interval.is_some_and(|[_, high]| high < 0.0) {
            return self;
        }
        self.value = self.value.map(|value| value.max(0.0));
        self.interval = self.interval.map(|ends| ends.map(|end| end.max(0.0)));
        self
    }

    /// Whether it brakes.
    pub(crate) fn is_friction(&self) -> bool {
        self.key.as_deref().is_some_and(|key| key.contains("friction"))
    }

    /// A friction that came out below zero by no more than chance gives: none, up to half of its interval.
    pub(crate) fn settled(self) -> Self {
        match self.interval {
            Some([low, high]) if high < 0.0 && self.is_friction() => {
                Self { value: Some(0.0), interval: Some([0.0, 0.5 * (high - low)]), ..self }
            }
            _ => self,
        }
    }
}
