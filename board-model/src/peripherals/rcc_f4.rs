//! Reset and clock control of STM32F405: RM0090 section 7.

use super::Peripheral;
use super::rcc::{CR, Layout, Origin, Oscillators, bus_divider, peripheral_divider, pll_is_on, timer_clock, within};
use crate::register::{Register, Registers, bit, bits};
use crate::wires::{Clocks, Reset, Time, Wires};

const PLLCFGR: u32 = 0x04;
const CFGR: u32 = 0x08;
const CIR: u32 = 0x0c;
const CSR: u32 = 0x74;
/// Internal oscillator [Hz].
const INTERNAL: u64 = 16_000_000;
const READY: u32 = bit(1) | bit(17) | bit(25) | bit(27);
const FLAGS: u32 = bits(31, 25);

/// RM0090 7.3, without the parts that the STM32F405 lacks: Ethernet, camera, cryptography, separate audio PLL.
static MAP: [Register; 18] = [
    Register::new("RCC_CR", CR, 0x83, bits(15, 3) | bits(1, 0) | bits(19, 16) | bits(27, 24))
        .special(READY | bits(15, 8)),
    Register::new("RCC_PLLCFGR", PLLCFGR, 0x2400_3010, 0x0f43_7fff),
    Register::new("RCC_CFGR", CFGR, 0, 0xffff_fcff).special(0xc),
    Register::new("RCC_CIR", CIR, 0, 0x00bf_3fbf).special(0x00bf_00bf),
    Register::new("RCC_AHB1RSTR", 0x10, 0, 0x2060_11ff),
    Register::new("RCC_AHB2RSTR", 0x14, 0, 0xc0),
    Register::new("RCC_AHB3RSTR", 0x18, 0, 1),
    Register::new("RCC_APB1RSTR", 0x20, 0, 0x36fe_c9ff),
    Register::new("RCC_APB2RSTR", 0x24, 0, 0x0007_5933),
    Register::new("RCC_AHB1ENR", 0x30, 0x0010_0000, 0x6074_11ff),
    Register::new("RCC_AHB2ENR", 0x34, 0, 0xc0),
    Register::new("RCC_AHB3ENR", 0x38, 0, 1),
    Register::new("RCC_APB1ENR", 0x40, 0, 0x36fe_c9ff),
    Register::new("RCC_APB2ENR", 0x44, 0, 0x0007_5f33),
    Register::new("RCC_BDCR", 0x70, 0, 0x0001_8307).special(bit(1)),
    Register::new("RCC_CSR", CSR, 0x0e00_0000, 0xff00_0003).special(FLAGS | bit(1)),
    Register::new("RCC_SSCGR", 0x80, 0, 0xcfff_ffff),
    Register::new("RCC_PLLI2SCFGR", 0x84, 0x2000_3000, 0x7000_7fc0),
];

static LAYOUT: Layout = Layout {
    internal: [0, 1],
    codes: [0, 1, 2],
    selection: (CFGR, 2),
    refusal: "selects a source that is not ready",
    sections: ["RM0090 7.3.1", "RM0090 7.3.1 HSEBYP", "RM0090 7.2.6"],
    security: [(CIR, 7), (CIR, 23)],
};

/// Reset and clock controller.
#[derive(Debug)]
pub struct Rcc {
    registers: Registers,
    oscillators: Oscillators,
}

impl Default for Rcc {
    fn default() -> Self {
        Self { registers: Registers::new(&MAP), oscillators: Oscillators::new(&LAYOUT) }
    }
}

impl Rcc {
    fn pll_source(&self) -> Origin {
        if self.registers.is_set(PLLCFGR, 22) { Origin::External } else { Origin::Internal }
    }

    /// Input, VCO and output frequency of the PLL: RM0090 7.3.2.
    fn pll_rates(&self) -> [u64; 3] {
        let source = match self.pll_source() {
            Origin::External => self.oscillators.external_rate,
            _ => INTERNAL,
        };
        let input = source / u64::from(self.registers.field(PLLCFGR, 0, 6)).max(1);
        let inner = input * u64::from(self.registers.field(PLLCFGR, 6, 9));
        [input, inner, inner / u64::from(2 * (self.registers.field(PLLCFGR, 16, 2) + 1))]
    }

