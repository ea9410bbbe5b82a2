//! Preset board files: all can be read, state the origin of every value, and yield valid inputs of the firmware's
//! build.

use std::collections::BTreeSet;
use std::path::Path;

use board_file::{
    Board, Chip, DEFAULT, ExternalClock, Level, PRESETS, Pin, all_cfgs, boards_with, cfgs, chip_in_place_of_board,
    linker_script, preset, read, rust_source,
};

fn board(name: &str) -> Board {
    match read(preset(name).expect("a preset")) {
        Ok(board) => board,
        Err(problems) => panic!("{name}: {problems:#?}"),
    }
}

fn pin(name: &str) -> Pin {
    name.parse().expect("a pin")
}

/// Every file in `boards` is a preset, and every preset a file.
#[test]
fn board_files_match_presets() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../boards");
    let mut stems = BTreeSet::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        assert_eq!(path.extension().and_then(|it| it.to_str()), Some("toml"), "{}", path.display());
        let stem = path.file_stem().and_then(|it| it.to_str()).expect("a name").to_owned();
        assert_eq!(std::fs::read_to_string(&path).expect("a text"), preset(&stem).expect("a preset"), "{stem}");
        stems.insert(stem);
    }
    assert_eq!(stems, PRESETS.map(str::to_owned).into_iter().collect());
    for name in PRESETS {
        assert_eq!(board(name).name, name);
    }
    assert_eq!(DEFAULT, "olimex-h405");
}

/// Presets are read without warnings other than the known one.
#[test]
fn presets_read_with_known_warnings() {
    for name in PRESETS {
        let warnings: Vec<String> = board(name).warnings.into_iter().map(|warning| warning.message).collect();
        let wanted: &[&str] = match name {
            // The maker sets the option bytes so that the pin is not read at a reset.
            "moteus-r4" => &["PB8 is read as BOOT0 at a reset: while it is high the chip starts its boot loader"],
            _ => &[],
        };
        assert_eq!(warnings, wanted, "{name}");
    }
}

/// Every value of a preset carries its origin.
#[test]
fn preset_values_state_origin() {
    for name in PRESETS {
        let sources = board(name).sources;
        assert!(sources.len() > 10, "{name}: {}", sources.len());
        let silent: Vec<_> = sources.iter().filter(|source| source.remark.is_none()).collect();
        assert!(silent.is_empty(), "{name}: {silent:?}");
    }
}

/// Each tag of an origin is explained at the top of the file.
#[test]
fn source_tags_explained() {
    for name in PRESETS {
        let text = preset(name).expect("a preset");
        let head: Vec<&str> = text.lines().take_while(|line| line.starts_with('#')).collect();
        let tags: Vec<&str> = head.iter().filter_map(|line| line.strip_prefix("#   ")?.split("  ").next()).collect();
        assert!(!tags.is_empty(), "{name}");
        for source in board(name).sources {
            let remark = source.remark.expect("every value has one");
            let first = remark.split([' ', ':', ',', ';']).next().unwrap_or_default();
            let plain = ["chosen", "assumed", "order", "data"].contains(&first);
            assert!(plain || tags.contains(&first), "{name}, {}: {remark}", source.key);
        }
    }
}

/// Pins and clocks of the first three boards stay as they were before there were board files; CAN came with role
/// `drive`.
#[test]
fn first_three_boards_unchanged() {
    let h405 = board("olimex-h405");
    assert_eq!((h405.chip, h405.probe_name.as_str()), (Chip::Stm32f405, "STM32F405RGTx"));
    assert_eq!((h405.flash_bytes, h405.ram_bytes), (1 << 20, 128 << 10));
    assert_eq!(h405.clock, ExternalClock::Crystal(8_000_000));
    assert_eq!((h405.serial.unit, h405.serial.baud, h405.serial.clock), ("USART1", 230_400, 84_000_000));
    let used: Vec<String> = h405.used_pins().iter().map(|(_, pin)| pin.to_string()).collect();
    assert_eq!(used, ["PA9", "PA10", "PA4", "PA5", "PA6", "PA7", "PB9", "PB8", "PB0", "PC12"]);
    assert_eq!((h405.enable.expect("it has one").on, h405.light.expect("it has one").on), (Level::High, Level::Low));
    let g474 = board("nucleo-g474re");
    assert_eq!((g474.probe_name.as_str(), g474.serial.unit), ("STM32G474RETx", "USART2"));
    assert_eq!(g474.pll.external.map(|pll| (pll.divider, pll.factor)), Some((6, 85)));
    let h743 = board("nucleo-h743zi");
    assert_eq!((h743.clock, h743.spi_slave.is_some()), (ExternalClock::Signal(8_000_000), false));
    assert_eq!((h743.probe_name.as_str(), h743.image_bytes()), ("STM32H743ZITx", 1 << 20));
}

