//! Compiles C sources over the library into a shared object of this machine, for programs that load one.

use std::fs;
use std::path::Path;
use std::process::Command;

use board::device::tool;
use report::failure::{Failure, Outcome};

use crate::library::Library;
use crate::programs::WARNINGS;

/// Flags of the C compiler: no fused multiply-add, so that every machine computes equal bits.
const FLAGS: [&str; 6] =
    ["-std=c99", "-O2", "-fPIC", "-ffp-contract=off", "-fvisibility=hidden", "-Wno-unused-parameter"];

/// Sources of a shared object.
#[derive(Debug, Default)]
pub struct Sources<'a> {
    /// Names, with slashes, and contents of all files; headers are found in `.` and `include`.
    pub files: Vec<(&'a str, &'a [u8])>,
    /// Names of the C files to compile.
    pub c_files: Vec<String>,
    /// Further flags of the compiler.
    pub flags: Vec<String>,
    /// Further files to link.
    pub objects: Vec<&'a Path>,
}

/// Compiles the sources. The names of temporary folders do not reach the result.
pub fn build(sources: &Sources, library: &Library) -> Outcome<Vec<u8>> {
    let failure = |error: std::io::Error| {
        Failure::new(format!("cannot compile C files in {}: {error}", std::env::temp_dir().display()))
            .with_help("free space there, or set TMPDIR to a folder that can be written to")
    };
    let folder = tempfile::tempdir().map_err(failure)?;
    for (name, bytes) in &sources.files {
        let path = folder.path().join(name);
        path.parent().map_or(Ok(()), fs::create_dir_all).map_err(failure)?;
        fs::write(path, bytes).map_err(failure)?;
    }
    fs::write(folder.path().join("liblostmotion.a"), &library.archive).map_err(failure)?;
    let mut command = Command::new(library.target.tool("gcc"));
    command.current_dir(folder.path()).args(WARNINGS).args(FLAGS).args(&sources.flags);
    command.args([
        "-shared",
        "-s",
        "-Wl,--gc-sections",
        "-Wl,--exclude-libs,ALL",
        "-Wl,--build-id=none",
        "-I.",
        "-Iinclude",
    ]);
    command.args(&sources.c_files).arg("liblostmotion.a").args(&sources.objects).args(["-o", "model.so"]);
    tool::capture_output(&mut command)?;
    fs::read(folder.path().join("model.so")).map_err(failure)
}
