//! Text, line by line: terminal output, Markdown, settings, logs. Lines are masked and compared word by word; empty lines and space between
//! words do not count.

use std::ops::Range;

use crate::ignored::{Place, RULES};
use crate::listing::{Listing, Row};
use crate::mask::MASKED;

/// Reads a text: a row for each line that is not empty.
pub fn read(text: &str) -> Listing {
    let (mut listing, mut column) = (Listing::default(), None);
    for (index, raw) in text.lines().enumerate() {
        column = under_head(raw, column);
        let mut line = raw.to_owned();
        if let Some((end, rule)) = column
            && let Some(word) = word_that_ends_at(raw, end)
        {
            listing.hidden.push((rule, raw[word.clone()].to_owned()));
            line.replace_range(word, MASKED);
        }
        let line = listing.masked(&line);
        if !line.is_empty() {
            let mut row = Row::at(format!("line {}", index + 1));
            row.push("", line);
            listing.rows.push(row);
        }
    }
    listing
}

/// End of an ignored column's words [characters] and its rule, from the head of its table to the next empty line.
fn under_head(line: &str, before: Option<(usize, &'static str)>) -> Option<(usize, &'static str)> {
    let first = line.split_whitespace().next()?;
    let end = |(place, rule): &(Place, &'static str)| match place {
        Place::Column(head, column) if head.eq_ignore_ascii_case(first) => {
            let start = line.find(&format!(" {column}"))?;
            let words = line.split_whitespace().any(|word| word == *column);
            words.then_some((line[..start].chars().count() + 1 + column.chars().count(), *rule))
        }
        _ => None,
    };
    RULES.iter().find_map(end).or(before)
}

/// Byte range of the figure that ends right before a character position.
fn word_that_ends_at(line: &str, end: usize) -> Option<Range<usize>> {
    let end = line.char_indices().map(|(at, _)| at).chain([line.len()]).nth(end)?;
    let start = line[..end].rfind(char::is_whitespace).map_or(0, |at| at + 1);
    let ends = line[end..].chars().next().is_none_or(char::is_whitespace);
    let is_figure = line[start..end].chars().any(|c| c.is_ascii_digit());
    (ends && is_figure).then_some(start..end)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A column of host time is ignored until its table ends.
    #[test]
    fn host_time_column_is_ignored_in_its_table() {
        let lines = |error: &str, cost: &str, behind: &str| {
            let table = format!(
                "scheme      deflections          gap  link offset      cost  sub-steps\n\
                 reference             -            -            -    {cost}    its own\n\
                 rk4             {error}      7.11e-3      7.91e-3    {cost}          2\n\n\
                 behind it                                           {behind}\n"
            );
            read(&table).rows.into_iter().map(|row| row.values).collect::<Vec<_>>()
        };
        let old = lines("2.03e-2", "  3.45", "3.45");
        let differing_lines = |new: Vec<_>| old.iter().zip(&new).filter(|(old, new)| old != new).count();
        assert_eq!(differing_lines(lines("2.03e-2", "276.26", "3.45")), 0);
        assert_eq!(differing_lines(lines("2.04e-2", "  3.45", "3.45")), 1);
        assert_eq!(differing_lines(lines("2.03e-2", "  3.45", "3.46")), 1);
    }
}
