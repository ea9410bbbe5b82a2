//! Plausibility of successive readings: no shaft can follow counts that stand still at once or jump.
//!
//! ```text
//! (O21) link:   n (v (1 - n/(2 n_st)) - n B) > 2 counts + 4 noise,   n <= n_st
//! (O22) motor:  n (max(f(r) (1 - n/(2 n_s)), f(|r_l| - |r - r_l|)) - n B) > 2 counts + 4 noise
//!       jump:   |reading - predicted| > 8 counts + 8 noise + impact
//! ```
//!
//! Symbols, in counts and periods: v, r = `rate`, n = `standstill_readings`, n_st, n_s = `stop`, B =
//! `half_deceleration`, f = `lower_speed_bound`, f(|r_l| - ...) = `speed_kept_by_teeth`, impact =
//! `impact_speed_change`, noise = mean deviation.
//!
//! A link is braked by load and teeth with at most their torque, and by an obstacle over a time that does not depend on
//! the speed (a spring). From the speed follows the least travel of the next few periods. A motor is braked by its own
//! torque and by teeth, which act as a spring and also push the motor back: its speed may jump by its own speed or by
//! twice the link's. A motor that turns with the link is not stopped by teeth: one flank pulls away, the other drives
//! the motor on.

use super::thresholds::{PART_BITS, PARTS_PER_COUNT, PLAUSIBILITY};
use crate::numbers::Real;
use crate::numbers::state_words::state_words;
use crate::observer::tables::StopTable;

/// Base-2 logarithm of the readings over which the noise is averaged.
const NOISE_AVERAGE_BITS: u32 = 5;

/// Value of `readings_since_jump` while the speed is unknown.
const SPEED_UNKNOWN: u8 = u8::MAX;

/// Plausibility of a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlausibilityResult {
    /// The shaft can reach the reading.
    Plausible,
    /// The shaft cannot reach the reading unless the next readings return; this reading is not used.
    Suspect,
    /// The shaft cannot reach the reading.
    Implausible,
}

/// Influences that change a shaft's speed between two readings.
pub trait MotionLimits<T: Real> {
    /// Table of the stopping times of the shaft.
    fn stop_table(&self) -> &StopTable<T>;
    /// Half of the deceleration by torques [counts per period^2].
    fn half_deceleration(&self) -> T;
    /// Largest sudden change of speed at the speed `rate` [parts of a count per period].
    fn impact_speed_change(&self, rate: i32) -> i32;
    /// Speed that the shaft keeps whatever it meets, at a speed of `rate` [parts of a count per period].
    fn speed_kept_by_teeth(&self, rate: i32) -> i32;
    /// Lower bound of the true speed [counts per period] at the estimate `rate` [parts of a count per period].
    fn lower_speed_bound(&self, rate: i32) -> T;
}

/// Estimated speed of a shaft's counts, and the deviation of readings from it.
#[derive(Debug, Clone, Copy)]
pub struct Plausibility {
    /// Speed [parts of a count per period].
    rate: i32,
    /// Mean deviation of readings from the speed, times the number of averaged readings.
    noise: u16,
    /// Distance of the readings from the predicted position since a jump, saturated [parts of a count].
    jump_distance: i16,
    /// Readings since the jump; 0 without a jump.
    readings_since_jump: u8,
    /// Equal readings in a row.
    standstill_readings: u8,
}
state_words! { struct Plausibility { rate, noise, jump_distance, readings_since_jump, standstill_readings } }

impl Default for Plausibility {
    fn default() -> Self {
        Self { rate: 0, noise: 0, jump_distance: 0, readings_since_jump: SPEED_UNKNOWN, standstill_readings: 0 }
    }
}

impl Plausibility {
    /// Handles a reading after an irregular interval: motion ends a standstill; a long interval (`is_long`) resets the
    /// speed.
    #[cold]
    pub fn skip_irregular(&mut self, by: i32, is_long: bool) {
        if is_long {
            self.reset_speed();
        } else if by != 0 {
            self.standstill_readings = 0;
        }
    }

    /// Resets the speed and keeps the noise.
    pub fn reset_speed(&mut self) {
        *self = Self { noise: self.noise, ..Self::default() };
    }

