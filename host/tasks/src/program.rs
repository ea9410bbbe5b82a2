//! Identity of the program that computes results: version and commit. Results of another program are not used.

use std::sync::OnceLock;

use report::provenance;

use report::digest::sha256;

static VERSION: OnceLock<String> = OnceLock::new();

/// End of a version that was built from sources that differ from their commit.
const CHANGED: &str = "changed)";

/// Sets the version of the program, with the commit of its sources; later calls have no effect.
pub fn set_version(version: &str) {
    let _ = VERSION.set(identity(version));
}

/// Identity of the program.
pub fn version() -> &'static str {
    VERSION.get_or_init(|| provenance::VERSION.to_owned())
}

/// Changed sources have no name of their own: there the digest of the executable distinguishes two builds.
fn identity(version: &str) -> String {
    let executable = || std::env::current_exe().and_then(std::fs::read).ok();
    match version.ends_with(CHANGED).then(executable).flatten() {
        Some(bytes) => format!("{version} {}", &sha256(&bytes)[..12]),
        None => version.to_owned(),
    }
}
