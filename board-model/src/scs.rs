//! System control space of the core: interrupt controller, SysTick, system control block. ARMv7-M Architecture
//! Reference Manual, chapter B3; four priority bits, as on all three chips.

use std::collections::BTreeSet;

use crate::register::{bit, bits};
use crate::wires::Wires;

/// Numbers of the system exceptions.
pub const NMI: usize = 2;
/// Hard fault, to which every fault escalates unless it is enabled separately.
pub const HARD_FAULT: usize = 3;
const BUS_FAULT: usize = 5;
/// Bits of CCR and SHCSR: handlers of highest priority ignore bus faults; the bus fault has its own handler.
const BFHFNMIGN: u32 = bit(8);
const BUSFAULTENA: u32 = bit(17);
const PEND_SV: usize = 14;
/// Exception of SysTick.
pub const SYSTICK: usize = 15;
/// Number of the first interrupt.
pub const FIRST_INTERRUPT: usize = 16;
const EXCEPTIONS: usize = 256;
/// Implemented priority bits: RM0090 12.1, RM0440 14.1, RM0433 19.1.1.
const PRIORITY_BITS: u8 = 0xf0;
/// Priority below all exceptions.
const IDLE: i32 = 256;
const MANUAL: &str = "ARMv7-M B3";

/// Masks of the core, from its special registers.
#[derive(Debug, Clone, Copy, Default)]
pub struct Masks {
    /// PRIMASK.
    pub primask: bool,
    /// FAULTMASK.
    pub faultmask: bool,
    /// BASEPRI.
    pub basepri: u8,
}

/// SysTick: ARMv7-M B3.3. Counts cycles of the core.
#[derive(Debug, Clone, Copy, Default)]
struct SysTick {
    control: u32,
    reload: u32,
    /// Cycle at which the counter holds the reload value.
    loaded: u64,
    /// Cycle of the next expiry.
    expires: u64,
    counted: bool,
    /// Counter value while SysTick is off.
    held: u32,
}

impl SysTick {
    fn is_on(&self) -> bool {
        self.control & 1 == 1
    }

    /// Starts counting: the next cycle loads the reload value.
    fn start(&mut self, now: u64) {
        self.loaded = now + 1;
        self.expires = self.loaded + u64::from(self.reload);
    }

    /// Returns whether it has expired since the last call.
    fn advance(&mut self, now: u64) -> bool {
        if !self.is_on() || self.reload == 0 || now < self.expires {
            return false;
        }
        let period = u64::from(self.reload) + 1;
        let times = (now - self.expires) / period + 1;
        self.loaded += times * period;
        self.expires += times * period;
        self.counted = true;
        true
    }

    fn value(&self, now: u64) -> u32 {
        match () {
            () if !self.is_on() => self.held,
            // Zero between expiry and reload.
            () if now < self.loaded => 0,
            () => self.reload.saturating_sub((now - self.loaded) as u32),
        }
    }
}

/// System control space.
#[derive(Debug)]
pub struct Scs {
    pending: BTreeSet<usize>,
    enabled: Vec<bool>,
    priority: Vec<u8>,
    /// Active exceptions, the innermost last.
    active: Vec<usize>,
    /// Number of entries by exception.
    taken: Vec<u32>,
    systick: SysTick,
    /// VTOR.
    pub vectors: u32,
    /// CPACR.
    pub coprocessors: u32,
    scr: u32,
    ccr: u32,
    shcsr: u32,
    fault_status: u32,
    hard_fault_status: u32,
    fault_address: u32,
    demcr: u32,
    cache_selection: u32,
    fp_context: u32,
    has_caches: bool,
    /// True if data caches were cleaned or invalidated since the flag was cleared.
    pub cache_maintained: bool,
}

impl Scs {
    /// State after a reset, with vectors at the start of flash.
    pub fn new(has_caches: bool) -> Self {
        let mut enabled = vec![false; EXCEPTIONS];
        enabled[..FIRST_INTERRUPT].fill(true);
        Self {
            pending: BTreeSet::new(),
            enabled,
            priority: vec![0; EXCEPTIONS],
            active: Vec::new(),
            taken: vec![0; EXCEPTIONS],
            systick: SysTick::default(),
            vectors: 0x0800_0000,
            coprocessors: 0,
            scr: 0,
            ccr: 0x200,
            shcsr: 0,
            fault_status: 0,
            hard_fault_status: 0,
            fault_address: 0,
            demcr: 0,
            cache_selection: 0,
            fp_context: 0xc000_0000,
            has_caches,
            cache_maintained: false,
        }
    }

    /// Active exception; 0 for none.
    pub fn running(&self) -> usize {
        self.active.last().copied().unwrap_or(0)
    }

