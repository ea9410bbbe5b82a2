//! Inputs of the firmware's build: constants as Rust, memory as a linker script, and `cfg` flags.

use std::fmt::Write;

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
    let hertz = |clock: ExternalClock| match clock {
        ExternalClock::None => "None".to_owned(),
        ExternalClock::Crystal(frequency) => format!("Some(({frequency}, false))"),
        ExternalClock::Signal(frequency) => format!("Some(({frequency}, true))"),
    };
    let pll = |Pll { divider, factor, range }: Pll| format!("({divider}, {factor}, {range})");
    let pin = |Alternate { pin, function }: Alternate| format!("({}, {}, {function})", pin.port, pin.number);
    let output = |output: Option<Output>| {
        some(output.map(|Output { pin, on }| format!("({}, {}, {})", pin.port, pin.number, on == Level::High)))
    };
    constant("What the board calls itself.", "NAME", "&str", format!("{:?}", board.name.as_str()));
    constant("Core clock [Hz].", "CORE_RATE", "u32", board.core_rate().to_string());
    constant(
        "What drives the clock from outside: frequency [Hz], and whether it is a signal rather than a crystal.",
        "EXTERNAL",
        "Option<(u32, bool)>",
        hertz(board.clock),
    );
    constant(
        "Of the PLL for that: divider, factor, code of the input's range.",
        "EXTERNAL_PLL",
        "Option<(u32, u32, u32)>",
        some(board.pll.external.map(pll)),
    );
    constant("Of the PLL for the chip's own oscillator.", "INTERNAL_PLL", "(u32, u32, u32)", pll(board.pll.internal));
    constant("The chip's own oscillator [Hz].", "INTERNAL", "u32", board.chip.internal_oscillator().to_string());
    constant("Where the line to the host sends: port, number, function.", "SERIAL_SEND", PIN, pin(board.serial.send));
    constant("Where it receives.", "SERIAL_RECEIVE", PIN, pin(board.serial.receive));
    constant("Clock of its unit while the PLL runs [Hz].", "SERIAL_CLOCK", "u32", board.serial.clock.to_string());
    constant("Its speed [baud].", "BAUD", "u32", board.serial.baud.to_string());
    constant(
        "Pins of the slave on SPI: select, clock, out, in.",
        "SPI_SLAVE",
        "Option<[(u8, u8, u8); 4]>",
        some(
            board
                .spi_slave
                .as_ref()
                .map(|slave| format!("[{}]", [slave.select, slave.clock, slave.out, slave.input].map(pin).join(", "))),
        ),
    );
    constant("What holds the supply: port, number, whether high is on.", "SUPPLY", OUTPUT, output(board.supply));
    constant("What switches the motor on: the same.", "ENABLE", OUTPUT, output(board.enable));
    constant("The status light: the same.", "LIGHT", OUTPUT, output(board.light));
    let [first, second] = board.slots();
    constant(
        "Where what the observer has learnt is kept.",
        "SLOTS",
        "[u32; 2]",
        format!("[{:#010x}, {:#010x}]", first.address, second.address),
    );
    constant(
        "So much of each may be used: no more than is erased at once.",
        "SLOT_BYTES",
        "u32",
        first.bytes.min(second.bytes).to_string(),
    );
    constant("Flash, that of the slots included.", "FLASH_BYTES", "u32", board.flash_bytes.to_string());
    constant("What an image may take of it.", "IMAGE_BYTES", "u32", board.image_bytes().to_string());
    constant("RAM.", "RAM_BYTES", "u32", board.ram_bytes.to_string());
    source
}

fn some(value: Option<String>) -> String {
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
        ("select_line", (0..16).map(|line| line.to_string()).collect()),
    ]
}
