//! Walks two trees in parallel and compares each pair of files by its kind. Files on one side only are differences.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use walkdir::WalkDir;

use crate::findings::Findings;
use crate::ignored::FILES;
use crate::listing::{self, Listing, Row};
use crate::{csv, html, json, log, text, xml};

/// Options of the comparison.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::Args)]
pub struct Options {
    /// Compared content of HTML pages
    #[arg(long, value_name = "LEVEL", value_enum, default_value_t)]
    pub html: html::Level,
    /// Allow pages of NEW to have more figures and cells than pages of OLD
    #[arg(long)]
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
        return Err(format!("{}: the folder has no files", old.display()));
    }
    for path in before.union(&after) {
        let name = path.to_string_lossy();
        let side = |there: bool| there.then(|| "a file".to_owned());
        match (before.contains(path), after.contains(path)) {
            (true, true) => {
                compare_files(&name, [&read(&old.join(path))?, &read(&new.join(path))?], options, &mut findings);
            }
            (in_old, in_new) => {
                findings.start_file(&name);
                findings.add_difference("", side(in_old), side(in_new));
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
    let mut found = BTreeSet::new();
    for entry in WalkDir::new(folder).follow_links(true) {
        let entry = entry.map_err(|error| error.to_string())?;
        if !entry.file_type().is_dir() && !FILES.iter().any(|name| entry.file_name() == *name) {
            found.insert(entry.path().strip_prefix(folder).unwrap_or(entry.path()).to_owned());
        }
    }
    Ok(found)
}

/// File extensions compared as text.
const TEXTS: [&str; 11] = ["txt", "md", "log", "toml", "stdout", "stderr", "exit", "command", "from", "rs", "yaml"];

fn compare_files(name: &str, files: [&[u8]; 2], options: Options, findings: &mut Findings) {
    findings.start_file(name);
    let kind = Path::new(name).extension().unwrap_or_default().to_string_lossy().to_lowercase();
    // Files that cannot be read, such as a truncated log, are compared byte by byte.
    let listings = listings(&kind, files, options).unwrap_or_else(|reason| bytes(files, &reason));
    listing::compare(listings.each_ref(), findings);
}

/// Listings of two files of a kind; fails, with the words before the byte offset in the report, if one is not of this kind.
fn listings(kind: &str, files: [&[u8]; 2], options: Options) -> Result<[Listing; 2], String> {
    let both = |[old, new]: [Result<Listing, String>; 2]| -> Result<_, String> { Ok([old?, new?]) };
    if kind == "mcap" {
        return both(files.map(log::read)).map_err(|reason| format!("unreadable log ({reason}), "));
    }
    let [Ok(old), Ok(new)] = files.map(std::str::from_utf8) else { return Err(String::new()) };
    let texts = [old, new];
    match kind {
        // Standard output may be JSON.
        "json" | "stdout" if kind == "json" || old.trim_start().starts_with('{') => Ok(json_or_text(texts)),
        "csv" => Ok(csv::read(texts)),
        "html" | "htm" => html::read(texts, options.html, options.html_may_grow)
            .map_err(|reason| format!("unreadable page ({reason}), ")),
        "xml" => both(texts.map(xml::read)).map_err(|reason| format!("unreadable XML ({reason}), ")),
        kind if TEXTS.contains(&kind) => Ok(texts.map(text::read)),
        _ => Err(String::new()),
    }
}

/// Listings of JSON, or of text where one is not JSON.
fn json_or_text(texts: [&str; 2]) -> [Listing; 2] {
    match texts.map(serde_json::from_str) {
        [Ok(old), Ok(new)] => [old, new].map(|document| json::read(&document)),
        _ => texts.map(text::read),
    }
}

/// Listings of the bytes of two files from the first that differs.
fn bytes(files: [&[u8]; 2], reason: &str) -> [Listing; 2] {
    let at = files[0].iter().zip(files[1]).take_while(|(old, new)| old == new).count();
    files.map(|file| {
        let here = file[at..file.len().min(at + 16)].escape_ascii();
        let mut row = Row::at(format!("{reason}byte {at}"));
        row.push("", format!("{} bytes, here {here}", file.len()));
        Listing::from_row(row)
    })
}
