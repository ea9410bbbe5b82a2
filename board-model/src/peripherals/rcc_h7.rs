//! Reset and clock control of STM32H743: RM0433 section 8. Only PLL 1 is modelled; the other two must stay off.

use super::Peripheral;
use super::rcc::{CR, Layout, Origin, Oscillators, bus_divider, peripheral_divider, pll_is_on, timer_clock, within};
use crate::register::{Register, Registers, bit};
use crate::wires::{Clocks, Reset, Time, Wires};

const CFGR: u32 = 0x10;
const CIFR: u32 = 0x64;
const CICR: u32 = 0x68;
const D1CFGR: u32 = 0x18;
const D2CFGR: u32 = 0x1c;
const PLLCKSELR: u32 = 0x28;
const PLLCFGR: u32 = 0x2c;
const PLL1DIVR: u32 = 0x30;
const D2CCIP1R: u32 = 0x50;
const RSR: u32 = 0xd0;
/// Internal oscillator [Hz].
const INTERNAL: u64 = 64_000_000;
const READY: u32 = bit(2) | bit(5) | bit(8) | bit(13) | bit(14) | bit(15) | bit(17) | bit(25) | bit(27) | bit(29);
const FLAGS: u32 = 0x55fa_0000;

/// RM0433 8.7, without the cryptography of STM32H753.
static MAP: [Register; 45] = [
    Register::new("RCC_CR", CR, 0xc025, 0x3f0f_f3bf).special(READY),
    Register::new("RCC_HSICFGR", 0x04, 0x4000_0000, 0x7f00_0fff).special(0xfff),
    Register::new("RCC_CRRCR", 0x08, 0, 0x3ff).special(u32::MAX),
    Register::new("RCC_CSICFGR", 0x0c, 0x2000_0000, 0x3f00_00ff).special(0xff),
    Register::new("RCC_CFGR", CFGR, 0, 0xfffc_ffff).special(0x38),
    Register::new("RCC_D1CFGR", D1CFGR, 0, 0x0f7f),
    Register::new("RCC_D2CFGR", D2CFGR, 0, 0x0770),
    Register::new("RCC_D3CFGR", 0x20, 0, 0x0070),
    Register::new("RCC_PLLCKSELR", PLLCKSELR, 0x0202_0200, 0x03f3_f3f3),
    Register::new("RCC_PLLCFGR", PLLCFGR, 0x01ff_0000, 0x01ff_0fff),
    Register::new("RCC_PLL1DIVR", PLL1DIVR, 0x0101_0280, 0x7f7f_ffff),
    Register::new("RCC_PLL1FRACR", 0x34, 0, 0xfff8),
    Register::new("RCC_PLL2DIVR", 0x38, 0x0101_0280, 0x7f7f_ffff),
    Register::new("RCC_PLL2FRACR", 0x3c, 0, 0xfff8),
    Register::new("RCC_PLL3DIVR", 0x40, 0x0101_0280, 0x7f7f_ffff),
    Register::new("RCC_PLL3FRACR", 0x44, 0, 0xfff8),
    Register::new("RCC_D1CCIPR", 0x4c, 0, 0x3001_0033),
    Register::new("RCC_D2CCIP1R", D2CCIP1R, 0, 0xb137_71c7),
    Register::new("RCC_D2CCIP2R", 0x54, 0, 0x70f0_333f),
    Register::new("RCC_D3CCIPR", 0x58, 0, 0x77e3_ff07),
    Register::new("RCC_CIER", 0x60, 0, 0x03ff),
    Register::new("RCC_CIFR", CIFR, 0, 0x07ff).special(u32::MAX),
    Register::new("RCC_CICR", CICR, 0, 0x07ff).special(u32::MAX),
    Register::new("RCC_BDCR", 0x70, 0, 0x0001_837f).special(bit(1)),
    Register::new("RCC_CSR", 0x74, 0, 3).special(bit(1)),
    Register::new("RCC_AHB3RSTR", 0x7c, 0, 0x8001_5031),
    Register::new("RCC_AHB1RSTR", 0x80, 0, 0x0a00_8023),
    Register::new("RCC_AHB2RSTR", 0x84, 0, 0x0241),
    Register::new("RCC_AHB4RSTR", 0x88, 0, 0x0328_07ff),
    Register::new("RCC_APB3RSTR", 0x8c, 0, 0x0008),
    Register::new("RCC_APB1LRSTR", 0x90, 0, 0xe8ff_c3ff),
    Register::new("RCC_APB1HRSTR", 0x94, 0, 0x0136),
    Register::new("RCC_APB2RSTR", 0x98, 0, 0x31d7_3033),
    Register::new("RCC_APB4RSTR", 0x9c, 0, 0x0020_deaa),
    Register::new("RCC_GCR", 0xa0, 0, 1),
    Register::new("RCC_RSR", RSR, 0x00e8_0000, 0x55fb_0000).special(FLAGS),
    Register::new("RCC_AHB3ENR", 0xd4, 0, 0x0001_5031),
    Register::new("RCC_AHB1ENR", 0xd8, 0, 0x1e03_8023),
    Register::new("RCC_AHB2ENR", 0xdc, 0, 0xe000_0241),
    Register::new("RCC_AHB4ENR", 0xe0, 0, 0x1328_07ff),
    Register::new("RCC_APB3ENR", 0xe4, 0, 0x0048),
    Register::new("RCC_APB1LENR", 0xe8, 0, 0xe8ff_c3ff),
    Register::new("RCC_APB1HENR", 0xec, 0, 0x0136),
    Register::new("RCC_APB2ENR", 0xf0, 0, 0x31d7_3033),
    Register::new("RCC_APB4ENR", 0xf4, 0x0001_0000, 0x0021_deaa),
];