    /// Number of entries into an exception since the reset.
    pub fn taken(&self, exception: usize) -> u32 {
        self.taken[exception]
    }

    /// Returns whether no enabled interrupt has the priority of an exception or a higher one.
    pub fn is_above_all(&self, exception: usize) -> bool {
        let own = self.priority_of(exception);
        (FIRST_INTERRUPT..EXCEPTIONS).all(|other| !self.enabled[other] || self.priority_of(other) > own)
    }

    /// Sets an exception pending.
    pub fn pend(&mut self, exception: usize) {
        self.pending.insert(exception);
    }

    /// Samples the interrupt lines and expiries of SysTick.
    pub fn advance(&mut self, now: u64, wires: &mut Wires) {
        if self.systick.advance(now) && self.systick.control & 2 != 0 {
            self.pending.insert(SYSTICK);
        }
        for exception in wires.interrupts.iter().map(|line| line + FIRST_INTERRUPT) {
            // A level sets the exception pending again after its handler.
            if !self.active.contains(&exception) {
                self.pending.insert(exception);
            }
        }
        if std::mem::take(&mut wires.non_maskable) && !self.active.contains(&NMI) {
            self.pending.insert(NMI);
        }
        if let Some(address) = wires.bus_fault.take() {
            self.note_bus_fault(address);
            if self.shcsr & BUSFAULTENA != 0 && self.priority_of(BUS_FAULT) < self.active_priority() {
                self.pending.insert(BUS_FAULT);
            } else {
                // HFSR: FORCED.
                self.hard_fault_status |= bit(30);
                self.pending.insert(HARD_FAULT);
            }
        }
    }

    /// Sets PRECISERR and BFARVALID in CFSR, and the address.
    fn note_bus_fault(&mut self, address: u32) {
        self.fault_status |= bit(9) | bit(15);
        self.fault_address = address;
    }

    /// Ignores a bus fault of a load or store except for its status, if FAULTMASK is set or a handler of highest
    /// priority runs with BFHFNMIGN (ARMv7-M B3.2.8). Code uses this to read memory that may be damaged.
    pub fn ignore_bus_fault(&mut self, faultmask: bool, wires: &mut Wires) {
        if self.ccr & BFHFNMIGN != 0
            && (faultmask || self.active_priority() < 0)
            && let Some(address) = wires.bus_fault.take()
        {
            self.note_bus_fault(address);
        }
    }

    /// Cycle of the next expiry of SysTick.
    pub fn next_event(&self) -> Option<u64> {
        (self.systick.is_on() && self.systick.reload > 0).then_some(self.systick.expires)
    }

    fn priority_of(&self, exception: usize) -> i32 {
        match exception {
            NMI => -2,
            HARD_FAULT => -1,
            _ => i32::from(self.priority[exception] & PRIORITY_BITS),
        }
    }

    /// Priority of the active exceptions, without masks.
    fn active_priority(&self) -> i32 {
        self.active.iter().map(|exception| self.priority_of(*exception)).min().unwrap_or(IDLE)
    }

    fn candidate(&self) -> Option<usize> {
        let enabled = self.pending.iter().copied().filter(|exception| self.enabled[*exception]);
        enabled.min_by_key(|exception| (self.priority_of(*exception), *exception))
    }

    /// Exception to be entered now: ARMv7-M B1.5.4.
    pub fn due(&self, masks: Masks) -> Option<usize> {
        let mut limit = self.active_priority();
        if masks.basepri != 0 {
            limit = limit.min(i32::from(masks.basepri & PRIORITY_BITS));
        }
        if masks.primask {
            limit = limit.min(0);
        }
        if masks.faultmask {
            limit = limit.min(-1);
        }
        self.candidate().filter(|exception| self.priority_of(*exception) < limit)
    }

    /// Returns whether the masks must be evaluated at all.
    pub fn may_be_due(&self) -> bool {
        self.candidate().is_some_and(|exception| self.priority_of(exception) < self.active_priority())
    }

    /// Returns whether WFI ends: PRIMASK does not prevent a wake-up (ARMv7-M B1.5.19).
    pub fn wakes(&self, masks: Masks) -> bool {
        self.due(Masks { primask: false, ..masks }).is_some()
    }

    /// Enters an exception; returns the address of its vector.
    pub fn enter(&mut self, exception: usize) -> u32 {
        self.pending.remove(&exception);
        self.active.push(exception);
        self.taken[exception] += 1;
        self.vectors + 4 * exception as u32
    }

    /// Leaves the active exception.
    pub fn leave(&mut self) {
        self.active.pop();
    }

    /// Returns whether a fault can no longer be handled.
    pub fn is_locked_up(&self) -> bool {
        self.active_priority() <= -1 && self.pending.contains(&HARD_FAULT)
    }

