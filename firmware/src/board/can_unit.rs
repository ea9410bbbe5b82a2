//! CAN peripheral of the board file, whichever kind the chip has.

#[cfg(family = "stm32f4")]
use super::bxcan as driver;
#[cfg(family = "stm32g4")]
use super::fdcan as driver;
use super::pac;
use crate::can::{CanReceiver, CanSender};

/// Halves of a CAN peripheral, for the interrupt and for the tick.
pub trait CanHalves {
    /// Half of the interrupt.
    type Receiver: CanReceiver;
    /// Half of the tick.
    type Sender: CanSender;

    /// Starts the peripheral. To be called once.
    fn open(clocks: &pac::RCC) -> (Self::Receiver, Self::Sender);
}

/// CAN line of this board.
pub struct CanLine;

impl CanHalves for CanLine {
    type Receiver = driver::Receiver;
    type Sender = driver::Sender;

    fn open(clocks: &pac::RCC) -> (Self::Receiver, Self::Sender) {
        driver::open(clocks)
    }
}
