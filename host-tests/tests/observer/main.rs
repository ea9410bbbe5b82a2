//! The observer against the fine-step plant: gap, contact, torques, width, faults, motor only, precision, memory, probe.
//! Each test is short; `monte_carlo` is the long run over many seeds, and is ignored by default.

mod experiment;
mod faults;
mod gap;
mod hour;
mod late;
mod learning;
mod memory;
mod monte_carlo;
mod motion;
mod motor_only;
mod page;
mod precision;
mod presets;
mod probe;
mod replay;
