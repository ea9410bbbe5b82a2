//! Tools in fixed versions, installed by pip and cargo below the build directory if they are missing there: maturin, which
//! builds wheels; zig as linker, which knows old versions of the C library; mdbook.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use board::device::{Say, tool};
use report::failure::{Failure, Outcome};

/// Builder of wheels, linker, and cargo's command for that linker.
pub const PACKAGES: [&str; 3] = ["maturin==1.16.0", "ziglang==0.15.1", "cargo-zigbuild==0.24.1"];
/// Version of mdbook that the pages are written for.
const MDBOOK: &str = "0.4.52";

/// Environment of Python with `PACKAGES`.
pub struct Python {
    programs: PathBuf,
}

impl Python {
    /// Installs the packages in `folder`, once.
    pub fn prepare(folder: &Path, say: Say<'_>) -> Outcome<Self> {
        let place = folder.join(PACKAGES.join("-").replace("==", "-"));
        let found = Self { programs: place.join("bin") };
        if found.has_packages() {
            return Ok(found);
        }
        say(&format!("installing {} below the build directory, once", PACKAGES.join(", ")));
        let help = "install python3 with venv (package python3-venv), and let pip reach its index; or leave wheel and \
                    command out: --only";
        let mut create = Command::new("python3");
        create.args(["-m", "venv", "--clear"]).arg(&place);
        let mut install = Command::new(found.program("python"));
        install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]).args(PACKAGES);
        for command in [&mut create, &mut install] {
            tool::run_with_progress(command, "installing the builder of wheels and the linker", say)
                .map_err(|failure| failure.with_help(help))?;
        }
        Ok(found)
    }

    /// A program of the environment; the programs that it starts by name are the environment's, too.
    pub fn command(&self, name: &str) -> Command {
        let mut command = Command::new(self.program(name));
        let users = std::env::var_os("PATH").unwrap_or_default();
        let folders = std::iter::once(self.programs.clone()).chain(std::env::split_paths(&users));
        if let Ok(path) = std::env::join_paths(folders) {
            command.env("PATH", path);
        }
        command
    }

    fn program(&self, name: &str) -> PathBuf {
        self.programs.join(name)
    }

    fn has_packages(&self) -> bool {
        let answers =
            |program: &str, arguments: &[&str]| tool::capture_output(self.command(program).args(arguments)).is_ok();
        answers("maturin", &["--version"]) && answers("python", &["-m", "ziglang", "version"])
    }
}

/// Program mdbook.
pub fn mdbook(folder: &Path, say: Say<'_>) -> Outcome<PathBuf> {
    let place = folder.join(format!("mdbook-{MDBOOK}"));
    let program = place.join("bin/mdbook");
    if tool::is_program(&program) {
        return Ok(program);
    }
    say(&format!("building mdbook {MDBOOK} below the build directory, once"));
    let mut install = tool::cargo();
    install
        .args(["install", "mdbook", "--version", MDBOOK, "--locked", "--no-default-features", "--features", "search"])
        .arg("--root")
        .arg(&place)
        .arg("--target-dir")
        .arg(place.join("build"));
    tool::run_with_progress(&mut install, "building mdbook", say)
        .map_err(|failure| failure.with_help("let cargo reach its registry once; or leave the book out: --only"))?;
    // 300 MB that nothing reads again; a build folder that stays does no harm.
    let _ = fs::remove_dir_all(place.join("build"));
    match tool::is_program(&program) {
        true => Ok(program),
        false => Err(Failure::new(format!("cargo has installed no {}", program.display()))
            .with_help("remove its folder and start again")),
    }
}
