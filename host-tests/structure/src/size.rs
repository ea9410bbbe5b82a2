//! Reading effort: lines of Rust in a crate, with blank lines and comments.
//!
//! Tests and benches are excluded, since they are read one at a time. Three crates hold many independent subjects and are measured a folder
//! at a time: `model-core`, `drives`, and `host-tests`, whose content is tests.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::members::Member;

/// Largest size of a crate [lines], chosen at the start of the split: 8,000 lines and a margin.
pub const LIMIT: usize = 8_500;

/// Crates measured by subject.
pub const BY_SUBJECT: [&str; 3] = ["model-core", "drives", "host-tests"];

/// Lines of a crate, or of each subject's folder, by name. `files` are the crate's sources, whose paths begin at the
/// workspace's root, with their lines.
pub fn sizes(member: &Member, files: &[(PathBuf, usize)]) -> BTreeMap<String, usize> {
    let by_subject = BY_SUBJECT.contains(&member.name.as_str());
    let mut sizes = BTreeMap::new();
    for (path, lines) in files {
        let inside = path.strip_prefix(&member.folder).unwrap_or(path);
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let tests = is_test(&name);
        if tests || !by_subject && (inside.starts_with("tests") || inside.starts_with("benches")) {
            continue;
        }
        let subject = inside.components().take(2).collect::<PathBuf>().with_extension("");
        let subject = if by_subject { member.folder.join(subject) } else { Path::new(&member.name).to_path_buf() };
        *sizes.entry(subject.display().to_string()).or_insert(0) += lines;
    }
    sizes
}

/// True for the name of a file that only tests need: `tests`, `x_tests`, `test_x`.
pub fn is_test(name: &str) -> bool {
    name == "tests" || name.ends_with("_tests") || name.starts_with("test_")
}

/// Lines of a source without its unit tests, which stand at its end.
pub fn lines(text: &str) -> usize {
    text.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default().lines().count()
}

/// Crates and subjects above the limit.
pub fn too_large(sizes: &BTreeMap<String, usize>) -> Vec<String> {
    let text = |(name, lines): (&String, &usize)| {
        format!("{name} has {lines} lines, more than {LIMIT}\n  help: move a subject into a crate of its own")
    };
    sizes.iter().filter(|(_, lines)| **lines > LIMIT).map(text).collect()
}
