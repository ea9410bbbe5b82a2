//! Table of crates in ARCHITECTURE.md, which states the allowed imports, compared with Cargo: a Markdown table with the columns `crate`,
//! `what it is`, `may import` and `open first`.
//!
//! `may import` lists names in backquotes: `` `parameters`, `link` (tests) `` allows `link` to tests only. Words without backquotes, such
//! as "nothing of ours", are for the reader.

use std::path::Path;

use crate::members::{Kind, Workspace};

/// Row of a crate.
#[derive(Debug, PartialEq)]
pub struct Row {
    /// First name in backquotes of the first column.
    pub name: String,
    /// Allowed crates, with `true` for tests only.
    pub may_import: Vec<(String, bool)>,
    /// Path of the file to open first, from the workspace's root.
    pub open_first: String,
    /// Line in the page, from one.
    pub line: usize,
}

/// Rows of every such table in a page.
pub fn rows(page: &str) -> Vec<Row> {
    let mut rows = vec![];
    let mut columns = None;
    for (at, line) in page.lines().enumerate() {
        let Some(inner) = line.trim().strip_prefix('|') else {
            columns = None;
            continue;
        };
        let cells: Vec<&str> = inner.trim_end_matches('|').split('|').map(str::trim).collect();
        let column = |title: &str| cells.iter().position(|cell| cell.to_lowercase() == title);
        if let (Some(name), Some(import), Some(first)) = (column("crate"), column("may import"), column("open first")) {
            columns = Some((name, import, first));
        } else if let Some((name, import, first)) = columns
            && !cells.iter().all(|cell| cell.chars().all(|sign| "-:".contains(sign)))
        {
            let cell = |at: usize| quoted(cells.get(at).unwrap_or(&""));
            let only = |names: Vec<(String, bool)>| names.into_iter().next().unwrap_or_default().0;
            rows.push(Row {
                name: only(cell(name)),
                may_import: cell(import),
                open_first: only(cell(first)),
                line: at + 1,
            });
        }
    }
    rows
}

/// Names in backquotes, also in a link's text, each with `true` if `(tests)` follows.
fn quoted(cell: &str) -> Vec<(String, bool)> {
    let parts: Vec<&str> = cell.split('`').collect();
    let name = |pair: &[&str]| (pair[0].to_string(), pair[1].trim_start().starts_with("(tests)"));
    parts[1..].chunks_exact(2).map(name).collect()
}

/// Differences between page and workspace; `exists` checks a path from the workspace's root.
pub fn differences(page: &str, workspace: &Workspace, exists: impl Fn(&Path) -> bool) -> Vec<String> {
    let rows = rows(page);
    let mut found = vec![];
    for Row { name, may_import, open_first, line } in &rows {
        let place = format!("ARCHITECTURE.md:{line}");
        if workspace.member(name).is_none() {
            found.push(format!("{place}: `{name}` is no crate of the workspace\n  help: remove or rename the row"));
        }
        if rows.iter().any(|row| row.name == *name && row.line < *line) {
            found.push(format!("{place}: `{name}` has a row already\n  help: remove one"));
        }
        for (other, _) in may_import.iter().filter(|(other, _)| workspace.member(other).is_none()) {
            found.push(format!("{place}: `{name}` may import `{other}`, which is no crate of the workspace"));
        }
        if open_first.is_empty() || !exists(Path::new(open_first)) {
            found.push(format!("{place}: the file to open first, `{open_first}`, does not exist"));
        }
    }
    for member in &workspace.members {
        let Some(row) = rows.iter().find(|row| row.name == member.name) else {
            found.push(format!("ARCHITECTURE.md has no row for `{}`\n  help: add one", member.name));
            continue;
        };
        for (other, kind) in &member.imports {
            let allows = |(name, tests): &(String, bool)| name == other && (!tests || *kind == Kind::Tests);
            if !row.may_import.iter().any(allows) {
                let manifest = member.folder.join("Cargo.toml");
                let (manifest, section, line) = (manifest.display(), kind.section(), row.line);
                let help = "remove the dependency, or move the needed code into a crate that may be imported";
                let text = format!("{manifest}: {other} in [{section}] is not allowed by ARCHITECTURE.md:{line}");
                found.push(format!("{text}\n  help: {help}"));
            }
        }
    }
    found
}

/// Paths with a slash that a page names between backquotes and that do not exist.
pub fn missing(page: &str, exists: impl Fn(&Path) -> bool) -> Vec<String> {
    let quoted = page.lines().flat_map(|line| line.split('`').skip(1).step_by(2));
    let is_place = |text: &&str| text.contains('/') && !text.contains([' ', '*', '<', '$', '(']);
    let lost = quoted.filter(is_place).filter(|place| !exists(Path::new(place)));
    lost.map(|place| format!("the page names `{place}`, which does not exist\n  help: use its present path")).collect()
}
