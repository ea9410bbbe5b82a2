//! Logs of joints as users bring them: text and MCAP files as columns of numbers in SI, row by row.
//!
//! `log_file` reads a file into `columns`, text by `text_table`, an MCAP log by `mcap_file`, `mcap_log` and `ros_message`,
//! message by message as `numbers`; `units` and `column_map` say what the columns are. `time_stamps` gives rows times of their
//! own, `bad_readings` leaves out what no encoder gives, and a `register` joins counts that begin anew.

pub mod bad_readings;
pub mod column_map;
pub mod columns;
pub mod log_file;
mod mcap_file;
mod mcap_log;
mod numbers;
pub mod register;
mod ros_message;
mod text_table;
pub mod time_stamps;
pub mod units;
