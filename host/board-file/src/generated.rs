//! Inputs of the firmware's build: constants as Rust, memory as a linker script, and `cfg` flags.

use std::fmt::Write;

use crate::bit_timing::BitTiming;
use crate::board::{Board, ExternalClock, Level, Output, RAM_START};
use crate::chip::Chip;
use crate::pin::Alternate;
use crate::pll::Pll;

/// Constants of the board as Rust source, to be included in a module.
///
/// ```
/// let board = board_file::read(board_file::preset("olimex-h405").unwrap()).unwrap();
/// let source = board_file::rust_source(&board);
/// assert!(source.contains("pub const SERIAL_SEND: (u8, u8, u8) = (0, 9, 7);"), "{source}");
/// ```
pub fn rust_source(board: &Board) -> String {
    let mut source = String::new();
    let mut constant = |what: &str, name: &str, kind: &str, value: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(source, "/// {what}\npub const {name}: {kind} = {value};");
    };
    const PIN: &str = "(u8, u8, u8)";
    const OUTPUT: &str = "Option<(u8, u8, bool)>";
    let external_clock = |clock: ExternalClock| match clock {
        ExternalClock::None => "None".to_owned(),
        ExternalClock::Crystal(frequency) => format!("Some(({frequency}, false))"),
        ExternalClock::Signal(frequency) => format!("Some(({frequency}, true))"),
    };
    let pll = |Pll { divider, factor, range }: Pll| format!("({divider}, {factor}, {range})");
    let pin = |Alternate { pin, function }: Alternate| format!("({}, {}, {function})", pin.port, pin.number);
    let output = |output: Option<Output>| {
        option_source(output.map(|Output { pin, on }| format!("({}, {}, {})", pin.port, pin.number, on == Level::High)))
    };
    constant("Name of the board, as in its hello.", "NAME", "&str", format!("{:?}", board.name.as_str()));
    constant("Core clock [Hz].", "CORE_RATE", "u32", board.core_rate().to_string());
    constant(
        "External source of the clock: frequency [Hz], and true for a signal, false for a crystal.",
        "EXTERNAL",
        "Option<(u32, bool)>",
        external_clock(board.clock),
    );
    constant(
        "PLL for the external source: divider, factor, code of the input's range.",
        "EXTERNAL_PLL",
        "Option<(u32, u32, u32)>",
        option_source(board.pll.external.map(pll)),
    );
    constant("PLL for the chip's own oscillator.", "INTERNAL_PLL", "(u32, u32, u32)", pll(board.pll.internal));
    constant(
        "Frequency of the chip's own oscillator [Hz].",
        "INTERNAL",
        "u32",
        board.chip.internal_oscillator().to_string(),
    );
    constant(
        "Transmit pin of the line to the host: port, number, function.",
        "SERIAL_SEND",
        PIN,
        pin(board.serial.send),
    );
    constant("Receive pin of the line to the host.", "SERIAL_RECEIVE", PIN, pin(board.serial.receive));
    constant(
        "Clock of the serial peripheral while the PLL runs [Hz].",
        "SERIAL_CLOCK",
        "u32",
        board.serial.clock.to_string(),
    );
    constant("Speed of the line to the host [baud].", "BAUD", "u32", board.serial.baud.to_string());
    constant(
        "Pins of the SPI slave: select, clock, out, in.",
        "SPI_SLAVE",
        "Option<[(u8, u8, u8); 4]>",
        option_source(
            board
                .spi_slave
                .as_ref()
                .map(|slave| format!("[{}]", [slave.select, slave.clock, slave.out, slave.input].map(pin).join(", "))),
        ),
    );
    if let Some(can) = &board.can {
        let pins = format!("[{}, {}]", pin(can.send), pin(can.receive));
        constant("Pins of the CAN line: send, receive.", "CAN", "[(u8, u8, u8); 2]", pins);
        let timing = |BitTiming { prescaler, before, after, jump }| format!("({prescaler}, {before}, {after}, {jump})");
        constant(
            "Bit timing of CAN: cycles of a quantum, quanta before and after the sample point, jump width.",
            "CAN_TIMING",
            "(u32, u32, u32, u32)",
            timing(can.timing),
        );
        constant(
            "Timing of the second bit rate of CAN, in the same form.",
            "CAN_DATA_TIMING",
            "Option<(u32, u32, u32, u32)>",
            option_source(can.data_timing.map(timing)),
        );
    }
    constant("Output that holds the supply: port, number, true if high is on.", "SUPPLY", OUTPUT, output(board.supply));
    constant("Output that switches the motor on, in the same form.", "ENABLE", OUTPUT, output(board.enable));
    constant("Status light, in the same form.", "LIGHT", OUTPUT, output(board.light));
    let [first, second] = board.slots();
    constant(
        "Addresses of the slots for the observer's memory.",
        "SLOTS",
        "[u32; 2]",
        format!("[{:#010x}, {:#010x}]", first.address, second.address),
    );
    constant(
        "Usable size of each slot, at most the part erased at once [byte].",
        "SLOT_BYTES",
        "u32",
        first.bytes.min(second.bytes).to_string(),
    );
    constant("Flash, including the slots [byte].", "FLASH_BYTES", "u32", board.flash_bytes.to_string());
    constant("Flash available to an image [byte].", "IMAGE_BYTES", "u32", board.image_bytes().to_string());
    constant("RAM [byte].", "RAM_BYTES", "u32", board.ram_bytes.to_string());
    source
}

