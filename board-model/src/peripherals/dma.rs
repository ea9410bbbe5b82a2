//! Parts shared by both kinds of DMA controller: transfer of items between a peripheral and memory, once or circular.

use crate::register::Registers;

/// Transfer of one item.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transfer {
    /// Source address.
    pub from: u32,
    /// Destination address.
    pub to: u32,
    /// Size of the item [byte].
    pub size: u32,
}

/// Addresses of a running channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Way {
    /// Address of the peripheral's register.
    pub peripheral: u32,
    /// Address of the first item in memory.
    pub memory: u32,
    /// True if addresses in memory increment.
    pub rises: bool,
    /// True from memory to the peripheral.
    pub outwards: bool,
    /// Size of an item [byte].
    pub size: u32,
}

impl Way {
    /// Transfer of an item by its number.
    pub fn item(self, number: u32) -> Transfer {
        let memory = self.memory + if self.rises { number * self.size } else { 0 };
        let (from, to) = if self.outwards { (memory, self.peripheral) } else { (self.peripheral, memory) };
        Transfer { from, to, size: self.size }
    }
}

/// Milestone reached with an item: RM0090 10.3.17, RM0440 12.4.6.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reached {
    /// No milestone.
    Nothing,
    /// Half of the items.
    Half,
    /// Last item.
    End,
}

/// Progress of a running channel.
#[derive(Debug, Clone, Copy, Default)]
pub struct Course {
    length: u32,
    moved: u32,
}

impl Course {
    /// Starts with the number of items in a register.
    pub fn start(&mut self, registers: &Registers, number: u32) {
        *self = Self { length: registers.get(number), moved: 0 };
    }

