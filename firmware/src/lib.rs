#![cfg_attr(target_os = "none", no_std)]
//! Firmware that simulates a joint, or runs its observer and compensation, in the tick of a microcontroller; the host
//! controls it over a serial line.
//!
//! `tick_handler` is the tick of every role: it takes commands from `schedule`, steps the role's `work`, records times
//! in `timing_monitor`, ends a run when `silence` finds the host silent, and enters `safe_state` on a fault. The roles
//! are `plant`, `observer` and `whole_loop`; `protocol` defines the messages of a role. `queues` connects the tick with
//! idle; `sized_queue` makes queue accesses of the tick free of panics. `conversation` runs in idle and answers the
//! host with the help of `identity`, `intake`, `memory_requests`, `batcher`, `telemetry` and `timing_report`; `serial`
//! moves the bytes. Role `drive` has neither host nor protocol of its own: `drive` is its tick, `can` its line. `port`
//! is the interface between a motor controller and observer with compensation, `encoder` reads the counts, `learnt`
//! holds the estimated parameters between runs, `kept_memory` stores them in flash. All of these are independent of the
//! hardware and tested on the host. `board`, `clock`, `logger`, `panic_message` and `stack` exist on a board only,
//! `measuring` in the emulator only. The physics is in `model-core`, the messages are in `link`.

pub mod batcher;
pub mod can;
pub mod conversation;
pub mod drive;
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
