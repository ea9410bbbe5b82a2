//! Files of commands: the user's own files are never overwritten, no file is left partial by a kill or a full disk, and
//! the next run cleans up after the last.

#[path = "../command/mod.rs"]
mod command;
mod full_disks;
mod kills;
#[path = "../pseudo_terminal/mod.rs"]
mod pseudo_terminal;
#[allow(dead_code, reason = "every test binary uses its own part of it")]
#[path = "../thread_board/mod.rs"]
mod thread_board;
mod tree;
mod user_files;
mod writers;