    /// Returns the number of the next item, and the milestone reached with it. The register counts down; in circular
    /// mode it is reloaded after the last item (RM0090 10.3.8, RM0440 12.4.5).
    pub fn step(&mut self, circular: bool, registers: &mut Registers, number: u32) -> (u32, Reached) {
        let item = self.moved;
        self.moved += 1;
        let reached = match self.moved {
            moved if moved == self.length => Reached::End,
            moved if moved == self.length / 2 => Reached::Half,
            _ => Reached::Nothing,
        };
        if circular && reached == Reached::End {
            self.moved = 0;
        }
        registers.set(number, self.length.saturating_sub(self.moved));
        (item, reached)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::chips;
    use crate::machine::Machine;
    use crate::peripherals::flash::BASE;
    use crate::wires::{Cable, MICROSECOND, Pin, SECOND, Surroundings, Time, cycles};

    const BAUD: u64 = 230_400;
    const BUFFER: u32 = 0x2000_0100;
    const LENGTH: u32 = 16;

    /// Differences between the chips: writes that start circular reception with interrupts of half, end and idle line;
    /// the register of remaining items; interrupts of DMA and USART; the DMA flag register with the flags of half and
    /// end; and the accesses that clear the idle flag.
    struct Case {
        machine: Machine,
        writes: &'static [(u32, u32)],
        left: u32,
        interrupts: [usize; 2],
        flags: (u32, u32),
        clears: fn(&mut Machine),
    }

    fn cases() -> [Case; 3] {
        let surroundings = Surroundings::default();
        let machine = |chip, unit, receive| {
            Machine::new(chip, surroundings, Cable { baud: BAUD, unit, receive, ..Cable::default() }, 1000)
        };
        let f405 = Case {
            machine: machine(chips::f405::chip(BASE + 0x1000), 1, Pin('A', 10)),
            writes: &[
                (0x4002_3830, 1 << 22 | 1),
                (0x4002_3844, 1 << 4),
                (0x4002_0024, 0x770),
                (0x4002_0000, 0xa828_0000),
                (0x4002_6444, LENGTH),
                (0x4002_6448, 0x4001_1004),
                (0x4002_644c, BUFFER),
                (0x4002_6440, 4 << 25 | 1 << 10 | 1 << 8 | 0b11 << 3 | 1),
                (0x4001_1008, 69),
                (0x4001_1014, 1 << 6),
                (0x4001_100c, 1 << 13 | 0b11 << 2 | 1 << 4),
            ],
            left: 0x4002_6444,
            interrupts: [58, 37],
            flags: (0x4002_6400, 0b11 << 20),
            clears: |machine| {
                machine.read(0x4001_1000, 4);
                machine.read(0x4001_1004, 4);
            },
        };
        let g474 = Case {
            machine: machine(chips::g474::chip(BASE + 0x1000), 2, Pin('A', 3)),
            writes: &[
                (0x4002_1048, 1 << 8 | 1 << 2 | 1),
                (0x4002_104c, 1),
                (0x4002_1058, 1 << 17 | 1 << 10),
                (0x4800_0020, 0x7700),
                (0x4800_0000, 0xabff_ffaf),
                (0x4002_0800, 26),
                (0x4002_000c, LENGTH),
                (0x4002_0010, 0x4000_4424),
                (0x4002_0014, BUFFER),
                (0x4002_0008, 1 << 7 | 1 << 5 | 0b11 << 1 | 1),
                (0x4000_440c, 69),
                (0x4000_4408, 1 << 6),
                (0x4000_4400, 0b11 << 2 | 1 << 4),
                (0x4000_4400, 0b11 << 2 | 1 << 4 | 1),
            ],
            left: 0x4002_000c,
            interrupts: [11, 38],
            flags: (0x4002_0000, 0b11 << 1),
            clears: |machine| machine.write(0x4000_4420, 4, 1 << 4),
        };
        let f405_low = Case {
            machine: machine(chips::f405::chip(BASE + 0x1000), 3, Pin('B', 11)),
            writes: &[
                (0x4002_3830, 1 << 21 | 1 << 1),
                (0x4002_3840, 1 << 18),
                (0x4002_0424, 0x7700),
                (0x4002_0400, 0x00a0_0280),
                (0x4002_602c, LENGTH),
                (0x4002_6030, 0x4000_4804),
                (0x4002_6034, BUFFER),
                (0x4002_6028, 4 << 25 | 1 << 10 | 1 << 8 | 0b11 << 3 | 1),
                (0x4000_4808, 69),
                (0x4000_4814, 1 << 6),
                (0x4000_480c, 1 << 13 | 0b11 << 2 | 1 << 4),
            ],
            left: 0x4002_602c,
            interrupts: [12, 39],
            flags: (0x4002_6000, 0b11 << 10),
            clears: |machine| {
                machine.read(0x4000_4800, 4);
                machine.read(0x4000_4804, 4);
            },
        };
        [f405, f405_low, g474]
    }

    /// Advances time with the DMA transfers in it, as the core does.
    fn run_for(machine: &mut Machine, memory: &mut BTreeMap<u32, u8>, duration: Time) {
        let end = machine.time() + duration;
        while machine.time() < end {
            machine.settle();
            while let Some(Transfer { from, to, size }) = machine.next_transfer() {
                memory.insert(to, machine.read(from, size) as u8);
                machine.settle();
            }
            machine.cycles = machine.deadline.min(machine.cycles + 100);
        }
    }

    fn started(case: &mut Case, memory: &mut BTreeMap<u32, u8>) {
        case.machine.settle();
        for (address, value) in case.writes {
            case.machine.set_up(*address, *value);
        }
        // A newly enabled receiver sees an idle line first.
        run_for(&mut case.machine, memory, cycles(12, BAUD));
        (case.clears)(&mut case.machine);
    }

    #[test]
    fn circular_transfer_reports_pause_once() {
        for mut case in cases() {
            let mut memory = BTreeMap::new();
            started(&mut case, &mut memory);
            let Case { mut machine, left, interrupts: [dma, line], flags: (register, flags), clears, .. } = case;
            let name = machine.chip.name;
            machine.wires.line.to_board.extend(1..=40);
            run_for(&mut machine, &mut memory, cycles(40 * 10, BAUD) + MICROSECOND);
            assert!(!machine.wires.interrupts.contains(&line), "{name}: idle at once");
            assert!(machine.wires.interrupts.contains(&dma) && machine.read(register, 4) as u32 & flags == flags);
            run_for(&mut machine, &mut memory, cycles(12, BAUD));
            assert!(machine.wires.interrupts.contains(&line), "{name}: not idle");
            assert_eq!(machine.read(left, 4), 8, "{name}");
            let held: Vec<u8> = memory.values().copied().collect();
            assert_eq!(held, [33, 34, 35, 36, 37, 38, 39, 40, 25, 26, 27, 28, 29, 30, 31, 32], "{name}");
            clears(&mut machine);
            run_for(&mut machine, &mut memory, SECOND / 100);
            assert!(!machine.wires.interrupts.contains(&line), "{name}: idle again");
            assert_eq!(machine.wires.line.overruns, 0, "{name}");
            let said: Vec<_> = machine.wires.violations.all().iter().map(ToString::to_string).collect();
            assert_eq!(said, [""; 0], "{name}");
        }
    }

    #[test]
    fn bytes_moved_while_core_stopped() {
        for mut case in cases() {
            let mut memory = BTreeMap::new();
            started(&mut case, &mut memory);
            case.machine.wires.line.to_board.extend(1..=200);
            run_for(&mut case.machine, &mut memory, cycles(20, BAUD));
            case.machine.wires.stall = SECOND / 10;
            run_for(&mut case.machine, &mut memory, SECOND / 9);
            let wires = &case.machine.wires;
            assert_eq!((wires.line.overruns, wires.line.to_board.len()), (0, 0), "{}", case.machine.chip.name);
            assert_eq!(memory[&(BUFFER + 7)], 200, "{}", case.machine.chip.name);
        }
    }
}
