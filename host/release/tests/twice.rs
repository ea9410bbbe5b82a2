//! A release of the last commit, built in two clones whose paths differ in length: equal bytes, digests that `sha256sum`
//! accepts, no folder of the machine in any file, and an SBOM that follows its published schema.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use report::workspace::workspace;

/// Validator of CycloneDX with the published schemas.
const VALIDATOR: &str = "cyclonedx-python-lib[json-validation]==11.12.0";
/// Program that validates the file of its first argument.
const VALIDATE: &str = "import sys; from cyclonedx.schema import SchemaVersion; from cyclonedx.validation.json import JsonStrictValidator; \
                        error = JsonStrictValidator(SchemaVersion.V1_5).validate_str(open(sys.argv[1]).read()); sys.exit(str(error) if error else 0)";
/// Arguments of `joint release` in place of none, such as `--only book,libraries`.
const ARGUMENTS: &str = "RELEASE_ARGUMENTS";

fn run(command: &mut Command) {
    let status = command.status().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    assert!(status.success(), "{command:?}: {status}");
}

/// Releases the last commit in a new clone.
fn release(clone: &Path) -> PathBuf {
    run(Command::new("git").args(["clone", "--quiet"]).arg(workspace()).arg(clone));
    let out = clone.join("dist");
    let mut command = Command::new("cargo");
    command.args(["run", "--quiet", "--package", "release", "--", "--out"]).arg(&out);
    command.args(std::env::var(ARGUMENTS).unwrap_or_default().split_whitespace());
    run(command.current_dir(clone).env("CARGO_TARGET_DIR", clone.join("target")));
    out
}

/// Files below a folder, in order of their paths relative to it.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let (mut found, mut folders) = (Vec::new(), vec![folder.to_path_buf()]);
    while let Some(inner) = folders.pop() {
        for entry in fs::read_dir(inner).expect("a folder") {
            let path = entry.expect("an entry").path();
            match path.is_dir() {
                true => folders.push(path),
                false => {
                    let bytes = fs::read(&path).expect("a file");
                    found.push((path.strip_prefix(folder).expect("below it").to_path_buf(), bytes));
                }
            }
        }
    }
    found.sort();
    found
}

/// Two clones give the same bytes.
#[test]
#[ignore = "builds a release twice: cargo test -p release --test twice -- --ignored --nocapture"]
fn two_clones_give_equal_bytes() {
    let place = tempfile::tempdir().expect("a folder");
    let outs = ["a", "another-clone-below/a-folder"].map(|name| release(&place.path().join(name)));
    let [one, other] = outs.each_ref().map(|out| files(out));
    let names = |files: &[(PathBuf, Vec<u8>)]| files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&one), names(&other));
    let different: Vec<&Path> =
        one.iter().zip(&other).filter(|(one, other)| one != other).map(|((name, _), _)| name.as_path()).collect();
    assert!(different.is_empty(), "{different:?} differ");
    // In a compressed wheel nothing is found: its library is that of the command.
    let registry = Path::new(&std::env::var("HOME").expect("a home")).join(".cargo");
    let folders = [place.path(), &registry].map(|folder| folder.to_str().expect("a path").to_owned());
    for (name, bytes) in &one {
        for folder in &folders {
            let names_it = bytes.windows(folder.len()).any(|part| part == folder.as_bytes());
            assert!(!names_it, "{} names {folder}", name.display());
        }
        println!("{:>11} B  {}", bytes.len(), name.display());
    }
    run(Command::new("sha256sum").args(["--check", "--strict", "--quiet", "SHA256SUMS"]).current_dir(&outs[1]));
    let python = place.path().join("python");
    run(Command::new("python3").args(["-m", "venv"]).arg(&python));
    let python = python.join("bin/python");
    run(Command::new(&python).args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", VALIDATOR]));
    run(Command::new(&python).args(["-c", VALIDATE]).arg(outs[0].join("sbom.cdx.json")));
}
