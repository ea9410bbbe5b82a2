//! A joint as an FMU (Functional Mock-up Unit) for FMI 2.0 and 3.0, plant or controller: `joint export --fmu`. `variables` lists
//! what crosses the interface; `description` writes it as modelDescription.xml, `sources` as C beside the wrapper of
//! `bindings/fmu/c`; `binary` compiles both over the C library; `archive` packs all of it.

pub mod archive;
mod binary;
mod description;
pub mod export;
pub mod model;
mod sources;
pub mod variables;