static LAYOUT: Layout = Layout {
    internal: [0, 2],
    codes: [0, 2, 3],
    selection: (CFGR, 3),
    refusal: "selects a source that is not ready",
    sections: ["RM0433 8.7.2", "RM0433 8.7.2 HSEBYP", "RM0433 8.7.6"],
    security: [(CIFR, 10), (CICR, 10)],
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
        if self.registers.field(PLLCKSELR, 0, 2) == 2 { Origin::External } else { Origin::Internal }
    }

    fn internal_rate(&self) -> u64 {
        INTERNAL >> self.registers.field(CR, 3, 2)
    }

    /// Input, VCO and output frequency of PLL 1: RM0433 8.5.5.
    fn pll_rates(&self) -> [u64; 3] {
        let source = match self.registers.field(PLLCKSELR, 0, 2) {
            0 => self.internal_rate(),
            2 => self.oscillators.external_rate,
            _ => 0,
        };
        let input = source.checked_div(self.registers.field(PLLCKSELR, 4, 6).into()).unwrap_or(0);
        let inner = input * u64::from(self.registers.field(PLL1DIVR, 0, 9) + 1);
        [input, inner, inner / u64::from(self.registers.field(PLL1DIVR, 9, 7) + 1)]
    }

    /// Clock that FDCANSEL selects, while it runs [Hz]: 8.7.20. Output Q of PLL 1 is divided by DIVQ1 + 1.
    fn can_clock(&self, wires: &Wires) -> u64 {
        match self.registers.field(D2CCIP1R, 28, 2) {
            0 => self.oscillators.divided_external(1, wires).unwrap_or(0),
            1 if self.registers.is_set(PLLCFGR, 17) && self.oscillators.is_ready(Origin::Pll, wires) => {
                self.pll_rates()[1] / u64::from(self.registers.field(PLL1DIVR, 16, 7) + 1)
            }
            _ => 0,
        }
    }

    fn start_pll(&mut self, wires: &mut Wires) {
        let [input, inner, output] = self.pll_rates();
        if !self.oscillators.is_ready(self.pll_source(), wires) {
            wires.violation("RCC_CR", "PLL 1 is switched on before its source is ready", "RM0433 8.5.5");
        }
        // PLL1RGE and PLL1VCOSEL must match the input frequency and the VCO.
        let range = self.registers.field(PLLCFGR, 2, 2);
        let medium = self.registers.is_set(PLLCFGR, 1);
        within(
            wires,
            "RCC_PLLCFGR",
            "the input of PLL 1, for its PLL1RGE,",
            input,
            [1_000_000 << range, 2_000_000 << range],
            "RM0433 8.7.13 PLL1RGE",
        );
        if medium && input > 2_000_000 {
            wires.violation("RCC_PLLCFGR", "the medium range inside takes 1 to 2 MHz only", "RM0433 8.7.13 PLL1VCOSEL");
        }
        let inside = if medium { [150_000_000, 420_000_000] } else { [192_000_000, 836_000_000] };
        within(wires, "RCC_PLL1DIVR", "PLL 1 inside", inner, inside, "RM0433 8.7.13 PLL1VCOSEL");
        within(wires, "RCC_PLL1DIVR", "the output of PLL 1", output, [1_500_000, 400_000_000], "RM0433 8.5.5");
        let (factor, divider) = (self.registers.field(PLL1DIVR, 0, 9) + 1, self.registers.field(PLL1DIVR, 9, 7) + 1);
        if factor < 4 || divider % 2 != 0 {
            let what = format!("N {factor} or P {divider} is not allowed: N of 4 and more, P even");
            wires.violation("RCC_PLL1DIVR", what, "RM0433 8.7.14");
        }
        if !self.registers.is_set(PLLCFGR, 16) {
            wires.violation("RCC_PLLCFGR", "PLL 1 is switched on with DIVP1EN 0", "RM0433 8.7.13");
        }
    }

    fn control_written(&mut self, value: u32, before: u32, wires: &mut Wires) {
        if value & (bit(26) | bit(28)) != 0 {
            wires.violation("RCC_CR", "PLL 2 and PLL 3 are not modelled", "RM0433 8.7.2");
        }
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
            PLLCKSELR | PLLCFGR | PLL1DIVR if pll_is_on(&self.registers) && value != before => {
                wires.violation("RCC_PLL", "a PLL is set up while it is on", "RM0433 8.5.5");
            }
            CFGR => self.oscillators.select(value, true, &mut self.registers, wires),
            CICR => self.oscillators.clear_security(offset, value, &mut self.registers),
            RSR if value & bit(16) != 0 => self.registers.change(RSR, 0, FLAGS | bit(16)),
            _ => {}
        }
        for register in &MAP {
            if (0x7c..0xa0).contains(&register.offset) || register.offset > RSR {
                wires.gates.insert(register.offset, self.registers.get(register.offset));
            }
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        let pll_source = self.pll_source();
        self.oscillators.watch(pll_source, &mut self.registers, wires);
        let ready = self.oscillators.ready_flags(wires) | bit(14) | bit(15) | bit(5);
        self.registers.change(CR, ready, READY);
        // RTCPRE: values below 2 give no clock.
        let divider = Some(self.registers.field(CFGR, 8, 6)).filter(|divider| *divider > 1);
        wires.divided_external = divider.and_then(|divider| self.oscillators.divided_external(divider, wires));
        let system = match self.oscillators.selected(&self.registers) {
            Origin::Internal => self.internal_rate(),
            Origin::External => self.oscillators.external_rate,
            Origin::Pll => self.pll_rates()[2],
        };
        let core = system / bus_divider(self.registers.field(D1CFGR, 8, 4));
        let bus = core / bus_divider(self.registers.field(D1CFGR, 0, 4));
        let divided = |offset, low| bus / peripheral_divider(self.registers.field(offset, low, 3));
        let [low, high] = [4, 8].map(|place| divided(D2CFGR, place));
        // RM0433 8.7.6: with TIMPRE the timers run at four times the clock of their bus, at most at the clock of the
        // core's bus.
        let timers = if self.registers.is_set(CFGR, 15) { bus.min(4 * high) } else { timer_clock(bus, high) };
        wires.fdcan.selected = self.can_clock(wires);
        let clocks = Clocks { system, core, bus, low, high, timers };
        if clocks != wires.clocks {
            wires.clocks = clocks;
            if system == 0 {
                return;
            }
            // RM0433 8.7.7 and data sheet table 23: limits by voltage scale.
            let [cores, buses, peripherals] = match wires.voltage {
                1 => [400, 200, 100],
                2 => [300, 150, 75],
                _ => [200, 100, 50],
            };
            for (what, rate, most) in [
                ("the core", core, cores),
                ("the bus", bus, buses),
                ("APB1", clocks.low, peripherals),
                ("APB2", clocks.high, peripherals),
                ("APB3", divided(D1CFGR, 4), peripherals),
                ("APB4", divided(0x20, 4), peripherals),
            ] {
                let what = format!("the clock of {what} at this voltage scale");
                within(wires, "RCC_D1CFGR", &what, rate, [1, most * 1_000_000], "RM0433 6.6.2, 8.7.7");
            }
        }
    }

    fn next_event(&self) -> Option<Time> {
        self.oscillators.next_event()
    }

    /// RM0433 8.4: a reset keeps the reset flags.
    fn reset(&mut self) {
        let flags = self.registers.get(RSR) & FLAGS;
        *self = Self::default();
        self.registers.set(RSR, flags);
    }
}

/// Flags set by a reset: RM0433 table 55.
pub fn flags(reset: Reset) -> (u32, u32) {
    let flags = match reset {
        Reset::Power => 0x00e8_0000,
        Reset::Software => bit(24) | bit(22) | bit(17),
        Reset::Watchdog => bit(26) | bit(22) | bit(17),
    };
    (RSR, flags)
}

/// Core clock after a reset [Hz].
pub const AFTER_RESET: u64 = INTERNAL;