    /// Speed of the shaft [parts of a count per period].
    pub fn rate(&self) -> i32 {
        self.rate
    }

    /// Speed before the readings broke off, if known [counts per period].
    pub fn speed<T: Real>(&self) -> Option<T> {
        (self.readings_since_jump != SPEED_UNKNOWN).then(|| counts(self.rate))
    }

    /// Lead of the link over readings that broke off [counts].
    pub fn lead<T: Real>(&self) -> T {
        if self.readings_since_jump == 0 {
            counts::<T>(self.rate) * T::from_i32(self.standstill_readings.into())
        } else {
            -counts::<T>(self.jump_distance.into())
        }
    }

    /// Returns true if the readings stand still, false if they jumped.
    pub fn is_standstill(&self) -> bool {
        self.readings_since_jump == 0
    }

    /// Judges the counts `by` which the shaft moved in a period.
    #[inline]
    pub fn check<T: Real>(&mut self, limits: &impl MotionLimits<T>, by: i32) -> PlausibilityResult {
        let by = by.wrapping_shl(PART_BITS);
        let deviation = by.wrapping_sub(self.rate);
        let noise = i32::from(self.noise) >> NOISE_AVERAGE_BITS;
        let jump = PLAUSIBILITY.jump + 2 * PLAUSIBILITY.noise_factor * noise;
        if self.readings_since_jump != 0 || deviation.wrapping_abs() > jump && self.is_jump(limits, deviation, jump) {
            return self.check_jump(by, deviation);
        }
        if by == 0 {
            return self.check_standstill(limits, noise);
        }
        // The travel after a standstill is spread over all readings of the standstill.
        let deviation = if self.standstill_readings == 0 { deviation } else { self.end_standstill(by) };
        self.rate += deviation >> 2;
        self.noise = (i32::from(self.noise) + deviation.wrapping_abs() - noise).min(u16::MAX.into()) as u16;
        PlausibilityResult::Plausible
    }

    /// Handles the first reading, a reading that jumps, and the readings after it.
    #[cold]
    fn check_jump(&mut self, by: i32, deviation: i32) -> PlausibilityResult {
        if self.readings_since_jump == SPEED_UNKNOWN {
            // A single reading is rounded by up to a count: the slowest speed that explains it is used.
            let rate = by - by.clamp(-PARTS_PER_COUNT, PARTS_PER_COUNT);
            *self = Self { rate, noise: self.noise, readings_since_jump: 0, ..Self::default() };
            return PlausibilityResult::Plausible;
        }
        self.jump_distance =
            i32::from(self.jump_distance).saturating_add(deviation).clamp(i16::MIN.into(), i16::MAX.into()) as i16;
        self.readings_since_jump += 1;
        self.standstill_readings = 0;
        if i32::from(self.jump_distance).abs() < PLAUSIBILITY.jump / 2 {
            (self.jump_distance, self.readings_since_jump) = (0, 0);
            PlausibilityResult::Plausible
        } else if self.readings_since_jump > PLAUSIBILITY.jump_confirmations {
            PlausibilityResult::Implausible
        } else {
            PlausibilityResult::Suspect
        }
    }

    /// Returns the mean travel since the last change of counts less the speed, and ends the standstill.
    #[cold]
    fn end_standstill(&mut self, by: i32) -> i32 {
        let readings = i32::from(core::mem::take(&mut self.standstill_readings)) + 1;
        by.checked_div(readings).unwrap_or(by) - self.rate
    }

    /// Returns true if a reading jumps by more than the shaft can be thrown.
    #[cold]
    fn is_jump<T: Real>(&self, limits: &impl MotionLimits<T>, deviation: i32, jump: i32) -> bool {
        deviation.wrapping_abs() > jump.saturating_add(limits.impact_speed_change(self.rate))
    }

