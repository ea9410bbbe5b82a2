//! Bad board files: each case asserts the message, the underlined text and the help. Every case is one good file with
//! one change, so that nothing else can be the cause.

use board_file::{Board, Problem, Severity, preset, read};

/// File with every section.
const GOOD: &str = r#"
name = "bench.2-a"
description = "on the bench"
chip = "STM32F405RG" # printed on it

[memory]
flash_KiB = 1024 # order name
ram_KiB = 128 # data sheet

[clock]
source = "crystal" # printed on it
frequency_Hz = 8_000_000 # printed on it

[serial]
unit = "USART1" # wired so
send = "PA9" # wired so
receive = "PA10" # wired so
baud = 230_400 # chosen

[spi_slave]
unit = "SPI1" # wired so
select = "PA4" # wired so
clock = "PA5" # wired so
out = "PA6" # wired so
in = "PA7" # wired so

[enable]
pin = "PB0" # wired so
on = "high" # wired so

[light]
pin = "PC12" # wired so
on = "low"

[never_driven]
PA8 = "gate of motor 0, phase A, high side" # schematic
PB12 = "brake resistor"
"#;

/// Good file with one piece of text replaced.
#[track_caller]
fn spoilt(from: &str, to: &str) -> String {
    assert_eq!(GOOD.matches(from).count(), 1, "`{from}` is not in the file exactly once");
    GOOD.replace(from, to)
}

/// Good file for another chip, without sections that the chip does not support.
fn with_chip(name: &str, flash: u32, ram: u32) -> String {
    let (start, rest) = GOOD.split_once("\n[spi_slave]").expect("it is there");
    let rest = rest.split_once("\n[enable]").expect("it is there").1;
    format!("{start}\n[enable]{rest}")
        .replace("STM32F405RG", name)
        .replace("1024", &flash.to_string())
        .replace("ram_KiB = 128", &format!("ram_KiB = {ram}"))
}

#[track_caller]
fn good(text: &str) -> Board {
    read(text).unwrap_or_else(|problems| panic!("{problems:#?}"))
}

/// Message, underlined text and help of the only problem.
#[track_caller]
fn only(text: &str) -> (String, String, String) {
    let problems = read(text).expect_err("the file is spoilt");
    assert_eq!(problems.len(), 1, "{problems:#?}");
    let Problem { span, message, help, severity } = problems[0].clone();
    assert_eq!(severity, Severity::Error);
    (message, text[span].to_owned(), help)
}

/// Asserts message and underlined text of the only problem, and that its help contains `wanted`.
#[track_caller]
fn refused(text: &str, message: &str, underlined: &str, wanted: &str) {
    let (found, place, help) = only(text);
    assert_eq!((found.as_str(), place.as_str()), (message, underlined));
    assert!(help.contains(wanted), "`{wanted}` is not in `{help}`");
}

/// The file with every section is read without warnings, on each family of chips.
#[test]
fn complete_file_accepted() {
    let board = good(GOOD);
    assert_eq!((board.warnings.len(), board.never_driven.len()), (0, 2));
    assert_eq!(board.used_pins().len(), 8);
    let remark = |key: &str| board.sources.iter().find(|source| source.key == key).expect(key).remark.clone();
    assert_eq!(remark("serial.send").as_deref(), Some("wired so"));
    assert_eq!(remark("never_driven.PA8").as_deref(), Some("schematic"));
    assert_eq!((remark("light.on"), remark("never_driven.PB12")), (None, None));
    good(&with_chip("STM32G474RE", 512, 96));
    good(&with_chip("STM32G431RB", 128, 22));
    good(&with_chip("STM32H743ZI", 2048, 128));
}

/// Optional sections may be left out.
#[test]
fn optional_sections_omitted() {
    let text = "name = \"a\"\nchip = \"STM32F405RG\"\n[memory]\nflash_KiB = 512\nram_KiB = 64\n[clock]\nsource = \"internal\"\n\
         [serial]\nunit = \"UART5\"\nsend = \"PC12\"\nreceive = \"PD2\"\nbaud = 1_000_000\n";
    let board = good(text);
    assert_eq!((&board.spi_slave, board.enable, board.light, board.never_driven.len()), (&None, None, None, 0));
    assert_eq!(board.pll.external, None);
    // Half of the chip's flash, as the file states.
    assert_eq!((board.flash_bytes, board.slots()[0].address), (512 << 10, 0x0804_0000));
}

