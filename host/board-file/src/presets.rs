//! Preset board files. Each value carries its origin.

use crate::chip::{Chip, OTHER_CHIPS, Part};

/// Declares the presets: a name each, with the text of its file in `boards`.
macro_rules! presets {
    ($($name:literal),+ $(,)?) => {
        /// Names of the presets, the default first.
        pub const PRESETS: [&str; [$($name),+].len()] = [$($name),+];
        /// Their texts, in the same order.
        const TEXTS: [&str; PRESETS.len()] = [$(include_str!(concat!("../../../boards/", $name, ".toml"))),+];
    };
}

presets![
    "olimex-h405",
    "nucleo-g474re",
    "nucleo-h743zi",
    "odrive-3.6",
    "feather-f405",
    "weact-f405",
    "b-g431b-esc1",
    "moteus-r4",
    "vesc-6",
    "nucleo-g431rb",
    "weact-g431",
];

/// Preset that is used if none is named.
pub const DEFAULT: &str = PRESETS[0];

/// Text of a preset, by its name.
pub fn preset(name: &str) -> Option<&'static str> {
    PRESETS.into_iter().position(|known| known == name).map(|place| TEXTS[place])
}

/// Presets with a chip.
pub fn boards_with(chip: Chip) -> Vec<&'static str> {
    let has_chip =
        |name: &&str| preset(name).and_then(|text| crate::read(text).ok()).is_some_and(|board| board.chip == chip);
    PRESETS.into_iter().filter(has_chip).collect()
}

/// Message and help for a chip's name or order name in the place of a board's name; `None` for other names.
pub fn chip_in_place_of_board(name: &str) -> Option<(String, String)> {
    let part = || Part::from_order_name(&name.to_uppercase()).map(|part| part.chip);
    let Some(chip) = Chip::from_name(&name.to_lowercase()).or_else(part) else {
        let is_order_name = |rest: &str| !rest.is_empty() && rest.chars().all(|letter| letter.is_ascii_alphanumeric());
        return name.to_lowercase().strip_prefix("stm32").filter(|rest| is_order_name(rest)).map(|_| {
            (
                format!("there is no firmware for the chip {name}"),
                format!("known: {}; {OTHER_CHIPS}", Part::names().join(", ")),
            )
        });
    };
    let boards = boards_with(chip);
    Some((
        format!("{name} is a chip, not a board: pins differ from board to board"),
        format!("boards with it: {}; or give the path of a board file of your own", boards.join(", ")),
    ))
}
