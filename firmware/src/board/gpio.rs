//! Pins by port and number, with equal registers on all chips. The board file defines the use of each pin; the build
//! has checked it against the chip.

use core::convert::Infallible;

use embedded_hal::digital::{ErrorType, OutputPin};

use super::pac;

/// Address distance between the registers of two ports [byte].
const PORT: usize = 0x400;

/// A pin.
#[derive(Debug, Clone, Copy)]
pub struct Pin {
    /// Port, counted from A.
    pub port: u8,
    /// Number within the port.
    pub number: u8,
}

impl Pin {
    /// Pin of a port, counted from A; the port's clock must be enabled before the pin is used.
    pub const fn new(port: u8, number: u8) -> Self {
        Self { port, number }
    }

    fn registers(self) -> &'static pac::gpioa::RegisterBlock {
        // SAFETY: ports have equal registers at this distance; the chip has this port.
        unsafe { &*pac::GPIOA::ptr().byte_add(PORT * usize::from(self.port)) }
    }

    /// Writes a pin's field in a register with one field per pin.
    fn field(self, bits: u32, width: u8, value: u32) -> u32 {
        let shift = u32::from(width) * u32::from(self.number) % 32;
        let mask = (1 << width) - 1;
        bits & !(mask << shift) | (value & mask) << shift
    }

    /// Assigns the pin to a peripheral function.
    pub fn set_function(self, function: u8) {
        let registers = self.registers();
        // SAFETY: of the register only this pin's field changes, and every value of that is allowed.
        unsafe {
            if self.number < 8 {
                registers.afrl().modify(|r, w| w.bits(self.field(r.bits(), 4, function.into())));
            } else {
                registers.afrh().modify(|r, w| w.bits(self.field(r.bits(), 4, function.into())));
            }
        }
        self.set_mode(2);
    }

    /// Sets the highest pin speed: at the speed after reset, edges of a fast line take longer than a bit.
    pub fn make_fast(self) {
        // SAFETY: of the register only this pin's field changes.
        self.registers().ospeedr().modify(|r, w| unsafe { w.bits(self.field(r.bits(), 2, 3)) });
    }

    /// Enables the pull-up.
    pub fn pull_up(self) {
        // SAFETY: of the register only this pin's field changes.
        self.registers().pupdr().modify(|r, w| unsafe { w.bits(self.field(r.bits(), 2, 1)) });
    }

    fn set_mode(self, mode: u32) {
        // SAFETY: of the register only this pin's field changes.
        self.registers().moder().modify(|r, w| unsafe { w.bits(self.field(r.bits(), 2, mode)) });
    }

    /// Sets the level of an output by a single write, which leaves the port's other pins unchanged.
    fn set_level(self, high: bool) {
        let bits = 1 << (u32::from(self.number) + if high { 0 } else { 16 });
        // SAFETY: every word is allowed; pins that are no outputs do not care.
        self.registers().bsrr().write(|w| unsafe { w.bits(bits) });
    }
}

/// Output of the board, or none. `set_high` of embedded-hal switches it on, whatever the active level of the pin.
#[derive(Debug)]
pub struct Output {
    pin: Option<Pin>,
    on_is_high: bool,
}

impl Output {
    /// Makes the pin an output that is on or off from the start.
    pub fn open(pin: Option<(Pin, bool)>, on: bool) -> Self {
        let output = Self { pin: pin.map(|(pin, _)| pin), on_is_high: pin.is_some_and(|(_, high)| high) };
        output.switch(on);
        if let Some(pin) = output.pin {
            pin.set_mode(1);
        }
        output
    }

    fn switch(&self, on: bool) {
        if let Some(pin) = self.pin {
            pin.set_level(on == self.on_is_high);
        }
    }
}

impl ErrorType for Output {
    type Error = Infallible;
}

impl OutputPin for Output {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.switch(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.switch(true);
        Ok(())
    }
}
