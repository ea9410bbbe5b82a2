//! HTML pages by their visible content. The layout of a page may change while every figure has to stay, so pages are compared, unless more
//! is requested, by the number of occurrences of each word with a digit and by the texts of their table cells. Pictures, styles and scripts
//! are skipped: drawn data is in the records.

use std::collections::BTreeMap;

use crate::listing::{Listing, Row};
use crate::page::{self, Page};
use crate::text;

/// Compared content of a page.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Level {
    /// Words with a digit, by their number of occurrences.
    Numbers,
    /// Words with a digit, and texts of table cells.
    #[default]
    Figures,
    /// All text, in order.
    Text,
}

/// Number of occurrences of each text.
type Counts = BTreeMap<String, usize>;

/// Reads two pages; `may_grow` allows the new page to have more. Fails if either cannot be parsed.
pub fn read(pages: [&str; 2], level: Level, may_grow: bool) -> Result<[Listing; 2], String> {
    let [old, new] = pages.map(page::read);
    let pages = [old?, new?];
    if level == Level::Text {
        return Ok(pages.map(|page| {
            let mut listing = text::read(&page.lines.join("\n"));
            listing.hidden.extend(page.hidden);
            listing
        }));
    }
    let figures = |page: &Page| counted(page.lines.iter().flat_map(|line| with_digits(line)));
    let mut kinds = vec![("figure", pages.each_ref().map(figures))];
    if level == Level::Figures {
        kinds.push(("cell", pages.each_ref().map(|page| counted(page.cells.iter().cloned()))));
    }
    let mut listings = pages.map(|page| Listing { rows: Vec::new(), hidden: page.hidden });
    for (what, [old, mut new]) in kinds {
        if may_grow {
            new.retain(|word, _| old.contains_key(word));
            new.iter_mut().for_each(|(word, count)| *count = old[word].min(*count));
        }
        for (listing, counts) in listings.iter_mut().zip([old, new]) {
            let mut row = Row::default();
            counts.iter().for_each(|(word, count)| row.push(format!("{what} `{word}`"), format!("{count} times")));
            listing.rows.push(row);
        }
    }
    Ok(listings)
}

fn counted(words: impl Iterator<Item = String>) -> Counts {
    let mut counts = Counts::new();
    words.for_each(|word| *counts.entry(word).or_default() += 1);
    counts
}

/// Words with a digit, without surrounding punctuation.
fn with_digits(line: &str) -> Vec<String> {
    line.split_whitespace()
        .map(|word| word.trim_matches(|c: char| "()[]{},;:.·\"'`".contains(c)))
        .filter(|word| word.chars().any(|c| c.is_ascii_digit()))
        .map(ToOwned::to_owned)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::Findings;

    fn differences(old: &str, new: &str, level: Level, may_grow: bool) -> Vec<String> {
        let mut findings = Findings::default();
        let [old, new] = read([old, new], level, may_grow).expect("two pages");
        crate::listing::compare([&old, &new], &mut findings);
        findings.differences.into_iter().map(|difference| difference.place).collect()
    }

    const PAGE: &str = "<h1>Run 7</h1><p>error <b>1.5</b> %</p><svg><text>9.9</text></svg>\
        <table><tr><th>check</th><th>figure</th></tr><tr><td>gap</td><td>2.5 um</td></tr></table>";

    /// A changed layout with equal figures is no difference.
    #[test]
    fn layout_is_ignored() {
        let other = "<table><tr><th>check</th></tr><tr><th>figure</th></tr><tr><td>gap</td></tr><tr><td>2.5 <i>um</i></td></tr></table>\
            <div>Run <em>7</em></div><div>1.5</div> <div>% error</div><svg><text>8.8</text></svg>";
        assert!(differences(PAGE, other, Level::Figures, false).is_empty());
        assert!(!differences(PAGE, other, Level::Text, false).is_empty());
    }

    /// Changed figures, missing figures and changed cells are found.
    #[test]
    fn changed_figures_and_cells_are_found() {
        let found = differences(PAGE, &PAGE.replace("1.5", "1.6"), Level::Figures, false);
        assert_eq!(found, ["figure `1.5`", "figure `1.6`"]);
        let verdict = PAGE.replace("gap", "twist");
        assert_eq!(differences(PAGE, &verdict, Level::Figures, false), ["cell `gap`", "cell `twist`"]);
        assert!(differences(PAGE, &verdict, Level::Numbers, false).is_empty());
        let more = format!("{PAGE}<p>3.25</p>");
        assert_eq!(differences(PAGE, &more, Level::Figures, false), ["figure `3.25`"]);
        assert!(differences(PAGE, &more, Level::Figures, true).is_empty());
        assert_eq!(differences(&more, PAGE, Level::Figures, true), ["figure `3.25`"]);
    }

    /// Columns, rows and tiles of host time are ignored.
    #[test]
    fn host_time_is_ignored() {
        let page = |cost: &str, error: &str, date: &str| {
            let heads =
                ["scheme", "deflections", "gap", "link offset", "cost", "sub-steps"].map(|h| format!("<th>{h}</th>"));
            let heads = heads.concat();
            format!(
                "<table><tr>{heads}</tr><tr><td>rk4</td><td>{error}</td><td>1</td><td>1</td><td>{cost}</td><td>2</td></tr>\
                </table><table><tr><th>Date</th><td>{date}</td></tr></table>\
                 <div>{cost}<span> s</span></div><div>On the clock</div><div>On the clock</div><div>{cost} s</div>"
            )
        };
        let old = page("3.45", "0.1", "today");
        assert!(differences(&old, &page("3.55", "0.1", "yesterday"), Level::Figures, false).is_empty());
        assert_eq!(differences(&old, &page("3.45", "0.2", "today"), Level::Numbers, false).len(), 2);
    }
}