/// A name with other characters, too long, or equal to a chip's name is rejected.
#[test]
fn invalid_board_name_rejected() {
    for name in ["", "My-Board", "two words", "\u{e9}", "..", "under_score"] {
        refused(
            &spoilt("\"bench.2-a\"", &format!("\"{name}\"")),
            &format!("`name` cannot be \"{name}\""),
            &format!("\"{name}\""),
            "up to 16 lower case letters",
        );
    }
    let long = "seventeen-letters";
    let message = "`name` has 17 letters";
    refused(&spoilt("bench.2-a", long), message, &format!("\"{long}\""), "up to 16");
    refused(
        &spoilt("bench.2-a", "stm32f405"),
        "`name` is the name of a chip: stm32f405",
        "\"stm32f405\"",
        "another name",
    );
}

/// A suggestion is made only within one part number; other chips get the list of supported ones.
#[test]
fn unknown_chip_rejected() {
    let same_number = [
        ("STM32F405", "write one of STM32F405RG, STM32F405VG"),
        ("stm32f405rg", "did you mean \"STM32F405RG\"?"),
        ("STM32F405RGU6", "did you mean \"STM32F405RG\"?"),
    ];
    // Another part number, or another maker's, is no typing error.
    let others =
        ["STM32F407VG", "STM32F446RE", "GD32F405RG", "AT32F405RG", "STM32G473RE", "STM32H750ZI", "STM32F4O5RG"];
    let others = others.map(|name| (name, "firmware exists for STM32F405RG, STM32F405VG"));
    for (name, help) in same_number.into_iter().chain(others) {
        let text = spoilt("\"STM32F405RG\"", &format!("\"{name}\""));
        let message = format!("there is no firmware for the chip \"{name}\"");
        refused(&text, &message, &format!("\"{name}\""), help);
        refused(&text, &message, &format!("\"{name}\""), "C library serves any chip with a Cortex-M4F, M7 or M33");
    }
}

/// Flash and RAM above the chip's are rejected.
#[test]
fn excessive_memory_rejected() {
    let text = spoilt("flash_KiB = 1024", "flash_KiB = 2048");
    refused(&text, "STM32F405RGT has 1024 KiB of flash, not 2048", "2048", "flash_KiB = 512 or 1024");
    let text = spoilt("ram_KiB = 128", "ram_KiB = 192");
    let message = "STM32F405RGT has 128 KiB of contiguous RAM for data, not 192";
    refused(&text, message, "192", "ram_KiB = 128, or less");
    let text = with_chip("STM32G474RE", 512, 128);
    refused(&text, "STM32G474RET has 96 KiB of contiguous RAM for data, not 128", "128", "ram_KiB = 96");
    let text = with_chip("STM32F405OE", 1024, 128);
    refused(&text, "STM32F405OEY has 512 KiB of flash, not 1024", "1024", "flash_KiB = 512");
}

/// A size of flash without slots for the observer's memory is rejected.
#[test]
fn flash_without_slots_rejected() {
    let text = spoilt("flash_KiB = 1024", "flash_KiB = 700");
    let message = "700 KiB of flash leave no slots for the observer's memory";
    refused(&text, message, "700", "flash_KiB = 512 or 1024");
    let text = spoilt("ram_KiB = 128", "ram_KiB = 8");
    refused(&text, "`ram_KiB` must be between 16 and 4096, not 8", "8", "contiguous RAM");
}

