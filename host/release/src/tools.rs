//! maturin and mdbook in fixed versions, installed by pip and cargo below the build directory if they are missing there.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use board::device::{Say, tool};
use report::failure::{Failure, Outcome};

/// Version of maturin that wheels are built with, as the wheel's test does.
const MATURIN: &str = "maturin==1.16.0";
/// Version of mdbook that the pages are written for.
const MDBOOK: &str = "0.4.52";

/// Interpreter with maturin.
pub fn python_with_maturin(folder: &Path, say: Say<'_>) -> Outcome<PathBuf> {
    let place = folder.join(MATURIN.replace("==", "-"));
    let python = place.join("bin/python");
    let has_maturin = || tool::capture_output(Command::new(&python).args(["-m", "maturin", "--version"])).is_ok();
    if has_maturin() {
        return Ok(python);
    }
    say(&format!("installing {MATURIN} below the build directory, once"));
    let help =
        "install python3 with venv (package python3-venv), and let pip reach its index; or leave the wheel out: --only";
    let mut create = Command::new("python3");
    create.args(["-m", "venv", "--clear"]).arg(&place);
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", MATURIN]);
    for command in [&mut create, &mut install] {
        tool::run_with_progress(command, &format!("installing {MATURIN}"), say)
            .map_err(|failure| failure.with_help(help))?;
    }
    Ok(python)
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