    /// Read on the private peripheral bus.
    pub fn read(&mut self, address: u32, size: u32, now: u64, wires: &mut Wires) -> u32 {
        self.advance(now, wires);
        let word = self.read_word(address & !3, now, wires);
        let shift = 8 * (address & 3);
        (word >> shift) & (u32::MAX >> (32 - 8 * size))
    }

    fn read_word(&mut self, address: u32, now: u64, wires: &mut Wires) -> u32 {
        match address {
            0xe000_e010 => self.systick.control | u32::from(std::mem::take(&mut self.systick.counted)) << 16,
            0xe000_e014 => self.systick.reload,
            0xe000_e018 => self.systick.value(now),
            0xe000_e01c => 0x4000_0000,
            0xe000_e100..0xe000_e120 | 0xe000_e180..0xe000_e1a0 => {
                self.bitmap(address, |scs, number| scs.enabled[number])
            }
            0xe000_e200..0xe000_e220 | 0xe000_e280..0xe000_e2a0 => {
                self.bitmap(address, |scs, number| scs.pending.contains(&number))
            }
            0xe000_e300..0xe000_e320 => self.bitmap(address, |scs, number| scs.active.contains(&number)),
            0xe000_e400..0xe000_e4f0 => self.priorities(FIRST_INTERRUPT + (address - 0xe000_e400) as usize),
            0xe000_ed00 => {
                if self.has_caches {
                    0x411f_c271
                } else {
                    0x410f_c241
                }
            }
            0xe000_ed04 => self.interrupt_state(),
            0xe000_ed08 => self.vectors,
            0xe000_ed0c => 0xfa05_0000,
            0xe000_ed10 => self.scr,
            0xe000_ed14 => self.ccr,
            0xe000_ed18..0xe000_ed24 => self.priorities(4 + (address - 0xe000_ed18) as usize),
            0xe000_ed24 => self.shcsr,
            0xe000_ed28 => self.fault_status,
            0xe000_ed2c => self.hard_fault_status,
            0xe000_ed34 => 0,
            0xe000_ed38 => self.fault_address,
            // 16 KiB each: instructions 2 ways of 256 sets, data 4 ways of 128 sets, lines of 32 bytes (RM0433 2.3).
            0xe000_ed80 if self.has_caches => {
                if self.cache_selection & 1 == 1 {
                    0xf01f_e009
                } else {
                    0xf00f_e019
                }
            }
            0xe000_ed84 if self.has_caches => self.cache_selection,
            0xe000_ed88 => self.coprocessors,
            0xe000_edf0 => 0,
            0xe000_edfc => self.demcr,
            0xe000_ef34 => self.fp_context,
            _ => {
                wires.violation(&format!("{address:#010x}"), "is read, and the model has no such register", MANUAL);
                0
            }
        }
    }

    fn bitmap(&self, address: u32, is_set: impl Fn(&Self, usize) -> bool) -> u32 {
        let first = FIRST_INTERRUPT + 8 * (address & 0x7c) as usize;
        (0..32).map(|index| u32::from(first + index < EXCEPTIONS && is_set(self, first + index)) << index).sum()
    }

    fn priorities(&self, first: usize) -> u32 {
        (0..4).map(|index| u32::from(self.priority.get(first + index).copied().unwrap_or(0)) << (8 * index)).sum()
    }

    /// ICSR.
    fn interrupt_state(&self) -> u32 {
        let flag = |exception: usize, place: u32| u32::from(self.pending.contains(&exception)) << place;
        let next = self.candidate().unwrap_or(0) as u32;
        let any = self.pending.range(FIRST_INTERRUPT..).next().is_some();
        let alone = self.active.len() <= 1;
        flag(NMI, 31)
            | flag(PEND_SV, 28)
            | flag(SYSTICK, 26)
            | u32::from(any) << 22
            | next << 12
            | u32::from(alone) << 11
            | self.running() as u32
    }

    /// Write on the private peripheral bus.
    pub fn write(&mut self, address: u32, size: u32, value: u32, now: u64, wires: &mut Wires) {
        self.advance(now, wires);
        match address {
            0xe000_e400..0xe000_e4f0 => {
                self.set_priorities(FIRST_INTERRUPT + (address - 0xe000_e400) as usize, size, value)
            }
            0xe000_ed18..0xe000_ed24 => self.set_priorities(4 + (address - 0xe000_ed18) as usize, size, value),
            _ if size != 4 || !address.is_multiple_of(4) => {
                wires.violation(&format!("{address:#010x}"), format!("is written by {size} bytes: words only"), MANUAL);
            }
            _ => self.write_word(address, value, now, wires),
        }
    }

    fn set_priorities(&mut self, first: usize, size: u32, value: u32) {
        for index in 0..size as usize {
            if let Some(priority) = self.priority.get_mut(first + index) {
                *priority = (value >> (8 * index)) as u8 & PRIORITY_BITS;
            }
        }
    }