/// Frequencies that the chip's oscillator or PLL cannot use are rejected.
#[test]
fn unusable_clock_rejected() {
    let text = spoilt("8_000_000", "14_745_600");
    let message = "STM32F405 cannot make its core clock of 168 MHz from 14.7456 MHz";
    refused(&text, message, "14_745_600", "4 MHz, 5 MHz, 6 MHz, 8 MHz, 10 MHz, 12 MHz, 16 MHz");
    let text = spoilt("8_000_000", "48_000_000");
    let message = "STM32F405 needs a crystal between 4 MHz and 26 MHz, not 48 MHz";
    refused(&text, message, "48_000_000", "25 MHz, 26 MHz");
    assert!(!only(&text).2.contains("48 MHz"));
    // As a signal, the frequency is allowed.
    good(&text.replace("crystal", "signal"));
    let text = with_chip("STM32G474RE", 512, 96).replace("8_000_000", "26_000_000");
    refused(
        &text,
        "STM32G474 cannot make its core clock of 170 MHz from 26 MHz",
        "26_000_000",
        "24 MHz, 25 MHz, 48 MHz",
    );
    let text = with_chip("STM32H743ZI", 2048, 128).replace("8_000_000", "49_000_000");
    let message = "STM32H743 needs a crystal between 4 MHz and 48 MHz, not 49 MHz";
    refused(&text, message, "49_000_000", "26 MHz, 48 MHz");
    let text = spoilt("8_000_000", "8");
    let message = "`frequency_Hz` must be between 1000000 and 50000000, not 8";
    refused(&text, message, "8", "8_000_000");
}

/// Source and frequency must agree.
#[test]
fn contradictory_clock_rejected() {
    let text = spoilt("\"crystal\"", "\"internal\"");
    let message = "`frequency_Hz` needs a crystal or signal, but `source` is \"internal\"";
    refused(&text, message, "8_000_000", "leave `frequency_Hz` out");
    let text = spoilt("frequency_Hz = 8_000_000 # printed on it\n", "");
    refused(&text, "`frequency_Hz` is missing from [clock]", "[clock]", "of crystal or signal");
    let text = spoilt("\"crystal\"", "\"quartz\"");
    let message = "`source` must be \"crystal\", \"signal\" or \"internal\", not \"quartz\"";
    refused(&text, message, "\"quartz\"", "the chip's own oscillator");
}

/// Values that are no pin's name are rejected.
#[test]
fn non_pin_value_rejected() {
    for name in ["A9", "PA16", "pa9", "PA09", "GPIOA9"] {
        let text = spoilt("send = \"PA9\"", &format!("send = \"{name}\""));
        let message = format!("`send` must be a pin such as \"PA9\", not \"{name}\"");
        refused(&text, &message, &format!("\"{name}\""), "transmit pin of the board");
    }
    let text = spoilt("send = \"PA9\"", "send = 9");
    refused(&text, "`send` must be a pin as a string, not a whole number", "9", "transmit pin");
}

/// A pin of another peripheral is rejected, and the possible pins of the package are named.
#[test]
fn pin_outside_unit_rejected() {
    let text = spoilt("send = \"PA9\"", "send = \"PA2\"");
    refused(&text, "PA2 cannot be `send` of USART1", "\"PA2\"", "USART1 has PA9 or PB6 for `send`");
    let text = spoilt("out = \"PA6\"", "out = \"PB5\"");
    refused(&text, "PB5 cannot be `out` of SPI1", "\"PB5\"", "SPI1 has PA6 or PB4 for `out`");
    let text = spoilt("in = \"PA7\"", "in = \"PB4\"");
    refused(&text, "PB4 cannot be `in` of SPI1", "\"PB4\"", "SPI1 has PA7 or PB5 for `in`");
    // Only pins that the package brings out are offered: PD8 of USART3 is not.
    let text = spoilt("\"USART1\"", "\"USART3\"").replace("\"PA9\"", "\"PB11\"").replace("\"PA10\"", "\"PC11\"");
    refused(&text, "PB11 cannot be `send` of USART3", "\"PB11\"", "USART3 has PB10 or PC10 for `send`");
}

/// A peripheral without pins in the package is reported as such.
#[test]
fn unit_without_package_pins_reported() {
    let text = with_chip("STM32G474CET", 512, 96).replace("PC12", "PB1");
    let text = text.replace("USART1", "UART4");
    let problems = read(&text).expect_err("the 48 pins have no UART4");
    assert!(problems[0].help.contains("no pin of this package is `send` of UART4"), "{problems:#?}");
}

