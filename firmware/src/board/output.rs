//! A pin of a GPIO port as an output for embedded-hal. Each board names its ports, and sets the pins up.

use core::convert::Infallible;

use embedded_hal::digital::{ErrorType, OutputPin};

/// A port that sets pins by the lower half of a word and clears them by the upper.
pub trait Port {
    /// Writes the bit set/reset register.
    fn set_reset(&mut self, bits: u32);
}

/// Makes ports of a board's device such ports.
macro_rules! ports {
    ($($port:ty),+) => {$(
        impl $crate::board::output::Port for $port {
            fn set_reset(&mut self, bits: u32) {
                // SAFETY: every word is allowed; pins that are no outputs do not care.
                self.bsrr().write(|w| unsafe { w.bits(bits) });
            }
        }
    )+};
}
pub(super) use ports;

/// One pin of a port that has no other output.
#[derive(Debug)]
pub struct Output<P, const PIN: u8> {
    port: P,
}

impl<P: Port, const PIN: u8> Output<P, PIN> {
    /// The pin of this port; the board has made it an output.
    pub fn new(port: P) -> Self {
        Self { port }
    }
}

impl<P, const PIN: u8> ErrorType for Output<P, PIN> {
    type Error = Infallible;
}

impl<P: Port, const PIN: u8> OutputPin for Output<P, PIN> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.port.set_reset(1 << (PIN + 16));
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.port.set_reset(1 << PIN);
        Ok(())
    }
}
