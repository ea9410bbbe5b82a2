//! Parts shared by the reset and clock controllers of the three chips: oscillators with start-up times, dividers, reset
//! flags.

use crate::register::{Registers, bit};
use crate::wires::{MICROSECOND, Time, Wires};

/// Times to the ready flags. A crystal takes the longest: 2 ms in all three data sheets.
const CRYSTAL_START: Time = 2000 * MICROSECOND;
/// Start-up of the input stage for an external clock signal.
const BYPASS_START: Time = 2 * MICROSECOND;
/// Start-up of the internal oscillator, at most 4 us.
const INTERNAL_START: Time = 4 * MICROSECOND;
/// Lock time of a PLL: 200 us (F405), less on the others.
const PLL_LOCK: Time = 200 * MICROSECOND;

/// Clock source that becomes ready a while after it is switched on.
#[derive(Debug, Clone, Copy, Default)]
struct Source {
    ready_at: Option<Time>,
}

impl Source {
    /// Source that has been running for long.
    const RUNNING: Self = Self { ready_at: Some(0) };

    /// Switches the source; `start` is `None` if it never becomes ready.
    fn switch(&mut self, on: bool, start: Option<Time>, now: Time) {
        self.ready_at = match (on, self.ready_at) {
            (false, _) => None,
            (true, Some(ready)) => Some(ready),
            (true, None) => start.map(|start| now + start),
        };
    }

    /// Returns whether the source is ready.
    fn is_ready(self, now: Time) -> bool {
        self.ready_at.is_some_and(|ready| ready <= now)
    }
}

/// Frequency of the external source and the time to its ready flag, if it starts at all.
fn external(wires: &Wires, bypass: bool) -> Option<(u64, Time)> {
    match bypass {
        _ if wires.surroundings.is_dead(wires.now) => None,
        true => wires.surroundings.external_clock.map(|rate| (rate, BYPASS_START)),
        false => wires.surroundings.crystal.map(|rate| (rate, CRYSTAL_START)),
    }
}

/// Control register of all three chips, with the bits common to them: RM0090 7.3.1, RM0440 7.4.1, RM0433 8.7.2.
pub const CR: u32 = 0x00;
const HSEON: u32 = bit(16);
const HSERDY: u32 = 17;
const HSEBYP: u32 = bit(18);
const CSSON: u32 = bit(19);
const PLLON: u32 = 24;
const PLLRDY: u32 = 25;

/// Possible source of the system clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// Internal oscillator.
    Internal,
    /// External source.
    External,
    /// PLL.
    Pll,
}

/// Register layout of a chip, as far as it differs.
#[derive(Debug)]
pub struct Layout {
    /// Bits of HSION and HSIRDY in the control register.
    pub internal: [u32; 2],
    /// Codes of internal oscillator, external source and PLL in SW and SWS.
    pub codes: [u32; 3],
    /// Register of SW, which begins at bit 0, and the width of SW; SWS follows SW.
    pub selection: (u32, u32),
    /// Text for a rejected selection.
    pub refusal: &'static str,
    /// Sections of the control register, of HSEBYP, and of the selection.
    pub sections: [&'static str; 3],
    /// Flag of the clock security system, and the bit that clears it, as registers and bits.
    pub security: [(u32, u32); 2],
}

/// Internal oscillator, external source, and the PLL behind them.
#[derive(Debug)]
pub struct Oscillators {
    layout: &'static Layout,
    internal: Source,
    external: Source,
    pll: Source,
    /// Frequency of the external source while it can run; 0 once it has failed [Hz].
    pub external_rate: u64,
    /// Time at which the external source fails.
    dies_at: Option<Time>,
}

impl Oscillators {
    /// State after a reset: the internal oscillator runs.
    pub fn new(layout: &'static Layout) -> Self {
        let (external, pll) = (Source::default(), Source::default());
        Self { layout, internal: Source::RUNNING, external, pll, external_rate: 0, dies_at: None }
    }

