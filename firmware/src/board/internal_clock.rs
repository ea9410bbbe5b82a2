//! Return to the internal oscillator after any clock setup of a bootloader. A macro, since the register types of the
//! chips are unrelated.

/// Defines `back_to_internal` for a chip: the bits of its PLL (on, ready) and of its clock security system in RCC_CR,
/// and the reset of the dividers of core and buses. Afterwards the core runs from the internal oscillator and all other
/// clocks are off; wait states, boost and voltage scale may stay.
macro_rules! back_to_internal {
    ($on:ident, $ready:ident, $security:ident, $dividers:expr) => {
        /// Restores the clocks after reset; `false` if the clock controller does not respond.
        fn back_to_internal(clocks: &pac::RCC) -> bool {
            clocks.cr().modify(|_, w| w.hsion().set_bit());
            if !wait_until(|| clocks.cr().read().hsirdy().bit_is_set()) {
                return false;
            }
            clocks.cfgr().modify(|_, w| w.sw().hsi());
            if !wait_until(|| clocks.cfgr().read().sws().is_hsi()) {
                return false;
            }
            clocks.cr().modify(|_, w| w.$on().clear_bit().hseon().clear_bit().$security().clear_bit());
            let is_off = |cr: &pac::rcc::cr::R| cr.$ready().bit_is_clear() && cr.hserdy().bit_is_clear();
            let is_alone = wait_until(|| is_off(&clocks.cr().read()));
            // The divider of the internal oscillator cannot be changed while a PLL runs from it.
            let dividers: fn(&pac::RCC) = $dividers;
            dividers(clocks);
            is_alone
        }
    };
}

pub(super) use back_to_internal;
