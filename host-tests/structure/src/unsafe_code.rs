//! Every `unsafe` of the sources against the list in docs/reference/unsafe.md.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use proc_macro2::{TokenStream, TokenTree};

/// Page with the list.
pub const PAGE: &str = "docs/reference/unsafe.md";

/// Number of times the word `unsafe` stands in a source, without comments and strings; fails if the source is not Rust.
pub fn count(source: &str) -> Result<usize, String> {
    source.parse::<TokenStream>().map(within).map_err(|error| error.to_string())
}

fn within(tokens: TokenStream) -> usize {
    let one = |token: TokenTree| match token {
        TokenTree::Ident(word) => usize::from(word == "unsafe"),
        TokenTree::Group(group) => within(group.stream()),
        _ => 0,
    };
    tokens.into_iter().map(one).sum()
}

/// Rows of the list: file, number, reason.
pub fn rows(page: &str) -> Vec<(PathBuf, usize, String)> {
    let row = |line: &str| {
        let mut cells = line.strip_prefix("| `")?.split(" | ");
        let file = cells.next()?.strip_suffix('`')?;
        let count = cells.next()?.parse().ok()?;
        Some((PathBuf::from(file), count, cells.next()?.trim_end_matches(" |").to_string()))
    };
    page.lines().filter_map(row).collect()
}

/// Differences between list and sources. `found` holds the files that contain the word, with their number.
pub fn differences(page: &str, found: &BTreeMap<PathBuf, usize>) -> Vec<String> {
    let listed: BTreeMap<PathBuf, (usize, String)> =
        rows(page).into_iter().map(|(file, count, why)| (file, (count, why))).collect();
    let mut out = Vec::new();
    for (file, count) in found {
        let name = file.display();
        match listed.get(file) {
            None => out.push(format!("{name}: `unsafe` {count} times\n  help: remove it, or add a row to {PAGE}")),
            Some((said, _)) if said != count => {
                out.push(format!(
                    "{name}: `unsafe` {count} times, {PAGE} says {said}\n  help: correct the row and its reason"
                ));
            }
            Some((_, why)) if why.len() < 10 => out.push(format!("{PAGE}: {name} has no reason")),
            Some(_) => {}
        }
    }
    let gone = listed.keys().filter(|file| !found.contains_key(*file));
    out.extend(gone.map(|file| format!("{PAGE}: {} has no `unsafe`\n  help: remove the row", file.display())));
    out
}

/// Crates without a file in the list whose manifest does not inherit the workspace's lints, which forbid `unsafe`, and crates with a file
/// whose manifest does. `manifests` are the members' folders with their manifests.
pub fn unforbidden(page: &str, manifests: &[(PathBuf, String)]) -> Vec<String> {
    let listed = rows(page);
    let folder_of = |file: &Path| {
        let holders = manifests.iter().map(|(folder, _)| folder).filter(|folder| file.starts_with(folder));
        holders.max_by_key(|folder| folder.components().count())
    };
    let excused: Vec<_> = listed.iter().filter_map(|(file, ..)| folder_of(file)).collect();
    let judge = |(folder, manifest): &(PathBuf, String)| {
        let forbids = manifest.contains("[lints]\nworkspace = true");
        let name = folder.components().as_path().display();
        match (excused.contains(&folder), forbids) {
            (false, false) => {
                Some(format!("{name}/Cargo.toml: `unsafe` is not forbidden\n  help: add [lints] workspace = true"))
            }
            (true, true) => Some(format!("{name}/Cargo.toml forbids what {PAGE} lists")),
            _ => None,
        }
    };
    manifests.iter().filter_map(judge).collect()
}
