//! C programs that test the library: compiled with tables for this machine or for an emulated one, and run to their
//! end.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use board::device::{measuring, tool};
use report::failure::{Failure, Outcome};
use report::workspace::workspace;

use crate::library::{Library, Target};
use crate::tables::CTables;

/// Warnings under which all C programs here compile.
pub const WARNINGS: [&str; 5] = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];

/// Emulated machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Machine {
    /// Name in the emulator.
    pub name: &'static str,
    /// Target of its programs.
    pub target: Target,
    /// Linker script of its memory, in `bindings/c/programs/board`.
    memory: &'static str,
}

/// All machines: an STM32F405, another Cortex-M4F, a Cortex-M33, a Cortex-M7.
pub const MACHINES: [Machine; 4] = [
    Machine { name: "netduinoplus2", target: Target::M4f, memory: "netduinoplus2.ld" },
    Machine { name: "mps2-an386", target: Target::M4f, memory: "mps2.ld" },
    Machine { name: "mps2-an505", target: Target::M33, memory: "mps2-an505.ld" },
    Machine { name: "mps2-an500", target: Target::M7, memory: "mps2.ld" },
];

/// Folder of the sources of the test programs.
pub fn folder() -> PathBuf {
    workspace().join("bindings/c/programs")
}

/// Temporary folder with the library and the tables `tables_of_test`, in which programs are compiled.
#[derive(Debug)]
pub struct Workbench {
    folder: tempfile::TempDir,
    target: Target,
}

impl Workbench {
    /// Creates the folder with its files.
    pub fn new(library: &Library, tables: &CTables) -> Outcome<Self> {
        let folder = tempfile::tempdir()
            .map_err(|error| Failure::new(format!("cannot create a folder for a build: {error}")))?;
        let bench = Self { folder, target: library.target };
        bench.write("liblostmotion.a", &library.archive)?;
        bench.write("test_tables.h", tables.header().as_bytes())?;
        bench.write("test_tables.c", tables.source().as_bytes())?;
        bench.write("tables_of_test.h", b"#include \"test_tables.h\"\n#define tables_of_test test_tables\n")?;
        Ok(bench)
    }

    /// Writes a file into the folder.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Outcome<()> {
        let path = self.path(name);
        fs::write(&path, bytes).map_err(|error| Failure::new(format!("cannot write {}: {error}", path.display())))
    }

    /// Path of a file in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Compiles a program for this machine with the caller's compiler, with the caller's flags in addition to the
    /// warnings.
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

    /// Compiles a program for an emulated machine.
    pub fn compile_for(&self, machine: Machine, sources: &[&Path], flags: &[&str]) -> Outcome<PathBuf> {
        if machine.target != self.target {
            return Err(Failure::new(format!("{} is not a machine of target {}", machine.name, self.target.name())));
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

/// Runs a program on this machine and returns its lines; a failing one becomes a failed check with its output.
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

/// Runs a program on an emulated machine and returns its lines.
pub fn run_on(machine: Machine, program: &Path) -> Outcome<Vec<String>> {
    measuring::run_on(machine.name, program)
}

/// Text after a prefix, in the first line with it.
pub fn value_after(lines: &[String], word: &str) -> Option<String> {
    lines.iter().find_map(|line| line.strip_prefix(word)).map(|rest| rest.trim().to_owned())
}
