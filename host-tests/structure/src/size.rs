//! Reading effort: lines of Rust in a crate, with blank lines and comments.
//!
//! Tests and benches are excluded, since they are read one at a time. Two crates hold many independent subjects and are measured a folder
//! at a time: `model-core`, and `host-tests`, whose content is tests.

use std::collections::BTreeMap;
use std::path::Path;

use crate::graph::Graph;
use crate::members::Member;

/// Largest size of a crate [lines], chosen at the start of the split: 8,000 lines and a margin.
pub const LIMIT: usize = 8_500;

/// Crates measured by subject.
pub const BY_SUBJECT: [&str; 2] = ["model-core", "host-tests"];

/// Lines of a crate, or of each subject's folder, by name.
pub fn sizes(member: &Member, graphs: &[(String, Graph)]) -> BTreeMap<String, usize> {
    let by_subject = BY_SUBJECT.contains(&member.name.as_str());
    let mut files = BTreeMap::new();
    for (kind, graph) in graphs {
        if by_subject || !matches!(kind.as_str(), "test" | "bench") {
            files.extend(graph.sources.files.iter().map(|file| (&file.path, file.lines)));
        }
    }
    let mut sizes = BTreeMap::new();
    for (path, lines) in files {
        let subject = path.strip_prefix(&member.folder).unwrap_or(path).components().take(2);
        let subject = subject.collect::<std::path::PathBuf>().with_extension("");
        let subject = if by_subject { member.folder.join(subject) } else { Path::new(&member.name).to_path_buf() };
        *sizes.entry(subject.display().to_string()).or_insert(0) += lines;
    }
    sizes
}

/// Crates and subjects above the limit.
pub fn too_large(sizes: &BTreeMap<String, usize>) -> Vec<String> {
    let text = |(name, lines): (&String, &usize)| {
        format!("{name} has {lines} lines, more than {LIMIT}\n  help: move a subject into a crate of its own")
    };
    sizes.iter().filter(|(_, lines)| **lines > LIMIT).map(text).collect()
}