    /// Returns whether a source is ready.
    pub fn is_ready(&self, origin: Origin, wires: &Wires) -> bool {
        let source = match origin {
            Origin::Internal => self.internal,
            Origin::External => self.external,
            Origin::Pll => self.pll,
        };
        source.is_ready(wires.now)
    }

    /// Ready flags in the control register.
    pub fn ready_flags(&self, wires: &Wires) -> u32 {
        let ready = [(self.internal, self.layout.internal[1]), (self.external, HSERDY), (self.pll, PLLRDY)];
        ready.iter().map(|(source, place)| u32::from(source.is_ready(wires.now)) << place).sum()
    }

    /// Source of the system clock, by SWS.
    pub fn selected(&self, registers: &Registers) -> Origin {
        let (register, width) = self.layout.selection;
        self.origin(registers.field(register, width, width)).unwrap_or(Origin::Internal)
    }

    /// Source for a code.
    pub fn origin(&self, code: u32) -> Option<Origin> {
        let place = self.layout.codes.iter().position(|known| *known == code)?;
        Some([Origin::Internal, Origin::External, Origin::Pll][place])
    }

    /// Handles a write of the control register; returns whether it switches the PLL on.
    pub fn control_written(&mut self, value: u32, before: u32, registers: &Registers, wires: &mut Wires) -> bool {
        let [control, bypass, _] = self.layout.sections;
        let internal = bit(self.layout.internal[0]);
        let source = match self.selected(registers) {
            Origin::Internal => internal,
            Origin::External => HSEON,
            Origin::Pll => bit(PLLON),
        };
        if value & source == 0 {
            wires.violation("RCC_CR", "switches off the source of the system clock", control);
        }
        if value & HSEON != 0 && (value ^ before) & HSEBYP != 0 && before & HSEON != 0 {
            wires.violation("RCC_CR", "HSEBYP is changed while HSEON is 1", bypass);
        }
        let outside = external(wires, value & HSEBYP != 0);
        self.external_rate = outside.map_or(0, |(rate, _)| rate);
        self.internal.switch(value & internal != 0, Some(INTERNAL_START), wires.now);
        self.external.switch(value & HSEON != 0, outside.map(|(_, start)| start), wires.now);
        self.pll.switch(value & bit(PLLON) != 0, Some(PLL_LOCK), wires.now);
        value & !before & bit(PLLON) != 0
    }

    /// Clears the flag of the clock security system if the right bit is written as one.
    pub fn clear_security(&self, offset: u32, value: u32, registers: &mut Registers) {
        let [(flags, flag), (clears, clear)] = self.layout.security;
        if offset == clears && value >> clear & 1 == 1 {
            registers.change(flags, 0, bit(flag));
        }
    }

    /// Tracks the external source. If it fails with the clock security system on, the source is switched off, with the
    /// PLL if that depends on it; the internal oscillator takes over, and the flag holds the non-maskable interrupt
    /// (RM0090 7.2.7, RM0440 7.2.9, RM0433 8.5.3). Without the clock security system the clocks driven by the source
    /// stop.
    pub fn watch(&mut self, pll_source: Origin, registers: &mut Registers, wires: &mut Wires) {
        self.dies_at = wires.surroundings.dies_at.filter(|time| *time > wires.now);
        if wires.surroundings.is_dead(wires.now) {
            self.external_rate = 0;
            if registers.get(CR) & CSSON != 0 && self.external.is_ready(wires.now) {
                self.fall_back(pll_source, registers, wires);
            }
        }
        let (flags, flag) = self.layout.security[0];
        wires.non_maskable |= registers.is_set(flags, flag);
    }

