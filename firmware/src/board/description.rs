//! Constants of this build's board file, written by the build script.

#![allow(dead_code, clippy::unreadable_literal, reason = "generated; each chip uses its own part")]

include!(concat!(env!("OUT_DIR"), "/board.rs"));
