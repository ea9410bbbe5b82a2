//! Keys of a board file: section, kind of value, and a hint for wrong input. The page docs/reference/board-files.md
//! lists every key in its tables.

use joint_file::Keys;

/// Kind of a key's value.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Kind {
    /// A string.
    Text,
    /// One of the given words.
    Choice(&'static [&'static str]),
    /// Whole number between two inclusive bounds.
    Whole(u32, u32),
    /// Name of a pin.
    Pin,
    /// Table.
    Section,
}

/// Key of a board file.
pub(crate) type Key = joint_file::Key<Kind>;

impl Keys for Kind {
    const FILE: &'static str = "a board file";
    const ALL: &'static [Key] = KEYS;

    fn stray(section: &str, word: &str) -> String {
        let known: Vec<String> = Self::of(section).map(|key| format!("`{}`", key.name)).collect();
        Self::belongs(word).unwrap_or_else(|| format!("known here: {}", known.join(", ")))
    }
}

const fn key(section: &'static str, name: &'static str, kind: Kind, hint: &'static str) -> Key {
    Key { section, name, kind, hint }
}

use Kind::{Choice, Pin, Section, Text, Whole};

/// Kinds of clock, in the order of the documentation.
pub(crate) const CLOCKS: &[&str] = &["crystal", "signal", "internal"];
/// Levels of a pin.
pub(crate) const LEVELS: &[&str] = &["high", "low"];

/// Answers to a question.
pub(crate) const ANSWERS: &[&str] = &["yes", "no"];

