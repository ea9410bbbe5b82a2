//! Start from a bootloader, whose state of the chip differs from the one after a reset.

use board::device::board::Chip;
use board_file::{ExternalClock, Pll};

use super::boot::ticks;
use super::{clean, spi};
use crate::boards::{Subject, pin};
use crate::cpu::Board;
use crate::talk::Talk;
use crate::wires::{MICROSECOND, Mode, Pin, SECOND, Time};

/// Interrupts of the serial lines of these boards: left pending and enabled.
const SERIAL: [usize; 3] = [37, 38, 39];
/// Longer than the start of any oscillator or PLL.
const A_WHILE: Time = 5000 * MICROSECOND;

/// Address of the chip's own bootloader: RM0090 2.4, RM0440 2.6, RM0433 2.6.
fn system_memory(chip: Chip) -> u32 {
    match chip {
        Chip::Stm32f405 | Chip::Stm32g474 | Chip::Stm32g431 => 0x1fff_0000,
        Chip::Stm32h743 => 0x1ff0_9800,
    }
}

/// Interrupt of USB, which no image serves: vector tables, RM0090 12.2, RM0440 14.3, RM0433 19.1.2.
fn usb(chip: Chip) -> usize {
    match chip {
        Chip::Stm32f405 => 67,
        Chip::Stm32g474 | Chip::Stm32g431 => 20,
        Chip::Stm32h743 => 101,
    }
}

/// Register writes that make the full core clock from the external source and switch the internal oscillator off; a
/// pause follows each.
fn full_speed(chip: Chip, is_signal: bool, Pll { divider, factor, range }: Pll) -> Vec<(u32, u32)> {
    let bypass = u32::from(is_signal) << 18;
    match chip {
        Chip::Stm32f405 => {
            let on = 0x83 | bypass | 1 << 16;
            vec![
                (0x4002_3800, 0x83 | bypass),
                (0x4002_3800, on),
                (0x4002_3804, 0x2700_0000 | 1 << 22 | factor << 6 | divider),
                (0x4002_3c00, 0x705),
                (0x4002_3800, on | 1 << 24),
                (0x4002_3808, 4 << 13 | 5 << 10),
                (0x4002_3808, 4 << 13 | 5 << 10 | 2),
                (0x4002_3800, on & !1 | 1 << 24),
            ]
        }
        Chip::Stm32g474 | Chip::Stm32g431 => {
            let on = 0x500 | bypass | 1 << 16;
            vec![
                (0x4002_1000, 0x500 | bypass),
                (0x4002_1000, on),
                (0x4002_100c, 1 << 24 | factor << 8 | (divider - 1) << 4 | 3),
                (0x4002_1000, on | 1 << 24),
                (0x4002_1058, 1 << 28 | 1 << 10),
                (0x4002_1008, 8 << 4 | 1),
                (0x4000_7080, 0),
                (0x4002_2000, 0x0004_0604),
                (0x4002_1008, 8 << 4 | 3),
                (0x4002_1008, 3),
                (0x4002_1000, on & !0x100 | 1 << 24),
            ]
        }
        Chip::Stm32h743 => {
            let on = 0xc025 | bypass | 1 << 16;
            vec![
                (0x5802_480c, 0x6),
                (0x5802_4818, 0xc000),
                (0x5802_4400, 0xc025 | bypass),
                (0x5802_4400, on),
                (0x5802_4428, 0x0202_0002 | divider << 4),
                (0x5802_442c, 0x01ff_0000 | range << 2),
                (0x5802_4430, 0x0101_0200 | (factor - 1)),
                (0x5802_4400, on | 1 << 24),
                (0x5200_2000, 0x22),
                (0x5802_4418, 4 << 4 | 8),
                (0x5802_441c, 4 << 8 | 4 << 4),
                (0x5802_4420, 4 << 4),
                (0x5802_4410, 3),
                (0x5802_4400, on & !1 | 1 << 24),
            ]
        }
    }
}

/// Pin that the bootloader drives: on some boards with the chip it is a gate, and no board in this check uses it.
const DRIVEN: Pin = Pin('C', 6);

/// Register writes that clock the port and drive the pin, in addition to the clocks that are on.
fn driven(chip: Chip) -> [(u32, u32); 3] {
    let (gates, port, was) = match chip {
        Chip::Stm32f405 => ((0x4002_3830, 0x0010_0004), 0x4002_0800, 0),
        Chip::Stm32g474 | Chip::Stm32g431 => ((0x4002_104c, 4), 0x4800_0800, u32::MAX),
        Chip::Stm32h743 => ((0x5802_44e0, 4), 0x5802_0800, u32::MAX),
    };
    [gates, (port + 0x18, 1 << DRIVEN.1), (port, was & !(3 << (2 * DRIVEN.1)) | 1 << (2 * DRIVEN.1))]
}