    fn write_word(&mut self, address: u32, value: u32, now: u64, wires: &mut Wires) {
        match address {
            0xe000_e010 => self.control_systick(value, now, wires),
            0xe000_e014 => {
                if value >> 24 != 0 {
                    wires.violation("SYST_RVR", "has 24 bits only", "ARMv7-M B3.3.4");
                }
                self.systick.reload = value & 0x00ff_ffff;
            }
            0xe000_e018 => {
                // Any write clears the counter; the next cycle reloads it.
                (self.systick.held, self.systick.counted) = (0, false);
                self.systick.start(now);
            }
            0xe000_e100..0xe000_e120 => self.set_bits(address, value, |scs, number| scs.enabled[number] = true),
            0xe000_e180..0xe000_e1a0 => self.set_bits(address, value, |scs, number| scs.enabled[number] = false),
            0xe000_e200..0xe000_e220 => self.set_bits(address, value, |scs, number| {
                scs.pending.insert(number);
            }),
            0xe000_e280..0xe000_e2a0 => self.set_bits(address, value, |scs, number| {
                scs.pending.remove(&number);
            }),
            0xe000_ed04 => {
                for (place, exception, level) in [
                    (31, NMI, true),
                    (28, PEND_SV, true),
                    (27, PEND_SV, false),
                    (26, SYSTICK, true),
                    (25, SYSTICK, false),
                ] {
                    if value & bit(place) != 0 && level {
                        self.pending.insert(exception);
                    } else if value & bit(place) != 0 {
                        self.pending.remove(&exception);
                    }
                }
            }
            0xe000_ed08 => {
                if value & 0x1ff != 0 {
                    wires.violation("VTOR", "is not aligned to the table of vectors", "ARMv7-M B3.2.5");
                }
                self.vectors = value;
            }
            0xe000_ed0c => self.reset_or_group(value, wires),
            0xe000_ed10 => self.scr = value,
            0xe000_ed14 => self.ccr = value,
            0xe000_ed24 => self.shcsr = value,
            0xe000_ed28 => self.fault_status &= !value,
            0xe000_ed2c => self.hard_fault_status &= !value,
            0xe000_ed84 if self.has_caches => self.cache_selection = value,
            0xe000_ed88 => self.coprocessors = value,
            0xe000_edfc => self.demcr = value,
            0xe000_ef00 => {
                self.pending.insert(FIRST_INTERRUPT + (value & 0xff) as usize % 240);
            }
            0xe000_ef34 => self.fp_context = value,
            // ICIALLU, ICIMVAU, branch predictor.
            0xe000_ef50 | 0xe000_ef58 | 0xe000_ef78 if self.has_caches => {}
            // Data caches by address, or by set and way.
            0xe000_ef5c..0xe000_ef78 if self.has_caches => self.cache_maintained = true,
            _ => wires.violation(&format!("{address:#010x}"), "is written, and the model has no such register", MANUAL),
        }
    }

    fn set_bits(&mut self, address: u32, value: u32, change: impl Fn(&mut Self, usize)) {
        let first = FIRST_INTERRUPT + 8 * (address & 0x7c) as usize;
        for index in (0..32).filter(|index| value >> index & 1 == 1) {
            if first + index < EXCEPTIONS {
                change(self, first + index);
            }
        }
    }

    fn control_systick(&mut self, value: u32, now: u64, wires: &mut Wires) {
        if value & !0x1_0007 != 0 {
            wires.violation("SYST_CSR", "reserved bits are written", "ARMv7-M B3.3.3");
        }
        if value & 1 == 1 && self.systick.reload == 0 {
            wires.violation("SYST_RVR", "is 0 while SysTick is switched on", "ARMv7-M B3.3.4");
        }
        if value & 4 == 0 && value & 1 == 1 {
            wires.violation("SYST_CSR", "the external clock of SysTick is not modelled", "ARMv7-M B3.3.3");
        }
        let was_on = self.systick.is_on();
        self.systick.held = self.systick.value(now);
        self.systick.control = value & 7;
        if !was_on && self.systick.is_on() {
            self.systick.start(now);
        }
    }

    /// AIRCR.
    fn reset_or_group(&mut self, value: u32, wires: &mut Wires) {
        if value >> 16 != 0x05fa {
            wires.violation("AIRCR", "is written without its key", "ARMv7-M B3.2.6");
        } else if value & bit(2) != 0 {
            wires.reset = Some(crate::wires::Reset::Software);
        } else if value & bits(10, 8) != 0 {
            wires.violation("AIRCR", "groups of priorities are not modelled", "ARMv7-M B3.2.6");
        }
    }
}
