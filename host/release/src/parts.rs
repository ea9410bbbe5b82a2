//! Parts of a release, each built by the tool or command that users have for it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use board::device::board::Board;
use board::device::image;
use board::device::tick_time::RateCheck;
use board::device::toolchain::{Toolchain, target_directory};
use board::device::{Say, tool};
use c_library::library::{self, Target};
use c_library::package;
use c_library::tarball::{self, Entry};
use joint_file::named;
use link::messages::Role;
use report::failure::{Failure, Outcome};
use report::workspace::workspace;

use crate::contents::{File, LeftOut};
use crate::paths::reproducible;
use crate::sbom::NOTICES;
use crate::source::Source;
use crate::tools::{self, Python};

/// Version of a release, equal to the workspace's.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Oldest C library that wheel and command run on: the oldest one that Rust's standard library supports.
const OLDEST_GLIBC: &str = "2.17";
/// Role of the images: the joint itself, which needs no parameters of a user's own joint.
const ROLE: Role = Role::Plant;

/// Builds of a release.
pub struct Builds<'b> {
    /// Commit.
    pub source: &'b Source,
    /// Build directory, apart from that of daily builds: the flags differ.
    pub folder: &'b Path,
    /// Messages for the user.
    pub say: Say<'b>,
}

/// Build directory of releases.
pub fn build_folder() -> PathBuf {
    target_directory().join("for-release")
}

/// Tag of a wheel for the oldest C library.
fn oldest_tag() -> String {
    format!("manylinux_{}", OLDEST_GLIBC.replace('.', "_"))
}

/// Python wheel, by maturin.
pub fn wheel(builds: &Builds<'_>) -> Outcome<File> {
    let python = Python::prepare(&builds.folder.join("tools"), builds.say)?;
    let out = new_folder(&builds.folder.join("wheel"))?;
    let mut command = python.command("maturin");
    reproducible(&mut command, builds.source, builds.folder)
        .current_dir(workspace().join("bindings/python"))
        .args(["build", "--release", "--locked", "--zig", "--compatibility", &oldest_tag(), "--out"])
        .arg(&out)
        .arg("--target-dir")
        .arg(builds.folder);
    tool::run_with_progress(&mut command, "building the wheel", builds.say)?;
    let (name, bytes) = files(&out)?.pop().ok_or_else(|| Failure::new("maturin has built no wheel"))?;
    let tag = name.trim_end_matches(".whl").rsplit('-').next().unwrap_or_default().to_owned();
    Ok(File {
        what: format!("Python module `lostmotion` and command `joint`: pip install {name}"),
        target: tag,
        path: name,
        bytes,
    })
}

/// The command `joint` with its test files, as an archive for this kind of machine.
pub fn program(builds: &Builds<'_>, notices: &[u8]) -> Outcome<File> {
    let python = Python::prepare(&builds.folder.join("tools"), builds.say)?;
    let triple = format!("{}-unknown-linux-gnu", std::env::consts::ARCH);
    let mut command = python.command("cargo-zigbuild");
    reproducible(&mut command, builds.source, builds.folder)
        .args(["zigbuild", "--release", "--locked", "--package", "joint", "--bin", "joint"])
        .args(["--target", &format!("{triple}.{OLDEST_GLIBC}"), "--target-dir"])
        .arg(builds.folder);
    tool::run_with_progress(&mut command, "building the command", builds.say)?;
    let target = format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS);
    let prefix = format!("lostmotion-{VERSION}-{target}");
    let program = read(&builds.folder.join(triple).join("release/joint"))?;
    if let Some(found) = newest_glibc(&program).filter(|found| !is_within(found, OLDEST_GLIBC)) {
        return Err(Failure::new(format!("bin/joint needs glibc {found}, newer than {OLDEST_GLIBC}")));
    }
    let mut entries = vec![
        ("LICENSE".to_owned(), Entry::File(read(&workspace().join("LICENSE"))?)),
        (NOTICES.to_owned(), Entry::File(notices.to_vec())),
        ("bin/joint".to_owned(), Entry::Program(program)),
    ];
    let tests = files(&workspace().join("hil"))?;
    let named = |(name, bytes)| (format!("share/lostmotion/hil/{name}"), Entry::File(bytes));
    entries.extend(tests.into_iter().map(named));
    Ok(File {
        path: format!("{prefix}.tar"),
        what: "command `joint` with its test files: unpack it, then run bin/joint".to_owned(),
        target,
        bytes: tarball::pack(&prefix, entries)?,
    })
}

