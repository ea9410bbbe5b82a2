//! `joint twin`: joints behind drives on a bus of this machine. Clients written for finished drives connect to a
//! pseudo-terminal or to a TCP port and command the joints as if they were real.
//!
//! `joint` is one joint with its drive, `image` the joint of a firmware image; `bus` is all joints with the frames
//! between them; `can` is the arbitration and the errors of a CAN bus; crate `wires` has the forms of the frames on a
//! line; `endpoint` is the line; `clock` paces the simulation; `control` changes joints while they run and commands a
//! `mode`; `log` records; `session` combines them.

mod arguments;
mod bus;
mod bus_report;
mod can;
mod clock;
mod control;
mod endpoint;
mod event;
mod gate;
mod image;
mod joint;
mod log;
mod mapping;
mod mode;
mod protocol;
mod session;
mod summary;
pub mod terminal;

pub use arguments::Arguments;
pub use session::run;
