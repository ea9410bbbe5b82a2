//! The board of this build, as its board file says it: written by the build script.

#![allow(dead_code, clippy::unreadable_literal, reason = "generated; each chip uses its own part")]

include!(concat!(env!("OUT_DIR"), "/board.rs"));
