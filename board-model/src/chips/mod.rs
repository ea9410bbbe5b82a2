//! Chips: their peripherals with addresses.

pub mod f405;
pub mod g431;
pub mod g474;
pub mod h743;

use crate::machine::Placed;
use crate::peripherals::Peripheral;
use crate::peripherals::gpio::Gpio;
use crate::wires::Gate;

/// Peripheral whose clock is always on.
fn always(name: &'static str, base: u32, peripheral: Box<dyn Peripheral>) -> Placed {
    Placed { name, base, size: 0x400, clock: None, hold: None, section: "", peripheral }
}

/// General-purpose ports from A on, by their names; each has one bit in the clock and the reset register.
fn ports<'a>(
    section: &'static str,
    base: u32,
    [clock, hold]: [u32; 2],
    names: &'a [&'static str],
    make: impl Fn(char) -> Gpio + 'a,
) -> impl Iterator<Item = Placed> + 'a {
    names.iter().zip('A'..).zip(0..).map(move |((name, port), index)| {
        gated(section, name, base + 0x400 * index, (clock, index), Some((hold, index)), Box::new(make(port)))
    })
}

/// Peripheral with a clock gate and a reset, as offsets and bits in the clock controller; `section` is the manual's
/// section.
fn gated(
    section: &'static str,
    name: &'static str,
    base: u32,
    (offset, bit): (u32, u32),
    hold: Option<(u32, u32)>,
    peripheral: Box<dyn Peripheral>,
) -> Placed {
    let hold = hold.map(|(offset, bit)| Gate { offset, bit });
    Placed { name, base, size: 0x400, clock: Some(Gate { offset, bit }), hold, section, peripheral }
}
