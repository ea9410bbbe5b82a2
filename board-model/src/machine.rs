//! Chip without its core: memory map, peripherals at their addresses, and the access rules common to all of them.

use std::collections::BTreeMap;

use crate::peripherals::Peripheral;
use crate::peripherals::dma::Transfer;
use crate::register::Register;
use crate::scs::Scs;
use crate::tamper::Tamper;
use crate::wires::{Cable, Clocks, Gate, Reset, SECOND, Surroundings, Time, Wires};

/// Index of the clock controller in the peripherals.
const CLOCK_CONTROLLER: usize = 0;
/// Private peripheral bus, whose registers belong to the core.
const PRIVATE: std::ops::Range<u32> = 0xe000_0000..0xe004_0000;
/// Rate of the counted cycles while the core's clock stands still [Hz].
const STOPPED_RATE: u64 = 1_000_000;
/// Cycles between two polls of busy flash, instead of some twenty: a sector takes a second.
const LOOK_AGAIN: u64 = 2000;

/// Peripheral at its address.
pub struct Placed {
    /// Name on the chip.
    pub name: &'static str,
    /// Base address.
    pub base: u32,
    /// Size of the address range [byte].
    pub size: u32,
    /// Clock gate; `None` if the clock is always on.
    pub clock: Option<Gate>,
    /// Bit that holds the peripheral in reset.
    pub hold: Option<Gate>,
    /// Section of the manual with the clock gate.
    pub section: &'static str,
    /// Model of the peripheral.
    pub peripheral: Box<dyn Peripheral>,
}

/// Plain memory.
#[derive(Debug, Clone, Copy)]
pub struct Memory {
    /// First address.
    pub base: u32,
    /// Size [byte].
    pub size: u32,
    /// True if the DMA controllers cannot reach it.
    pub core_only: bool,
}

/// Parts of a chip.
pub struct Chip {
    /// Name of the chip.
    pub name: &'static str,
    /// True for a Cortex-M7, with caches and double precision.
    pub is_m7: bool,
    /// Size of flash [byte].
    pub flash: u32,
    /// Plain memories.
    pub memories: &'static [Memory],
    /// Peripherals; the clock controller comes first.
    pub peripherals: Vec<Placed>,
    /// Clock after a reset [Hz].
    pub after_reset: u64,
    /// Register of the reset flags, and the flags that a reset adds.
    pub reset_flags: fn(Reset) -> (u32, u32),
}

/// Running chip.
pub struct Machine {
    /// Wires between the parts.
    pub wires: Wires,
    /// Peripherals of the core.
    pub scs: Scs,
    /// Parts of the chip.
    pub chip: Chip,
    /// Cycles of the core since power-up.
    pub cycles: u64,
    /// Cycles and time at the start of the present clock.
    since: (u64, Time),
    rate: u64,
    /// True if a write may have changed levels.
    pub attention: bool,
    /// Cycle of the next event.
    pub deadline: u64,
    /// Instructions per block, by address.
    pub blocks: crate::blocks::Blocks,
    /// Cost of an instruction [thousandths of a cycle].
    pub cost: u64,
    fraction: u64,
    /// Resets so far, with their times.
    pub resets: Vec<(Reset, Time)>,
    /// Value of a branch that leaves an exception.
    pub returning: Option<u32>,
    /// Reason for which the emulation has halted.
    pub halted: Option<String>,
    /// Clocks that were switched on without a read-back of their register: offsets in the clock controller, and bits.
    rising: BTreeMap<u32, u32>,
    /// Planted mistakes.
    pub tampers: &'static [Tamper],
    /// True if one more block must run before anything else.
    pub go_on: bool,
    /// True if the block hook stopped the core, which is then not asleep.
    pub stopped: bool,
}

impl Machine {
    /// Chip at power-up.
    pub fn new(chip: Chip, surroundings: Surroundings, cable: Cable, cost: u64) -> Self {
        let (scs, rate) = (Scs::new(chip.is_m7), chip.after_reset);
        let mut machine = Self {
            wires: Wires::new(surroundings, cable),
            scs,
            chip,
            cycles: 0,
            since: (0, 0),
            rate,
            attention: true,
            deadline: 0,
            blocks: crate::blocks::Blocks::default(),
            cost,
            fraction: 0,
            resets: Vec::new(),
            returning: None,
            halted: None,
            rising: BTreeMap::new(),
            tampers: &[],
            go_on: false,
            stopped: false,
        };
        machine.wires.clocks = Clocks { system: rate, core: rate, bus: rate, low: rate, high: rate, timers: rate };
        machine.note_reset(Reset::Power);
        machine
    }

