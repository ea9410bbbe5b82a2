//! Timers whose first channel can capture the divided external source, so that an image can measure it against the
//! internal oscillator: TIM11 of STM32F405 (RM0090 7.2.11 and section 19), TIM16 and TIM17 of STM32G474 (RM0440 7.2.16
//! and section 30), TIM17 of STM32H743 (RM0433 8.5.8 and section 41). Counter, prescaler, reload and capture of rising
//! edges are modelled; other inputs, outputs and slave modes are not.

use super::Peripheral;
use crate::register::{Register, Registers, bit, bits};
use crate::wires::{SECOND, Time, Wires};

const CR1: u32 = 0x00;
const DIER: u32 = 0x0c;
const SR: u32 = 0x10;
const EGR: u32 = 0x14;
const CCMR1: u32 = 0x18;
const CCER: u32 = 0x20;
const CNT: u32 = 0x24;
const PSC: u32 = 0x28;
const ARR: u32 = 0x2c;
const CCR1: u32 = 0x34;
/// Flags of an update, of a capture, and of an overcapture.
const UIF: u32 = bit(0);
const CC1IF: u32 = bit(1);
const CC1OF: u32 = bit(9);
/// UG and CC1G of the event register.
const UPDATE: u32 = bit(0);
const CAPTURE: u32 = bit(1);

/// RM0090 19.5: ARR, which stops the counter while it is 0, is 0 after a reset.
pub static F4: [Register; 11] = [
    Register::new("TIM_CR1", CR1, 0, 0x038f),
    Register::new("TIM_DIER", DIER, 0, 0x3),
    Register::new("TIM_SR", SR, 0, 0x203).special(u32::MAX),
    Register::new("TIM_EGR", EGR, 0, 0x3).special(u32::MAX),
    Register::new("TIM_CCMR1", CCMR1, 0, 0xff),
    Register::new("TIM_CCER", CCER, 0, 0xb),
    Register::new("TIM_CNT", CNT, 0, 0xffff),
    Register::new("TIM_PSC", PSC, 0, 0xffff),
    Register::new("TIM_ARR", ARR, 0, 0xffff),
    Register::new("TIM_CCR1", CCR1, 0, 0xffff),
    Register::new("TIM_OR", 0x50, 0, 0x3),
];
/// RM0440 30.8.
pub static G4: [Register; 14] = newer(0x1b8f, 0x140f_ffff, 0x5c);
/// RM0433 41.6.
pub static H7: [Register; 14] = newer(0x0b8f, 0x000f_ffff, 0x68);

/// Register map of the newer timers, with the fields of their first control register and of BDTR, and the offset of
/// TISEL.
const fn newer(control: u32, brake: u32, selection: u32) -> [Register; 14] {
    [
        Register::new("TIM_CR1", CR1, 0, control),
        Register::new("TIM_CR2", 0x04, 0, 0x030d),
        Register::new("TIM_DIER", DIER, 0, 0x03a3),
        Register::new("TIM_SR", SR, 0, 0x02a3).special(u32::MAX),
        Register::new("TIM_EGR", EGR, 0, 0xa3).special(u32::MAX),
        Register::new("TIM_CCMR1", CCMR1, 0, 0x0001_00ff),
        Register::new("TIM_CCER", CCER, 0, 0xf),
        Register::new("TIM_CNT", CNT, 0, 0x8000_ffff),
        Register::new("TIM_PSC", PSC, 0, 0xffff),
        Register::new("TIM_ARR", ARR, 0xffff, 0xffff),
        Register::new("TIM_RCR", 0x30, 0, 0xff),
        Register::new("TIM_CCR1", CCR1, 0, 0xffff),
        Register::new("TIM_BDTR", 0x44, 0, brake),
        Register::new("TIM_TISEL", selection, 0, 0xf),
    ]
}

/// Connections of a timer on the chip.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Register map.
    pub map: &'static [Register],
    /// Interrupt.
    pub interrupt: usize,
    /// Register that selects the input, and the code of the external source.
    pub selection: (u32, u32),
}

/// Timer.
#[derive(Debug)]
pub struct Timer {
    registers: Registers,
    place: Place,
    /// Active prescaler, copied from PSC by the last update.
    prescaler: u32,
    /// Counter value at a time, and the rate at which it counts on [Hz].
    counted: (u32, Time, u64),
    /// Number of wraps since then that have been handled.
    rounds: u64,
    /// Time of the next captured edge.
    next_edge: Option<Time>,
}

