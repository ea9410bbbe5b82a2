//! Plausibility of successive readings (O21, O22): no shaft can follow counts that stand still at once or jump.
//!
//! A link is braked by load and teeth with at most their torque, and by an obstacle over a time that does not depend on
//! the speed (a spring). From the speed follows the least travel of the next few periods. A motor is braked by its own
//! torque and by teeth, which act as a spring and also throw the motor back: its speed may jump by its own speed or by
//! twice the link's. A motor that turns with the link is not stopped by teeth: one flank pulls away, the other drives
//! the motor on.

use crate::numbers::Real;
use crate::observer::tables::StopTable;

/// Base-2 logarithm of the parts of a count.
const PART: u32 = 6;
pub const COUNT: i32 = 1 << PART;

/// Fewest equal readings before standing still is a fault, plus one per count of noise: two may be one reading given
/// twice.
pub const FEWEST: u16 = 3;

/// Readings that must confirm a jump: wrong bits in one or two readings are ignored.
const CONFIRMED: u8 = 3;

/// Missing counts beyond noise that make an encoder frozen: rounding, and one more count.
const MISSING: i32 = 2 * COUNT;

/// Jump of a reading beyond noise that makes the reading suspect.
const JUMP: i32 = 8 * COUNT;

/// Mean deviations of the readings added to both limits above: five standard deviations of normal noise.
const NOISY: i32 = 4;

/// Base-2 logarithm of the readings over which the noise is averaged.
const AVERAGED: u32 = 5;

/// Value of `jumped_for` while the speed is unknown.
const UNKNOWN: u8 = u8::MAX;

/// Plausibility of a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The shaft can reach the reading.
    Plausible,
    /// The shaft cannot reach the reading unless the next readings return; this reading is not used.
    Suspect,
    /// The shaft cannot reach the reading.
    Implausible,
}

/// Influences that change a shaft's speed between two readings.
pub trait Surroundings<T: Real> {
    /// Table of the stopping times of the shaft.
    fn stops(&self) -> &StopTable<T>;
    /// Half of the deceleration by torques [counts per period^2].
    fn brake(&self) -> T;
    /// Largest sudden change of speed at the speed `rate` [parts of a count per period].
    fn throw(&self, rate: i32) -> i32;
    /// Speed that the shaft keeps whatever it meets, at a speed of `rate` [parts of a count per period].
    fn carried(&self, rate: i32) -> i32;
    /// Lower bound of the true speed [counts per period] at the estimate `rate` [parts of a count per period].
    fn sure(&self, rate: i32) -> T;
}

/// Estimated speed of a shaft's counts, and the deviation of readings from it.
#[derive(Debug, Clone, Copy)]
pub struct Plausibility {
    /// Speed [parts of a count per period].
    rate: i32,
    /// Mean deviation of readings from the speed, times the number of averaged readings.
    noise: u16,
    /// Distance of the readings from the predicted position since a jump, saturated [parts of a count].
    away: i16,
    /// Readings since the jump; 0 without a jump.
    jumped_for: u8,
    /// Equal readings in a row.
    still: u8,
}

impl Plausibility {
    pub fn new() -> Self {
        Self { rate: 0, noise: 0, away: 0, jumped_for: UNKNOWN, still: 0 }
    }

    /// Handles a reading after an irregular interval: motion ends a standstill; a long interval (`far`) resets the
    /// speed.
    #[cold]
    pub fn miss(&mut self, by: i32, far: bool) {
        if far {
            self.lose();
        } else if by != 0 {
            self.still = 0;
        }
    }

    /// Resets the speed and keeps the noise.
    pub fn lose(&mut self) {
        *self = Self { noise: self.noise, ..Self::new() };
    }

    /// Speed of the shaft [parts of a count per period].
    pub fn rate(&self) -> i32 {
        self.rate
    }

    /// Speed before the readings broke off, if known [counts per period].
    pub fn speed<T: Real>(&self) -> Option<T> {
        (self.jumped_for != UNKNOWN).then(|| counts(self.rate))
    }

