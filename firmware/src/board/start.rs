//! The start of a board: its chip first, then the pins that its file names.

use link::messages::{Clock, ClockSource};

use super::chip::{Chip, Parts};
use super::gpio::{Output, Pin};
use super::watchdog::Watchdog;
use super::{ThisChip, description, pac};

/// A board that is up.
pub struct Started {
    /// What the core clock is made of.
    pub clock: Clock,
    /// The motor-enable output, off.
    pub enable: Output,
    /// The status light.
    pub light: Output,
    /// Where what was learnt is kept.
    pub slots: <ThisChip as Chip>::Slots,
    /// Running.
    pub watchdog: Watchdog,
    /// The last reset came from the watchdog.
    pub watchdog_reset: bool,
    /// Switches of the clocks of everything else.
    clocks: pac::RCC,
}

/// Where the linker puts the vectors: at the start of flash.
const VECTORS: u32 = 0x0800_0000;

/// Sets up clock, outputs and watchdog. Every wait is bounded.
pub fn start(device: pac::Peripherals, core: &mut cortex_m::Peripherals) -> Started {
    // Whoever jumped here, such as a bootloader, may have had vectors of its own; what else it leaves is `handover`'s.
    // SAFETY: vectors are there, and no interrupt is on yet.
    unsafe { core.SCB.vtor.write(VECTORS) };
    ThisChip::reset_ports(&device.RCC);
    // What holds the supply comes first: until then it is there by courtesy of a finger on a button.
    let _supply = output(&device.RCC, description::SUPPLY, true);
    let Parts { clock, slots, watchdog, watchdog_reset, clocks } = ThisChip::start(device, core);
    Started {
        clock,
        enable: output(&clocks, description::ENABLE, false),
        light: output(&clocks, description::LIGHT, false),
        slots,
        watchdog: Watchdog::start(watchdog),
        watchdog_reset,
        clocks,
    }
}

impl Started {
    /// Opens the serial line to the host.
    pub fn open_serial(&self) -> <ThisChip as Chip>::Port {
        let [send, receive] =
            [description::SERIAL_SEND, description::SERIAL_RECEIVE].map(|pin| given(&self.clocks, pin));
        send.0.give_to(send.1);
        // Nothing drives it before a host is there.
        receive.0.pull_up();
        receive.0.give_to(receive.1);
        let has_pll = self.clock.source != ClockSource::Failed;
        let clock = if has_pll { description::SERIAL_CLOCK } else { ThisChip::INTERNAL.rate };
        ThisChip::open_port(&self.clocks, clock, description::BAUD)
    }
}

/// An output of the board's file, the clock of its port on.
fn output(clocks: &pac::RCC, output: Option<(u8, u8, bool)>, on: bool) -> Output {
    let pin = output.map(|(port, number, high)| {
        ThisChip::power_port(clocks, port);
        (Pin::new(port, number), high)
    });
    Output::open(pin, on)
}

/// A pin with the function that it is given to, the clock of its port on.
pub(super) fn given(clocks: &pac::RCC, (port, number, function): (u8, u8, u8)) -> (Pin, u8) {
    ThisChip::power_port(clocks, port);
    (Pin::new(port, number), function)
}
