//! C programs that try the library: compiled with tables beside them, for this machine or for one of the emulator's, and
//! run to their end.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use board::device::{measuring, tool};
use report::failure::{Failure, Outcome};
use report::workspace::workspace;

use crate::library::{Library, Target};
use crate::tables::CTables;

/// What C programs here are clean under.
pub const WARNINGS: [&str; 5] = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];

/// A machine of the emulator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Machine {
    /// As the emulator calls it.
    pub name: &'static str,
    /// What its programs are compiled for.
    pub target: Target,
    /// Its memory, a linker script of `bindings/c/programs/board`.
    memory: &'static str,
}

/// The machines: an STM32F405, another Cortex-M4F, a Cortex-M33, a Cortex-M7.
pub const MACHINES: [Machine; 4] = [
    Machine { name: "netduinoplus2", target: Target::M4f, memory: "netduinoplus2.ld" },
    Machine { name: "mps2-an386", target: Target::M4f, memory: "mps2.ld" },
    Machine { name: "mps2-an505", target: Target::M33, memory: "mps2-an505.ld" },
    Machine { name: "mps2-an500", target: Target::M7, memory: "mps2.ld" },
];

/// Sources of programs that try the library.
pub fn folder() -> PathBuf {
    workspace().join("bindings/c/programs")
}

/// A folder with the library and tables called `tables_of_test`, for programs to be compiled in.
#[derive(Debug)]
pub struct Workbench {
    folder: tempfile::TempDir,
    target: Target,
}

impl Workbench {
    /// Puts everything in place.
    pub fn new(library: &Library, tables: &CTables) -> Outcome<Self> {
        let folder = tempfile::tempdir().map_err(|error| Failure::new(format!("no folder for a build: {error}")))?;
        let bench = Self { folder, target: library.target };
        bench.write("liblostmotion.a", &library.archive)?;
        bench.write("test_tables.h", tables.header().as_bytes())?;
        bench.write("test_tables.c", tables.source().as_bytes())?;
        bench.write("tables_of_test.h", b"#include \"test_tables.h\"\n#define tables_of_test test_tables\n")?;
        Ok(bench)
    }

    /// Writes a file into it.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Outcome<()> {
        let path = self.path(name);
        fs::write(&path, bytes).map_err(|error| Failure::new(format!("cannot write {}: {error}", path.display())))
    }

    /// A file in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Compiles a program for this machine, with flags of the caller's beside the warnings, by a compiler of the caller's.
    pub fn compile(&self, compiler: &str, sources: &[&Path], flags: &[&str]) -> Outcome<PathBuf> {
        let program = self.path("program");
        let mut command = Command::new(compiler);
        command
            .current_dir(self.folder.path())
            .args(WARNINGS)
            .args(flags)
            .arg("-I.")
            .arg("-I")
            .arg(crate::library::include())
            .arg("-I")
            .arg(folder());
        command
            .args(sources)
            .arg(folder().join("host.c"))
            .args(["test_tables.c", "liblostmotion.a", "-lm", "-o"])
            .arg(&program);
        tool::capture_output(&mut command)?;
        Ok(program)
    }

    /// Compiles a program for a machine of the emulator.
    pub fn compile_for(&self, machine: Machine, sources: &[&Path], flags: &[&str]) -> Outcome<PathBuf> {
        if machine.target != self.target {
            return Err(Failure::new(format!("{} is no {}", machine.name, self.target.name())));
        }
        let (program, board) = (self.path(&format!("{}.elf", machine.name)), folder().join("board"));
        let mut command = Command::new(self.target.tool("gcc"));
        command.current_dir(self.folder.path()).args(self.target.c_flags()).args(WARNINGS).args(flags);
        command.args(["-std=c99", "-ffunction-sections", "-fdata-sections", "-nostartfiles", "-Wl,--gc-sections"]);
        command
            .arg("-I.")
            .arg("-I")
            .arg(crate::library::include())
            .arg("-I")
            .arg(folder())
            .arg("-L")
            .arg(&board)
            .arg("-T")
            .arg(board.join(machine.memory));
        command
            .args(sources)
            .arg(board.join("start.c"))
            .args(["test_tables.c", "liblostmotion.a", "-lm", "-lgcc", "-o"])
            .arg(&program);
        tool::capture_output(&mut command)?;
        Ok(program)
    }
}

/// Runs a program of this machine; its lines. One that fails is a failed check with what it said.
pub fn run(program: &Path, arguments: &[&str]) -> Outcome<Vec<String>> {
    let output = Command::new(program)
        .args(arguments)
        .output()
        .map_err(|error| Failure::new(format!("{}: {error}", program.display())))?;
    let said = String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        let other = String::from_utf8_lossy(&output.stderr);
        return Err(Failure::check_failed(format!("a C program failed ({}):\n{said}{other}", output.status)));
    }
    Ok(said.lines().map(str::to_owned).collect())
}

/// Runs a program on a machine of the emulator; its lines.
pub fn run_on(machine: Machine, program: &Path) -> Outcome<Vec<String>> {
    measuring::run_on(machine.name, program)
}

/// What a line says after a word.
pub fn said(lines: &[String], word: &str) -> Option<String> {
    lines.iter().find_map(|line| line.strip_prefix(word)).map(|rest| rest.trim().to_owned())
}
