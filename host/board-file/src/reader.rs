//! Reads a whole board file: parses it, reads the sections, checks the values against the chip, and returns the board
//! with its warnings or all problems at once.

use joint_file::{Notes, Problems};
use toml::de::DeTable;

use crate::board::{Board, ExternalClock, Level, Output, Serial, SpiSlave};
use crate::can;
use crate::chip::{Chip, OTHER_CHIPS, Part, SerialUnit, SpiUnit};
use crate::lines;
use crate::pins::{Pins, report_unknown_unit};
use crate::pll::Plls;
use crate::section::Section;

/// Tolerance of a line's speed: a tenth of a receiver's tolerance over ten bits [%].
const BAUD_TOLERANCE_PERCENT: u64 = 1;
/// Smallest divider of a USART, equal to its samples per bit.
const MIN_BAUD_DIVIDER: u32 = 16;
/// Largest divider of a USART.
const MAX_BAUD_DIVIDER: u32 = 0xffff;

/// Reads the text of a board file. On failure returns every problem, including warnings, in the order of the text.
///
/// ```
/// let text = board_file::preset("olimex-h405").unwrap();
/// let board = board_file::read(text).unwrap();
/// assert_eq!((board.chip, board.serial.unit), (board_file::Chip::Stm32f405, "USART1"));
///
/// let slip = text.replace("\"PA9\"", "\"PA8\"");
/// let problems = board_file::read(&slip).unwrap_err();
/// // Each problem has its place in the text and a help.
/// assert_eq!(&slip[problems[0].span.clone()], "\"PA8\"");
/// assert!(problems[0].help.contains("PA9 or PB6"), "{}", problems[0]);
/// ```
pub fn read(text: &str) -> Result<Board, Problems> {
    let notes = Notes::new(text);
    let (table, syntax) = DeTable::parse_recoverable(text);
    syntax.iter().take(1).for_each(|error| notes.syntax(error));
    // The parser drops broken parts; their absence must not be reported as an error of the file.
    let board = if syntax.is_empty() { read_table(&Section::top(table.get_ref(), &notes)) } else { None };
    let failed = notes.has_errors();
    let (problems, sources) = notes.into_parts();
    match board {
        Some(board) if !failed => Ok(Board { warnings: problems, sources, ..board }),
        _ => Err(problems.into()),
    }
}

fn read_table(top: &Section<'_>) -> Option<Board> {
    let name = read_name(top);
    let description = if top.has("description") { top.text("description") } else { Some(String::new()) };
    let chip_name = top.required("chip", Section::text_with_source);
    let part = chip_name.as_deref().and_then(|name| read_part(top, name));
    let memory = top.required_section("memory").map(|section| read_memory(&section, part));
    let clock = top.required_section("clock").and_then(|section| read_clock(&section, part.map(|part| part.chip)));
    let pins = Pins::new(part, clock);
    let serial = top.required_section("serial").and_then(|section| read_serial(&section, part, &pins));
    let spi_slave = optional(top, "spi_slave", |section| read_spi_slave(section, part, &pins));
    let can = optional(top, "can", |section| can::read(section, part, &pins));
    let encoders = optional(top, "encoder", |section| lines::read_encoders(section, part, &pins));
    let supply = optional(top, "supply", |section| read_output(section, &pins));
    let enable = optional(top, "enable", |section| read_output(section, &pins));
    let light = optional(top, "light", |section| read_output(section, &pins));
    let never_driven = pins.never_driven(top);
    pins.check(never_driven.as_deref().unwrap_or_default(), top.notes);

    let (part, clock, (flash, ram)) = (part?, clock?, memory?);
    let external = match clock.frequency() {
        Some(frequency) => Some(part.chip.pll(frequency)?),
        None => None,
    };
    Some(Board {
        name: name?,
        description: description?,
        chip: part.chip,
        chip_name: chip_name?,
        probe_name: part.probe_name(),
        flash_bytes: flash? << 10,
        ram_bytes: ram? << 10,
        clock,
        pll: Plls { external, internal: part.chip.internal_pll() },
        serial: serial?,
        spi_slave: spi_slave?,
        can: can?,
        encoders: encoders?.unwrap_or_default(),
        supply: supply?,
        enable: enable?,
        light: light?,
        never_driven: never_driven?,
        warnings: Vec::new(),
        sources: Vec::new(),
    })
}

/// Reads an optional section; returns `None` if it is there and wrong.
fn optional<'a, T>(
    top: &Section<'a>,
    name: &'static str,
    read: impl FnOnce(&Section<'a>) -> Option<T>,
) -> Option<Option<T>> {
    if top.has(name) { read(&top.section(name)?).map(Some) } else { Some(None) }
}