/// A pin that the package does not bring out is rejected.
#[test]
fn pin_outside_package_rejected() {
    let text = spoilt("pin = \"PB0\"", "pin = \"PE3\"");
    refused(&text, "STM32F405RGT has no PE3", "\"PE3\"", "PC0 to PC15, PD2, PH0 to PH1");
    let text = spoilt("send = \"PA9\"", "send = \"PD8\"").replace("USART1", "USART3").replace("PA10", "PB11");
    refused(&text, "STM32F405RGT has no PD8", "\"PD8\"", "its package brings out");
    let text = spoilt("PB12 = \"brake resistor\"", "PE3 = \"brake resistor\"");
    refused(&text, "the chip has no PE3", "\"brake resistor\"", "its package brings out");
    // The G4's reset input counts as no pin.
    let text = with_chip("STM32G474RE", 512, 96).replace("\"PB0\"", "\"PG10\"");
    refused(&text, "STM32G474RET has no PG10", "\"PG10\"", "PF0 to PF1");
}

/// The second use of a pin is underlined, and both keys are named.
#[test]
fn pin_used_twice_rejected() {
    let text = spoilt("pin = \"PB0\"", "pin = \"PA9\"");
    let message = "PA9 is used twice, for `serial.send` and for `enable.pin`";
    let problems = read(&text).expect_err("the file is spoilt");
    assert_eq!(problems.len(), 1, "{problems:#?}");
    assert_eq!(problems[0].message, message);
    assert_eq!(problems[0].span.start, text.rfind("\"PA9\"").expect("it is there"));
    assert!(problems[0].help.contains("another pin"));
    let text = spoilt("pin = \"PC12\"", "pin = \"PA4\"");
    assert_eq!(only(&text).0, "PA4 is used twice, for `spi_slave.select` and for `light.pin`");
}

/// A pin of `[never_driven]` is rejected for every use.
#[test]
fn never_driven_pin_rejected_for_any_use() {
    let what = "gate of motor 0, phase A, high side";
    for (from, key) in [
        ("send = \"PA9\"", "serial.send"),
        ("receive = \"PA10\"", "serial.receive"),
        ("select = \"PA4\"", "spi_slave.select"),
        ("clock = \"PA5\"", "spi_slave.clock"),
        ("out = \"PA6\"", "spi_slave.out"),
        ("in = \"PA7\"", "spi_slave.in"),
        ("pin = \"PB0\"", "enable.pin"),
        ("pin = \"PC12\"", "light.pin"),
    ] {
        let pin = from.split('"').nth(1).expect("a pin");
        let text = spoilt("\nPA8 =", &format!("\n{pin} ="));
        refused(&text, &format!("{pin} of `{key}` is never driven: {what}"), &format!("\"{pin}\""), "another pin");
    }
}

/// The pins of the debug probe cannot be used otherwise.
#[test]
fn debug_probe_pins_rejected() {
    let text = spoilt("pin = \"PC12\"", "pin = \"PA13\"");
    refused(&text, "PA13 is the debug probe's data (SWDIO)", "\"PA13\"", "use another pin");
    // On the G4, USART2 could transmit on this pin.
    let text = with_chip("STM32G474RE", 512, 96).replace("USART1", "USART2").replace("PA9", "PA14");
    let text = text.replace("PA10", "PA3");
    refused(&text, "PA14 is the debug probe's clock (SWCLK)", "\"PA14\"", "use another pin");
}

/// The oscillator's pins are free only with the internal oscillator.
#[test]
fn oscillator_pins_rejected_if_connected() {
    let text = spoilt("pin = \"PC12\"", "pin = \"PH0\"");
    refused(&text, "PH0 is the pin of the crystal", "\"PH0\"", "source = \"internal\"");
    let signal = text.replace("\"crystal\"", "\"signal\"").replace("PH0", "PH1");
    refused(&signal, "PH1 is the pin of the clock signal", "\"PH1\"", "use another pin");
    good(&text.replace("\"crystal\"", "\"internal\"").replace("frequency_Hz = 8_000_000 # printed on it\n", ""));
    let text = with_chip("STM32G474RE", 512, 96).replace("PC12", "PF1");
    refused(&text, "PF1 is the pin of the crystal", "\"PF1\"", "use another pin");
    let text = with_chip("STM32H743ZI", 2048, 128).replace("PC12", "PH1");
    refused(&text, "PH1 is the pin of the crystal", "\"PH1\"", "use another pin");
}

