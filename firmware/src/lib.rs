#![cfg_attr(target_os = "none", no_std)]
//! A joint simulated in the tick of a microcontroller, driven and watched over a serial line.
//!
//! `tick_handler` is one tick of any role: it takes commands from `schedule`, steps the role's `work`, records times in
//! `timing_monitor`, listens for the host's `silence`, and enters `safe_state` on a fault. The roles are `plant`, `observer`
//! and `whole_loop`; `protocol` is what they differ in on the line. `queues` connects the tick to the rest, by a
//! `sized_queue` that cannot panic.
//! `conversation`, run in idle, answers the host with the help of `identity`, `intake`, `memory_requests`, `batcher`, `telemetry`
//! and `timing_report`; `serial` moves its bytes. `port` is the seam between a motor controller and observer with compensation, `encoder`
//! where counts come from, `learnt` what an observer has learnt, `kept_memory` where that outlives a power cut.
//! All of these are free of hardware and are tested on the host; `board`, `clock`, `logger`, `panic_message` and
//! `stack` exist on a board only; `measuring` in the emulator only. Physics is in `model-core`, the
//! messages are in `link`.

pub mod batcher;
pub mod conversation;
pub mod encoder;
pub mod identity;
pub mod intake;
pub mod kept_memory;
pub mod learnt;
pub mod memory_requests;
pub mod observer;
pub mod plant;
pub mod port;
pub mod protocol;
pub mod queues;
pub mod safe_state;
pub mod schedule;
pub mod serial;
pub mod shared;
pub mod silence;
pub mod sized_queue;
pub mod status_light;
pub mod telemetry;
pub mod tick_handler;
pub mod timing_monitor;
pub mod timing_report;
pub mod whole_loop;
pub mod work;

/// The joint that this image is built from: `PLANETS`, `JOINT_NAME` and `TABLES`, written by the build script.
pub mod tables {
    #![allow(missing_docs, clippy::all, clippy::excessive_precision, reason = "generated numbers")]
    include!(concat!(env!("OUT_DIR"), "/tables.rs"));
}

#[cfg(target_os = "none")]
pub mod board;
#[cfg(target_os = "none")]
pub mod clock;
#[cfg(target_os = "none")]
pub mod logger;
#[cfg(all(target_os = "none", feature = "measuring"))]
pub mod measuring;
#[cfg(target_os = "none")]
pub mod panic_message;
#[cfg(target_os = "none")]
pub mod stack;
