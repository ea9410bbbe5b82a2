//! Third-party packages of the workspace: their source and their licence.

use std::path::Path;

use serde_json::Value;

use crate::cargo;

/// Prefix of the source of a package from a registry, as opposed to a repository.
const REGISTRY: &str = "registry+";

/// Licences allowed for dependencies: most of them require a notice at most. MPL-2.0 requires its own files to stay open, which they do.
const LICENCES: [&str; 12] = [
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "ISC",
    "MIT",
    "MPL-2.0",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// Packages of `Cargo.lock`, for every platform, from a source other than the registry of the first package; members of the workspace have
/// no source.
pub fn foreign(lock: &str) -> Vec<String> {
    let source = |line: &str| line.strip_prefix("source = \"").map(|rest| rest.trim_end_matches('"').to_string());
    let mut sources = lock.lines().filter_map(source).peekable();
    let first = sources.peek().cloned().unwrap_or_default();
    let foreign = sources.filter(|source| !source.starts_with(REGISTRY) || *source != first);
    foreign
        .map(|source| format!("Cargo.lock: a package from {source}\n  help: use a package of the registry"))
        .collect()
}

/// Returns true if an SPDX expression permits one of the licences; a slash is an old form of OR.
pub fn is_allowed(licence: &str) -> bool {
    let mut words = Vec::<String>::new();
    for word in licence.replace('(', " ( ").replace(')', " ) ").replace('/', " OR ").split_whitespace() {
        match words.last_mut() {
            // An exception belongs to the licence before it.
            Some(last) if word == "WITH" || last.ends_with(" WITH") => *last = format!("{last} {word}"),
            _ => words.push(word.to_string()),
        }
    }
    let (allowed, rest) = any_of(&words);
    allowed && rest.is_empty()
}

fn any_of(words: &[String]) -> (bool, &[String]) {
    let (mut allowed, mut rest) = all_of(words);
    while let [or, more @ ..] = rest
        && or == "OR"
    {
        let (other, left) = all_of(more);
        (allowed, rest) = (allowed | other, left);
    }
    (allowed, rest)
}

fn all_of(words: &[String]) -> (bool, &[String]) {
    let (mut allowed, mut rest) = one(words);
    while let [and, more @ ..] = rest
        && and == "AND"
    {
        let (other, left) = one(more);
        (allowed, rest) = (allowed & other, left);
    }
    (allowed, rest)
}

fn one(words: &[String]) -> (bool, &[String]) {
    match words {
        [open, rest @ ..] if open == "(" => match any_of(rest) {
            (allowed, [close, rest @ ..]) if close == ")" => (allowed, rest),
            (_, rest) => (false, rest),
        },
        [name, rest @ ..] => (LICENCES.contains(&name.as_str()), rest),
        [] => (false, &[]),
    }
}

/// Packages of Cargo's metadata whose licence is not allowed.
pub fn unlicensed(metadata: &Value) -> Vec<String> {
    let packages = metadata["packages"].as_array().map(Vec::as_slice).unwrap_or_default();
    let judge = |package: &Value| {
        let (name, licence) = (package["name"].as_str()?, package["license"].as_str().unwrap_or("none stated"));
        (!is_allowed(licence))
            .then(|| format!("{name}: licence {licence}\n  help: remove the dependency, or allow its licence"))
    };
    packages.iter().filter_map(judge).collect()
}

/// Cargo's metadata of all packages built on this machine, read offline: packages of other platforms need not be present.
///
/// # Panics
/// If Cargo cannot be run or reports an error.
pub fn metadata(root: &Path) -> Value {
    let version = cargo::output(root, &["-vV"]);
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).expect("cargo names its host");
    cargo::metadata(root, &["--filter-platform", host])
}