/// Reads the name; it must suit the board's hello and the option of a command.
fn read_name(top: &Section<'_>) -> Option<heapless::String<16>> {
    let text = top.required("name", Section::text)?;
    let plain = |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit() || ".-".contains(letter);
    let hint = top.value("name")?.1.hint;
    let (message, help) = match heapless::String::try_from(text.as_str()) {
        Ok(_) if Chip::from_name(&text).is_some() => {
            (format!("`name` is the name of a chip: {text}"), "give the board another name")
        }
        Ok(name) if text.contains(|letter: char| letter.is_ascii_alphanumeric()) && text.chars().all(plain) => {
            return Some(name);
        }
        Ok(_) => (format!("`name` cannot be \"{text}\""), hint),
        Err(_) => (format!("`name` has {} letters", text.chars().count()), hint),
    };
    top.notes.error(top.place("name"), message, help);
    None
}

fn read_part(top: &Section<'_>, name: &str) -> Option<Part> {
    let part = Part::from_order_name(name);
    if part.is_none() {
        let help = format!("{}; {OTHER_CHIPS}", Part::unknown_name_help(name));
        top.notes.error(top.place("chip"), format!("there is no firmware for the chip \"{name}\""), help);
    }
    part
}

/// Reads the sizes of flash and RAM [KiB].
fn read_memory(section: &Section<'_>, part: Option<Part>) -> (Option<u32>, Option<u32>) {
    let flash = section.required("flash_KiB", Section::whole);
    let ram = section.required("ram_KiB", Section::whole);
    let Some(part) = part else { return (None, None) };
    let sizes = part.flash_kib();
    let most = sizes.last().copied().unwrap_or_default();
    let flash = flash.filter(|flash| {
        let message = match flash {
            _ if sizes.contains(flash) => return true,
            _ if *flash > most => format!("{} has {most} KiB of flash, not {flash}", part.name()),
            _ => format!("{flash} KiB of flash leave no slots for the observer's memory"),
        };
        let sizes: Vec<String> = sizes.iter().map(u32::to_string).collect();
        let help = format!("write flash_KiB = {}", sizes.join(" or "));
        section.notes.error(section.place("flash_KiB"), message, help);
        false
    });
    let most = part.chip.facts().ram_kib;
    let ram = ram.filter(|ram| {
        if *ram > most {
            let message = format!("{} has {most} KiB of contiguous RAM for data, not {ram}", part.name());
            section.notes.error(section.place("ram_KiB"), message, format!("write ram_KiB = {most}, or less"));
        }
        *ram <= most
    });
    (flash, ram)
}

fn read_clock(section: &Section<'_>, chip: Option<Chip>) -> Option<ExternalClock> {
    let source = section.required("source", Section::choice);
    if source == Some("internal") {
        if section.has("frequency_Hz") {
            let message = "`frequency_Hz` needs a crystal or signal, but `source` is \"internal\"";
            section.notes.error(section.place("frequency_Hz"), message, "leave `frequency_Hz` out, or change `source`");
        }
        return Some(ExternalClock::None);
    }
    let frequency = section.required("frequency_Hz", Section::whole);
    let (source, frequency, chip) = (source?, frequency?, chip?);
    let crystal = source == "crystal";
    let (least, greatest) = chip.oscillator_limits(crystal);
    let chip_name = chip.name().to_uppercase();
    let common: Vec<String> =
        chip.facts().pll.common_frequencies((least, greatest)).iter().map(|frequency| megahertz(*frequency)).collect();
    let common = format!("common frequencies that fit: {}", common.join(", "));
    let message = if !(least..=greatest).contains(&frequency) {
        let limits = format!("between {} and {}", megahertz(least), megahertz(greatest));
        format!("{chip_name} needs a {source} {limits}, not {}", megahertz(frequency))
    } else if chip.pll(frequency).is_none() {
        format!(
            "{chip_name} cannot make its core clock of {} from {}",
            megahertz(chip.core_rate()),
            megahertz(frequency)
        )
    } else {
        return Some(if crystal { ExternalClock::Crystal(frequency) } else { ExternalClock::Signal(frequency) });
    };
    section.notes.error(section.place("frequency_Hz"), message, common);
    None
}

/// Frequency as text in MHz.
fn megahertz(frequency: u32) -> String {
    format!("{} MHz", f64::from(frequency) / 1e6)
}