/// Newest version of glibc whose symbols a program needs: the versions stand in it as `GLIBC_2.17`.
fn newest_glibc(program: &[u8]) -> Option<String> {
    const MARK: &[u8] = b"GLIBC_";
    let versions = program.windows(MARK.len()).enumerate().filter(|(_, window)| *window == MARK).map(|(at, _)| {
        let digits = program[at + MARK.len()..].iter().take_while(|byte| byte.is_ascii_digit() || **byte == b'.');
        digits.map(|byte| char::from(*byte)).collect::<String>()
    });
    versions.max_by_key(|version| numbers(version))
}

fn is_within(version: &str, oldest: &str) -> bool {
    numbers(version) <= numbers(oldest)
}

fn numbers(version: &str) -> Vec<u32> {
    version.split('.').map(|number| number.parse().unwrap_or(0)).collect()
}

/// Library for C and C++ for each target, by `joint library`.
pub fn libraries(builds: &Builds<'_>) -> Outcome<Vec<File>> {
    let build = |target: Target| {
        (builds.say)(&format!("building the library for {}", target.name()));
        let library = library::build(target, "library", builds.say)?;
        let host = format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS);
        Ok(File {
            path: format!("{}.tar", package::prefix(target)),
            what: "library for C and C++: header, library, build files, costs, test program".to_owned(),
            target: if target == Target::Host { host } else { target.name().to_owned() },
            bytes: package::archive(&library, builds.say)?,
        })
    };
    [Target::M4f, Target::M33, Target::M7, Target::Host].into_iter().map(build).collect()
}

/// Images of preset joints for boards, by `joint image`; an image that no board has room or time for is left out.
pub fn images(builds: &Builds<'_>, joints: &[&str], boards: &[Board]) -> Outcome<(Vec<File>, Vec<LeftOut>)> {
    let toolchain = Toolchain::prepare(builds.say)?.for_release(builds.folder);
    Target::M4f.prepare(builds.say)?;
    let (mut files, mut left_out) = (Vec::new(), Vec::new());
    // All joints of a board follow one another, so that cargo keeps what it has built for the chip.
    for board in boards {
        for joint in joints {
            let name = format!("{joint}-{}-{}", board.name(), image::role_name(ROLE));
            (builds.say)(&format!("building images/{name}.elf"));
            match built(builds, &toolchain, joint, board, &name)? {
                Ok(file) => files.push(file),
                Err(why) => left_out.push(LeftOut { path: format!("images/{name}.elf"), why }),
            }
        }
    }
    Ok((files, left_out))
}

/// Image of a joint for a board, or the reason why the board cannot run it.
fn built(
    builds: &Builds<'_>,
    toolchain: &Toolchain,
    joint: &str,
    board: &Board,
    name: &str,
) -> Outcome<Result<File, String>> {
    let parameters = named::load(Path::new(joint))?.file.parameters;
    let check = RateCheck::new(&parameters, board, ROLE);
    let usual = image::DEFAULT_TICK_RATE;
    let rate = if check.check(usual).is_ok() { Some(usual) } else { check.nearest_accepted(usual) };
    let Some(rate) = rate else {
        return Ok(Err(check.check(usual).err().map_or_else(String::new, |f| f.message().to_owned())));
    };
    let file = image::preset_file(joint);
    let elf = match image::build_image(toolchain, &file, board, ROLE, rate, false, builds.say) {
        Ok(image) => image.elf,
        Err(failure) if failure.message().contains(image::TOO_LARGE) => return Ok(Err(failure.message().to_owned())),
        Err(failure) => return Err(failure),
    };
    let out = new_folder(&builds.folder.join("stripped"))?.join(name);
    let mut strip = Command::new(Target::M4f.tool("objcopy"));
    tool::capture_output(strip.arg("--strip-debug").arg(elf).arg(&out))?;
    Ok(Ok(File {
        path: format!("images/{name}.elf"),
        what: format!("firmware, preset {joint} at {rate} Hz; never ran on silicon"),
        target: board.name().to_owned(),
        bytes: read(&out)?,
    }))
}

