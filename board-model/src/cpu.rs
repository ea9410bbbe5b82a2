//! Core: the emulator library executes instructions but leaves exceptions to the model. Exceptions are entered and left
//! here, between blocks of code (ARMv7-M B1.5), with frames with and without floating-point registers; these are
//! stacked at once, where the core would stack them lazily. Tail chaining follows from testing for exceptions before
//! every instruction. Only the main stack pointer is modelled, which the images use.

use unicorn_engine::{Arch, ArmCpuModel, HookType, Mode, Prot, RegisterARM, Unicorn, uc_error};

use crate::can_bus::{CanBus, CanCable};
use crate::image::Image;
use crate::machine::{Chip, Machine};
use crate::peripherals::dma::Transfer;
use crate::peripherals::flash;
use crate::scs::{FIRST_INTERRUPT, HARD_FAULT, Masks, SYSTICK};
use crate::wires::{Cable, MICROSECOND, Reset, Surroundings, Time};

/// Interrupt numbers of the emulator library.
const BREAKPOINT: u32 = 7;
const EXCEPTION_EXIT: u32 = 8;
/// Granule of the library's memory map.
const GRANULE: u32 = 0x1000;
/// Address without any instruction.
const NOWHERE: u64 = 0x0fff_fffe;
/// Registers of a frame, in ascending order of addresses.
const FRAME: [RegisterARM; 6] =
    [RegisterARM::R0, RegisterARM::R1, RegisterARM::R2, RegisterARM::R3, RegisterARM::R12, RegisterARM::LR];
const FIRST_SINGLE: i32 = RegisterARM::S0 as i32;
/// Values that a branch uses to leave an exception: to a handler, or to the thread, on the main stack; bit 4 is 0 with
/// floating-point registers (ARMv7-M table B1-8).
const TO_HANDLER: u32 = 0xffff_fff1;
const TO_THREAD: u32 = 0xffff_fff9;
const BASIC_FRAME: u32 = 1 << 4;
/// IT state in xPSR.
const IF_THEN: u32 = 0x0600_fc00;
/// Encoding of `dsb sy` in memory.
const BARRIER: [u8; 4] = [0xbf, 0xf3, 0x4f, 0x8f];

/// Time step while a debugger holds the core.
const STEP_WHILE_HELD: Time = 20 * MICROSECOND;

/// Cycles between two ticks of a bootloader: a millisecond at the clock after a reset.
const BOOTLOADER_TICK: u64 = 15_999;

/// Setup of a board.
#[derive(Debug, Clone, Copy)]
pub struct Setup {
    /// Clock source outside of the chip.
    pub surroundings: Surroundings,
    /// Serial line to the host.
    pub cable: Cable,
    /// CAN bus.
    pub can: CanCable,
    /// Cost of an instruction [thousandths of a cycle].
    pub cost: u64,
}

/// Chip with its core and an image.
pub struct Board<'a> {
    core: Unicorn<'a, Machine>,
    /// Image.
    pub image: Image,
    sleeping: bool,
}

