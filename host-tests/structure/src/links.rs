//! Links among the Markdown pages, and the list of the book's pages in docs/SUMMARY.md.
//!
//! A link is what stands as `[text](target)` or `![text](target)` outside code. Targets with a scheme, such as `https:`,
//! are not looked at; a target without one is a file beside the page, and what follows `#` is a heading there.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// The pages that the book is made of lie here, and no link of theirs leads out of it.
pub const BOOK: &str = "docs";
/// Its list of pages.
pub const SUMMARY: &str = "docs/SUMMARY.md";

/// The pages, each by its path from the workspace's root.
pub type Pages = BTreeMap<PathBuf, String>;

/// One link of a page.
#[derive(Debug, PartialEq)]
pub struct Link {
    /// The file, as it is written there; empty for a heading of the same page.
    pub file: String,
    /// What follows `#`.
    pub heading: Option<String>,
    /// In the page, from one.
    pub line: usize,
}

/// The page without its code: blocks between fences, and what stands between backquotes. Lines stay where they are.
fn prose(page: &str) -> String {
    let (mut out, mut fenced) = (String::new(), false);
    for line in page.lines() {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        if !fence && !fenced {
            let parts: Vec<&str> = line.split('`').collect();
            // A backquote without a partner is a backquote.
            let code = |at: usize| at % 2 == 1 && at + 1 < parts.len();
            let kept = parts.iter().enumerate().map(|(at, part)| if code(at) { "" } else { part });
            out.extend(kept);
        }
        out.push('\n');
    }
    out
}

/// The links of a page.
pub fn links(page: &str) -> Vec<Link> {
    let prose = prose(page);
    let mut links = vec![];
    for (at, _) in prose.match_indices("](") {
        let Some((target, _)) = prose[at + 2..].split_once(')') else { continue };
        // `(file "title")`, and `()` for a chapter of the book that has no page.
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

/// What a heading is linked by: lower case, blanks as hyphens, without other signs; a second one of a page ends in `-1`.
pub fn headings(page: &str) -> Vec<String> {
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    let (mut found, mut fenced) = (vec![], false);
    for line in page.lines() {
        fenced ^= line.trim_start().starts_with("```");
        let text = line.trim_start_matches('#');
        if fenced || text.len() == line.len() || !text.starts_with(' ') {
            continue;
        }
        // Of a link only its text is part of the heading.
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

/// Pages and files of the book that a source names, in comments and in texts for users, each with its line.
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

/// `file` beside `page`, without `..`; `None` if it leads out of the workspace.
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

/// Links that lead nowhere; `exists` tells of a path from the workspace's root.
pub fn broken(pages: &Pages, exists: impl Fn(&Path) -> bool) -> Vec<String> {
    let mut found = vec![];
    for (path, text) in pages {
        for Link { file, heading, line } in links(text) {
            let place = format!("{}:{line}", path.display());
            let target = if file.is_empty() { Some(path.clone()) } else { beside(path, &file) };
            let Some(target) = target.filter(|target| exists(target)) else {
                found.push(format!("{place}: the link to `{file}` leads nowhere\n  mend: name where it is now"));
                continue;
            };
            if path.starts_with(BOOK) && !target.starts_with(BOOK) {
                let mend = "name the file in backquotes, without a link";
                found.push(format!("{place}: the link to `{file}` leads out of the book\n  mend: {mend}"));
            }
            let Some(heading) = heading else { continue };
            let known = pages.get(&target).map(|page| headings(page)).unwrap_or_default();
            if !known.contains(&heading) {
                let (target, known) = (target.display(), known.join(", "));
                found.push(format!("{place}: {target} has no heading `{heading}`\n  mend: one of {known}"));
            }
        }
    }
    found
}

/// Pages of the book that its list leaves out.
pub fn unlisted(pages: &Pages) -> Vec<String> {
    let summary = Path::new(SUMMARY);
    let listed = pages.get(summary).map(|page| links(page)).unwrap_or_default();
    let listed: Vec<PathBuf> = listed.iter().filter_map(|link| beside(summary, &link.file)).collect();
    let of_book = pages.keys().filter(|path| path.starts_with(BOOK) && *path != summary);
    let left_out = of_book.filter(|path| !listed.contains(path));
    left_out.map(|path| format!("{} is not in {SUMMARY}\n  mend: give it a line there", path.display())).collect()
}
