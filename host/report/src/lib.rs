//! Common parts of every command: failures and exit codes, complete-or-nothing files, progress, interruption, checks,
//! digests, seeds, provenance, HTML pages and vector plots.

pub mod checks;
pub mod command_line;
pub mod contacts;
pub mod digest;
pub mod document;
pub mod escape;
pub mod failure;
pub mod folder;
pub mod input;
pub mod interruption;
pub mod log;
pub mod number;
pub mod output;
mod own_files;
pub mod panels;
pub mod plot;
pub mod progress;
pub mod provenance;
pub mod seeds;
pub mod spectrum;
pub mod workspace;
pub mod write;
