//! Walks two trees side by side and hands each pair of files to those who know their kind. Files on one side only are
//! differences.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::findings::Findings;
use crate::{csv, html, json, log, text, xml};

/// What counts where it is not the same for everybody.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Options {
    /// What counts on a page.
    pub html: html::Level,
    /// Pages of the new tree may have more than those of the old one.
    pub html_may_grow: bool,
}

/// Compares two folders, or two files. Fails if one cannot be read, or if there is nothing to compare.
pub fn compare(old: &Path, new: &Path, options: Options) -> Result<Findings, String> {
    let mut findings = Findings::default();
    match (old.is_dir(), new.is_dir()) {
        (true, true) => {}
        (false, false) => {
            let name = old.file_name().unwrap_or(old.as_os_str()).to_string_lossy().into_owned();
            compare_files(&name, [&read(old)?, &read(new)?], options, &mut findings);
            return Ok(findings);
        }
        _ => return Err(format!("{} and {}: one is a folder, the other is not", old.display(), new.display())),
    }
    let (before, after) = (files(old)?, files(new)?);
    if before.is_empty() {
        return Err(format!("{}: there is no file in it", old.display()));
    }
    for path in before.union(&after) {
        let name = path.to_string_lossy();
        let side = |there: bool| there.then(|| "a file".to_owned());
        match (before.contains(path), after.contains(path)) {
            (true, true) => {
                compare_files(&name, [&read(&old.join(path))?, &read(&new.join(path))?], options, &mut findings);
            }
            (in_old, in_new) => {
                findings.begin(&name);
                findings.differs("", side(in_old), side(in_new));
            }
        }
    }
    Ok(findings)
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    fs::read(path).map_err(|error| format!("{}: {error}", path.display()))
}

/// All files below a folder, relative to it.
fn files(folder: &Path) -> Result<BTreeSet<PathBuf>, String> {
    let (mut found, mut open) = (BTreeSet::new(), vec![PathBuf::new()]);
    while let Some(place) = open.pop() {
        let unreadable = |error: std::io::Error| format!("{}: {error}", folder.join(&place).display());
        for entry in fs::read_dir(folder.join(&place)).map_err(unreadable)? {
            let entry = entry.map_err(unreadable)?;
            let path = place.join(entry.file_name());
            if folder.join(&path).is_dir() {
                open.push(path);
            } else {
                found.insert(path);
            }
        }
    }
    Ok(found)
}

/// Kinds of files that are text whatever is in them.
const TEXTS: [&str; 11] = ["txt", "md", "log", "toml", "stdout", "stderr", "exit", "command", "from", "rs", "yaml"];

fn compare_files(name: &str, [old, new]: [&[u8]; 2], options: Options, findings: &mut Findings) {
    findings.begin(name);
    let kind = Path::new(name).extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if kind == "mcap" {
        if let Err(why) = log::compare(old, new, findings) {
            // Two that are cut off may still be the same.
            compare_bytes(old, new, &format!("a log that cannot be read ({why})"), findings);
        }
        return;
    }
    let (Ok(a), Ok(b)) = (std::str::from_utf8(old), std::str::from_utf8(new)) else {
        return compare_bytes(old, new, "", findings);
    };
    match kind.as_str() {
        "json" => compare_json(a, b, findings),
        "csv" => csv::compare(a, b, findings),
        "html" | "htm" => html::compare(a, b, options.html, options.html_may_grow, findings),
        "xml" => xml::compare(a, b, findings),
        // A command may have been asked for JSON in place of its text.
        "stdout" if a.trim_start().starts_with('{') => compare_json(a, b, findings),
        kind if TEXTS.contains(&kind) => text::compare(a, b, findings),
        _ => compare_bytes(old, new, "", findings),
    }
}

/// What is no JSON is a text.
fn compare_json(old: &str, new: &str, findings: &mut Findings) {
    match (serde_json::from_str(old), serde_json::from_str(new)) {
        (Ok(old), Ok(new)) => json::compare(&old, &new, findings),
        _ => text::compare(old, new, findings),
    }
}

fn compare_bytes(old: &[u8], new: &[u8], what: &str, findings: &mut Findings) {
    if old == new {
        return findings.same(1);
    }
    let at = old.iter().zip(new).take_while(|(a, b)| a == b).count();
    let said = |bytes: &[u8]| {
        let rest: &[u8] = &bytes[at..bytes.len().min(at + 16)];
        Some(format!("{} bytes, here {:?}", bytes.len(), String::from_utf8_lossy(rest)))
    };
    let place = if what.is_empty() { format!("byte {at}") } else { format!("{what}, byte {at}") };
    findings.differs(place, said(old), said(new));
}