fn option_source(value: Option<String>) -> String {
    value.map_or("None".to_owned(), |value| format!("Some({value})"))
}

/// Linker script to be read before the one of the start-up code: start of the stack, and assertions that an image fits.
pub fn linker_script(board: &Board) -> String {
    let name = &board.name;
    let end = RAM_START + board.ram_bytes;
    let [first, _] = board.slots();
    let (flash, image, ram) = (board.flash_bytes >> 10, board.image_bytes() >> 10, board.ram_bytes >> 10);
    let (stack, least) = ((board.ram_bytes - board.static_bytes()) >> 10, RAM_START + board.static_bytes());
    format!(
        "/* Memory of the board {name}, {chip}. */
_stack_start = {end:#010x};

ASSERT(__sidata + (__edata - __sdata) <= {slot:#010x},
\"the image is too large for the board {name}: of {flash} KiB of flash it may take the first {image} KiB\");
ASSERT(__ebss <= {least:#010x} && __euninit <= {least:#010x},
\"statics are too large for the board {name}: of {ram} KiB of RAM they must leave {stack} KiB to the stack\");
",
        chip = board.chip_name,
        slot = first.address,
    )
}

/// `cfg` flags of a board, as names with values. Peripherals are named in lower case.
///
/// ```
/// let board = board_file::read(board_file::preset("olimex-h405").unwrap()).unwrap();
/// let cfgs = board_file::cfgs(&board);
/// assert!(cfgs.contains(&("serial", "usart1".to_owned())));
/// ```
pub fn cfgs(board: &Board) -> Vec<(&'static str, String)> {
    let mut cfgs = vec![
        ("chip", board.chip.name().to_owned()),
        ("family", board.chip.family().to_owned()),
        ("serial", board.serial.unit.to_lowercase()),
    ];
    if let Some(slave) = &board.spi_slave {
        cfgs.push(("spi_slave", slave.unit.to_lowercase()));
        // External interrupt lines are numbered like the pins, whatever the port.
        cfgs.push(("select_line", slave.select.pin.number.to_string()));
    }
    if let Some(can) = &board.can {
        cfgs.push(("can", can.unit.to_lowercase()));
    }
    cfgs
}

/// Every name of [`cfgs`] with all of its possible values.
pub fn all_cfgs() -> Vec<(&'static str, Vec<String>)> {
    let names = |of: fn(Chip) -> Vec<&'static str>| {
        let mut names: Vec<String> = Chip::ALL.into_iter().flat_map(of).map(str::to_lowercase).collect();
        names.sort();
        names.dedup();
        names
    };
    vec![
        ("chip", names(|chip| vec![chip.name()])),
        ("family", names(|chip| vec![chip.family()])),
        ("serial", names(|chip| chip.facts().serial.iter().map(|unit| unit.name).collect())),
        ("spi_slave", names(|chip| chip.facts().spi.unwrap_or_default().iter().map(|unit| unit.name).collect())),
        ("can", names(|chip| chip.facts().can.iter().map(|unit| unit.name).collect())),
        ("select_line", (0..16).map(|line| line.to_string()).collect()),
    ]
}