/// A peripheral that the chip lacks or that is unsupported is rejected with the possible ones.
#[test]
fn missing_unit_rejected() {
    let text = spoilt("\"USART1\"", "\"UART7\"");
    let wanted = "\"USART1\", \"USART2\", \"USART3\", \"UART4\", \"UART5\" or \"USART6\"";
    refused(&text, "STM32F405 has no UART7 for [serial]", "\"UART7\"", wanted);
    let text = spoilt("\"SPI1\"", "\"SPI4\"");
    refused(&text, "STM32F405 has no SPI4 for [spi_slave]", "\"SPI4\"", "\"SPI1\", \"SPI2\" or \"SPI3\"");
    // The G431 has no UART5.
    let text = with_chip("STM32G431RB", 128, 22).replace("USART1", "UART5");
    refused(&text, "STM32G431 has no UART5 for [serial]", "\"UART5\"", "\"USART3\" or \"UART4\"");
    let text = with_chip("STM32G474RE", 512, 96).replace("USART1", "LPUART1");
    let message = "LPUART1 of STM32G474 cannot be used: its registers and clock divider differ from a USART's";
    refused(&text, message, "\"LPUART1\"", "USART2");
}

/// The STM32H743 cannot be an SPI slave.
#[test]
fn spi_slave_of_h743_rejected() {
    let text = GOOD.replace("STM32F405RG", "STM32H743ZI").replace("1024", "2048");
    let message =
        "a board with this chip cannot be an SPI slave: the firmware has no slave for the STM32H743's kind of SPI";
    refused(&text, message, "[spi_slave]", "leave [spi_slave] out");
}

/// Speeds out of range or more than 1 % from the nearest possible one are rejected.
#[test]
fn unreachable_baud_rate_rejected() {
    let text = spoilt("230_400", "9_500");
    refused(&text, "`baud` must be between 9600 and 10000000, not 9500", "9_500", "230_400, 921_600");
    let text = spoilt("230_400", "10_000_000");
    let message = "USART1 makes 1281 to 5250000 baud, not 10000000";
    refused(&text, message, "10_000_000", "divider of 84 MHz is a whole number: the nearest speed is 5250000 baud");
    let text = spoilt("230_400", "4_500_000");
    let message = "USART1 would make 4421053 baud, more than 1 % from 4500000";
    refused(&text, message, "4_500_000", "nearest speed is 4421053 baud");
    // Half the clock: 42 MHz / 46 is 0.93 % from 921600, 42 MHz / 17 is 1.2 % from 2500000.
    for (baud, makes) in [("921_600", true), ("1_843_200", true), ("2_625_000", true), ("2_500_000", false)] {
        let text = spoilt("230_400", baud).replace("USART1", "USART2").replace("PA9", "PA2").replace("PA10", "PA3");
        assert_eq!(read(&text).is_ok(), makes, "{baud}");
    }
}

/// Entries of `[never_driven]` need a pin and a use.
#[test]
fn invalid_never_driven_rejected() {
    let text = spoilt("PB12 = \"brake resistor\"", "brake = \"PB12\"");
    refused(&text, "`brake` in [never_driven] is no pin", "brake", "PA8 = \"its use\"");
    let text = spoilt("PB12 = \"brake resistor\"", "PB12 = true");
    refused(&text, "`PB12` in [never_driven] must state the pin's use", "true", "as a string");
    let text = spoilt("PB12 = \"brake resistor\"", "PB12 = \" \"");
    refused(&text, "`PB12` in [never_driven] must state the pin's use", "\" \"", "as a string");
    let text = spoilt("PB12 = \"brake resistor\"", "PA8 = \"brake resistor\"");
    refused(&text, "not TOML: duplicate key", "PA8", "leave one of the two out");
}

/// Missing sections and keys are named with their hints.
#[test]
fn missing_sections_and_keys_named() {
    for (section, hint) in [("memory", "flash_KiB"), ("clock", "source"), ("serial", "baud")] {
        let text = GOOD.replace(&format!("[{section}]"), &format!("[other_{section}]"));
        let problems = read(&text).expect_err("a section is missing");
        let missing = problems.iter().find(|it| it.message == format!("the section [{section}] is missing"));
        assert!(missing.expect("it is told").help.contains(hint));
        assert!(problems.iter().any(|it| it.message == format!("unknown key `other_{section}` in a board file")));
    }
    let text = spoilt("baud = 230_400 # chosen\n", "");
    refused(&text, "`baud` is missing from [serial]", "[serial]", "baud rate");
    let text = spoilt("on = \"low\"\n", "");
    refused(&text, "`on` is missing from [light]", "[light]", "while the light is on");
    let text = spoilt("name = \"bench.2-a\"\n", "");
    refused(&text, "`name` is missing from the top of the file", "description = \"on the bench\"", "16");
}