impl Board<'_> {
    /// Board after power-up, before the first instruction.
    pub fn new(chip: impl FnOnce(u32) -> Chip, image: Image, setup: Setup) -> Result<Self, String> {
        let failed = |error: uc_error| format!("the emulator library refuses: {error:?}");
        let image_end = flash::BASE + (image.bytes.len() as u32).next_multiple_of(GRANULE);
        let chip = chip(image_end);
        let (is_m7, flash_size, memories) = (chip.is_m7, chip.flash, chip.memories);
        if image.bytes.len() as u32 > flash_size {
            return Err(format!("the image is longer than the flash of {}", chip.name));
        }
        let mut machine = Machine::new(chip, setup.surroundings, setup.cable, setup.cost);
        machine.wires.can = CanBus::new(setup.can);
        machine.wires.image_end = image_end;
        let mut core = Unicorn::new_with_data(Arch::ARM, Mode::THUMB | Mode::MCLASS, machine).map_err(failed)?;
        let model = if is_m7 { ArmCpuModel::CORTEX_M7 } else { ArmCpuModel::CORTEX_M4 };
        core.ctl_set_cpu_model(model as i32).map_err(failed)?;
        for memory in memories {
            core.mem_map(memory.base.into(), memory.size.into(), Prot::ALL).map_err(failed)?;
        }
        core.mem_map(flash::BASE.into(), (image_end - flash::BASE).into(), Prot::READ | Prot::EXEC).map_err(failed)?;
        core.mem_write(flash::BASE.into(), &image.bytes).map_err(failed)?;
        let rest = flash::BASE + flash_size - image_end;
        for (base, size) in [(image_end, rest), (0x4000_0000, 0x2000_0000), (0xe000_0000, 0x10_0000)] {
            if size > 0 {
                map_device(&mut core, base, size).map_err(failed)?;
            }
        }
        hook(&mut core, &image).map_err(failed)?;
        let mut board = Self { core, image, sleeping: false };
        board.start();
        Ok(board)
    }

    /// Chip.
    pub fn machine(&self) -> &Machine {
        self.core.get_data()
    }

    /// Chip, for changes from outside.
    pub fn machine_mut(&mut self) -> &mut Machine {
        self.core.get_data_mut()
    }

    /// Time since power-up.
    pub fn now(&self) -> Time {
        self.machine().time()
    }

    /// Runs for a time, or until the emulation halts.
    pub fn run_for(&mut self, duration: Time) {
        let end = self.now() + duration;
        while self.now() < end && self.machine().halted.is_none() {
            self.turn(end);
        }
    }

    /// Enters the image as a bootloader does: with the bootloader's vectors and tick, interrupts masked, and some of
    /// them enabled and pending.
    pub fn jump_from(&mut self, bootloader: u32, left: &[usize]) {
        self.set(RegisterARM::PRIMASK, 1);
        let machine = self.core.get_data_mut();
        machine.scs.vectors = bootloader;
        for line in left {
            machine.write(0xe000_e100 + 4 * (*line as u32 / 32), 4, 1 << (line % 32));
            machine.scs.pend(FIRST_INTERRUPT + line);
        }
        for (register, value) in [(0xe000_e014, BOOTLOADER_TICK), (0xe000_e018, 0), (0xe000_e010, 0b111)] {
            machine.write(register, 4, value);
        }
    }

    /// Holds the core as a debugger does, for a time or until a reset of the chip.
    pub fn hold_for(&mut self, duration: Time) {
        let end = self.now() + duration;
        while self.now() < end && self.machine().wires.reset.is_none() {
            self.core.get_data_mut().pass_without_core(STEP_WHILE_HELD);
            self.transfers();
        }
        self.core.get_data_mut().wires.is_held = false;
    }

    /// Brings everything to the present, handles exceptions, then runs code until the next event.
    fn turn(&mut self, end: Time) {
        self.core.get_data_mut().settle();
        self.transfers();
        if let Some(reset) = self.core.get_data_mut().wires.reset.take() {
            self.core.get_data_mut().reset(reset);
            if reset == Reset::Power {
                self.forget_memory();
            }
            self.start();
            return;
        }
        let stands_still = self.machine().is_stopped();
        if !stands_still {
            self.exceptions();
        }
        let machine = self.core.get_data_mut();
        if self.sleeping || stands_still {
            let wake = machine.deadline;
            let step = machine.wires.clocks.core / 1000;
            let limit = machine.cycles + step.max(1000);
            machine.cycles = if machine.time() < end { wake.min(limit) } else { machine.cycles };
            return;
        }
        machine.stopped = false;
        let pc = self.register(RegisterARM::PC);
        if let Err(error) = self.core.emu_start(u64::from(pc) | 1, NOWHERE, 0, 0) {
            self.fault(error);
            return;
        }
        if let Some(value) = self.core.get_data_mut().returning.take() {
            self.leave(value);
        } else if !self.machine().stopped {
            self.sleeping = true;
        }
    }

    /// Executes the pending DMA transfers.
    fn transfers(&mut self) {
        while let Some(Transfer { from, to, size }) = self.core.get_data_mut().next_transfer() {
            let mut bytes = [0; 8];
            let item = &mut bytes[..size as usize];
            if self.is_reached(from) {
                let _ = self.core.mem_read(from.into(), item);
            } else {
                let value = self.core.get_data_mut().read(from, size);
                item.copy_from_slice(&value.to_le_bytes()[..size as usize]);
            }
            if self.is_reached(to) {
                let _ = self.core.mem_write(to.into(), item);
            } else {
                self.core.get_data_mut().write(to, size, u64::from_le_bytes(bytes));
            }
            self.core.get_data_mut().settle();
        }
    }

    /// Returns whether an address is in memory; memory out of reach of DMA is a violation.
    fn is_reached(&mut self, address: u32) -> bool {
        let memory = self.machine().memory_at(address);
        if memory.is_some_and(|memory| memory.core_only) {
            let what = "is out of reach of DMA";
            self.violation(&format!("{address:#010x}"), what, "RM0090 2.1, RM0440 2.1");
        }
        memory.is_some()
    }

    /// Enters the exception that is due.
    fn exceptions(&mut self) {
        if !self.machine().scs.may_be_due() {
            return;
        }
        let masks = self.masks();
        if self.sleeping && self.machine().scs.wakes(masks) {
            self.sleeping = false;
        }
        if self.machine().scs.is_locked_up() {
            self.core.get_data_mut().halted = Some("the core is locked up: a fault in the handler of a fault".into());
            return;
        }
        let Some(exception) = self.machine().scs.due(masks) else { return };
        if self.register(RegisterARM::XPSR) & IF_THEN != 0 {
            // The library can split the block of an IT instruction, and its state cannot be restored on return.
            self.core.get_data_mut().go_on = true;
            return;
        }
        self.enter(exception);
    }

    fn masks(&self) -> Masks {
        Masks {
            primask: self.register(RegisterARM::PRIMASK) & 1 == 1,
            faultmask: self.register(RegisterARM::FAULTMASK) & 1 == 1,
            basepri: self.register(RegisterARM::BASEPRI) as u8,
        }
    }

    /// Starts from the vector table.
    fn start(&mut self) {
        self.sleeping = false;
        let vectors = self.machine().scs.vectors;
        let (stack, entry) = (self.word(vectors), self.word(vectors + 4));
        for (register, value) in [
            (RegisterARM::PRIMASK, 0),
            (RegisterARM::FAULTMASK, 0),
            (RegisterARM::BASEPRI, 0),
            (RegisterARM::CONTROL, 0),
            (RegisterARM::SP, stack),
            (RegisterARM::LR, u32::MAX),
            (RegisterARM::PC, entry),
        ] {
            self.set(register, value);
        }
        self.set_running(0);
    }

    /// Fills RAM with noise, as after a loss of power.
    fn forget_memory(&mut self) {
        for memory in self.machine().chip.memories {
            let noise: Vec<u8> = (0..memory.size).map(|place| (place.wrapping_mul(0x9e37_79b9) >> 13) as u8).collect();
            let _ = self.core.mem_write(memory.base.into(), &noise);
        }
    }

    /// Enters an exception: ARMv7-M B1.5.6.
    fn enter(&mut self, exception: usize) {
        let with_floats = self.register(RegisterARM::CONTROL) & 4 != 0;
        if with_floats && self.machine().scs.coprocessors >> 20 & 0xf != 0xf {
            self.violation("CPACR", "the floating-point unit is used while it is off", "ARMv7-M B3.2.20");
        }
        let status = self.register(RegisterARM::XPSR);
        let stack = self.register(RegisterARM::SP);
        let odd = stack >> 2 & 1;
        let size = if with_floats { 0x68 } else { 0x20 };
        let frame = (stack & !7) - size;
        let mut words: Vec<u32> = FRAME.iter().map(|register| self.register(*register)).collect();
        words.push(self.register(RegisterARM::PC) & !1);
        words.push(status & !(1 << 9) | odd << 9);
        if with_floats {
            words.extend((0..16).map(|number| self.register(FIRST_SINGLE + number)));
            words.push(self.register(RegisterARM::FPSCR));
        }
        for (word, address) in words.iter().zip((frame..).step_by(4)) {
            if self.core.mem_write(address.into(), &word.to_le_bytes()).is_err() {
                self.core.get_data_mut().halted = Some(format!("the stack has left memory at {address:#010x}"));
                return;
            }
        }
        let base = if self.machine().scs.running() == 0 { TO_THREAD } else { TO_HANDLER };
        if exception == SYSTICK {
            self.core.get_data_mut().wires.can.ticks += 1;
        }
        let vector = self.core.get_data_mut().scs.enter(exception);
        if !(flash::BASE..self.machine().wires.image_end).contains(&vector) {
            let what =
                format!("exception {exception} is taken by the vector at {vector:#010x}, which is not the image's");
            self.violation("VTOR", &what, "ARMv7-M B3.2.5");
            self.core.get_data_mut().halted = Some(what);
            return;
        }
        let handler = self.word(vector);
        if handler & 1 == 0 {
            let what = format!("exception {exception} is taken, and its vector holds {handler:#010x}");
            self.violation("vectors", &what, "ARMv7-M B1.5.3");
        }
        self.set(RegisterARM::SP, frame);
        self.set(RegisterARM::LR, if with_floats { base & !BASIC_FRAME } else { base });
        self.set(RegisterARM::CONTROL, self.register(RegisterARM::CONTROL) & !4);
        self.set(RegisterARM::PC, handler);
        self.set_running(exception);
        // Twelve cycles to the first instruction; the chip stacks floating-point registers lazily.
        self.core.get_data_mut().cycles += 12;
    }

    /// Leaves an exception: ARMv7-M B1.5.8.
    fn leave(&mut self, value: u32) {
        let machine = self.core.get_data_mut();
        let inner = machine.scs.running();
        machine.scs.leave();
        let outer = machine.scs.running();
        let expected = if outer == 0 { TO_THREAD } else { TO_HANDLER };
        if inner == 0 || value | BASIC_FRAME != expected {
            machine.halted = Some(format!("an exception is left by {value:#010x}, which leads nowhere"));
            return;
        }
        let frame = self.register(RegisterARM::SP);
        for (register, address) in FRAME.iter().zip((frame..).step_by(4)) {
            let word = self.word(address);
            self.set(*register, word);
        }
        let (pc, status) = (self.word(frame + 24), self.word(frame + 28));
        let with_floats = value & BASIC_FRAME == 0;
        if with_floats {
            for number in 0..16 {
                let word = self.word(frame + 32 + 4 * number as u32);
                self.set(FIRST_SINGLE + number, word);
            }
            let word = self.word(frame + 96);
            self.set(RegisterARM::FPSCR, word);
        }
        let control = self.register(RegisterARM::CONTROL) & !4 | u32::from(with_floats) << 2;
        self.set(RegisterARM::CONTROL, control);
        self.set(RegisterARM::SP, frame + if with_floats { 0x68 } else { 0x20 } + (status >> 9 & 1) * 4);
        // Every return but the one from NMI clears FAULTMASK.
        if inner != crate::scs::NMI {
            self.set(RegisterARM::FAULTMASK, 0);
        }
        self.set(RegisterARM::XPSR_NZCVQG, status & 0xf80f_0000);
        self.set(RegisterARM::PC, pc | 1);
        self.set_running(outer);
        self.core.get_data_mut().cycles += 12;
        if outer != 0 && status & 0x1ff != outer as u32 {
            self.violation("frame", "holds another exception than the one returned to", "ARMv7-M B1.5.8");
        }
    }

    /// Sets the exception number, by which the library also knows that a handler runs.
    fn set_running(&mut self, exception: usize) {
        self.set(RegisterARM::IPSR, exception as u32);
        // Writing this register makes the library re-evaluate its state.
        let flags = self.register(RegisterARM::XPSR) & 0xf000_0000;
        self.set(RegisterARM::APSR_NZCV, flags);
    }

    /// Turns an error of the library into the fault that a chip would raise.
    fn fault(&mut self, error: uc_error) {
        let pc = self.register(RegisterARM::PC);
        let what = format!("{error:?} in {}", self.image.function(pc));
        self.core.get_data_mut().wires.pc = pc;
        self.violation("core", &what, "ARMv7-M B1.5.14");
        if self.machine().scs.running() == HARD_FAULT {
            self.core.get_data_mut().halted = Some(format!("the core is locked up: {what} at {pc:#010x}"));
            return;
        }
        self.core.get_data_mut().scs.pend(HARD_FAULT);
    }

    fn violation(&mut self, register: &str, what: &str, section: &'static str) {
        self.core.get_data_mut().wires.violation(register, what, section);
    }

    fn register(&self, register: impl Into<i32>) -> u32 {
        self.core.reg_read(register).unwrap_or_default() as u32
    }

    fn set(&mut self, register: impl Into<i32>, value: u32) {
        if self.core.reg_write(register, value.into()).is_err() {
            self.core.get_data_mut().halted = Some("the emulator library refuses a register".into());
        }
    }

    /// Reads a word of memory.
    pub fn word(&self, address: u32) -> u32 {
        let mut bytes = [0; 4];
        match self.core.mem_read(address.into(), &mut bytes) {
            Ok(()) => u32::from_le_bytes(bytes),
            Err(_) => u32::MAX,
        }
    }

    /// Text about the core's present place.
    pub fn whereabouts(&self) -> String {
        let pc = self.register(RegisterARM::PC);
        let exception = self.machine().scs.running();
        let what = match exception {
            0 => "thread".to_owned(),
            1..FIRST_INTERRUPT => format!("exception {exception}"),
            _ => format!("interrupt {}", exception - FIRST_INTERRUPT),
        };
        format!("{pc:#010x} in {} ({what})", self.image.function(pc))
    }
}

