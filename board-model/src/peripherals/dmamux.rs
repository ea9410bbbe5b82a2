//! DMA request multiplexer of STM32G474 and STM32G431: RM0440 section 13. Its first outputs are the channels of DMA1,
//! the others those of DMA2: eight each, or six.

use super::Peripheral;
use crate::register::{Register, Registers};
use crate::wires::{Request, Wires};

/// Maximum number of outputs.
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

/// DMA request multiplexer.
#[derive(Debug)]
pub struct DmaMux {
    registers: Registers,
    channels: u32,
}

impl DmaMux {
    /// Multiplexer for controllers with a number of channels.
    pub fn new(channels: u32) -> Self {
        Self { registers: Registers::new(&MAP[..2 + 2 * channels as usize]), channels }
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
        for output in 0..2 * self.channels {
            let route = request(self.registers.field(4 * output, 0, 7));
            wires.routes.insert((1 + output / self.channels, output % self.channels), route);
        }
    }
}
