//! Core clock of a chip: an oscillator's frequency f is divided by M, multiplied by N in the PLL's own oscillator and
//! halved at its output, so that `core = f / M * N / 2`, exactly.

/// Settings of a PLL.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pll {
    /// M: divider of the oscillator's frequency.
    pub divider: u32,
    /// N: factor from the PLL's input to its own oscillator.
    pub factor: u32,
    /// Code of the input's frequency range, on chips that need it; else 0.
    pub range: u32,
}

/// PLL settings for both oscillators of a board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plls {
    /// Settings for the external source, if there is one.
    pub external: Option<Pll>,
    /// Settings for the chip's own oscillator, the fallback if the external source fails.
    pub internal: Pll,
}

/// Limits of a family's PLL.
#[derive(Debug)]
pub(crate) struct PllLimits {
    /// Lowest and highest input frequency [Hz].
    pub input: (u32, u32),
    /// Preferred input frequency [Hz]. If it cannot be made, the highest possible one is used: a faster input jitters
    /// less.
    pub preferred_input: u32,
    /// Frequency of the PLL's own oscillator, twice the core clock [Hz].
    pub oscillator: u32,
    /// Smallest and largest M.
    pub divider: (u32, u32),
    /// Smallest and largest N.
    pub factor: (u32, u32),
    /// Input frequencies at which the range code rises by one [Hz].
    pub ranges: &'static [u32],
}

/// Common crystal frequencies [Hz].
const COMMON_CRYSTALS: [u32; 12] = [
    4_000_000, 5_000_000, 6_000_000, 8_000_000, 10_000_000, 12_000_000, 16_000_000, 20_000_000, 24_000_000, 25_000_000,
    26_000_000, 48_000_000,
];

impl PllLimits {
    /// Settings for an oscillator [Hz]; `None` if no pair of divider and factor gives the core clock exactly.
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

    /// Common frequencies within bounds that give the core clock [Hz].
    pub fn common_frequencies(&self, (least, greatest): (u32, u32)) -> Vec<u32> {
        let fits = |frequency: &u32| (least..=greatest).contains(frequency) && self.settings(*frequency).is_some();
        COMMON_CRYSTALS.into_iter().filter(fits).collect()
    }
}