impl Timer {
    /// Timer that is off.
    pub fn new(place: Place) -> Self {
        let registers = Registers::new(place.map);
        Self { registers, place, prescaler: 0, counted: (0, 0, 0), rounds: 0, next_edge: None }
    }

    /// Counter value at a time, with the number of wraps.
    fn count(&self, now: Time) -> (u32, u64) {
        let (count, since, rate) = self.counted;
        let passed = u128::from(now.saturating_sub(since)) * u128::from(rate) / u128::from(SECOND);
        let period = u128::from(self.registers.get(ARR)) + 1;
        let total = u128::from(count) + passed;
        ((total % period) as u32, (total / period) as u64)
    }

    fn rate(&self, wires: &Wires) -> u64 {
        let clock = wires.clocks.timers as i64;
        let off = clock / 1000 * wires.surroundings.internal_off;
        (clock + off) as u64 / u64::from(self.prescaler + 1)
    }

    /// Continues counting from a value.
    fn go_on(&mut self, count: u32, wires: &Wires) {
        let runs = self.registers.is_set(CR1, 0) && self.registers.get(ARR) > 0;
        (self.counted, self.rounds) = ((count, wires.now, if runs { self.rate(wires) } else { 0 }), 0);
    }

    /// Executes an update: the prescaler takes effect.
    fn update(&mut self) {
        self.prescaler = self.registers.get(PSC);
        self.registers.change(SR, UIF, 0);
    }

    fn capture(&mut self, now: Time) {
        let (count, _) = self.count(now);
        let lost = self.registers.get(SR) & CC1IF != 0;
        self.registers.set(CCR1, count);
        self.registers.change(SR, CC1IF | if lost { CC1OF } else { 0 }, 0);
    }

    /// Time between two captured edges, if any are captured.
    fn between(&self, wires: &Wires) -> Option<Time> {
        let (register, code) = self.place.selection;
        let selected = self.registers.field(register, 0, 4) == code && self.registers.field(CCMR1, 0, 2) == 1;
        let captures = selected && self.registers.is_set(CCER, 0);
        let rate = wires.divided_external.filter(|_| captures)?;
        Some((SECOND / rate.max(1)) << self.registers.field(CCMR1, 2, 2))
    }

    fn set_up(&mut self, wires: &mut Wires) {
        if self.registers.get(CCER) & (bit(1) | bit(3)) != 0 {
            wires.violation("TIM_CCER", "only rising edges are modelled", "RM0090 19.5.7");
        }
        if self.registers.get(DIER) & bits(9, 8) != 0 {
            wires.violation("TIM_DIER", "DMA of timers is not modelled", "RM0440 30.8.4");
        }
        let input = wires.divided_external.unwrap_or(0);
        if self.between(wires).is_some() && 2 * input > wires.clocks.timers {
            let what =
                format!("{input} Hz are captured by a timer at {} Hz: less than half of it", wires.clocks.timers);
            wires.violation("TIM_CCMR1", what, "RM0090 19.3.5");
        }
        // The edge divider restarts when the channel is enabled.
        self.next_edge = self.between(wires).map(|between| (wires.now / between + 1) * between);
    }
}

impl Peripheral for Timer {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn read(&mut self, offset: u32, wires: &mut Wires) -> u32 {
        self.advance(wires);
        match offset {
            CNT => self.count(wires.now).0,
            CCR1 => {
                self.registers.change(SR, 0, CC1IF);
                self.registers.get(CCR1)
            }
            EGR => 0,
            _ => self.registers.get(offset),
        }
    }

    fn written(&mut self, offset: u32, value: u32, before: u32, wires: &mut Wires) {
        let count = self.count(wires.now).0;
        match offset {
            // Writing zeros clears.
            SR => self.registers.change(SR, 0, !value),
            EGR => {
                if value & CAPTURE != 0 {
                    self.capture(wires.now);
                }
                if value & UPDATE != 0 {
                    self.update();
                    self.go_on(0, wires);
                }
            }
            CNT => self.go_on(value & 0xffff, wires),
            CR1 | ARR => self.go_on(count, wires),
            _ if value != before => self.set_up(wires),
            _ => {}
        }
        self.advance(wires);
    }

