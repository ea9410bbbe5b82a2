//! Reset and clock control of STM32G474 and STM32G431: RM0440 section 7.

use super::Peripheral;
use super::rcc::{CR, Layout, Origin, Oscillators, bus_divider, peripheral_divider, pll_is_on, timer_clock, within};
use crate::register::{Register, Registers, bit, bits};
use crate::wires::{Clocks, MICROSECOND, Reset, Time, Wires};

const CFGR: u32 = 0x08;
const CIFR: u32 = 0x1c;
const CICR: u32 = 0x20;
const PLLCFGR: u32 = 0x0c;
const CCIPR: u32 = 0x88;
const CSR: u32 = 0x94;
/// Internal oscillator [Hz].
const INTERNAL: u64 = 16_000_000;
const READY: u32 = bit(10) | bit(17) | bit(25);
const FLAGS: u32 = bits(31, 25);
/// RM0440 7.2.16: divider of the external source for capture by timers.
const MEASURED: u32 = 32;
/// RM0440 7.2.7: a larger clock step requires a microsecond at half speed.
const STEP: u64 = 80_000_000;

/// RM0440 7.4, without the cryptography of STM32G484.
const MAP: [Register; 28] = [
    Register::new("RCC_CR", CR, 0x0500, bits(10, 8) | bits(19, 16) | bits(25, 24)).special(READY),
    Register::new("RCC_ICSCR", 0x04, 0x4000_0000, 0x7fff_0000).special(0x00ff_0000),
    Register::new("RCC_CFGR", CFGR, 0x05, 0x7f00_3fff).special(0xc),
    Register::new("RCC_PLLCFGR", PLLCFGR, 0x1000, 0xff73_7ff3 | bits(31, 27)),
    Register::new("RCC_CIER", 0x18, 0, 0x63b),
    Register::new("RCC_CIFR", CIFR, 0, 0x73b).special(u32::MAX),
    Register::new("RCC_CICR", CICR, 0, 0x73b).special(u32::MAX),
    Register::new("RCC_AHB1RSTR", 0x28, 0, 0x111f),
    Register::new("RCC_AHB2RSTR", 0x2c, 0, 0x040f_607f),
    Register::new("RCC_AHB3RSTR", 0x30, 0, 0x0101),
    Register::new("RCC_APB1RSTR1", 0x38, 0, 0xd2fe_c13f),
    Register::new("RCC_APB1RSTR2", 0x3c, 0, 0x0103),
    Register::new("RCC_APB2RSTR", 0x40, 0, 0x0437_f801),
    Register::new("RCC_AHB1ENR", 0x48, 0x0100, 0x111f),
    Register::new("RCC_AHB2ENR", 0x4c, 0, 0x040f_607f),
    Register::new("RCC_AHB3ENR", 0x50, 0, 0x0101),
    Register::new("RCC_APB1ENR1", 0x58, 0x0400, 0xd2fe_cd3f),
    Register::new("RCC_APB1ENR2", 0x5c, 0, 0x0103),
    Register::new("RCC_APB2ENR", 0x60, 0, 0x0437_f801),
    Register::new("RCC_AHB1SMENR", 0x68, 0x131f, 0x131f),
    Register::new("RCC_AHB2SMENR", 0x6c, 0x040f_667f, 0x040f_667f),
    Register::new("RCC_AHB3SMENR", 0x70, 0x0101, 0x0101),
    Register::new("RCC_APB1SMENR1", 0x78, 0xd2fe_cd3f, 0xd2fe_cd3f),
    Register::new("RCC_APB1SMENR2", 0x7c, 0x0103, 0x0103),
    Register::new("RCC_APB2SMENR", 0x80, 0x0437_f801, 0x0437_f801),
    Register::new("RCC_CCIPR", CCIPR, 0, u32::MAX),
    Register::new("RCC_BDCR", 0x90, 0, 0x0301_837f).special(bit(1)),
    Register::new("RCC_CSR", CSR, 0x0c00_0000, 0xfe80_0003).special(FLAGS | bit(1)),
];

/// Category 3: STM32G474.
static CATEGORY_3: [Register; 28] = MAP;
/// Category 2: STM32G431, without ADC3 to ADC5, DAC2, DAC4, FMC, QUADSPI, TIM5, UART5, I2C4, SPI4, TIM20 and HRTIM.
/// Resets and gates of each bus.
static CATEGORY_2: [Register; 28] = without(&[
    ([0x2c, 0x4c], bit(14) | bit(17) | bit(19)),
    ([0x30, 0x50], bit(0) | bit(8)),
    ([0x38, 0x58], bit(3) | bit(20)),
    ([0x3c, 0x5c], bit(1)),
    ([0x40, 0x60], bit(15) | bit(20) | bit(26)),
]);