/// Pages of `docs` as a book, by mdbook, after the house's check of their links.
pub fn book(builds: &Builds<'_>) -> Outcome<File> {
    let mut check = tool::cargo();
    check.current_dir(workspace()).args([
        "test",
        "--quiet",
        "--locked",
        "--package",
        "structure",
        "--test",
        "workspace",
    ]);
    check.args(["--", "every_link_has_a_target", "book_lists_every_page"]);
    // The findings stand on standard output.
    tool::capture_output(&mut check).map_err(|failure| {
        failure.while_doing("checking the links of the pages").with_help("run: cargo test -p structure")
    })?;
    let mdbook = tools::mdbook(&builds.folder.join("tools"), builds.say)?;
    let out = new_folder(&builds.folder.join("book"))?;
    let mut command = Command::new(mdbook);
    command.current_dir(workspace()).args(["build", "docs", "--dest-dir"]).arg(&out);
    tool::run_with_progress(&mut command, "building the book", builds.say)?;
    let prefix = format!("lostmotion-{VERSION}-book");
    let entries = files(&out)?.into_iter().map(|(name, bytes)| (name, Entry::File(bytes))).collect();
    Ok(File {
        path: format!("{prefix}.tar"),
        what: "all pages of docs as a book with search: unpack it, then open index.html".to_owned(),
        target: "any".to_owned(),
        bytes: tarball::pack(&prefix, entries)?,
    })
}

/// Empty folder in place of an earlier one.
fn new_folder(folder: &Path) -> Outcome<PathBuf> {
    let _ = fs::remove_dir_all(folder);
    report::folder::make(folder)?;
    Ok(folder.to_path_buf())
}

fn read(path: &Path) -> Outcome<Vec<u8>> {
    fs::read(path).map_err(|error| Failure::new(format!("{}: {error}", path.display())))
}

/// Files below a folder, in order of their paths relative to it.
fn files(folder: &Path) -> Outcome<Vec<(String, Vec<u8>)>> {
    let unreadable = |path: &Path, error: &std::io::Error| Failure::new(format!("{}: {error}", path.display()));
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(inner) = folders.pop() {
        for entry in fs::read_dir(&inner).map_err(|error| unreadable(&inner, &error))? {
            let path = entry.map_err(|error| unreadable(&inner, &error))?.path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let name = path.strip_prefix(folder).unwrap_or(&path).to_string_lossy().into_owned();
            found.push((name, read(&path)?));
        }
    }
    found.sort();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Versions are compared by their numbers, and private ones are none.
    #[test]
    fn newest_glibc_is_found() {
        let program = b"\0GLIBC_2.9\0GLIBC_PRIVATE\0GLIBC_2.17\0GLIBC_2.2.5\0";
        let found = newest_glibc(program).expect("a version");
        assert_eq!(found, "2.17");
        assert!(is_within(&found, OLDEST_GLIBC) && !is_within("2.18", OLDEST_GLIBC) && !is_within("3.0", OLDEST_GLIBC));
        assert_eq!(newest_glibc(b"static"), None);
    }

    /// The order of an archive does not depend on that of the folder.
    #[test]
    fn files_are_sorted_by_path() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["c", "a/z", "b", "a/b/c"] {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("room");
            fs::write(path, name).expect("room");
        }
        let found: Vec<String> = files(folder.path()).expect("readable").into_iter().map(|(name, _)| name).collect();
        assert_eq!(found, ["a/b/c", "a/z", "b", "c"]);
    }
}
