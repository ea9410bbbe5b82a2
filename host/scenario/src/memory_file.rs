//! What the observer of a run on the host has learnt, as a file that a board could have kept; beside it the joint file that
//! it was learnt with, which is the only one that it is good for.

use std::io::Write;

use model_core::observer::Memory;

use super::log_file::FOLDER;
use report::failure::Outcome;
use report::folder::Folder;

/// Names of both among the results.
pub const MEMORIES: &str = "runs/*.memory";
pub const JOINTS: &str = "runs/*.toml";

/// Writes both under a name, and says where the memory is in the folder of all.
pub fn write(folder: &Folder, name: &str, memory: &Memory, joint: &str) -> Outcome<String> {
    let path = format!("{FOLDER}/{name}.memory");
    folder.write_text(&format!("{FOLDER}/{name}.toml"), joint)?;
    folder.write_with(&path, |file| file.write_all(memory))?;
    Ok(path)
}