    fn start_pll(&mut self, wires: &mut Wires) {
        let [input, inner, output] = self.pll_rates();
        if !self.oscillators.is_ready(self.pll_source(), wires) {
            wires.violation("RCC_CR", "the PLL is switched on before its source is ready", "RM0090 7.2.3");
        }
        within(wires, "RCC_PLLCFGR", "the input of the PLL", input, [1_000_000, 2_000_000], "RM0090 7.3.2 PLLM");
        within(wires, "RCC_PLLCFGR", "the PLL inside", inner, [100_000_000, 432_000_000], "RM0090 7.3.2 PLLN");
        within(wires, "RCC_PLLCFGR", "the output of the PLL", output, [24_000_000, 168_000_000], "RM0090 7.3.2 PLLP");
        let [m, n, q] = [(0, 6), (6, 9), (24, 4)].map(|(low, width)| self.registers.field(PLLCFGR, low, width));
        if m < 2 || !(50..=432).contains(&n) || q < 2 {
            wires.violation("RCC_PLLCFGR", format!("M {m}, N {n} or Q {q} is not allowed"), "RM0090 7.3.2");
        }
    }

    fn control_written(&mut self, value: u32, before: u32, wires: &mut Wires) {
        if self.oscillators.control_written(value, before, &self.registers, wires) {
            self.start_pll(wires);
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
            PLLCFGR if pll_is_on(&self.registers) => {
                wires.violation("RCC_PLLCFGR", "is written while the PLL is on", "RM0090 7.3.2");
            }
            CFGR => self.oscillators.select(value, true, &mut self.registers, wires),
            CIR => self.oscillators.clear_security(offset, value, &mut self.registers),
            CSR if value & bit(24) != 0 => self.registers.change(CSR, 0, FLAGS | bit(24)),
            _ => {}
        }
        for offset in [0x10, 0x20, 0x24, 0x30, 0x34, 0x38, 0x40, 0x44] {
            wires.gates.insert(offset, self.registers.get(offset));
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        let pll_source = self.pll_source();
        self.oscillators.watch(pll_source, &mut self.registers, wires);
        self.registers.change(CR, self.oscillators.ready_flags(wires), READY);
        // RTCPRE: values below 2 give no clock.
        let divider = Some(self.registers.field(CFGR, 16, 5)).filter(|divider| *divider > 1);
        wires.divided_external = divider.and_then(|divider| self.oscillators.divided_external(divider, wires));
        let system = match self.oscillators.selected(&self.registers) {
            Origin::Internal => INTERNAL,
            Origin::External => self.oscillators.external_rate,
            Origin::Pll => self.pll_rates()[2],
        };
        let core = system / bus_divider(self.registers.field(CFGR, 4, 4));
        let low = core / peripheral_divider(self.registers.field(CFGR, 10, 3));
        let high = core / peripheral_divider(self.registers.field(CFGR, 13, 3));
        let clocks = Clocks { system, core, bus: core, low, high, timers: timer_clock(core, high) };
        if clocks != wires.clocks {
            wires.clocks = clocks;
            if system == 0 {
                return;
            }
            for (what, rate, most) in [("core", core, 168), ("APB1", low, 42), ("APB2", high, 84)] {
                let what = format!("the clock of {what}");
                within(wires, "RCC_CFGR", &what, rate, [1, most * 1_000_000], "RM0090 7.3.3");
            }
        }
    }

    fn next_event(&self) -> Option<Time> {
        self.oscillators.next_event()
    }

    /// RM0090 7.1.1: a reset keeps the reset flags.
    fn reset(&mut self) {
        let flags = self.registers.get(CSR) & FLAGS;
        *self = Self::default();
        self.registers.set(CSR, flags);
    }
}

/// Flags set by a reset: RM0090 7.3.21.
pub fn flags(reset: Reset) -> (u32, u32) {
    (
        CSR,
        match reset {
            Reset::Power => 0x0e00_0000,
            Reset::Software => bit(28) | bit(26),
            Reset::Watchdog => bit(29) | bit(26),
        },
    )
}

/// Core clock after a reset [Hz].
pub const AFTER_RESET: u64 = INTERNAL;
