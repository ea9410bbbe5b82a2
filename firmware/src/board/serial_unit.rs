//! USART of the serial line, by the board file: registers, interrupt, clock enable.

use cortex_m::peripheral::NVIC;

use super::pac;

/// Registers, interrupt and clock of each unit of a chip.
macro_rules! units {
    ($($name:literal => $unit:ident, $gates:ident, $gate:ident, $resets:ident, $reset:ident;)+) => {$(
        /// Registers of the unit.
        #[cfg(serial = $name)]
        pub type Registers = pac::$unit;

        /// Interrupt of the unit.
        #[cfg(serial = $name)]
        const INTERRUPT: pac::Interrupt = pac::Interrupt::$unit;

        /// Returns the unit with its clock enabled, after a reset, since a bootloader may have used it.
        #[cfg(serial = $name)]
        pub fn take(clocks: &pac::RCC) -> Registers {
            clocks.$gates().modify(|_, w| w.$gate().set_bit());
            let _ = clocks.$gates().read();
            clocks.$resets().modify(|_, w| w.$reset().set_bit());
            clocks.$resets().modify(|_, w| w.$reset().clear_bit());
            // SAFETY: called once, at the start; there is no other user of the unit.
            unsafe { Registers::steal() }
        }
    )+};
}

#[cfg(family = "stm32f4")]
units! {
    "usart1" => USART1, apb2enr, usart1en, apb2rstr, usart1rst;
    "usart2" => USART2, apb1enr, usart2en, apb1rstr, usart2rst;
    "usart3" => USART3, apb1enr, usart3en, apb1rstr, usart3rst;
    "uart4" => UART4, apb1enr, uart4en, apb1rstr, uart4rst;
    "uart5" => UART5, apb1enr, uart5en, apb1rstr, uart5rst;
    "usart6" => USART6, apb2enr, usart6en, apb2rstr, usart6rst;
}

#[cfg(family = "stm32g4")]
units! {
    "usart1" => USART1, apb2enr, usart1en, apb2rstr, usart1rst;
    "usart2" => USART2, apb1enr1, usart2en, apb1rstr1, usart2rst;
    "usart3" => USART3, apb1enr1, usart3en, apb1rstr1, usart3rst;
    "uart4" => UART4, apb1enr1, uart4en, apb1rstr1, uart4rst;
    "uart5" => UART5, apb1enr1, uart5en, apb1rstr1, uart5rst;
}

#[cfg(family = "stm32h7")]
units! {
    "usart1" => USART1, apb2enr, usart1en, apb2rstr, usart1rst;
    "usart2" => USART2, apb1lenr, usart2en, apb1lrstr, usart2rst;
    "usart3" => USART3, apb1lenr, usart3en, apb1lrstr, usart3rst;
    "uart4" => UART4, apb1lenr, uart4en, apb1lrstr, uart4rst;
    "uart5" => UART5, apb1lenr, uart5en, apb1lrstr, uart5rst;
    "usart6" => USART6, apb2enr, usart6en, apb2rstr, usart6rst;
    "uart7" => UART7, apb1lenr, uart7en, apb1lrstr, uart7rst;
    "uart8" => UART8, apb1lenr, uart8en, apb1lrstr, uart8rst;
}

/// Requests the interrupt.
pub fn wake() {
    NVIC::pend(INTERRUPT);
}
