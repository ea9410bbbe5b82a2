//! Features of packages: a build shares what another one has built only if both ask for the same features.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::cargo;

/// Sets of features with which a selection builds each package; a build script's packages may have another set.
pub type Features = BTreeMap<String, BTreeSet<String>>;

/// Features of all packages of a selection of `cargo tree`, read offline.
///
/// # Panics
/// If Cargo cannot be run or reports an error.
pub fn of(root: &Path, selection: &[&str]) -> Features {
    let arguments = ["tree", "--prefix", "none", "--format", "{p}\t{f}"];
    parse(&cargo::output(root, &[&arguments, selection].concat()))
}

/// Features of the lines "package, tab, features".
pub fn parse(tree: &str) -> Features {
    let mut features = Features::new();
    for (package, set) in tree.lines().filter_map(|line| line.split_once('\t')) {
        let set = set.trim_end_matches("(*)").trim_end();
        features.entry(package.to_owned()).or_default().insert(set.to_owned());
    }
    features
}

/// Packages of `part` that `whole` builds with other features.
pub fn unshared(part: &Features, whole: &Features) -> Vec<String> {
    let differs = |(package, sets): (&String, &BTreeSet<String>)| {
        let shared = whole.get(package)?;
        let own: Vec<_> = sets.difference(shared).map(String::as_str).collect();
        let help =
            "help: ask for the features of both in host/shared-features, or drop the dependency that asks for more";
        (!own.is_empty()).then(|| format!("{package}: features {own:?}, else {shared:?}\n  {help}"))
    };
    part.iter().filter_map(differs).collect()
}
