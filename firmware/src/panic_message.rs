//! Message of a panic or a hard fault: it is stored in memory that a reset does not clear, then the board resets; the
//! next start sends the message in the hello. Nothing is sent before the reset, because the line may be the cause.

use core::cell::UnsafeCell;
use core::fmt::{self, Write};
use core::mem::MaybeUninit;
#[cfg(not(feature = "measuring"))]
use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use heapless::String;

/// Longest message, as the hello allows.
const LENGTH: usize = 96;
/// "last", little-endian.
const MAGIC: u32 = 0x7473_616c;

static CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

#[derive(Clone, Copy)]
#[repr(C)]
struct Words {
    magic: u32,
    length: u32,
    text: [u8; LENGTH],
    checksum: u32,
}

struct Memory(UnsafeCell<MaybeUninit<Words>>);

// SAFETY: read once in init before interrupts are on; written once with interrupts off before a reset.
unsafe impl Sync for Memory {}

#[unsafe(link_section = ".uninit.last_words")]
static MEMORY: Memory = Memory(UnsafeCell::new(MaybeUninit::uninit()));

/// Returns the message of the last reset, if it is complete, and clears it.
pub fn take() -> Option<String<LENGTH>> {
    let place = MEMORY.0.get().cast::<Words>();
    // SAFETY: every bit pattern is a `Words`; volatile, since the bytes are those that the memory held at reset.
    let words = unsafe { place.read_volatile() };
    // SAFETY: a field of the same static.
    unsafe { (&raw mut (*place).magic).write_volatile(0) };
    let text = words.text.get(..words.length as usize)?;
    if words.magic != MAGIC || words.checksum != CRC.checksum(text) {
        return None;
    }
    String::try_from(core::str::from_utf8(text).ok()?).ok()
}

fn leave(arguments: fmt::Arguments<'_>) -> ! {
    cortex_m::interrupt::disable();
    let mut message = Truncated(String::new());
    let _ = message.write_fmt(arguments);
    let mut words = Words { magic: MAGIC, length: message.0.len() as u32, text: [0; LENGTH], checksum: 0 };
    for (place, byte) in words.text.iter_mut().zip(message.0.bytes()) {
        *place = byte;
    }
    words.checksum = CRC.checksum(message.0.as_bytes());
    // SAFETY: interrupts are off and nothing else runs until the reset.
    unsafe { MEMORY.0.get().cast::<Words>().write_volatile(words) };
    SCB::sys_reset()
}

/// Text that keeps as many characters as fit.
struct Truncated(String<LENGTH>);

impl Write for Truncated {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.chars().try_for_each(|character| self.0.push(character).map_err(|_| fmt::Error))
    }
}

#[cfg(not(feature = "measuring"))]
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    match info.location() {
        Some(place) => leave(format_args!("{}:{}: {}", place.file(), place.line(), info.message())),
        None => leave(format_args!("{}", info.message())),
    }
}

// SAFETY: the handler touches nothing but the message's memory, and does not return.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    leave(format_args!("hard fault at {:#010x}, called from {:#010x}", frame.pc(), frame.lr()))
}