    /// Counts the instructions of a block.
    pub fn count(&mut self, instructions: u32) {
        let thousandths = self.fraction + u64::from(instructions) * self.cost;
        self.cycles += thousandths / 1000;
        self.fraction = thousandths % 1000;
    }

    /// Present time, from the cycles.
    pub fn time(&self) -> Time {
        let (cycles, time) = self.since;
        time + crate::wires::cycles(self.cycles - cycles, self.rate)
    }

    /// First cycle at or after a time.
    fn cycle_at(&self, time: Time) -> u64 {
        let (cycles, start) = self.since;
        let passed = u128::from(time.saturating_sub(start));
        cycles + (passed * u128::from(self.rate)).div_ceil(u128::from(SECOND)) as u64
    }

    /// Advances time while the core stands still.
    pub fn pass(&mut self, duration: Time) {
        self.cycles = self.cycle_at(self.time() + duration);
    }

    /// Advances time for all but the core, which a debugger holds.
    pub fn pass_without_core(&mut self, duration: Time) {
        self.since.1 += duration;
        self.wires.is_held = true;
        self.settle();
    }

    /// Brings all parts to the present, and finds the next event.
    pub fn settle(&mut self) {
        let stall = std::mem::take(&mut self.wires.stall);
        if stall > 0 {
            self.pass(stall);
        }
        self.wires.now = self.time();
        for placed in &mut self.chip.peripherals {
            placed.peripheral.advance(&mut self.wires);
        }
        self.hold();
        let rate = if self.is_stopped() { STOPPED_RATE } else { self.wires.clocks.core };
        if rate != self.rate {
            self.since = (self.cycles, self.wires.now);
            self.rate = rate;
        }
        self.scs.advance(self.cycles, &mut self.wires);
        let events = self.chip.peripherals.iter().filter_map(|placed| placed.peripheral.next_event());
        let next = events
            .chain(self.wires.line.arrives)
            .chain(self.wires.master.next)
            .chain(self.wires.can.next_event())
            .min()
            .map(|time| self.cycle_at(time));
        let never = self.cycles + self.rate;
        self.deadline = [next, self.scs.next_event()].into_iter().flatten().min().unwrap_or(never).max(self.cycles + 1);
        self.attention = false;
    }

    /// Returns whether the clock of the core stands still.
    pub fn is_stopped(&self) -> bool {
        self.wires.clocks.core == 0
    }

    /// Next item that DMA moves.
    pub fn next_transfer(&mut self) -> Option<Transfer> {
        let wires = &mut self.wires;
        self.chip.peripherals.iter_mut().find_map(|placed| placed.peripheral.next_transfer(wires))
    }

