//! The files that commands leave: none of the user's own is written over, none is half written after a kill or on a full
//! disk, and the next run mends what is left of the last.

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
