//! Boards named on a command line: a file takes precedence over a preset, and errors underline the place.
#![cfg(feature = "diagnostics")]

use std::path::Path;

use board_file::named::load;
use board_file::preset;

/// A preset is found by its name.
#[test]
fn preset_found_by_name() {
    let loaded = load(Path::new("olimex-h405")).expect("a preset");
    assert_eq!((loaded.name.as_str(), loaded.board.name.as_str()), ("olimex-h405", "olimex-h405"));
    assert_eq!(Some(loaded.text.as_str()), preset("olimex-h405"));
}

/// A file is read by path, and its problems are underlined.
#[test]
fn file_problems_underlined() {
    let folder = std::env::temp_dir().join(format!("board-file-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("mine.toml");
    let text = preset("olimex-h405").expect("a preset");
    std::fs::write(&path, text.replace("olimex-h405\"", "mine\"")).expect("written");
    assert_eq!(load(&path).expect("a board").board.name, "mine");
    std::fs::write(&path, text.replace("\"PA9\"", "\"PA8\"")).expect("written");
    let failure = load(&path).expect_err("PA8 does not send");
    std::fs::remove_dir_all(&folder).expect("removed");
    assert!(failure.message().contains("PA8 cannot be `send` of USART1"), "{failure:?}");
    assert!(failure.full_help().is_some_and(|help| help.contains("PA9 or PB6")));
    assert_eq!(failure.exit_code(), 2);
}

/// A chip's name is answered with the boards that have the chip.
#[test]
fn chip_name_lists_boards() {
    let failure = load(Path::new("stm32g431")).expect_err("a chip");
    assert_eq!(failure.message(), "stm32g431 is a chip, not a board: pins differ from board to board");
    assert!(failure.help().is_some_and(|help| help.contains("b-g431b-esc1")));
}

/// A chip without firmware is answered with the C library.
#[test]
fn unsupported_chip_points_to_c_library() {
    for name in ["stm32f446", "STM32F446RE", "stm32f446ret6"] {
        let failure = load(Path::new(name)).expect_err("a chip");
        assert_eq!(failure.message(), format!("there is no firmware for the chip {name}"));
        let help = failure.help().unwrap_or_default();
        assert!(help.contains("Cortex-M4F, M7 or M33") && help.contains("STM32F405RG"), "{help}");
    }
}

/// Any other name is answered with the presets.
#[test]
fn unknown_name_lists_presets() {
    let failure = load(Path::new("no-such-board")).expect_err("nothing");
    assert!(failure.message().contains("cannot read the board file no-such-board"), "{failure:?}");
    assert!(failure.help().is_some_and(|help| help.contains("olimex-h405, nucleo-g474re")));
}