    fn fall_back(&mut self, pll_source: Origin, registers: &mut Registers, wires: &Wires) {
        let selected = self.selected(registers);
        self.external.switch(false, None, wires.now);
        registers.change(CR, 0, HSEON);
        let lost_pll = pll_source == Origin::External;
        if lost_pll {
            self.pll.switch(false, None, wires.now);
            registers.change(CR, 0, bit(PLLON));
        }
        if selected == Origin::External || selected == Origin::Pll && lost_pll {
            let (register, width) = self.layout.selection;
            let code = self.layout.codes[0];
            self.internal = Source::RUNNING;
            registers.change(CR, bit(self.layout.internal[0]), 0);
            registers.change(register, code << width | code, bit(2 * width) - 1);
        }
        let (flags, flag) = self.layout.security[0];
        registers.change(flags, bit(flag), 0);
    }

    /// Future time at which the external source fails.
    pub fn next_event(&self) -> Option<Time> {
        self.dies_at
    }

    /// Frequency of the external source behind a divider, while it runs.
    pub fn divided_external(&self, divider: u32, wires: &Wires) -> Option<u64> {
        let runs = self.external.is_ready(wires.now) && self.external_rate > 0;
        runs.then(|| self.external_rate.checked_div(divider.into())).flatten()
    }

    /// Handles a write of SW: the selection takes effect if its source is ready. `led_out` tells whether the PLL's
    /// output to the system clock is enabled, on chips with such a switch.
    pub fn select(&self, value: u32, led_out: bool, registers: &mut Registers, wires: &mut Wires) {
        let (register, width) = self.layout.selection;
        let code = value & (bit(width) - 1);
        let ready =
            self.origin(code).is_some_and(|origin| self.is_ready(origin, wires) && (led_out || origin != Origin::Pll));
        if ready {
            registers.change(register, code << width, (bit(width) - 1) << width);
        } else {
            wires.violation("RCC_CFGR", self.layout.refusal, self.layout.sections[2]);
        }
    }
}

/// Returns whether the PLL is on; it must not be configured then.
pub fn pll_is_on(registers: &Registers) -> bool {
    registers.is_set(CR, PLLON)
}

/// Divider of the core's bus: RM0090 7.3.3, RM0440 7.4.3, RM0433 8.7.6.
pub fn bus_divider(code: u32) -> u64 {
    match code {
        0..8 => 1,
        8..12 => 2 << (code - 8),
        _ => 64 << (code - 12),
    }
}

/// Divider of a peripheral bus, in the same registers.
pub fn peripheral_divider(code: u32) -> u64 {
    if code < 4 { 1 } else { 2 << (code - 4) }
}

/// Clock of the timers on a peripheral bus: the bus clock if it is not divided, else twice the bus clock (RM0090 7.2,
/// RM0440 7.2, RM0433 8.7.6 with TIMPRE 0).
pub fn timer_clock(bus: u64, peripherals: u64) -> u64 {
    if bus == peripherals { bus } else { 2 * peripherals }
}

/// Frequency in megahertz, for messages.
pub fn megahertz(rate: u64) -> String {
    format!("{:.3} MHz", rate as f64 / 1e6)
}

/// Records a violation if a frequency is out of range.
pub fn within(wires: &mut Wires, register: &str, what: &str, rate: u64, [low, high]: [u64; 2], section: &'static str) {
    if !(low..=high).contains(&rate) {
        let [low, high] = [low, high].map(megahertz);
        let what = format!("{what} is {}: {low} to {high} are allowed", megahertz(rate));
        wires.violation(register, what, section);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dividers_match_manual() {
        assert_eq!([0, 8, 11, 12, 15].map(bus_divider), [1, 2, 16, 64, 512]);
        assert_eq!([0, 4, 5, 7].map(peripheral_divider), [1, 2, 4, 16]);
    }

    #[test]
    fn clock_source_ready_after_its_time() {
        let mut source = Source::default();
        source.switch(true, Some(5), 10);
        source.switch(true, Some(5), 14);
        assert_eq!([14, 15].map(|now| source.is_ready(now)), [false, true]);
        source.switch(false, Some(5), 20);
        assert!(!source.is_ready(100));
    }
}
