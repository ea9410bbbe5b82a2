//! Plausibility of successive readings (O21, O22): no shaft can follow counts that stand still at once or jump.
//!
//! A link is braked by load and teeth with at most their torque, and by an obstacle over a time that does not depend on
//! the speed (a spring). From the speed follows the least travel of the next few periods. A motor is braked by its own
//! torque and by teeth, which act as a spring and also throw the motor back: its speed may jump by its own speed or by
//! twice the link's. A motor that turns with the link is not stopped by teeth: one flank pulls away, the other drives
//! the motor on.

use super::thresholds::{PART_BITS, PARTS_PER_COUNT, PLAUSIBILITY};
use crate::numbers::Real;
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

impl Plausibility {
    pub fn new() -> Self {
        Self { rate: 0, noise: 0, jump_distance: 0, readings_since_jump: SPEED_UNKNOWN, standstill_readings: 0 }
    }

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
        *self = Self { noise: self.noise, ..Self::new() };
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
            *self = Self { rate, noise: self.noise, readings_since_jump: 0, ..Self::new() };
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
