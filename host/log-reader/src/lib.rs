//! Logs of joints in users' formats: text and MCAP files as columns of numbers in SI, row by row.
//!
//! `log_file` reads a file into `columns`: text through `text_table`, an MCAP log through `mcap_file`, `mcap_log` and
//! `ros_message`, message by message as `numbers`. `units` and `column_map` name the columns and their units.
//! `time_stamps` gives each row its own time, `bad_readings` removes readings that no encoder gives, and a `register`
//! joins wrapped counts. `readings` are an encoder's counts or angles at `even_times`; `noise` is their variance.

pub mod bad_readings;
pub mod column_map;
pub mod columns;
pub mod even_times;
pub mod log_file;
mod mcap_file;
mod mcap_log;
pub mod noise;
mod numbers;
pub mod readings;
pub mod register;
pub mod resolution;
mod ros_message;
mod text_table;
pub mod time_stamps;
pub mod units;