/// Unknown keys are reported with a similar key or the key's section.
#[test]
fn unknown_keys_get_suggestion() {
    let text = spoilt("receive =", "recieve =");
    let problems = read(&text).expect_err("the file is spoilt");
    assert_eq!(problems.len(), 2, "{problems:#?}");
    assert!(problems.iter().any(|it| it.help.contains("did you mean `receive`?")));
    let text = spoilt("on = \"low\"\n", "on = \"low\"\nbaud = 1\n");
    refused(&text, "unknown key `baud` in [light]", "baud", "it belongs in [serial]");
    let text = spoilt("[never_driven]\n", "[never_driven]\n[gates]\n");
    assert!(read(&text).expect_err("unknown")[0].message.contains("unknown key `gates`"));
}

/// Values of a wrong type are rejected with the expected one.
#[test]
fn wrong_types_rejected() {
    let text = spoilt("baud = 230_400", "baud = \"fast\"");
    refused(&text, "`baud` must be a whole number, not a string", "\"fast\"", "230_400");
    let text = spoilt("on = \"high\"", "on = true");
    refused(&text, "`on` must be a string, not true or false", "true", "while the motor is on");
    let text = spoilt("on = \"high\"", "on = \"up\"");
    refused(&text, "`on` must be \"high\" or \"low\", not \"up\"", "\"up\"", "while the motor is on");
    let text = spoilt("chip = \"STM32F405RG\"", "chip = 405");
    refused(&text, "`chip` must be a string, not a whole number", "405", "order name");
    let text = format!("light = \"PC12\"\n{}", GOOD.split_once("\n[light]").expect("it is there").0);
    refused(&text, "`light` must be a section, not a string", "\"PC12\"", "[light]");
}

/// All problems of a file are reported together, in the order of the text.
#[test]
fn all_problems_reported_at_once() {
    let text =
        spoilt("\"PA9\"", "\"PA2\"").replace("8_000_000", "14_745_600").replace("ram_KiB = 128", "ram_KiB = 192");
    let text = text.replace("bench.2-a", "Bench");
    let problems = read(&text).expect_err("the file is spoilt");
    assert_eq!(problems.len(), 4, "{problems:#?}");
    assert!(problems.is_sorted_by_key(|problem| problem.span.start));
}

/// With an unknown chip nothing else is reported.
#[test]
fn unknown_chip_is_only_problem() {
    let text = spoilt("\"STM32F405RG\"", "\"STM32F407VG\"").replace("\"USART1\"", "\"UART9\"");
    assert!(only(&text).0.contains("STM32F407VG"));
}

/// Texts that are no board file are rejected with a message.
#[test]
fn non_board_file_rejected() {
    for text in ["", "\u{0}", "= 1", "[[serial]]", "name = ", "serial = [1]", "never_driven = 3"] {
        assert!(!read(text).expect_err("no board").is_empty(), "{text:?}");
    }
}

/// A preset cut anywhere is read or rejected.
#[test]
fn truncated_preset_never_panics() {
    let text = preset("odrive-3.6").expect("a preset");
    for end in (0..text.len()).filter(|end| text.is_char_boundary(*end)).step_by(7) {
        let _ = read(&text[..end]);
    }
}

/// A preset with a line of another one is read or rejected.
#[test]
fn mixed_preset_lines_never_panic() {
    // A linear congruential generator (Knuth's MMIX): any seed will do.
    let mut state: u64 = 1;
    let mut below = |count: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % count
    };
    let mut read_well = 0;
    for _ in 0..2000 {
        let [one, other] = [0, 1].map(|_| preset(board_file::PRESETS[below(9)]).expect("a preset"));
        let mut lines: Vec<&str> = one.lines().collect();
        let others: Vec<&str> = other.lines().collect();
        lines[below(one.lines().count())] = others[below(others.len())];
        read_well += usize::from(read(&lines.join("\n")).is_ok());
    }
    // Changed comments and pin lists leave a file valid.
    assert!((100..1900).contains(&read_well), "{read_well}");
}

