//! What tick, serial interrupt and idle pass to one another, in every order in which they can come to it, with every value
//! that an atomic may show. The code is the firmware's own.
//!
//! On a board the tick interrupts the two others and the serial line interrupts idle, on one core. Here all three are
//! threads that may be held up anywhere, two or three times a run: whatever a board can do is among that, and more. Each
//! model was seen to fail when what it is about was weakened:
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
//! Relaxed would do for `steps`, `running` and the horizon of a reset: what they are about comes through a queue, whose order
//! is enough. Not modelled: the inside of heapless's queues; two queues without an atomic beside them (the log, the port in
//! shared memory), which pass nothing but entries; the log's sink and the clock's counts, which exist on a board only. The
//! sink is held by one context that has masked the others, of the clock's counts each is written by one priority or added to
//! in one step, and a reader looks twice.

mod board;
mod end_of_run;
mod schedules;
mod stops;
