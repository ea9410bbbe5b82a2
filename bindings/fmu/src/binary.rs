//! Compiles the sources of an FMU over the C library into a shared library of this machine.

use c_library::library::Library;
use c_library::shared_object::{self, Sources};
use report::failure::Outcome;

use crate::archive::File;
use crate::model::{Fmi, Model};
use crate::sources::c_files;

/// Folder of the binary for this machine, in `binaries`.
pub fn platform(fmi: Fmi) -> &'static str {
    match (fmi, cfg!(target_arch = "x86_64")) {
        (Fmi::Two, true) => "linux64",
        (Fmi::Three, true) => "x86_64-linux",
        // FMI 2 has no name for it; importers use the one of FMI 3.
        (_, false) => "aarch64-linux",
    }
}

/// Compiles the sources.
pub fn build(model: &Model, sources: &[File], library: &Library) -> Outcome<Vec<u8>> {
    let files = sources.iter().map(|file| (file.name.as_str(), &file.bytes[..])).collect();
    shared_object::build(&Sources { files, c_files: c_files(model), ..Sources::default() }, library)
}