/// Using the pin that is read as BOOT0 gives a warning.
#[test]
fn boot0_pin_warned() {
    let text = with_chip("STM32G474RE", 512, 96).replace("PC12", "PB8");
    let warnings = good(&text).warnings;
    assert_eq!(warnings.len(), 1, "{warnings:#?}");
    assert_eq!((warnings[0].severity, &text[warnings[0].span.clone()]), (Severity::Warning, "\"PB8\""));
    assert!(warnings[0].help.contains("nSWBOOT0"));
    // On the F405, PB8 is an ordinary pin.
    assert_eq!(good(&spoilt("pin = \"PC12\"", "pin = \"PB8\"")).warnings, []);
}

/// Good file with a piece appended.
fn with(piece: &str) -> String {
    format!("{GOOD}\n{piece}")
}

const CAN: &str = "[can]\nunit = \"CAN1\"\nsend = \"PB9\"\nreceive = \"PB8\"\n";
const PULSES: &str = "[encoder.motor]\nunit = \"TIM3\"\na = \"PC6\"\nb = \"PC7\"\nindex = \"PC8\"\n";
const ON_SPI: &str =
    "[encoder.output]\nunit = \"SPI3\"\nselect = \"PA15\"\nclock = \"PC10\"\nout = \"PC11\"\nin = \"PB5\"\n";

/// Lines that no image uses yet are read, and their pins are reserved.
#[test]
fn unused_lines_reserve_pins() {
    let board = good(&with(&format!("{PULSES}{ON_SPI}")));
    let pins: Vec<String> = board.unused_line_pins().iter().map(|(key, pin)| format!("{key} {pin}")).collect();
    let wanted = [
        "encoder.motor.a PC6",
        "encoder.motor.b PC7",
        "encoder.motor.index PC8",
        "encoder.output.select PA15",
        "encoder.output.clock PC10",
        "encoder.output.out PC11",
        "encoder.output.in PB5",
    ];
    assert_eq!(pins, wanted);
    // The firmware uses none of these pins.
    assert_eq!(board.used_pins(), good(GOOD).used_pins());
}

#[test]
fn pins_of_can_are_used_once() {
    let pins: Vec<String> = good(&with(CAN)).used_pins().iter().map(|(key, pin)| format!("{key} {pin}")).collect();
    assert!(pins.contains(&"can.send PB9".to_owned()) && pins.contains(&"can.receive PB8".to_owned()), "{pins:?}");
    let taken = with(CAN).replace("pin = \"PC12\"", "pin = \"PB9\"");
    refused(&taken, "PB9 is used twice, for `can.send` and for `light.pin`", "\"PB9\"", "another pin");
    let gate = with(&CAN.replace("PB9", "PA12")).replace("PB12 = ", "PA12 = ");
    refused(&gate, "PA12 of `can.send` is never driven: brake resistor", "\"PA12\"", "take it out");
}

/// Bit rates of CAN are exact, and a board without a transceiver says so.
#[test]
fn can_rates_are_exact() {
    let can = good(&with(CAN)).can.expect("it has one");
    assert_eq!((can.bitrate, can.timing.prescaler, can.timing.quanta()), (1_000_000, 3, 14));
    let of = |answer: &str| good(&with(&format!("{CAN}transceiver = \"{answer}\"\n"))).can.expect("it has one");
    assert_eq!(of("yes").missing_transceiver(), None);
    let missing = of("no").missing_transceiver().expect("a sentence");
    assert!(missing.contains("no CAN transceiver") && missing.contains("TXD to PB9"), "{missing}");
    let rate = with(&format!("{CAN}bitrate = 800_000\n"));
    let message = "`bitrate` of 800000 bit/s cannot be made from the 42 MHz of CAN1: no prescaler gives whole quanta with \
                   the sample point within 5 % of 87.5 %";
    refused(&rate, message, "800_000", "1000000, 500000");
    let fast = with(&format!("{CAN}data_bitrate = 2_000_000\n"));
    refused(&fast, "CAN1 has no second bit rate: it is classical CAN", "2_000_000", "leave `data_bitrate` out");
}

