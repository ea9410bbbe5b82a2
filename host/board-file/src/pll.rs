//! How a chip makes its core clock: an oscillator's frequency f is divided by M, multiplied by N in the PLL's own oscillator
//! and halved at its output, so that `core = f / M * N / 2`, exactly.

/// Divider and factor that a PLL is set to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pll {
    /// M: the oscillator's frequency is divided by it.
    pub divider: u32,
    /// N: the PLL's own oscillator is so many times faster than what comes in.
    pub factor: u32,
    /// The code of the range that the input lies in, on chips that want to be told; else 0.
    pub range: u32,
}

/// The settings for both oscillators of a board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plls {
    /// From what the board supplies, if it supplies anything.
    pub external: Option<Pll>,
    /// From the chip's own oscillator, which takes over if nothing comes from outside.
    pub internal: Pll,
}

/// What the PLL of a family of chips can do.
#[derive(Debug)]
pub(crate) struct PllLimits {
    /// Least and greatest frequency that may come in [Hz].
    pub input: (u32, u32),
    /// Taken if it can be made [Hz]; else the highest that can: a faster input jitters less.
    pub preferred_input: u32,
    /// Of the PLL's own oscillator [Hz]: twice the core clock.
    pub oscillator: u32,
    /// Least and greatest M.
    pub divider: (u32, u32),
    /// Least and greatest N.
    pub factor: (u32, u32),
    /// Input frequencies at which the code of the range rises by one [Hz].
    pub ranges: &'static [u32],
}

/// Frequencies that crystals are commonly cut for [Hz].
const COMMON: [u32; 12] = [
    4_000_000, 5_000_000, 6_000_000, 8_000_000, 10_000_000, 12_000_000, 16_000_000, 20_000_000, 24_000_000, 25_000_000,
    26_000_000, 48_000_000,
];

impl PllLimits {
    /// The settings for an oscillator [Hz]; `None` if no pair of divider and factor gives the core clock exactly.
    pub fn settings(&self, frequency: u32) -> Option<Pll> {
        let frequency = u64::from(frequency);
        let fits = |divider: u32| -> Option<Pll> {
            let times = |hertz: u32| u64::from(hertz) * u64::from(divider);
            if !(times(self.input.0)..=times(self.input.1)).contains(&frequency) {
                return None;
            }
            let product = times(self.oscillator);
            let factor = (product % frequency == 0).then(|| product / frequency)?;
            let factor = u32::try_from(factor).ok().filter(|it| (self.factor.0..=self.factor.1).contains(it))?;
            let range = self.ranges.iter().filter(|edge| frequency >= times(**edge)).count() as u32;
            Some(Pll { divider, factor, range })
        };
        let dividers = || (self.divider.0..=self.divider.1).filter_map(fits);
        let preferred = |pll: &Pll| u64::from(self.preferred_input) * u64::from(pll.divider) == frequency;
        dividers().find(preferred).or_else(|| dividers().next())
    }

    /// Common frequencies between two that give the core clock [Hz].
    pub fn common(&self, (least, greatest): (u32, u32)) -> Vec<u32> {
        let fits = |frequency: &u32| (least..=greatest).contains(frequency) && self.settings(*frequency).is_some();
        COMMON.into_iter().filter(fits).collect()
    }
}
