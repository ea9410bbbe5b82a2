//! Memory files of runs on the host: the estimated parameters in the form in which a board stores them, beside the
//! joint file that they are valid for.

use std::io::Write;

use model_core::observer::Memory;

use super::log_file::FOLDER;
use report::failure::Outcome;
use report::folder::Folder;

/// File names of memories and joint files in the output folder.
pub const MEMORIES: &str = "runs/*.memory";
pub const JOINTS: &str = "runs/*.toml";

/// Writes memory and joint file; returns the memory's path relative to the output folder.
pub fn write(folder: &Folder, name: &str, memory: &Memory, joint: &str) -> Outcome<String> {
    let path = format!("{FOLDER}/{name}.memory");
    folder.write_text(&format!("{FOLDER}/{name}.toml"), joint)?;
    folder.write_with(&path, |file| file.write_all(memory))?;
    Ok(path)
}
