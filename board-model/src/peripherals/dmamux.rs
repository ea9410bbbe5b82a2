//! The multiplexer of requests of STM32G474: RM0440 section 13. Its outputs 0 to 7 are the channels of DMA1, 8 to 15 those of
//! DMA2.

use super::Peripheral;
use crate::register::{Register, Registers};
use crate::wires::{Request, Wires};

const OUTPUTS: u32 = 16;

static MAP: [Register; 18] = map();

/// RM0440 13.6.
const fn map() -> [Register; 18] {
    let mut map = [Register::new("DMAMUX_CSR", 0x80, 0, 0xffff).special(u32::MAX); 18];
    map[1] = Register::new("DMAMUX_CFR", 0x84, 0, 0xffff).special(u32::MAX);
    let mut output = 0;
    while output < OUTPUTS {
        map[2 + output as usize] = Register::new("DMAMUX_CxCR", 4 * output, 0, 0x1fff_037f);
        output += 1;
    }
    map
}

/// The multiplexer.
#[derive(Debug)]
pub struct DmaMux {
    registers: Registers,
}

impl Default for DmaMux {
    fn default() -> Self {
        Self { registers: Registers::new(&MAP) }
    }
}

/// RM0440 table 91.
fn request(number: u32) -> Option<Request> {
    match number {
        10 => Some(Request::SpiReceived(1)),
        11 => Some(Request::SpiToSend(1)),
        12 => Some(Request::SpiReceived(2)),
        13 => Some(Request::SpiToSend(2)),
        14 => Some(Request::SpiReceived(3)),
        15 => Some(Request::SpiToSend(3)),
        24 => Some(Request::UsartReceived(1)),
        25 => Some(Request::UsartToSend(1)),
        26 => Some(Request::UsartReceived(2)),
        27 => Some(Request::UsartToSend(2)),
        28 => Some(Request::UsartReceived(3)),
        29 => Some(Request::UsartToSend(3)),
        _ => None,
    }
}

impl Peripheral for DmaMux {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn written(&mut self, _offset: u32, _value: u32, _before: u32, wires: &mut Wires) {
        for output in 0..OUTPUTS {
            let route = request(self.registers.field(4 * output, 0, 7));
            wires.routes.insert((1 + output / 8, output % 8), route);
        }
    }
}
