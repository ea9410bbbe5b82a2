//! The chips: which peripherals are where.

pub mod f405;
pub mod g474;
pub mod h743;

use crate::machine::Placed;
use crate::peripherals::Peripheral;
use crate::wires::Gate;

/// A peripheral whose clock is always on.
fn always(name: &'static str, base: u32, peripheral: Box<dyn Peripheral>) -> Placed {
    Placed { name, base, size: 0x400, clock: None, hold: None, section: "", peripheral }
}

/// One with a clock gate and a reset: offsets and bits in the clock controller, whose section is named.
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
