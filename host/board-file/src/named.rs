//! Finds a board file by path or as a preset and reads it; errors underline the place in the text.

use std::path::Path;

use joint_file::diagnostic;
use report::failure::{Failure, Outcome};
use report::input;

use crate::board::Board;
use crate::presets::{PRESETS, chip_in_place_of_board, preset};

/// Board file with its name and text.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// Path, or name of the preset.
    pub name: String,
    /// Text of the file.
    pub text: String,
    /// Parsed board.
    pub board: Board,
}

/// Reads a path or a preset. A file takes precedence over a preset of the same name.
pub fn load(file: &Path) -> Outcome<Loaded> {
    let name = file.display().to_string();
    let known = file.to_str().filter(|_| !file.is_file());
    if let Some((message, help)) = known.and_then(chip_in_place_of_board) {
        return Err(Failure::new(message).with_help(help));
    }
    let text = match input::preset(file, preset) {
        Some(text) => text.to_owned(),
        None => input::text(file, input::LARGEST_TYPED).map_err(|why| {
            let help = format!("give the path of a board file, or one of the boards {}", PRESETS.join(", "));
            Failure::new(format!("cannot read the board file {}: {why}", file.display())).with_help(help)
        })?,
    };
    match crate::read(&text) {
        Ok(board) => Ok(Loaded { name, text, board }),
        Err(problems) => Err(Failure::from_report(diagnostic::report(&name, &text, &problems))),
    }
}
