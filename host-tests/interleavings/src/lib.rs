//! Tick, serial interrupt and idle of the firmware, unchanged, on atomics whose every ordering is explored. Only `shared` is replaced: it
//! has the same names and orderings on top of loom. The models are in `tests`.

#[path = "../../../firmware/src/conversation.rs"]
pub mod conversation;
#[path = "../../../firmware/src/intake.rs"]
pub mod intake;
#[path = "../../../firmware/src/kept_memory.rs"]
pub mod kept_memory;
#[path = "../../../firmware/src/learnt.rs"]
pub mod learnt;
#[path = "../../../firmware/src/memory_requests.rs"]
pub mod memory_requests;
pub mod port;
#[path = "../../../firmware/src/protocol.rs"]
pub mod protocol;
#[path = "../../../firmware/src/queues.rs"]
pub mod queues;
#[path = "../../../firmware/src/safe_state.rs"]
pub mod safe_state;
#[path = "../../../firmware/src/schedule.rs"]
pub mod schedule;
#[path = "../../../firmware/src/serial.rs"]
pub mod serial;
pub mod shared;
#[path = "../../../firmware/src/silence.rs"]
pub mod silence;
#[path = "../../../firmware/src/sized_queue.rs"]
pub mod sized_queue;
#[path = "../../../firmware/src/tick_handler.rs"]
pub mod tick_handler;
#[path = "../../../firmware/src/timing_monitor.rs"]
pub mod timing_monitor;
#[path = "../../../firmware/src/timing_report.rs"]
pub mod timing_report;
#[path = "../../../firmware/src/work.rs"]
pub mod work;
