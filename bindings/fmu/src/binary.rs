//! Compiles the sources of an FMU over the C library into a shared library of this machine.

use std::fs;
use std::process::Command;

use board::device::tool;
use c_library::library::Library;
use c_library::programs::WARNINGS;
use report::failure::{Failure, Outcome};

use crate::archive::File;
use crate::model::{Fmi, Model};
use crate::sources::{FLAGS, c_files};

/// Folder of the binary for this machine, in `binaries`.
pub fn platform(fmi: Fmi) -> &'static str {
    match (fmi, cfg!(target_arch = "x86_64")) {
        (Fmi::Two, true) => "linux64",
        (Fmi::Three, true) => "x86_64-linux",
        // FMI 2 has no name for it; importers use the one of FMI 3.
        (_, false) => "aarch64-linux",
    }
}

/// Compiles the sources. The names of temporary folders do not reach the result.
pub fn build(model: &Model, sources: &[File], library: &Library) -> Outcome<Vec<u8>> {
    let failure = |error: std::io::Error| {
        Failure::new(format!("cannot build the FMU in {}: {error}", std::env::temp_dir().display()))
            .with_help("free space there, or set TMPDIR to a folder that can be written to")
    };
    let folder = tempfile::tempdir().map_err(failure)?;
    for file in sources {
        let path = folder.path().join(&file.name);
        path.parent().map_or(Ok(()), fs::create_dir_all).map_err(failure)?;
        fs::write(path, &file.bytes).map_err(failure)?;
    }
    fs::write(folder.path().join("liblostmotion.a"), &library.archive).map_err(failure)?;
    let mut command = Command::new(library.target.tool("gcc"));
    command.current_dir(folder.path()).args(WARNINGS).args(FLAGS);
    command.args([
        "-shared",
        "-s",
        "-Wl,--gc-sections",
        "-Wl,--exclude-libs,ALL",
        "-Wl,--build-id=none",
        "-I.",
        "-Iinclude",
    ]);
    command.args(c_files(model)).args(["liblostmotion.a", "-o", "model.so"]);
    tool::capture_output(&mut command)?;
    fs::read(folder.path().join("model.so")).map_err(failure)
}
