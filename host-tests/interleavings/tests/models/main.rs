//! Data passed between tick, serial interrupt and idle, in every order and with every value that an atomic may show. The code is the
//! firmware's own.
//!
//! On a board the tick interrupts the two others and the serial line interrupts idle, on one core. Here all three are threads that may be
//! suspended anywhere, two or three times a run, which includes all that a board can do, and more. Each model was seen to fail when its
//! subject was weakened:
//!
//! | in `firmware/src` | changed | found by |
//! |---|---|---|
//! | `serial.rs` | `frames` stored, or looked at, Relaxed; counted before `stops` | all that see a frame see its stop |
//! | `serial.rs` | `stops` stored, or looked at, Relaxed | every byte before a stop |
//! | `tick_handler.rs` | `stops` looked at before `frames` in a tick | the tick that finds a stop |
//! | `tick_handler.rs` | a reset without a look at `stops` | stops that idle has read |
//! | `conversation.rs` | idle looks at `stops` after it has read, not before | stops that idle has read |
//! | `intake.rs`, `tick_handler.rs` | `horizon` stored, or looked at, Relaxed; stored before the commands | commands |
//! | `tick_handler.rs` | the horizon of the run before stays | a run that follows another |
//! | `tick_handler.rs` | the answer to a reset given before `running` is set | a run that follows another |
//! | `tick_handler.rs` | a trip told before the last sample is handed out | the end of a run |
//! | `conversation.rs` | idle looks for samples before it looks for the event | the end of a run |
//! | `sized_queue.rs` | the first entry looked at without the fence | commands, the end of a run |
//!
//! Relaxed would suffice for `steps`, `running` and the horizon of a reset, since a queue orders the data that they announce. Not modelled:
//! the inside of heapless's queues; two queues without an atomic beside them (the log, the port in shared memory), which pass nothing but
//! entries; the log's sink and the clock's counts, which exist on a board only. The sink is held by one context that has masked the others;
//! each of the clock's counts is written by one priority or incremented atomically, and a reader reads twice.

mod board;
mod end_of_run;
mod schedules;
mod stops;
