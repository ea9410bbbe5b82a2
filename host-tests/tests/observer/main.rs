//! The observer against the fine-step plant: gap, contact, torques, width, faults, motor only, precision, memory, probe. Tests are short
//! except the long runs `monte_carlo` and `hour`, which are ignored by default.

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
mod recording;
mod replay;