/// Register map with additional reserved bits in some registers.
const fn without(lacking: &[([u32; 2], u32)]) -> [Register; 28] {
    let mut map = MAP;
    let mut place = 0;
    while place < map.len() {
        let mut bus = 0;
        while bus < lacking.len() {
            let ([hold, gate], bits) = lacking[bus];
            if map[place].offset == hold || map[place].offset == gate {
                map[place].fields &= !bits;
            }
            bus += 1;
        }
        place += 1;
    }
    map
}

static LAYOUT: Layout = Layout {
    internal: [8, 10],
    codes: [1, 2, 3],
    selection: (CFGR, 2),
    refusal: "selects a source that is not ready, or the PLL without PLLREN",
    sections: ["RM0440 7.4.1", "RM0440 7.4.1 HSEBYP", "RM0440 7.2.7"],
    security: [(CIFR, 8), (CICR, 8)],
};

/// Reset and clock controller.
#[derive(Debug)]
pub struct Rcc {
    registers: Registers,
    oscillators: Oscillators,
    /// Time since which the bus clock has been half the system clock.
    halved_since: Option<Time>,
}

impl Rcc {
    /// Controller of the STM32G474.
    pub fn category_3() -> Self {
        Self::with(Registers::new(&CATEGORY_3))
    }

    /// Controller of the STM32G431.
    pub fn category_2() -> Self {
        Self::with(Registers::new(&CATEGORY_2))
    }

    fn with(registers: Registers) -> Self {
        Self { registers, oscillators: Oscillators::new(&LAYOUT), halved_since: None }
    }

    fn pll_source(&self) -> Origin {
        if self.registers.field(PLLCFGR, 0, 2) == 3 { Origin::External } else { Origin::Internal }
    }

    fn source_rate(&self) -> u64 {
        match self.registers.field(PLLCFGR, 0, 2) {
            2 => INTERNAL,
            3 => self.oscillators.external_rate,
            _ => 0,
        }
    }

    /// Input, VCO and output frequency of the PLL: RM0440 7.4.4.
    fn pll_rates(&self) -> [u64; 3] {
        let input = self.source_rate() / u64::from(self.registers.field(PLLCFGR, 4, 4) + 1);
        let inner = input * u64::from(self.registers.field(PLLCFGR, 8, 7));
        [input, inner, inner / u64::from(2 * (self.registers.field(PLLCFGR, 25, 2) + 1))]
    }

    fn start_pll(&mut self, wires: &mut Wires) {
        let [input, inner, output] = self.pll_rates();
        if !self.oscillators.is_ready(self.pll_source(), wires) {
            wires.violation("RCC_CR", "the PLL is switched on before its source is ready", "RM0440 7.2.4");
        }
        within(wires, "RCC_PLLCFGR", "the input of the PLL", input, [2_660_000, 16_000_000], "RM0440 7.4.4 PLLM");
        within(wires, "RCC_PLLCFGR", "the PLL inside", inner, [96_000_000, 344_000_000], "RM0440 7.4.4 PLLN");
        within(wires, "RCC_PLLCFGR", "the output of the PLL", output, [8_000_000, 170_000_000], "RM0440 7.4.4 PLLR");
        let factor = self.registers.field(PLLCFGR, 8, 7);
        if !(8..=127).contains(&factor) {
            wires.violation("RCC_PLLCFGR", format!("N {factor} is not allowed"), "RM0440 7.4.4 PLLN");
        }
    }

    fn control_written(&mut self, value: u32, before: u32, wires: &mut Wires) {
        if self.oscillators.control_written(value, before, &self.registers, wires) {
            self.start_pll(wires);
        }
    }

