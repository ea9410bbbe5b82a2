//! Time of a processor for the step: clock, cycles per instruction, flash wait, and share of the period. No cycle count
//! was measured on silicon. A board's work in addition to the step is not counted.

/// Processor and its share of time for the step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Processor {
    /// Core clock [Hz].
    pub clock: u32,
    /// Cycles per instruction of the step from memory without wait states.
    pub cycles_per_instruction: f64,
    /// Additional mean cycles per instruction spent waiting for flash.
    pub flash_wait: f64,
    /// Share of the period for the worst-case step; the tick handler needs the rest.
    pub share: f64,
}

impl Processor {
    /// STM32F405: Cortex-M4F at 168 MHz. 1.4 cycles per instruction: timing tables of the core's manual, weighted by a
    /// trace of the step. No flash wait: from the data sheet of the flash accelerator; the trace does not show it.
    pub const STM32F405: Self =
        Self { clock: 168_000_000, cycles_per_instruction: 1.4, flash_wait: 0.0, share: USUAL_SHARE };
    /// STM32G474 and STM32G431: Cortex-M4F at 170 MHz. The flash delivers two instructions every five cycles and the
    /// accelerator holds a quarter of the step; assumed flash wait: half a cycle.
    pub const STM32G474: Self = Self { clock: 170_000_000, flash_wait: 0.5, ..Self::STM32F405 };
    /// STM32H743: Cortex-M7 at 400 MHz. One cycle per instruction: the core can issue two at once, but the instructions of
    /// the step depend on one another. The instruction cache holds the whole step.
    pub const STM32H743: Self = Self { clock: 400_000_000, cycles_per_instruction: 1.0, ..Self::STM32F405 };

    /// Returns the instructions per second.
    pub fn instructions_per_second(&self) -> f64 {
        f64::from(self.clock) / (self.cycles_per_instruction + self.flash_wait)
    }

    /// Returns the limit of the instructions of a worst-case step.
    pub fn affordable(&self, tick_rate: u32) -> f64 {
        self.share * self.instructions_per_second() / f64::from(tick_rate)
    }

    /// Returns the share of the period that `instructions` take.
    pub fn part(&self, instructions: f64, tick_rate: u32) -> f64 {
        instructions * f64::from(tick_rate) / self.instructions_per_second()
    }
}

/// Default share: the tick handler of the plant's firmware takes about 240 of 6,000 instructions in addition to the step
/// (EMULATED, Cortex-M4F, 20 kHz).
const USUAL_SHARE: f64 = 0.96;
