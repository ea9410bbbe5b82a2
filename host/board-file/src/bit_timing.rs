//! Bit timing of CAN: prescaler and segments that make a bit rate exactly from the clock of the peripheral, with the
//! sample point close to the one that the bus expects.
//!
//! A bit has `1 + before + after` quanta of `prescaler` clock cycles; the level is sampled after `1 + before` of them.

/// Ranges of a peripheral's bit timing: largest values, the least is 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimingLimits {
    /// Prescaler.
    pub prescaler: u32,
    /// Quanta between the synchronisation quantum and the sample point.
    pub before: u32,
    /// Quanta after the sample point.
    pub after: u32,
    /// Synchronisation jump width [quanta].
    pub jump: u32,
}

/// Bit timing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BitTiming {
    /// Clock cycles in a quantum.
    pub prescaler: u32,
    /// Quanta between the synchronisation quantum and the sample point.
    pub before: u32,
    /// Quanta after the sample point.
    pub after: u32,
    /// Synchronisation jump width [quanta].
    pub jump: u32,
}

/// Fewest quanta in a bit, so that the sample point can be placed.
const MIN_QUANTA: u32 = 8;
/// Largest distance of the sample point from the wanted one [thousandths of a bit].
const MAX_DISTANCE: u32 = 50;

impl BitTiming {
    /// Timing of `rate` bits a second from a clock [Hz], with the sample point nearest to `sample_point` [thousandths
    /// of a bit], then with the most quanta. `None` if no timing is exact, or none has its sample point within 5 % of
    /// a bit.
    pub fn new(clock: u32, rate: u32, sample_point: u32, limits: TimingLimits) -> Option<Self> {
        let cycles = clock.checked_div(rate).filter(|cycles| cycles * rate == clock)?;
        let timings = (1..=limits.prescaler.min(cycles / MIN_QUANTA))
            .filter(|prescaler| cycles.is_multiple_of(*prescaler))
            .filter_map(|prescaler| Self::with_prescaler(prescaler, cycles / prescaler, sample_point, limits));
        let best = timings.min_by_key(|timing| (timing.distance(sample_point), timing.prescaler))?;
        (best.distance(sample_point) <= MAX_DISTANCE).then_some(best)
    }

    fn with_prescaler(prescaler: u32, quanta: u32, sample_point: u32, limits: TimingLimits) -> Option<Self> {
        let wanted = (quanta * (1000 - sample_point) + 500) / 1000;
        // As close to the sample point as both segments allow.
        let least = quanta.saturating_sub(1 + limits.before).max(1);
        let after = wanted.max(least).min(limits.after);
        let before = quanta.checked_sub(1 + after).filter(|before| (1..=limits.before).contains(before))?;
        Some(Self { prescaler, before, after, jump: after.min(limits.jump) })
    }

    /// Quanta of a bit.
    pub fn quanta(&self) -> u32 {
        1 + self.before + self.after
    }

    /// Sample point [thousandths of a bit].
    pub fn sample_point(&self) -> u32 {
        1000 * (1 + self.before) / self.quanta()
    }

    /// Largest deviation of the clock that resynchronisation makes up for [ppm]: jump / (20 quanta), once in ten bits
    /// of equal level, at either end.
    pub fn tolerance_ppm(&self) -> u32 {
        1_000_000 * self.jump / (20 * self.quanta())
    }

    fn distance(&self, sample_point: u32) -> u32 {
        self.sample_point().abs_diff(sample_point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// RM0090 32.7.7.
    const BXCAN: TimingLimits = TimingLimits { prescaler: 1024, before: 16, after: 8, jump: 4 };

    #[test]
    fn megabit_from_42_mhz() {
        let timing = BitTiming::new(42_000_000, 1_000_000, 875, BXCAN).unwrap();
        assert_eq!(timing, BitTiming { prescaler: 3, before: 11, after: 2, jump: 2 });
        assert_eq!((timing.sample_point(), timing.tolerance_ppm()), (857, 7142));
    }

    #[test]
    fn rate_that_is_not_exact_refused() {
        assert_eq!(BitTiming::new(42_000_000, 800_000, 875, BXCAN), None);
        assert_eq!(BitTiming::new(42_000_000, 0, 875, BXCAN), None);
        assert_eq!(BitTiming::new(4_000_000, 1_000_000, 875, BXCAN), None);
    }

    /// Every timing makes its rate exactly, within the ranges.
    #[test]
    fn timings_are_exact() {
        for clock in [42_000_000, 80_000_000, 170_000_000] {
            for rate in [10_000, 20_000, 50_000, 125_000, 250_000, 500_000, 1_000_000] {
                let Some(timing) = BitTiming::new(clock, rate, 875, BXCAN) else { continue };
                assert_eq!(timing.prescaler * timing.quanta() * rate, clock);
                assert!(timing.before <= 16 && timing.after <= 8 && timing.prescaler <= 1024, "{timing:?}");
                assert!((825..=925).contains(&timing.sample_point()), "{timing:?}");
            }
        }
    }
}