/// Gates, and the pins that arm them, are in `[never_driven]`.
#[test]
fn power_stages_never_driven() {
    // Gates and the pins that arm them.
    let stages: [(&str, &[&str]); 4] = [
        (
            "odrive-3.6",
            &[
                "PA8", "PA9", "PA10", "PB13", "PB14", "PB15", "PC6", "PC7", "PC8", "PA7", "PB0", "PB1", "PB10", "PB11",
                "PB12",
            ],
        ),
        ("b-g431b-esc1", &["PA8", "PA9", "PA10", "PC13", "PA12", "PB15"]),
        ("moteus-r4", &["PA0", "PA1", "PA2", "PA3", "PB7"]),
        ("vesc-6", &["PA8", "PA9", "PA10", "PB13", "PB14", "PB15", "PB5"]),
    ];
    for (name, pins) in stages {
        let board = board(name);
        assert_eq!(board.enable, None, "{name}");
        for wanted in pins {
            assert!(board.never_driven.iter().any(|(left, _)| *left == pin(wanted)), "{name}: {wanted}");
        }
    }
}

#[test]
fn image_pins_would_harm_other_board() {
    // Reason for board files: an image for one board would drive gates on another.
    let (h405, odrive) = (board("olimex-h405"), board("odrive-3.6"));
    let harm = h405.used_pins().into_iter().filter(|(_, pin)| odrive.never_driven.iter().any(|(left, _)| left == pin));
    let harm: Vec<String> = harm.map(|(key, pin)| format!("{key} {pin}")).collect();
    assert!(harm.contains(&"serial.send PA9".to_owned()) && harm.contains(&"enable.pin PB0".to_owned()), "{harm:?}");
}

/// The generated source consists of 19 public constants, and 3 more for a board with CAN.
#[test]
fn generated_constants_parse_as_rust() {
    for name in PRESETS {
        let board = board(name);
        let (source, count) = (rust_source(&board), if board.can.is_some() { 22 } else { 19 });
        let file = syn::parse_file(&source).unwrap_or_else(|error| panic!("{name}: {error}\n{source}"));
        let public =
            |item: &syn::Item| matches!(item, syn::Item::Const(it) if matches!(it.vis, syn::Visibility::Public(_)));
        assert!(file.items.len() == count && file.items.iter().all(public), "{source}");
    }
}

/// The generated constants have the board's values.
#[test]
fn generated_constants_match_board() {
    let source = rust_source(&board("olimex-h405"));
    for line in [
        "pub const NAME: &str = \"olimex-h405\";",
        "pub const CORE_RATE: u32 = 168000000;",
        "pub const EXTERNAL: Option<(u32, bool)> = Some((8000000, false));",
        "pub const EXTERNAL_PLL: Option<(u32, u32, u32)> = Some((4, 168, 0));",
        "pub const INTERNAL_PLL: (u32, u32, u32) = (8, 168, 0);",
        "pub const SERIAL_SEND: (u8, u8, u8) = (0, 9, 7);",
        "pub const BAUD: u32 = 230400;",
        "pub const SPI_SLAVE: Option<[(u8, u8, u8); 4]> = Some([(0, 4, 5), (0, 5, 5), (0, 6, 5), (0, 7, 5)]);",
        "pub const ENABLE: Option<(u8, u8, bool)> = Some((1, 0, true));",
        "pub const LIGHT: Option<(u8, u8, bool)> = Some((2, 12, false));",
        "pub const SLOTS: [u32; 2] = [0x080c0000, 0x080e0000];",
        "pub const SLOT_BYTES: u32 = 131072;",
        "pub const IMAGE_BYTES: u32 = 786432;",
    ] {
        assert!(source.contains(line), "no `{line}` in\n{source}");
    }
    let moteus = rust_source(&board("moteus-r4"));
    for line in ["EXTERNAL: Option<(u32, bool)> = None;", "SPI_SLAVE: Option<[(u8, u8, u8); 4]> = None;"] {
        assert!(moteus.contains(line), "no `{line}` in\n{moteus}");
    }
    assert!(rust_source(&board("nucleo-h743zi")).contains("Some((8000000, true))"));
}