/// Maps everything but plain memory to the machine.
fn map_device(core: &mut Unicorn<'_, Machine>, base: u32, size: u32) -> Result<(), uc_error> {
    let read = move |core: &mut Unicorn<'_, Machine>, offset: u64, size: usize| {
        let value = core.get_data_mut().read(base + offset as u32, size as u32);
        if core.get_data().wires.bus_fault.is_some() {
            let faultmask = core.reg_read(RegisterARM::FAULTMASK).unwrap_or_default() & 1 == 1;
            let machine = core.get_data_mut();
            machine.scs.ignore_bus_fault(faultmask, &mut machine.wires);
        }
        value
    };
    let write = move |core: &mut Unicorn<'_, Machine>, offset: u64, size: usize, value: u64| {
        core.get_data_mut().write(base + offset as u32, size as u32, value);
    };
    core.mmio_map(base.into(), size.into(), Some(read), Some(write))
}

fn hook(core: &mut Unicorn<'_, Machine>, image: &Image) -> Result<(), uc_error> {
    core.add_block_hook(1, 0, |core, address, size| {
        let (address, machine) = (address as u32, core.get_data_mut());
        machine.wires.pc = address;
        // Events that are due are handled before the block, which is then started again.
        let goes_on = std::mem::take(&mut machine.go_on);
        if !goes_on && (machine.attention || machine.cycles >= machine.deadline) {
            machine.stopped = true;
            let _ = core.emu_stop();
            return;
        }
        let count = machine.blocks.get(address, size);
        let count = match count {
            Some(count) => count,
            None => {
                let code = core.mem_read_as_vec(address.into(), size as usize).unwrap_or_default();
                core.get_data_mut().blocks.look(address, &code)
            }
        };
        core.get_data_mut().count(count);
    })?;
    core.add_intr_hook(|core, number| {
        let pc = core.reg_read(RegisterARM::PC).unwrap_or_default() as u32;
        let machine = core.get_data_mut();
        machine.stopped = true;
        match number {
            EXCEPTION_EXIT => machine.returning = Some(pc | 1),
            BREAKPOINT => machine.halted = Some(format!("a breakpoint at {pc:#010x}")),
            _ => {
                let what = format!("exception {number} of the emulator library");
                machine.wires.violation("core", what, "ARMv7-M B1.5");
                machine.scs.pend(HARD_FAULT);
            }
        }
        let _ = core.emu_stop();
    })?;
    core.add_mem_hook(HookType::MEM_WRITE_PROT, 1, 0, |core, _, address, size, value| {
        let machine = core.get_data_mut();
        let what = format!("{value:#x} ({size} bytes) is written over the image at {address:#010x}");
        machine.wires.violation("flash", what, "the image");
        true
    })?;
    core.add_mem_hook(HookType::MEM_READ_UNMAPPED | HookType::MEM_WRITE_UNMAPPED, 1, 0, |core, _, address, _, _| {
        let what = "nothing is there: a bus fault";
        core.get_data_mut().wires.violation(&format!("{address:#010x}"), what, "the memory map");
        false
    })?;
    for (place, _) in image.bytes.windows(4).enumerate().step_by(2).filter(|(_, bytes)| *bytes == BARRIER) {
        let address = u64::from(flash::BASE) + place as u64;
        core.add_code_hook(address, address, |core, _, _| core.get_data_mut().wires.barrier = true)?;
    }
    Ok(())
}
