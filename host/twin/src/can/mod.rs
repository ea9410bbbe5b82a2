//! CAN bus of the twin: length of frames in bits, arbitration, errors and their counters.
//!
//! Documents: ISO 11898-1 (2015), chapters 10 (frames, bit stuffing) and 12 (error counters and states).

mod medium;
mod node;
mod statistics;

pub use medium::{Event, Medium, Rate};
pub use node::ErrorState;