/// DMA that receives into the first bytes of RAM without end, if the chip's DMA is modelled: clock register with its
/// bits, control register of the channel, and the writes that start it.
struct Received {
    gate: (u32, u32),
    control: u32,
    begun: &'static [(u32, u32)],
}

fn received(chip: Chip) -> Option<Received> {
    const RAM: u32 = 0x2000_0000;
    match chip {
        // Stream 0 of DMA1, channel 4: UART5.
        Chip::Stm32f405 => Some(Received {
            gate: (0x4002_3830, 0x0030_0004),
            control: 0x4002_6010,
            begun: &[
                (0x4002_6014, 16),
                (0x4002_6018, 0x4000_5004),
                (0x4002_601c, RAM),
                (0x4002_6010, 4 << 25 | 1 << 10 | 1 << 8 | 1),
            ],
        }),
        // Channel 6 of DMA1, by the multiplexer's request of USART3.
        Chip::Stm32g474 | Chip::Stm32g431 => Some(Received {
            gate: (0x4002_1048, 0x105),
            control: 0x4002_006c,
            begun: &[
                (0x4002_0814, 28),
                (0x4002_0070, 16),
                (0x4002_0074, 0x4000_4824),
                (0x4002_0078, RAM),
                (0x4002_006c, 1 << 7 | 1 << 5 | 1),
            ],
        }),
        Chip::Stm32h743 => None,
    }
}

/// Board whose image is entered from a bootloader at full speed: with the bootloader's clock, vectors and tick, with
/// pending and enabled interrupts (some of which the image does not serve), with a driven pin, and with DMA under way.
fn jumped_to<'a>(subject: &Subject) -> Result<Board<'a>, String> {
    let (mut board, chip) = (subject.start()?, subject.board.chip());
    let description = &subject.board.description;
    let is_signal = matches!(description.clock, ExternalClock::Signal(_));
    let external = description.pll.external;
    for (address, value) in external.map(|pll| full_speed(chip, is_signal, pll)).unwrap_or_default() {
        let machine = board.machine_mut();
        machine.settle();
        machine.set_up(address, value);
        machine.pass(A_WHILE);
        machine.settle();
    }
    let received = received(chip).map(|received| [&[received.gate][..], received.begun].concat());
    for (address, value) in driven(chip).into_iter().chain(received.unwrap_or_default()) {
        board.machine_mut().set_up(address, value);
    }
    let core = board.machine().wires.clocks.core;
    if external.is_some() && core != u64::from(subject.board.core_rate()) {
        return Err(format!("the bootloader runs at {core} Hz"));
    }
    board.jump_from(system_memory(chip), &[SERIAL[0], SERIAL[1], SERIAL[2], usb(chip)]);
    clean(&board)?;
    Ok(board)
}

/// The image sets its own vectors before any interrupt comes, and its own clock, and is not disturbed by interrupts
/// that it does not serve.
pub fn starts(subject: &Subject) -> Result<String, String> {
    let chip = subject.board.chip();
    let mut talk = Talk::new(jumped_to(subject)?);
    let hello = talk.call(2 * SECOND);
    clean(&talk.board.borrow())?;
    let hello = hello.ok_or_else(|| format!("no answer; it was at {}", talk.board.borrow().whereabouts()))?;
    let core = talk.board.borrow().machine().wires.clocks.core;
    let is_external = subject.board.description.clock.frequency().is_some();
    if core != u64::from(subject.board.core_rate()) || hello.clock.source.is_external() != is_external {
        return Err(format!("{core} Hz from {:?}", hello.clock));
    }
    let is_used = subject.board.description.used_pins().iter().any(|(_, used)| pin(*used) == DRIVEN);
    if !is_used && matches!(talk.board.borrow().machine().wires.mode(DRIVEN), Mode::Output(_)) {
        return Err("a pin that the bootloader drove is driven still".into());
    }
    ticks(&mut talk, hello.tick_rate)?;
    clean(&talk.board.borrow())?;
    if let Some(Received { gate, control, .. }) = received(chip) {
        let mut board = talk.board.borrow_mut();
        let machine = board.machine_mut();
        machine.set_up(gate.0, gate.1);
        if machine.read(control, 4) & 1 == 1 {
            return Err("the bootloader's DMA still receives into RAM".into());
        }
        clean(&board)?;
    }
    Ok(format!("{core} Hz, vectors at {:#010x}", talk.board.borrow().machine().scs.vectors))
}

/// The SPI slave, which has no tick, answers after a bootloader.
pub fn serves_a_master(subject: &Subject) -> Result<String, String> {
    spi::serves(subject, jumped_to(subject)?)
}
