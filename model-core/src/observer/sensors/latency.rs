//! Freshness of the motor readings by time stamp: reading of this period, late reading, or repeated reading after a
//! lost one.

use super::thresholds::LATENCY;
use crate::numbers::state_words::state_words;

/// Resolution of ages [parts of a control period].
const AGE_PARTS: u32 = 16;

/// Freshness of the motor reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleAge {
    /// Taken in this period.
    Fresh,
    /// Repeated: one or two readings were lost. The motor state is extrapolated.
    Repeated,
    /// Repeated for longer. The force since then is a guess: estimates that depend on the force are invalid, and no
    /// parameter is updated.
    RepeatedForLong,
    /// New, but older than a period: estimates are invalid and no parameter is updated, as for `RepeatedForLong`.
    Late,
    /// Missing, or too old to be used.
    Unusable,
}

/// Age of the motor readings over time.
#[derive(Debug, Clone, Copy, Default)]
pub struct Latency {
    /// Age of the last reading in [`AGE_PARTS`] of a period; zero for a fresh reading.
    age: u8,
    /// Excess of late periods over punctual ones; above [`LATENCY.tolerated_late_periods`], punctual periods left until
    /// recovery plus `LATENCY.tolerated_late_periods`.
    lateness: u8,
}
state_words! { struct Latency { age, lateness } }

impl Latency {
    /// Classifies a reading by its age, `None` if too old, and the control period; both in ticks.
    #[inline]
    pub fn step(&mut self, age: Option<u32>, period: u32) -> SampleAge {
        match age {
            Some(age) if age < period => {
                self.age = 0;
                self.lateness = self.lateness.saturating_sub(1);
                SampleAge::Fresh
            }
            _ => self.step_late(age, period),
        }
    }

    #[cold]
    fn step_late(&mut self, age: Option<u32>, period: u32) -> SampleAge {
        let parts =
            age.and_then(|age| age.saturating_mul(AGE_PARTS).checked_div(period)).map_or(u8::MAX, |parts| parts as u8);
        let before = u32::from(core::mem::replace(&mut self.age, parts));
        let is_repeated = u32::from(parts) >= before + LATENCY.repeated_age_increase;
        let sample_age = match age {
            Some(age)
                if is_repeated
                    && age < period.saturating_mul(LATENCY.extrapolated_periods).saturating_add(period / 2) =>
            {
                SampleAge::Repeated
            }
            Some(_) if is_repeated => SampleAge::RepeatedForLong,
            Some(_) => SampleAge::Late,
            None => SampleAge::Unusable,
        };
        self.lateness = match sample_age {
            SampleAge::Fresh | SampleAge::Repeated => self.lateness.saturating_sub(1),
            SampleAge::RepeatedForLong | SampleAge::Late if self.lateness < LATENCY.tolerated_late_periods => {
                self.lateness + 1
            }
            _ => LATENCY.tolerated_late_periods + LATENCY.recovery_periods,
        };
        sample_age
    }

    /// Returns whether readings have been late for long.
    pub fn is_persistently_late(&self) -> bool {
        self.lateness > LATENCY.tolerated_late_periods
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: u32 = 1000;

    /// Latency after `late` late readings.
    fn after_late(late: u8) -> Latency {
        let mut latency = Latency::default();
        latency.step(Some(PERIOD + 100), PERIOD);
        latency.lateness = 0;
        for _ in 0..late {
            assert_eq!(latency.step(Some(PERIOD + 100), PERIOD), SampleAge::Late);
        }
        latency
    }

    #[test]
    fn age_below_period_is_fresh() {
        let mut latency = Latency::default();
        assert_eq!(latency.step(Some(0), PERIOD), SampleAge::Fresh);
        assert_eq!(latency.step(Some(PERIOD - 1), PERIOD), SampleAge::Fresh);
        assert_ne!(latency.step(Some(PERIOD), PERIOD), SampleAge::Fresh);
    }

    #[test]
    fn age_rising_by_period_is_repeated() {
        let mut latency = Latency::default();
        assert_eq!(latency.step(Some(PERIOD), PERIOD), SampleAge::Repeated);
        assert_eq!(latency.step(Some(2 * PERIOD), PERIOD), SampleAge::Repeated);
        assert_eq!(latency.step(Some(3 * PERIOD), PERIOD), SampleAge::RepeatedForLong);
    }

    #[test]
    fn age_rising_below_limit_is_late() {
        let mut latency = Latency::default();
        latency.step(Some(PERIOD), PERIOD);
        // 16 parts of a period before; 12 parts more are a repetition, 11 are not.
        assert_eq!(latency.step(Some(PERIOD * 27 / 16), PERIOD), SampleAge::Late);
        let mut latency = Latency::default();
        latency.step(Some(PERIOD), PERIOD);
        assert_eq!(latency.step(Some(PERIOD * 28 / 16), PERIOD), SampleAge::Repeated);
    }

    #[test]
    fn missing_age_is_unusable() {
        let mut latency = Latency::default();
        assert_eq!(latency.step(None, PERIOD), SampleAge::Unusable);
        assert!(latency.is_persistently_late());
    }

    #[test]
    fn four_late_periods_are_tolerated() {
        assert!(!after_late(4).is_persistently_late());
        assert!(after_late(5).is_persistently_late());
    }

    #[test]
    fn lateness_ends_after_32_punctual_periods() {
        let mut latency = after_late(5);
        (0..31).for_each(|_| assert_eq!(latency.step(Some(0), PERIOD), SampleAge::Fresh));
        assert!(latency.is_persistently_late());
        latency.step(Some(0), PERIOD);
        assert!(!latency.is_persistently_late());
    }

    #[test]
    fn period_of_zero_does_not_divide() {
        let mut latency = Latency::default();
        assert_eq!(latency.step(Some(5), 0), SampleAge::RepeatedForLong);
    }
}