/// All keys, in the order of the documentation.
pub(crate) const KEYS: &[Key] = &[
    key("", "name", Text, "name of up to 16 lower case letters, digits, dots and hyphens: name = \"my-board\""),
    key("", "description", Text, "sentence that distinguishes the board"),
    key("", "chip", Text, "order name printed on the chip, such as \"STM32F405RG\""),
    key("", "memory", Section, "sizes of flash and RAM: flash_KiB and ram_KiB"),
    key("", "clock", Section, "clock of the chip: source and frequency_Hz"),
    key("", "serial", Section, "line to the host: unit, send, receive and baud"),
    key(
        "",
        "spi_slave",
        Section,
        "SPI line to a motor controller, the board as slave; leave the section out if there is none",
    ),
    key("", "can", Section, "CAN line of the role drive; leave the section out if there is none"),
    key(
        "",
        "encoder",
        Section,
        "[encoder.motor] and [encoder.output], which no image reads yet; leave a section out if there is no encoder",
    ),
    key("", "supply", Section, "output that holds the board's own supply; leave the section out if there is none"),
    key("", "enable", Section, "output that switches the motor on; leave the section out if there is none"),
    key("", "light", Section, "status light; leave the section out if there is none"),
    key(
        "",
        "never_driven",
        Section,
        "pins that the firmware never drives, each with its use: PA8 = \"gate of phase A\"",
    ),
    // Memory
    key("memory", "flash_KiB", Whole(1, 4096), "flash in KiB, as the chip's order name states"),
    key(
        "memory",
        "ram_KiB",
        Whole(16, 4096),
        "contiguous RAM from 0x2000_0000 on in KiB, without RAM that holds code only",
    ),
    // Clock
    key("clock", "source", Choice(CLOCKS), "crystal, external clock signal, or the chip's own oscillator"),
    key(
        "clock",
        "frequency_Hz",
        Whole(1_000_000, 50_000_000),
        "frequency of crystal or signal, as printed on the part: 8_000_000",
    ),
    // Serial
    key("serial", "unit", Text, "peripheral of the pins, such as \"USART1\""),
    key("serial", "send", Pin, "transmit pin of the board"),
    key("serial", "receive", Pin, "receive pin of the board"),
    key("serial", "baud", Whole(9_600, 10_000_000), "baud rate, equal to that of the host's port: 230_400, 921_600"),
    // Slave on SPI
    key("spi_slave", "unit", Text, "peripheral of the pins, such as \"SPI1\""),
    key("spi_slave", "select", Pin, "select input, low while the master addresses this board (NSS)"),
    key("spi_slave", "clock", Pin, "clock of the master (SCK)"),
    key("spi_slave", "out", Pin, "data to the master (MISO)"),
    key("spi_slave", "in", Pin, "data from the master (MOSI)"),
    // CAN
    key("can", "unit", Text, "peripheral of the pins, such as \"CAN1\""),
    key("can", "send", Pin, "data to the transceiver"),
    key("can", "receive", Pin, "data from the transceiver"),
    key("can", "bitrate", Whole(10_000, 1_000_000), "bit rate of the bus [bit/s]; optional, 1_000_000 without it"),
    key(
        "can",
        "data_bitrate",
        Whole(10_000, 8_000_000),
        "second bit rate, for the data of CAN FD frames [bit/s]; optional; not with classical CAN",
    ),
    key(
        "can",
        "transceiver",
        Choice(ANSWERS),
        "yes if the board has a transceiver between these pins and the bus; optional: without it, builds remind of it",
    ),
    // Lines that no image uses yet
    key("encoder", "motor", Section, "encoder at the motor: unit and pins"),
    key("encoder", "output", Section, "encoder at the joint's output: unit and pins"),
    key(
        "encoder.motor",
        "unit",
        Text,
        "peripheral that reads the encoder: an SPI, or a timer that counts pulses, such as \"TIM3\"",
    ),
    key("encoder.motor", "select", Pin, "on SPI: select output, low while the board addresses the encoder; any pin"),
    key("encoder.motor", "clock", Pin, "on SPI: clock of the board (SCK)"),
    key("encoder.motor", "out", Pin, "on SPI: data from the encoder (MISO)"),
    key("encoder.motor", "in", Pin, "on SPI: data to the encoder (MOSI)"),
    key("encoder.motor", "a", Pin, "by pulses: channel A"),
    key("encoder.motor", "b", Pin, "by pulses: channel B"),
    key("encoder.motor", "index", Pin, "by pulses: index, once a turn; any pin; optional"),
    // Outputs
    key("supply", "pin", Pin, "pin that holds the supply"),
    key("supply", "on", Choice(LEVELS), "level while the supply is held"),
    key("enable", "pin", Pin, "pin that switches the motor on"),
    key("enable", "on", Choice(LEVELS), "level while the motor is on"),
    key("light", "pin", Pin, "pin of the light"),
    key("light", "on", Choice(LEVELS), "level while the light is on"),
];

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = include_str!("../../../docs/reference/board-files.md");

    /// The page lists every key with its kind of value and its hint.
    #[test]
    fn keys_documented_with_kind() {
        for key in KEYS {
            let value = match key.kind {
                Kind::Text => "text".to_owned(),
                Kind::Choice(words) => {
                    words.iter().map(|word| format!("`\"{word}\"`")).collect::<Vec<_>>().join(" or ")
                }
                Kind::Whole(low, high) => format!("between {low} and {high}"),
                Kind::Pin => "pin".to_owned(),
                Kind::Section => continue,
            };
            let section = format!("## `[{}]`", key.section);
            let start = if key.section.is_empty() { "## Top of the file" } else { &section };
            let table = PAGE.split_once(start).map(|(_, rest)| rest.split("\n## ").next().unwrap_or_default());
            let name = format!("| `{}` |", key.name);
            let row = table.unwrap_or_default().lines().find(|line| line.starts_with(&name));
            let row = row.unwrap_or_else(|| panic!("no row `{name}` under `{start}`"));
            assert!(row.contains(&value) && row.contains(key.hint), "{row}: want `{value}` and `{}`", key.hint);
        }
    }

    /// The page has a heading for every section.
    #[test]
    fn sections_documented() {
        for key in KEYS.iter().filter(|key| matches!(key.kind, Kind::Section) && key.name != "encoder") {
            let name =
                if key.section.is_empty() { key.name.to_owned() } else { format!("{}.{}", key.section, key.name) };
            let is_heading = |line: &str| line.starts_with("## ") && line.contains(&format!("`[{name}]`"));
            assert!(PAGE.lines().any(is_heading), "{name}");
        }
    }
}