    /// Judges one more reading with unchanged counts.
    #[cold]
    fn check_standstill<T: Real>(&mut self, limits: &impl MotionLimits<T>, noise: i32) -> PlausibilityResult {
        let table = limits.stop_table();
        self.standstill_readings = self.standstill_readings.saturating_add(1);
        if self.standstill_readings > table.forgotten {
            self.rate = 0;
        }
        // Noise can leave the counts unchanged by chance.
        if self.rate == 0
            || i32::from(self.standstill_readings)
                < i32::from(PLAUSIBILITY.min_standstill_readings) + (noise >> PART_BITS)
        {
            return PlausibilityResult::Plausible;
        }
        let periods = T::from_i32(self.standstill_readings.into());
        let rate = if self.standstill_readings > table.stop {
            T::ZERO
        } else {
            limits.lower_speed_bound(self.rate.wrapping_abs())
        };
        let stopped = rate - periods * rate * table.per_stops;
        let kept = limits.lower_speed_bound(limits.speed_kept_by_teeth(self.rate));
        let least_travel =
            periods * (if stopped > kept { stopped } else { kept } - periods * limits.half_deceleration());
        if least_travel > counts(PLAUSIBILITY.missing_counts + PLAUSIBILITY.noise_factor * noise) {
            PlausibilityResult::Implausible
        } else {
            PlausibilityResult::Plausible
        }
    }
}