/// The linker script holds the start of the stack and the limits of image and statics.
#[test]
fn linker_script_limits_memory() {
    let script = linker_script(&board("nucleo-g474re"));
    for part in [
        "_stack_start = 0x20018000;",
        "__sidata + (__edata - __sdata) <= 0x0807e000",
        "the board nucleo-g474re: of 512 KiB of flash it may take the first 504 KiB",
        "__ebss <= 0x20016000 && __euninit <= 0x20016000",
        "of 96 KiB of RAM they must leave 8 KiB to the stack",
    ] {
        assert!(script.contains(part), "no `{part}` in\n{script}");
    }
    for name in PRESETS {
        assert!(linker_script(&board(name)).matches("ASSERT(").count() == 2, "{name}");
    }
}

/// Every `cfg` of a preset is among the announced ones.
#[test]
fn cfgs_announced() {
    let announced = all_cfgs();
    for name in PRESETS {
        for (key, value) in cfgs(&board(name)) {
            let values = announced.iter().find(|(name, _)| *name == key).map(|(_, values)| values).expect("announced");
            assert!(values.contains(&value), "{name}: {key} = {value}");
        }
    }
    let of = |name: &str| cfgs(&board(name));
    assert_eq!(
        of("nucleo-g474re"),
        [
            ("chip", "stm32g474".to_owned()),
            ("family", "stm32g4".to_owned()),
            ("serial", "usart2".to_owned()),
            ("spi_slave", "spi2".to_owned()),
            ("select_line", "12".to_owned()),
            ("can", "fdcan1".to_owned())
        ]
    );
    assert_eq!(of("moteus-r4")[2..], [("serial", "usart3".to_owned()), ("can", "fdcan1".to_owned())]);
}

/// A chip's name in the place of a board's is answered with the boards that have the chip.
#[test]
fn chip_in_place_of_board_lists_boards() {
    let (message, help) = chip_in_place_of_board("stm32f405").expect("a chip");
    assert_eq!(message, "stm32f405 is a chip, not a board: pins differ from board to board");
    assert!(help.contains("boards with it: olimex-h405, odrive-3.6, feather-f405, weact-f405, vesc-6"), "{help}");
    for name in ["STM32G431", "STM32G431CBU6", "stm32g431cb"] {
        let (message, help) = chip_in_place_of_board(name).expect("a chip");
        assert!(
            message.starts_with(name) && help.contains("boards with it: b-g431b-esc1, nucleo-g431rb, weact-g431;"),
            "{message}: {help}"
        );
    }
    for name in ["olimex-h405", "stm32f405.toml", "boards/stm32f405", "stm32"] {
        assert_eq!(chip_in_place_of_board(name), None, "{name}");
    }
    for chip in Chip::ALL {
        assert!(!boards_with(chip).is_empty(), "{chip:?}");
        assert_eq!(chip.processor().clock, chip.core_rate(), "{chip:?}");
    }
}

/// The page lists every preset with chip, clock and serial line.
#[test]
fn page_lists_presets() {
    let page = include_str!("../../../docs/reference/board-files.md");
    for name in PRESETS {
        let Board { chip_name, clock, serial, .. } = board(name);
        let row = page.lines().find(|line| line.starts_with(&format!("| `{name}` |"))).expect(name);
        let clock = match clock {
            ExternalClock::None => "no crystal".to_owned(),
            ExternalClock::Crystal(frequency) => format!("{} MHz crystal", frequency / 1_000_000),
            ExternalClock::Signal(frequency) => format!("{} MHz signal", frequency / 1_000_000),
        };
        let (send, receive) = (format!("{} out", serial.send.pin), format!("{} in", serial.receive.pin));
        for part in [&chip_name[..11], &clock, serial.unit, &send, &receive, &serial.baud.to_string()] {
            assert!(row.contains(part), "`{part}` is not in {row}");
        }
    }
}