    /// Lead of the link over readings that broke off [counts].
    pub fn ahead<T: Real>(&self) -> T {
        if self.jumped_for == 0 {
            counts::<T>(self.rate) * T::from_i32(self.still.into())
        } else {
            -counts::<T>(self.away.into())
        }
    }

    /// Returns true if the readings stand still, false if they jumped.
    pub fn stands_still(&self) -> bool {
        self.jumped_for == 0
    }

    /// Judges the counts `by` which the shaft moved in a period.
    #[inline]
    pub fn take<T: Real>(&mut self, surroundings: &impl Surroundings<T>, by: i32) -> Verdict {
        let by = by.wrapping_shl(PART);
        let beyond = by.wrapping_sub(self.rate);
        let noise = i32::from(self.noise) >> AVERAGED;
        let jump = JUMP + 2 * NOISY * noise;
        if self.jumped_for != 0 || beyond.wrapping_abs() > jump && self.leaps(surroundings, beyond, jump) {
            return self.take_odd(by, beyond);
        }
        if by == 0 {
            return self.stand_still(surroundings, noise);
        }
        // The travel after a standstill is spread over all readings of the standstill.
        let beyond = if self.still == 0 { beyond } else { self.spread(by) };
        self.rate += beyond >> 2;
        self.noise = (i32::from(self.noise) + beyond.wrapping_abs() - noise).min(u16::MAX.into()) as u16;
        Verdict::Plausible
    }

    /// Handles the first reading, a reading that jumps, and the readings after it.
    #[cold]
    fn take_odd(&mut self, by: i32, beyond: i32) -> Verdict {
        if self.jumped_for == UNKNOWN {
            // A single reading is rounded by up to a count: the slowest speed that explains it is used.
            let rate = by - by.clamp(-COUNT, COUNT);
            *self = Self { rate, noise: self.noise, jumped_for: 0, ..Self::new() };
            return Verdict::Plausible;
        }
        self.away = i32::from(self.away).saturating_add(beyond).clamp(i16::MIN.into(), i16::MAX.into()) as i16;
        self.jumped_for += 1;
        self.still = 0;
        if i32::from(self.away).abs() < JUMP / 2 {
            (self.away, self.jumped_for) = (0, 0);
            Verdict::Plausible
        } else if self.jumped_for > CONFIRMED {
            Verdict::Implausible
        } else {
            Verdict::Suspect
        }
    }

    /// Returns the mean travel since the last change of counts less the speed, and ends the standstill.
    #[cold]
    fn spread(&mut self, by: i32) -> i32 {
        let readings = i32::from(core::mem::take(&mut self.still)) + 1;
        by.checked_div(readings).unwrap_or(by) - self.rate
    }

    /// Returns true if a reading jumps by more than the shaft can be thrown.
    #[cold]
    fn leaps<T: Real>(&self, surroundings: &impl Surroundings<T>, beyond: i32, jump: i32) -> bool {
        beyond.wrapping_abs() > jump.saturating_add(surroundings.throw(self.rate))
    }

    /// Judges one more reading with unchanged counts.
    #[cold]
    fn stand_still<T: Real>(&mut self, surroundings: &impl Surroundings<T>, noise: i32) -> Verdict {
        let table = surroundings.stops();
        self.still = self.still.saturating_add(1);
        if self.still > table.forgotten {
            self.rate = 0;
        }
        // Noise can leave the counts unchanged by chance.
        if self.rate == 0 || i32::from(self.still) < i32::from(FEWEST) + (noise >> PART) {
            return Verdict::Plausible;
        }
        let periods = T::from_i32(self.still.into());
        let rate = if self.still > table.stop { T::ZERO } else { surroundings.sure(self.rate.wrapping_abs()) };
        let stopped = rate - periods * rate * table.per_stops;
        let carried = surroundings.sure(surroundings.carried(self.rate));
        let least = periods * (if stopped > carried { stopped } else { carried } - periods * surroundings.brake());
        if least > counts(MISSING + NOISY * noise) { Verdict::Implausible } else { Verdict::Plausible }
    }
}

/// Converts parts of a count to counts.
pub fn counts<T: Real>(parts: i32) -> T {
    T::from_i32(parts).over(T::from_i32(COUNT))
}