fn read_serial(section: &Section<'_>, part: Option<Part>, pins: &Pins) -> Option<Serial> {
    let name = section.required("unit", Section::text_with_source);
    let unit = name.zip(part).and_then(|(name, part)| {
        let facts = part.chip.facts();
        let units: Vec<&str> = facts.serial.iter().map(|unit| unit.name).collect();
        let why = facts.unsupported_serial.iter().find(|(unsupported, _)| *unsupported == name).map(|(_, why)| *why);
        let found = facts.serial.iter().find(|unit| unit.name == name);
        found.or_else(|| report_unknown_unit(section, &name, part, &units, why))
    });
    let unit_pins = |list: fn(&SerialUnit) -> &'static [_]| unit.map(|unit| (unit.name, list(unit)));
    let send = pins.claim_alternate(section, "send", unit_pins(|unit| unit.send));
    let receive = pins.claim_alternate(section, "receive", unit_pins(|unit| unit.receive));
    let baud = section.required("baud", Section::whole);
    let (unit, baud) = (unit?, baud?);
    check_baud(section, unit, baud);
    Some(Serial { unit: unit.name, clock: unit.clock, send: send?, receive: receive?, baud })
}

/// Reports a speed that the peripheral cannot make.
fn check_baud(section: &Section<'_>, unit: &SerialUnit, baud: u32) {
    let exact = |divider: u32| f64::from(unit.clock) / f64::from(divider);
    let divider = baud_divider(unit.clock, baud);
    let (fastest, slowest) = (unit.clock / MIN_BAUD_DIVIDER, unit.clock / MAX_BAUD_DIVIDER);
    let message = if !(MIN_BAUD_DIVIDER..=MAX_BAUD_DIVIDER).contains(&divider) {
        format!("{} makes {slowest} to {fastest} baud, not {baud}", unit.name)
    } else {
        // |clock / divider - baud| > 1 % of baud, in whole numbers.
        let made = u64::from(baud) * u64::from(divider);
        if u64::from(unit.clock).abs_diff(made) * 100 <= BAUD_TOLERANCE_PERCENT * made {
            return;
        }
        format!("{} would make {:.0} baud, more than 1 % from {baud}", unit.name, exact(divider))
    };
    let near = divider.clamp(MIN_BAUD_DIVIDER, MAX_BAUD_DIVIDER);
    let help = format!(
        "the divider of {} is a whole number: the nearest speed is {:.0} baud",
        megahertz(unit.clock),
        exact(near)
    );
    section.notes.error(section.place("baud"), message, help);
}

/// Divider of a USART for a speed, rounded to the nearest whole number.
pub fn baud_divider(clock: u32, baud: u32) -> u32 {
    let divider = (2 * u64::from(clock) + u64::from(baud)) / (2 * u64::from(baud.max(1)));
    u32::try_from(divider).unwrap_or(u32::MAX)
}

fn read_spi_slave(section: &Section<'_>, part: Option<Part>, pins: &Pins) -> Option<SpiSlave> {
    if let Some(Err(why)) = part.map(|part| part.chip.facts().spi) {
        section.notes.error(
            section.header.clone(),
            format!("a board with this chip cannot be an SPI slave: {why}"),
            format!("leave [spi_slave] out; {OTHER_CHIPS}"),
        );
        return None;
    }
    let name = section.required("unit", Section::text_with_source);
    let unit = name.zip(part).and_then(|(name, part)| {
        let all = part.chip.facts().spi.unwrap_or_default();
        let units: Vec<&str> = all.iter().map(|unit| unit.name).collect();
        all.iter().find(|unit| unit.name == name).or_else(|| report_unknown_unit(section, &name, part, &units, None))
    });
    let unit_pins = |list: fn(&SpiUnit) -> &'static [_]| unit.map(|unit| (unit.name, list(unit)));
    let select = pins.claim_alternate(section, "select", unit_pins(|unit| unit.select));
    let clock = pins.claim_alternate(section, "clock", unit_pins(|unit| unit.clock));
    let out = pins.claim_alternate(section, "out", unit_pins(|unit| unit.out));
    let input = pins.claim_alternate(section, "in", unit_pins(|unit| unit.input));
    Some(SpiSlave { unit: unit?.name, select: select?, clock: clock?, out: out?, input: input? })
}

fn read_output(section: &Section<'_>, pins: &Pins) -> Option<Output> {
    let pin = pins.claim(section, "pin");
    let on = match section.required("on", Section::choice)? {
        "high" => Level::High,
        _ => Level::Low,
    };
    Some(Output { pin: pin?, on })
}
