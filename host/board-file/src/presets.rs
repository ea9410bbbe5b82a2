//! The board files that come with the program. Each carries the source of what it says.

use crate::chip::{Chip, Part};

/// Names of the presets, the default first.
pub const PRESETS: [&str; 9] = [
    "olimex-h405",
    "nucleo-g474re",
    "nucleo-h743zi",
    "odrive-3.6",
    "feather-f405",
    "weact-f405",
    "b-g431b-esc1",
    "moteus-r4",
    "vesc-6",
];

/// The board that is meant where none is named.
pub const DEFAULT: &str = PRESETS[0];

/// The text of a preset, by its name.
pub fn preset(name: &str) -> Option<&'static str> {
    Some(match name {
        "olimex-h405" => include_str!("../../../boards/olimex-h405.toml"),
        "nucleo-g474re" => include_str!("../../../boards/nucleo-g474re.toml"),
        "nucleo-h743zi" => include_str!("../../../boards/nucleo-h743zi.toml"),
        "odrive-3.6" => include_str!("../../../boards/odrive-3.6.toml"),
        "feather-f405" => include_str!("../../../boards/feather-f405.toml"),
        "weact-f405" => include_str!("../../../boards/weact-f405.toml"),
        "b-g431b-esc1" => include_str!("../../../boards/b-g431b-esc1.toml"),
        "moteus-r4" => include_str!("../../../boards/moteus-r4.toml"),
        "vesc-6" => include_str!("../../../boards/vesc-6.toml"),
        _ => return None,
    })
}

/// The presets with a chip.
pub fn boards_with(chip: Chip) -> Vec<&'static str> {
    let of = |name: &&str| preset(name).and_then(|text| crate::read(text).ok()).is_some_and(|board| board.chip == chip);
    PRESETS.into_iter().filter(of).collect()
}

/// What is wrong with a chip's name, or its order name, where a board is wanted, and the help; `None` if it is none.
pub fn chip_in_place_of_board(name: &str) -> Option<(String, String)> {
    let part = || Part::of(&name.to_uppercase()).map(|part| part.chip);
    let chip = Chip::of_name(&name.to_lowercase()).or_else(part)?;
    let boards = boards_with(chip);
    Some((
        format!("{name} is a chip, not a board: pins differ from board to board"),
        format!("boards with it: {}; or give the path of a board file of your own", boards.join(", ")),
    ))
}
