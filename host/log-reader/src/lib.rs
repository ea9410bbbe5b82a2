//! Logs of joints as users bring them: text and MCAP files as columns of numbers in SI, row by row.
//!
//! `log_file` reads a file into `columns`, text by `text_table`, an MCAP log by `mcap_file`, `mcap_log` and `ros_message`,
//! message by message as `numbers`; `units` and `column_map` say what the columns are. `time_stamps` gives rows times of their
//! own, `bad_readings` leaves out what no encoder gives, and a `register` joins counts that begin anew. `readings` are an encoder's counts or
//! angles at `even_times`, whose scatter is `noise`.

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