    fn configuration_written(&mut self, value: u32, before: u32, wires: &mut Wires) {
        let rate = |rcc: &Self| rcc.system() / bus_divider(rcc.registers.field(CFGR, 4, 4));
        let slow = wires.clocks.core;
        let led_out = self.registers.is_set(PLLCFGR, 24);
        self.oscillators.select(value, led_out, &mut self.registers, wires);
        let (was, is) = (before >> 4 & 0xf, value >> 4 & 0xf);
        let fast = rate(self);
        if is == 8 && was != 8 {
            self.halved_since = Some(wires.now);
        }
        let switches = (value ^ before) & 3 != 0;
        if switches && is == 8 {
            self.halved_since = Some(wires.now);
        }
        if fast > slow && fast > STEP && slow < STEP && was != 8 && is != 8 {
            let what = "the bus clock rises over 80 MHz at once, with no microsecond at half speed between";
            wires.violation("RCC_CFGR", what, "RM0440 7.2.7");
        }
        if was == 8 && is < 8 && fast > STEP && self.halved_since.is_none_or(|since| wires.now < since + MICROSECOND) {
            wires.violation("RCC_CFGR", "the bus clock was at half speed for less than a microsecond", "RM0440 7.2.7");
        }
    }

    /// Clock that FDCANSEL selects, while it runs [Hz]: 7.4.27.
    fn can_clock(&self, low: u64, wires: &Wires) -> u64 {
        match self.registers.field(CCIPR, 24, 2) {
            0 => self.oscillators.divided_external(1, wires).unwrap_or(0),
            1 if self.registers.is_set(PLLCFGR, 20) && self.oscillators.is_ready(Origin::Pll, wires) => {
                self.pll_rates()[1] / u64::from(2 * (self.registers.field(PLLCFGR, 21, 2) + 1))
            }
            2 => low,
            _ => 0,
        }
    }

    fn system(&self) -> u64 {
        match self.oscillators.selected(&self.registers) {
            Origin::Internal => INTERNAL,
            Origin::External => self.oscillators.external_rate,
            Origin::Pll => self.pll_rates()[2],
        }
    }
}

impl Peripheral for Rcc {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn written(&mut self, offset: u32, value: u32, before: u32, wires: &mut Wires) {
        match offset {
            CR => self.control_written(value, before, wires),
            PLLCFGR if pll_is_on(&self.registers) && (value ^ before) & !(bit(16) | bit(20) | bit(24)) != 0 => {
                wires.violation("RCC_PLLCFGR", "is written while the PLL is on", "RM0440 7.4.4");
            }
            CFGR => self.configuration_written(value, before, wires),
            CICR => self.oscillators.clear_security(offset, value, &mut self.registers),
            CSR if value & bit(23) != 0 => self.registers.change(CSR, 0, FLAGS | bit(23)),
            _ => {}
        }
        for offset in [0x28, 0x2c, 0x30, 0x38, 0x3c, 0x40, 0x48, 0x4c, 0x50, 0x58, 0x5c, 0x60] {
            wires.gates.insert(offset, self.registers.get(offset));
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        let pll_source = self.pll_source();
        self.oscillators.watch(pll_source, &mut self.registers, wires);
        self.registers.change(CR, self.oscillators.ready_flags(wires), READY);
        wires.divided_external = self.oscillators.divided_external(MEASURED, wires);
        let system = self.system();
        let core = system / bus_divider(self.registers.field(CFGR, 4, 4));
        let low = core / peripheral_divider(self.registers.field(CFGR, 8, 3));
        let high = core / peripheral_divider(self.registers.field(CFGR, 11, 3));
        wires.fdcan.selected = self.can_clock(low, wires);
        let clocks = Clocks { system, core, bus: core, low, high, timers: timer_clock(core, high) };
        if clocks != wires.clocks {
            wires.clocks = clocks;
            if system == 0 {
                return;
            }
            within(wires, "RCC_CFGR", "the clock of the core", core, [1, 170_000_000], "RM0440 7.2");
        }
    }

    fn next_event(&self) -> Option<Time> {
        self.oscillators.next_event()
    }

    /// RM0440 7.1: a reset keeps the reset flags.
    fn reset(&mut self) {
        let flags = self.registers.get(CSR) & FLAGS;
        self.registers.reset();
        *self = Self::with(self.registers.clone());
        self.registers.set(CSR, flags);
    }
}

/// Flags set by a reset: RM0440 7.4.28.
pub fn flags(reset: Reset) -> (u32, u32) {
    let flags = match reset {
        Reset::Power => bit(26) | bit(27),
        Reset::Software => bit(28) | bit(26),
        Reset::Watchdog => bit(29) | bit(26),
    };
    (CSR, flags)
}

/// Core clock after a reset [Hz].
pub const AFTER_RESET: u64 = INTERNAL;