    /// Memory at an address.
    pub fn memory_at(&self, address: u32) -> Option<&'static Memory> {
        self.chip.memories.iter().find(|memory| address >= memory.base && address - memory.base < memory.size)
    }

    /// Resets everything but memory and the reset flags.
    pub fn reset(&mut self, reset: Reset) {
        self.wires.now = self.time();
        for placed in &mut self.chip.peripherals {
            if reset == Reset::Power {
                placed.peripheral.power_lost();
            }
            placed.peripheral.reset();
        }
        self.scs = Scs::new(self.chip.is_m7);
        self.wires.interrupts.clear();
        self.wires.gates.clear();
        self.rising.clear();
        self.wires.routes.clear();
        self.wires.requests.clear();
        self.wires.served.clear();
        self.wires.pins.clear();
        (self.wires.bus_fault, self.wires.non_maskable, self.wires.stall) = (None, false, 0);
        self.note_reset(reset);
        self.attention = true;
    }

    fn note_reset(&mut self, reset: Reset) {
        self.resets.push((reset, self.wires.now));
        let (register, flags) = (self.chip.reset_flags)(reset);
        if let Some(placed) = self.chip.peripherals.first_mut() {
            placed.peripheral.registers().change(register, flags, 0);
        }
    }

    /// Read outside of plain memory.
    pub fn read(&mut self, address: u32, size: u32) -> u64 {
        (self.wires.now, self.wires.width) = (self.time(), size);
        if PRIVATE.contains(&address) {
            return self.scs.read(address, size, self.cycles, &mut self.wires).into();
        }
        for placed in &mut self.chip.peripherals {
            if let Some(value) = placed.peripheral.read_memory(address, size, &mut self.wires) {
                self.look();
                return value;
            }
        }
        let Some((place, offset)) = self.find(address, "read") else { return 0 };
        let Some(register) = self.check(place, offset, size, "read") else { return 0 };
        if place == CLOCK_CONTROLLER {
            self.rising.remove(&register.offset);
        }
        let placed = &mut self.chip.peripherals[place];
        let value = placed.peripheral.read(register.offset, &mut self.wires);
        self.look();
        if std::mem::take(&mut self.wires.waiting) {
            // Only a further poll can happen before the deadline.
            self.cycles = (self.cycles + LOOK_AGAIN).min(self.deadline);
        }
        u64::from(value >> (8 * (offset - register.offset))) & (u64::MAX >> (64 - 8 * size))
    }

    /// Requests attention if a read has changed anything that is checked between blocks, such as a FIFO or busy flash.
    fn look(&mut self) {
        let wires = &mut self.wires;
        let stopped = wires.stall > 0 || wires.bus_fault.is_some() || wires.non_maskable;
        self.attention |= std::mem::take(&mut wires.changed) || stopped;
    }

    /// Resets the peripherals that the clock controller holds in reset.
    fn hold(&mut self) {
        for placed in &mut self.chip.peripherals {
            if placed.hold.is_some_and(|hold| self.wires.is_on(hold)) {
                placed.peripheral.reset();
            }
        }
    }

    /// Write outside of plain memory.
    pub fn write(&mut self, address: u32, size: u32, value: u64) {
        (self.wires.now, self.wires.width) = (self.time(), size);
        self.attention = true;
        let planted = self.tampers.iter().try_fold(value as u32, |value, tamper| tamper.apply(address, value));
        let Some(value) = planted.map(|low| value & !u64::from(u32::MAX) | u64::from(low)) else { return };
        if PRIVATE.contains(&address) {
            return self.scs.write(address, size, value as u32, self.cycles, &mut self.wires);
        }
        for placed in &mut self.chip.peripherals {
            if placed.peripheral.write_memory(address, size, value, &mut self.wires) {
                return;
            }
        }
        let Some((place, offset)) = self.find(address, "written") else { return };
        let Some(register) = self.check(place, offset, size, "written") else { return };
        let Placed { name, peripheral, .. } = &mut self.chip.peripherals[place];
        let before = peripheral.registers().get(register.offset);
        let shift = 8 * (offset - register.offset);
        let mask = (u64::MAX >> (64 - 8 * size)) as u32;
        let written = match size {
            4 => value as u32,
            // The other bytes of the register stay; bits that act when written receive zeros.
            _ => before & !register.special & !(mask << shift) | (value as u32 & mask) << shift,
        };
        let reserved = !register.fields;
        if !register.any_value && (written ^ register.reset) & reserved != 0 && written & reserved != 0 {
            let bits = written & reserved & (written ^ register.reset);
            let what = format!("reserved bits {bits:#010x} are written");
            self.wires.violation(&format!("{name} {}", register.name), what, "the register's own section");
        }
        let kept = register.special | reserved;
        peripheral.registers().set(register.offset, before & kept | written & !kept);
        peripheral.written(register.offset, written, before, &mut self.wires);
        if place == CLOCK_CONTROLLER {
            *self.rising.entry(register.offset).or_default() |= written & !before;
            self.hold();
        }
    }

    /// Writes a word as correct code does: after switching a clock on it reads the register back.
    pub fn set_up(&mut self, address: u32, value: u32) {
        self.write(address, 4, value.into());
        let clocks = &self.chip.peripherals[CLOCK_CONTROLLER];
        if (clocks.base..clocks.base + clocks.size).contains(&address) {
            self.read(address, 4);
        }
    }

    /// Peripheral at an address, and the offset in it.
    fn find(&mut self, address: u32, done: &str) -> Option<(usize, u32)> {
        let within = |placed: &Placed| address >= placed.base && address - placed.base < placed.size;
        let place = self.chip.peripherals.iter().position(within);
        if place.is_none() {
            let what = format!("is {done}, and the model has nothing there");
            self.wires.violation(&format!("{address:#010x}"), what, "the memory map");
        }
        place.map(|place| (place, address - self.chip.peripherals[place].base))
    }

    /// Checks the rules common to all registers.
    fn check(&mut self, place: usize, offset: u32, size: u32, done: &str) -> Option<&'static Register> {
        let Placed { name, clock, hold, section, peripheral, .. } = &mut self.chip.peripherals[place];
        let registers = peripheral.registers();
        let Some(register) = registers.describe(offset).or_else(|| registers.describe(offset & !3)) else {
            let what = format!("is {done}, and the model has no such register");
            self.wires.violation(&format!("{name}+{offset:#x}"), what, "the register map");
            return None;
        };
        let named = format!("{name} {}", register.name);
        if clock.is_some_and(|clock| !self.wires.is_on(clock)) {
            self.wires.violation(&named, format!("is {done} while the clock of {name} is off"), section);
            return None;
        }
        let rising = |clock: Gate| self.rising.get(&clock.offset).is_some_and(|bits| bits >> clock.bit & 1 == 1);
        if clock.is_some_and(rising) {
            let what = format!("is {done} before the clock of {name}, just switched on, was read back");
            self.wires.violation(&named, what, "RM0440 7.2.17, ES0182: two cycles of the bus");
        }
        if hold.is_some_and(|hold| self.wires.is_on(hold)) {
            self.wires.violation(&named, format!("is {done} while {name} is held in reset"), section);
            return None;
        }
        if register.widths & size == 0 || !offset.is_multiple_of(size) {
            self.wires.violation(&named, format!("is {done} by {size} bytes"), "the register's own section");
        }
        Some(register)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chips;
    use crate::peripherals::flash::BASE;

    fn machine() -> Machine {
        let surroundings = Surroundings::crystal(8_000_000);
        let mut machine = Machine::new(chips::f405::chip(BASE + 0x1000), surroundings, Cable::default(), 1000);
        machine.settle();
        machine
    }

    fn said(machine: &Machine) -> Vec<String> {
        machine.wires.violations.all().iter().map(|violation| violation.what.clone()).collect()
    }

    #[test]
    fn unclocked_register_not_written() {
        let mut machine = machine();
        machine.write(0x4002_0000, 4, 0xa800_0001);
        assert_eq!(said(&machine), ["is written while the clock of GPIOA is off"]);
        machine.set_up(0x4002_3830, 0x0010_0001);
        machine.write(0x4002_0000, 4, 0xa800_0001);
        assert_eq!((machine.read(0x4002_0000, 4), said(&machine).len()), (0xa800_0001, 1));
    }

    #[test]
    fn enabled_clock_read_back_first() {
        let mut machine = machine();
        machine.write(0x4002_3830, 4, 0x0010_0001);
        machine.write(0x4002_0000, 4, 0xa800_0001);
        assert_eq!(said(&machine), ["is written before the clock of GPIOA, just switched on, was read back"]);
        // Reading another register is not enough.
        machine.read(0x4002_3840, 4);
        machine.read(0x4002_0000, 4);
        assert_eq!(said(&machine).len(), 2);
        machine.read(0x4002_3830, 4);
        machine.read(0x4002_0000, 4);
        // A clock that stays on needs no further read-back.
        machine.write(0x4002_3830, 4, 0x0010_0001);
        machine.read(0x4002_0000, 4);
        assert_eq!(said(&machine).len(), 2);
    }

    #[test]
    fn reserved_bits_and_widths_checked() {
        let mut machine = machine();
        machine.write(0x4002_3830, 4, 0x0010_0200);
        assert_eq!(said(&machine), ["reserved bits 0x00000200 are written"]);
        machine.write(0x4002_3808, 1, 0);
        assert_eq!(said(&machine)[1], "is written by 1 bytes");
    }

    #[test]
    fn missing_features_reported() {
        let mut machine = machine();
        machine.read(0x4000_0000, 4);
        machine.read(0x4002_3888, 4);
        assert!(said(&machine).iter().all(|what| what.contains("the model has")), "{:?}", said(&machine));
    }

    #[test]
    fn reset_peripheral_as_after_power_up() {
        let mut machine = machine();
        machine.set_up(0x4002_3844, 1 << 4);
        machine.write(0x4001_1008, 4, 364);
        machine.write(0x4002_3824, 4, 1 << 4);
        machine.write(0x4002_3824, 4, 0);
        assert_eq!((machine.read(0x4001_1008, 4), said(&machine).len()), (0, 0));
    }

    #[test]
    fn time_advances_with_present_clock() {
        let mut machine = machine();
        machine.count(16_000);
        assert_eq!(machine.time(), 1_000_000_000_000);
        machine.pass(500_000_000);
        assert_eq!(machine.cycles, 16_008);
    }
}
