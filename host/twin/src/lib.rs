//! `joint twin`: joints behind drives on a bus of this machine. Clients written for finished drives connect to a
//! pseudo-terminal or to a TCP port and command the joints as if they were real.
//!
//! `joint` is one joint with its drive, `image` the joint of a firmware image; `bus` is all joints with the frames
//! between them; crate `wires` has the forms of the frames on a line; `endpoint` is the line; `clock` paces the
//! simulation; `control` changes joints while they run; `log` records; `session` combines them.

mod arguments;
mod bus;
mod clock;
mod control;
mod endpoint;
mod event;
mod image;
mod joint;
mod log;
mod mapping;
mod protocol;
mod session;
mod summary;
pub mod terminal;
mod truth;

pub use arguments::Arguments;
pub use session::run;