/// Converts parts of a count to counts.
pub fn counts<T: Real>(parts: i32) -> T {
    T::from_i32(parts) / T::from_i32(PARTS_PER_COUNT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::test_tables::Q1_DOUBLE;

    /// Limits of a shaft that an obstacle stops in 10 periods.
    struct Limits {
        stops: StopTable<f32>,
        impact: i32,
        kept: i32,
    }

    impl MotionLimits<f32> for Limits {
        fn stop_table(&self) -> &StopTable<f32> {
            &self.stops
        }

        fn half_deceleration(&self) -> f32 {
            0.0
        }

        fn impact_speed_change(&self, _: i32) -> i32 {
            self.impact
        }

        fn speed_kept_by_teeth(&self, _: i32) -> i32 {
            self.kept
        }

        fn lower_speed_bound(&self, rate: i32) -> f32 {
            counts(rate)
        }
    }

    fn limits() -> Limits {
        Limits { stops: StopTable { stop: 10, forgotten: 12, per_stops: 0.05 }, impact: 0, kept: 0 }
    }

    /// Shaft that turns steadily by `by` counts per period.
    fn steady(by: i32) -> Plausibility {
        let mut plausibility = Plausibility::default();
        for _ in 0..100 {
            assert_eq!(plausibility.check(&limits(), by), PlausibilityResult::Plausible);
        }
        plausibility
    }

    #[test]
    fn first_reading_gives_slowest_speed() {
        let mut plausibility = Plausibility::default();
        assert_eq!(plausibility.speed::<f32>(), None);
        plausibility.check(&limits(), 20);
        assert_eq!(plausibility.speed::<f32>(), Some(19.0));
        let mut backward = Plausibility::default();
        backward.check(&limits(), -20);
        assert_eq!(backward.speed::<f32>(), Some(-19.0));
    }

    #[test]
    fn speed_follows_readings() {
        assert!((steady(5).speed::<f32>().unwrap_or_default() - 5.0).abs() < 0.1);
        assert!((steady(-5).speed::<f32>().unwrap_or_default() + 5.0).abs() < 0.1);
    }

    #[test]
    fn standstill_in_motion_is_implausible() {
        for by in [5, -5] {
            let mut plausibility = steady(by);
            for _ in 1..PLAUSIBILITY.min_standstill_readings {
                assert_eq!(plausibility.check(&limits(), 0), PlausibilityResult::Plausible);
            }
            assert_eq!(plausibility.check(&limits(), 0), PlausibilityResult::Implausible);
            assert!(plausibility.is_standstill());
        }
    }

    #[test]
    fn slow_standstill_is_plausible() {
        let mut plausibility = Plausibility::default();
        plausibility.check(&limits(), 0);
        for reading in 0..200 {
            assert_eq!(plausibility.check(&limits(), i32::from(reading % 4 == 0)), PlausibilityResult::Plausible);
        }
        for _ in 0..10 {
            assert_eq!(plausibility.check(&limits(), 0), PlausibilityResult::Plausible);
        }
    }

    #[test]
    fn long_standstill_is_forgotten() {
        let mut plausibility = steady(1);
        for _ in 0..20 {
            plausibility.check(&limits(), 0);
        }
        assert_eq!(plausibility.rate(), 0);
    }

    #[test]
    fn teeth_keep_speed_over_stop_time() {
        let kept = Limits { kept: 5 * PARTS_PER_COUNT, ..limits() };
        let mut plausibility = steady(1);
        let results: [_; 9] = core::array::from_fn(|_| plausibility.check(&kept, 0));
        assert_eq!(results[2], PlausibilityResult::Implausible);
    }

    #[test]
    fn deviation_at_jump_limit_is_plausible() {
        let mut plausibility = steady(0);
        assert_eq!(plausibility.check(&limits(), 8), PlausibilityResult::Plausible);
        let mut plausibility = steady(0);
        assert_eq!(plausibility.check(&limits(), 9), PlausibilityResult::Suspect);
    }

    #[test]
    fn impact_allows_larger_deviation() {
        let impact = Limits { impact: 20 * PARTS_PER_COUNT, ..limits() };
        assert_eq!(steady(0).check(&impact, 28), PlausibilityResult::Plausible);
        assert_eq!(steady(0).check(&impact, 29), PlausibilityResult::Suspect);
    }

    #[test]
    fn wrong_reading_that_returns_is_ignored() {
        let mut plausibility = steady(5);
        assert_eq!(plausibility.check(&limits(), 105), PlausibilityResult::Suspect);
        assert_eq!(plausibility.check(&limits(), -95), PlausibilityResult::Plausible);
        assert_eq!(plausibility.check(&limits(), 5), PlausibilityResult::Plausible);
    }

    #[test]
    fn confirmed_jump_is_implausible() {
        let mut plausibility = steady(5);
        assert_eq!(plausibility.check(&limits(), 105), PlausibilityResult::Suspect);
        // Two readings confirm the jump; the third excludes the encoder.
        for _ in 0..2 {
            assert_eq!(plausibility.check(&limits(), 5), PlausibilityResult::Suspect);
        }
        assert_eq!(plausibility.check(&limits(), 5), PlausibilityResult::Implausible);
        assert!(!plausibility.is_standstill());
        assert!((plausibility.lead::<f32>() + 100.0).abs() < 3.0, "the shaft is behind the readings");
    }

    #[test]
    fn noise_widens_jump_limit() {
        let mut plausibility = steady(0);
        for reading in 0..200 {
            plausibility.check(&limits(), if reading & 1 == 0 { 6 } else { -6 });
        }
        assert_eq!(plausibility.check(&limits(), 20), PlausibilityResult::Plausible);
    }

    #[test]
    fn reset_speed_keeps_noise() {
        let mut plausibility = steady(0);
        for reading in 0..200 {
            plausibility.check(&limits(), if reading & 1 == 0 { 6 } else { -6 });
        }
        let noise = plausibility.noise;
        plausibility.reset_speed();
        assert_eq!((plausibility.noise, plausibility.speed::<f32>()), (noise, None));
        assert!(noise > 0);
    }

    #[test]
    fn long_gap_resets_speed() {
        let mut plausibility = steady(5);
        plausibility.skip_irregular(5, false);
        assert!(plausibility.speed::<f32>().is_some());
        plausibility.skip_irregular(5, true);
        assert_eq!(plausibility.speed::<f32>(), None);
    }

    #[test]
    fn largest_readings_do_not_panic() {
        let mut plausibility = steady(0);
        for by in [i32::MAX, i32::MIN, i32::MAX, 0, i32::MIN] {
            plausibility.check(&limits(), by);
        }
    }

    /// Reading without a count at which a link of Q1 that turns at a speed [parts of a count per period] cannot have
    /// stopped.
    fn freeze_is_found_at(rate: i32) -> Option<u32> {
        let table = &Q1_DOUBLE.supervisor;
        let mut plausibility = Plausibility { rate, readings_since_jump: 0, ..Plausibility::default() };
        (1..100).find(|_| plausibility.check(table, 0) == PlausibilityResult::Implausible)
    }

    #[test]
    fn freeze_is_found_from_42_parts_of_a_count() {
        // A slower link may be stopped within 1 ms, braked by twice the motor's largest torque, and miss two counts.
        assert_eq!([41, 42].map(freeze_is_found_at), [None, Some(6)]);
    }
}