/// FDCAN compensates the transmitter's delay with a prescaler of 1 or 2 only: 2 Mbit/s from 170 MHz needs 5.
#[test]
fn second_bit_rate_needs_small_prescaler() {
    let file = board_file::preset("nucleo-g474re").expect("a preset");
    let can = good(file).can.expect("it has one");
    assert_eq!(can.data_timing.expect("5 Mbit/s").prescaler, 1);
    let slow = file.replace("data_bitrate = 5_000_000", "data_bitrate = 2_000_000");
    let message = "`data_bitrate` of 2000000 bit/s cannot be made from the 170 MHz of FDCAN1: neither prescaler that the \
                   transmitter delay compensation allows, 1 and 2, gives whole quanta with the sample point within 5 % of \
                   80 %";
    refused(&slow, message, "2_000_000", "5000000");
}

/// Only a board with a crystal or an external clock is accurate enough for CAN at 1 Mbit/s.
#[test]
fn can_on_internal_oscillator_warned_of() {
    let of = |name: &str| good(board_file::preset(name).expect("a preset")).inaccurate_can_clock();
    assert_eq!((of("nucleo-g474re"), of("feather-f405")), (None, None));
    let sentence = of("moteus-r4").expect("a sentence");
    assert!(sentence.contains("1 % off") && sentence.contains("allows 0.6 %"), "{sentence}");
}

/// Two SPI encoders may share clock and data, but no select.
#[test]
fn encoders_share_bus_not_select() {
    let motor = ON_SPI.replace("output", "motor").replace("PA15", "PB1");
    assert!(good(&with(&format!("{ON_SPI}{motor}"))).encoders.iter().all(Option::is_some));
    let same = with(&format!("{}{ON_SPI}", ON_SPI.replace("output", "motor")));
    let message = "PA15 is used twice, for `encoder.motor.select` and for `encoder.output.select`";
    refused(&same, message, "\"PA15\"", "another pin");
    // Devices share a bus wire by wire.
    let crossed = motor.replace("clock = \"PC10\"", "clock = \"PB3\"").replace("select = \"PB1\"", "select = \"PC10\"");
    let message = "PC10 is used twice, for `encoder.motor.select` and for `encoder.output.clock`";
    refused(&with(&format!("{ON_SPI}{crossed}")), message, "\"PC10\"", "another pin");
}

/// CAN peripherals, timers and pins that the chip lacks are rejected.
#[test]
fn missing_lines_rejected() {
    let can = with(&CAN.replace("CAN1", "CAN3"));
    refused(&can, "STM32F405 has no CAN3 for [can]", "\"CAN3\"", "\"CAN1\" or \"CAN2\"");
    let pin = with(&CAN.replace("PB9", "PC3"));
    refused(&pin, "PC3 cannot be `send` of CAN1", "\"PC3\"", "CAN1 has PA12 or PB9 for `send`");
    let unit = with(&ON_SPI.replace("SPI3", "TIM9"));
    refused(&unit, "STM32F405 has no TIM9 for [encoder.output]", "\"TIM9\"", "\"SPI3\"");
    let channel = with(&PULSES.replace("a = \"PC6\"", "a = \"PC9\""));
    refused(&channel, "PC9 cannot be `a` of TIM3", "\"PC9\"", "PA6 or PB4 or PC6");
    let probe = with(&PULSES.replace("PC8", "PA13"));
    refused(&probe, "PA13 is the debug probe's data (SWDIO)", "\"PA13\"", "another pin");
    let kinds = with(&PULSES.replace("index", "select"));
    refused(&kinds, "`select` is no pin of an encoder on TIM3", "\"PC8\"", "`a`, `b` and `index`");
    let half = with(&CAN.replace("receive = \"PB8\"\n", ""));
    assert!(only(&half).0.contains("`receive`"));
    let large = with_chip("STM32H743ZI", 2048, 128) + "\n" + ON_SPI;
    let message = "SPI3 of STM32H743 cannot be used: the pins of its SPI are not in this program";
    refused(&large, message, "\"SPI3\"", "\"TIM1\"");
    let other = with("[encoder.link]\nunit = \"TIM3\"\n");
    assert!(only(&other).0.contains("link"));
}
