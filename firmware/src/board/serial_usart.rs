//! Which USART of the chip the serial line is on, and its interrupt, for boards whose USART has FIFOs. Pins and clock are
//! set up by the board, bytes are moved by `fifo_uart`.

use cortex_m::peripheral::NVIC;
#[cfg(feature = "stm32g474")]
use stm32g4::stm32g474 as pac;
#[cfg(feature = "stm32h743")]
use stm32h7::stm32h743 as pac;

/// The USART of the serial line.
#[cfg(feature = "stm32g474")]
pub type UsartRegisters = pac::USART2;
/// The USART of the serial line.
#[cfg(feature = "stm32h743")]
pub type UsartRegisters = pac::USART3;

#[cfg(feature = "stm32g474")]
const INTERRUPT: pac::Interrupt = pac::Interrupt::USART2;
#[cfg(feature = "stm32h743")]
const INTERRUPT: pac::Interrupt = pac::Interrupt::USART3;

/// Makes its interrupt run.
pub fn wake() {
    NVIC::pend(INTERRUPT);
}
