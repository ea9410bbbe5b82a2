//! Links between the Markdown pages, and the list of the book's pages in docs/SUMMARY.md.
//!
//! A link has the form `[text](target)` or `![text](target)` outside code. Targets with a scheme, such as `https:`, are not checked; a
//! target without a scheme is a file relative to the page, and `#` is followed by a heading there.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// Folder of the book's pages, which no link of theirs leaves.
pub const BOOK: &str = "docs";
/// List of the book's pages.
pub const SUMMARY: &str = "docs/SUMMARY.md";

/// Pages by their path from the workspace's root.
pub type Pages = BTreeMap<PathBuf, String>;

/// Link of a page.
#[derive(Debug, PartialEq)]
pub struct Link {
    /// File as written; empty for a heading of the same page.
    pub file: String,
    /// Heading after `#`.
    pub heading: Option<String>,
    /// Line in the page, from one.
    pub line: usize,
}

/// Page without its code: fenced blocks, and text between backquotes. Line numbers are preserved.
fn prose(page: &str) -> String {
    let (mut out, mut fenced) = (String::new(), false);
    for line in page.lines() {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        if !fence && !fenced {
            let parts: Vec<&str> = line.split('`').collect();
            // A backquote without a partner is text.
            let code = |at: usize| at % 2 == 1 && at + 1 < parts.len();
            let kept = parts.iter().enumerate().map(|(at, part)| if code(at) { "" } else { part });
            out.extend(kept);
        }
        out.push('\n');
    }
    out
}

/// Links of a page.
pub fn links(page: &str) -> Vec<Link> {
    let prose = prose(page);
    let mut links = vec![];
    for (at, _) in prose.match_indices("](") {
        let Some((target, _)) = prose[at + 2..].split_once(')') else { continue };
        // `(file "title")`, or `()` for a chapter of the book without a page.
        let target = target.split_whitespace().next().unwrap_or_default();
        if target.is_empty() || target.contains(':') {
            continue;
        }
        let (file, heading) = target.split_once('#').map_or((target, None), |(file, heading)| (file, Some(heading)));
        let line = prose[..at].lines().count().max(1);
        links.push(Link { file: file.into(), heading: heading.map(Into::into), line });
    }
    links
}

/// Anchors of the headings: lower case, blanks as hyphens, other signs removed; a repeated heading ends in `-1`.
pub fn headings(page: &str) -> Vec<String> {
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    let (mut found, mut fenced) = (vec![], false);
    for line in page.lines() {
        fenced ^= line.trim_start().starts_with("```");
        let text = line.trim_start_matches('#');
        if fenced || text.len() == line.len() || !text.starts_with(' ') {
            continue;
        }
        // Only the text of a link is part of the heading.
        let text: String = text.split("](").enumerate().map(|(at, part)| after_target(at, part)).collect();
        let kept = text.trim().chars().filter(|sign| sign.is_alphanumeric() || "_- ".contains(*sign));
        let slug = kept.collect::<String>().to_lowercase().replace(' ', "-");
        let again = seen.entry(slug.clone()).and_modify(|count| *count += 1).or_default();
        found.push(if *again == 0 { slug } else { format!("{slug}-{again}") });
    }
    found
}

fn after_target(at: usize, part: &str) -> &str {
    if at == 0 { part } else { part.split_once(')').map_or("", |(_, rest)| rest) }
}

/// Pages and files of the book named by a source, in comments and in texts for users, each with its line.
pub fn named(source: &str) -> Vec<(usize, PathBuf)> {
    let mut found = vec![];
    for (at, line) in source.lines().enumerate() {
        for (start, _) in line.match_indices("docs/") {
            let name = line[start..].split(|sign: char| !sign.is_ascii_alphanumeric() && !"/._-".contains(sign));
            let name = PathBuf::from(name.map(|name| name.trim_end_matches('.')).next().unwrap_or_default());
            if name.extension().is_some() && !line[..start].contains("://") {
                found.push((at + 1, name));
            }
        }
    }
    found
}

/// `file` relative to `page`, without `..`; `None` if it leaves the workspace.
fn beside(page: &Path, file: &str) -> Option<PathBuf> {
    let mut path = page.parent()?.to_path_buf();
    for part in Path::new(file).components() {
        match part {
            Component::ParentDir => path.pop().then_some(())?,
            Component::Normal(name) => path.push(name),
            Component::CurDir => {}
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(path)
}

/// Broken links; `exists` checks a path from the workspace's root.
pub fn broken(pages: &Pages, exists: impl Fn(&Path) -> bool) -> Vec<String> {
    let mut found = vec![];
    for (path, text) in pages {
        for Link { file, heading, line } in links(text) {
            let place = format!("{}:{line}", path.display());
            let target = if file.is_empty() { Some(path.clone()) } else { beside(path, &file) };
            let Some(target) = target.filter(|target| exists(target)) else {
                found.push(format!("{place}: broken link to `{file}`\n  help: link the file where it is now"));
                continue;
            };
            if path.starts_with(BOOK) && !target.starts_with(BOOK) {
                let help = "name the file in backquotes, without a link";
                found.push(format!("{place}: the link to `{file}` leaves the book\n  help: {help}"));
            }
            let Some(heading) = heading else { continue };
            let known = pages.get(&target).map(|page| headings(page)).unwrap_or_default();
            if !known.contains(&heading) {
                let (target, known) = (target.display(), known.join(", "));
                found.push(format!("{place}: {target} has no heading `{heading}`\n  help: use one of {known}"));
            }
        }
    }
    found
}

/// Pages of the book missing in its list.
pub fn unlisted(pages: &Pages) -> Vec<String> {
    let summary = Path::new(SUMMARY);
    let listed = pages.get(summary).map(|page| links(page)).unwrap_or_default();
    let listed: Vec<PathBuf> = listed.iter().filter_map(|link| beside(summary, &link.file)).collect();
    let of_book = pages.keys().filter(|path| path.starts_with(BOOK) && *path != summary);
    let left_out = of_book.filter(|path| !listed.contains(path));
    left_out.map(|path| format!("{} is not in {SUMMARY}\n  help: add a line there", path.display())).collect()
}
