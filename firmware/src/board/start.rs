//! Start of a board: chip first, then the pins of the board file.

use link::messages::{Clock, ClockSource};

use super::chip::{Chip, Parts};
use super::gpio::{Output, Pin};
use super::watchdog::Watchdog;
use super::{ThisChip, description, pac};

/// Board after its start.
pub struct Started {
    /// Source and tolerance of the core clock.
    pub clock: Clock,
    /// Motor-enable output, off.
    pub enable: Output,
    /// Status light.
    pub light: Output,
    /// Flash slots for the estimated parameters.
    pub slots: <ThisChip as Chip>::Slots,
    /// Running watchdog.
    pub watchdog: Watchdog,
    /// The last reset came from the watchdog.
    pub watchdog_reset: bool,
    /// Clock enables of all other peripherals.
    clocks: pac::RCC,
}

/// Address of the vectors: start of flash.
const VECTORS: u32 = 0x0800_0000;

/// Sets up clock, outputs and watchdog. Every wait is bounded.
pub fn start(device: pac::Peripherals, core: &mut cortex_m::Peripherals) -> Started {
    // A bootloader may have set other vectors; `handover` handles its other leftovers.
    // SAFETY: the vectors of this image lie at `VECTORS`, and no interrupt is enabled yet.
    unsafe { core.SCB.vtor.write(VECTORS) };
    ThisChip::reset_ports(&device.RCC);
    // Outputs that hold the supply come first: until then a finger on a button holds it.
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
    /// Opens the CAN line. Its timing holds for the PLL only: without it nothing is sent or received.
    #[cfg(has_can)]
    pub fn open_can(&self) -> (super::can::Receiver, super::can::Sender) {
        if self.clock.source != ClockSource::Failed {
            let [send, receive] = description::CAN.map(|pin| clocked_pin(&self.clocks, pin));
            send.0.make_fast();
            send.0.set_function(send.1);
            // Without a transceiver the bus is silent instead of held.
            receive.0.pull_up();
            receive.0.set_function(receive.1);
        }
        super::can::open(&self.clocks)
    }

    /// Opens the serial line to the host.
    pub fn open_serial(&self) -> <ThisChip as Chip>::Port {
        let [send, receive] =
            [description::SERIAL_SEND, description::SERIAL_RECEIVE].map(|pin| clocked_pin(&self.clocks, pin));
        send.0.set_function(send.1);
        // No host drives the line yet.
        receive.0.pull_up();
        receive.0.set_function(receive.1);
        let has_pll = self.clock.source != ClockSource::Failed;
        let clock = if has_pll { description::SERIAL_CLOCK } else { ThisChip::INTERNAL.rate };
        ThisChip::open_port(&self.clocks, clock, description::BAUD)
    }
}

/// Opens an output of the board file and enables the clock of its port.
fn output(clocks: &pac::RCC, output: Option<(u8, u8, bool)>, on: bool) -> Output {
    let pin = output.map(|(port, number, high)| {
        ThisChip::power_port(clocks, port);
        (Pin::new(port, number), high)
    });
    Output::open(pin, on)
}

/// Returns a pin and its function and enables the clock of its port.
pub(super) fn clocked_pin(clocks: &pac::RCC, (port, number, function): (u8, u8, u8)) -> (Pin, u8) {
    ThisChip::power_port(clocks, port);
    (Pin::new(port, number), function)
}
