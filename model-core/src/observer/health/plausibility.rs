//! Whether a shaft could follow its encoder's readings from one to the next: counts that stand still at once, or jump, are no
//! shaft's.
//!
//! A link is stopped by its teeth, its load, and by what it runs into: the first two brake it by no more than a torque,
//! the last takes a time that does not depend on the speed, as a spring does. So a link that has gone on by so many counts
//! a period goes on by at least so many in the next few periods. So it is with a motor, which its own torque brakes and its
//! teeth stop as a spring does; but they throw it back as well, so that it may jump by as much as it was fast, or the link. A
//! motor that turns with the link is not stopped by teeth at all: those of one flank pull away, those of the other push it on.

use crate::numbers::Real;
use crate::observer::tables::StopTable;

/// Parts of a count, as a power of two.
const PART: u32 = 6;
pub const COUNT: i32 = 1 << PART;

/// Standing still is no fault until so many readings say the same, and one more for each count of noise: two may be a
/// reading given twice.
pub const FEWEST: u16 = 3;

/// Readings that must say what one that jumped said: a wrong bit in one or two of them goes by.
const CONFIRMED: u8 = 3;

/// Counts that must be missing, noise aside, before an encoder counts as frozen: rounding, and one more.
const MISSING: i32 = 2 * COUNT;

/// Counts by which a reading must jump, noise aside, before it is suspect.
const JUMP: i32 = 8 * COUNT;

/// Mean deviations of the readings by which those grow: five standard deviations of normal noise.
const NOISY: i32 = 4;

/// Readings over which the noise is taken, as a power of two.
const AVERAGED: u32 = 5;

/// Stands for readings since one that jumped while the speed is not known.
const UNKNOWN: u8 = u8::MAX;

/// Whether a link could have gone as a reading says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// It could.
    Plausible,
    /// It could not, unless the next readings go back: this one is not used.
    Suspect,
    /// It could not.
    Implausible,
}

/// What may change a shaft's speed from one reading to the next.
pub trait Surroundings<T: Real> {
    /// How soon the shaft stops.
    fn stops(&self) -> &StopTable<T>;
    /// Half of the counts by which torques may slow it down in a period, for each period.
    fn brake(&self) -> T;
    /// Parts of a count in a period by which it may be thrown at once, while it goes on by so many.
    fn throw(&self, rate: i32) -> i32;
    /// Parts of a count in a period by which it is carried on whatever it runs into, while it goes on by so many.
    fn carried(&self, rate: i32) -> i32;
    /// Counts in a period that are known for sure where so many parts of them are said.
    fn sure(&self, rate: i32) -> T;
}

/// Speed of a shaft's counts, and how readings follow it.
#[derive(Debug, Clone, Copy)]
pub struct Plausibility {
    /// Parts of a count in a period.
    rate: i32,
    /// Mean deviation from that, times the readings that it is taken over.
    noise: u16,
    /// Parts of a count by which readings are away since one jumped, as far as they fit.
    away: i16,
    /// Readings since then; 0 if none has jumped.
    jumped_for: u8,
    /// Readings in a row that said the same.
    still: u8,
}

impl Plausibility {
    pub fn new() -> Self {
        Self { rate: 0, noise: 0, away: 0, jumped_for: UNKNOWN, still: 0 }
    }

    /// A reading that is not a period after the one before says nothing of the speed but that the link turns.
    #[cold]
    pub fn miss(&mut self, by: i32, far: bool) {
        if far {
            self.lose();
        } else if by != 0 {
            self.still = 0;
        }
    }

    /// Forgets the speed.
    pub fn lose(&mut self) {
        *self = Self { noise: self.noise, ..Self::new() };
    }

    /// Parts of a count by which the shaft goes on in a period.
    pub fn rate(&self) -> i32 {
        self.rate
    }

    /// Counts in a period before the readings broke off, if they were known.
    pub fn speed<T: Real>(&self) -> Option<T> {
        (self.jumped_for != UNKNOWN).then(|| counts(self.rate))
    }

    /// Counts by which the link is ahead of readings that broke off.
    pub fn ahead<T: Real>(&self) -> T {
        if self.jumped_for == 0 {
            counts::<T>(self.rate) * T::from_i32(self.still.into())
        } else {
            -counts::<T>(self.away.into())
        }
    }

    /// Whether readings stand still, rather than being away.
    pub fn stands_still(&self) -> bool {
        self.jumped_for == 0
    }

    /// Takes in by how many counts the shaft went on in a period.
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
        // What a reading goes on by after others that stood still is spread over all of them.
        let beyond = if self.still == 0 { beyond } else { self.spread(by) };
        self.rate += beyond >> 2;
        self.noise = (i32::from(self.noise) + beyond.wrapping_abs() - noise).min(u16::MAX.into()) as u16;
        Verdict::Plausible
    }

    /// The first reading, one that jumps, or those after it.
    #[cold]
    fn take_odd(&mut self, by: i32, beyond: i32) -> Verdict {
        if self.jumped_for == UNKNOWN {
            // One reading is rounded by up to a count: no faster than it must be.
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

    /// By what a reading goes on beyond the speed, less so for the readings before it that stood still.
    #[cold]
    fn spread(&mut self, by: i32) -> i32 {
        let readings = i32::from(core::mem::take(&mut self.still)) + 1;
        by.checked_div(readings).unwrap_or(by) - self.rate
    }

    /// Whether a reading jumps by more than what may throw the shaft.
    #[cold]
    fn leaps<T: Real>(&self, surroundings: &impl Surroundings<T>, beyond: i32, jump: i32) -> bool {
        beyond.wrapping_abs() > jump.saturating_add(surroundings.throw(self.rate))
    }

    /// One more reading that says the same.
    #[cold]
    fn stand_still<T: Real>(&mut self, surroundings: &impl Surroundings<T>, noise: i32) -> Verdict {
        let table = surroundings.stops();
        self.still = self.still.saturating_add(1);
        if self.still > table.forgotten {
            self.rate = 0;
        }
        // Noise may say the same by chance, again and again.
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

/// Parts of a count as counts.
pub fn counts<T: Real>(parts: i32) -> T {
    T::from_i32(parts).over(T::from_i32(COUNT))
}