    fn advance(&mut self, wires: &mut Wires) {
        match (self.between(wires), self.next_edge) {
            (Some(between), Some(mut edge)) => {
                while edge <= wires.now {
                    self.capture(edge);
                    edge += between;
                }
                self.next_edge = Some(edge);
            }
            (Some(between), None) => self.next_edge = Some(wires.now + between),
            (None, _) => self.next_edge = None,
        }
        let (count, rounds) = self.count(wires.now);
        if rounds > self.rounds {
            self.rounds = rounds;
            self.update();
        }
        if self.counted.2 != 0 && self.counted.2 != self.rate(wires) {
            self.go_on(count, wires);
        }
        let asks = self.registers.get(SR) & self.registers.get(DIER) & (UIF | CC1IF) != 0;
        wires.interrupt(self.place.interrupt, asks);
    }

    fn next_event(&self) -> Option<Time> {
        self.next_edge.filter(|_| self.registers.get(DIER) & CC1IF != 0)
    }

    fn reset(&mut self) {
        *self = Self::new(self.place);
    }
}

#[cfg(test)]
mod tests {
    use crate::chips;
    use crate::machine::Machine;
    use crate::peripherals::flash::BASE;
    use crate::wires::{Cable, MICROSECOND, Surroundings, Time};

    /// Ratio of the timer's clock to the external source, from eight captures of every eighth edge.
    fn measured(mut machine: Machine, writes: &[(u32, u32)], timer: u32, divider: u64) -> u64 {
        machine.settle();
        for (address, value) in writes {
            machine.set_up(*address, *value);
            machine.settle();
            machine.pass(100 * MICROSECOND);
            machine.settle();
        }
        machine.write(timer + super::SR, 4, 0);
        let mut captured = Vec::new();
        let pause: Time = MICROSECOND;
        for _ in 0..100_000 {
            machine.pass(pause);
            machine.settle();
            if machine.read(timer + super::SR, 4) & 2 != 0 {
                captured.push(machine.read(timer + super::CCR1, 4));
            }
        }
        assert_eq!(machine.read(timer + super::SR, 4) & 0x200, 0, "a capture was lost");
        let said: Vec<_> = machine.wires.violations.all().iter().map(ToString::to_string).collect();
        assert_eq!(said, [""; 0]);
        let counts: u64 = captured.windows(2).take(8).map(|pair| pair[1].wrapping_sub(pair[0]) & 0xffff).sum();
        machine.wires.clocks.timers * 64 * divider / counts
    }

    const SET_UP: [(u32, u32); 5] =
        [(super::ARR, 0xffff), (super::CCMR1, 0b1101), (super::CCER, 1), (super::EGR, 1), (super::CR1, 1)];

    #[test]
    fn external_oscillator_measured_by_internal_one() {
        for rate in [8_000_000, 12_000_000, 16_000_000, 24_000_000, 25_000_000, 26_000_000] {
            let machine = |chip, source| Machine::new(chip, source, Cable::default(), 1000);
            let f405 = machine(chips::f405::chip(BASE + 0x1000), Surroundings::crystal(rate));
            let g474 = machine(chips::g474::chip(BASE + 0x1000), Surroundings::crystal(rate));
            let h743 = machine(chips::h743::chip(BASE + 0x1000), Surroundings::clock(rate));
            // HSE on until it is ready; its divider; the timer's clock; its input.
            let crystal = [(0x4002_3800, 0x1_0083); 21];
            let begin = [(0x4002_3808, 31 << 16), (0x4002_3844, 1 << 18), (0x4001_4850, 2)];
            let old = measured(f405, &with_timer(&[&crystal[..], &begin].concat(), 0x4001_4800), 0x4001_4800, 31);
            let crystal = [(0x4002_1000, 0x1_0500); 21];
            let begin = [(0x4002_1060, 1 << 18), (0x4001_485c, 3)];
            let new = measured(g474, &with_timer(&[&crystal[..], &begin].concat(), 0x4001_4800), 0x4001_4800, 32);
            let begin = [(0x5802_4400, 0x4_c025), (0x5802_4400, 0x5_c025), (0x5802_4410, 63 << 8)];
            let input = [(0x5802_44f0, 1 << 18), (0x4001_4868, 2)];
            let large = measured(h743, &with_timer(&[&begin[..], &input].concat(), 0x4001_4800), 0x4001_4800, 63);
            for (name, found) in [("F405", old), ("G474", new), ("H743", large)] {
                assert!(found.abs_diff(rate) * 1000 < 4 * rate, "{name}: {found} for {rate}");
            }
        }
    }

    fn with_timer(begin: &[(u32, u32)], timer: u32) -> Vec<(u32, u32)> {
        let set_up = SET_UP.map(|(offset, value)| (timer + offset, value));
        begin.iter().copied().chain(set_up).collect()
    }
}
