//! Text, line by line: what a terminal showed, Markdown, settings, logs. Lines are compared word by word once they are
//! masked; empty lines and space between words do not count.

use std::ops::Range;

use crate::align::{Step, steps};
use crate::findings::Findings;
use crate::ignored::{COLUMNS, Column};
use crate::mask::{HIDDEN, Masked, masked};

/// A line that says something.
struct Line<'a> {
    number: usize,
    said: &'a str,
    masked: Masked,
}

fn lines(text: &str) -> Vec<Line<'_>> {
    let mut table = None;
    let mut lines = Vec::new();
    for (index, said) in text.lines().enumerate() {
        table = under_head(said, table);
        let hidden = table.and_then(|(end, rule)| Some((word_that_ends_at(said, end)?, rule)));
        let masked = match hidden {
            Some((word, rule)) => {
                let mut rest = masked(&format!("{}{HIDDEN}{}", &said[..word.start], &said[word.end..]));
                rest.hidden.push((rule, said[word].to_owned()));
                rest
            }
            None => masked(said),
        };
        if !masked.words.is_empty() {
            lines.push(Line { number: index + 1, said, masked });
        }
    }
    lines
}

/// Where the words of a column that is left out end, in characters, and by which rule: from the head of its table to the
/// next empty line.
fn under_head(line: &str, before: Option<(usize, &'static str)>) -> Option<(usize, &'static str)> {
    if line.trim().is_empty() {
        return None;
    }
    let first = line.split_whitespace().next();
    let head = |column: &&Column| {
        first.is_some_and(|first| first.eq_ignore_ascii_case(column.first))
            && line.split_whitespace().any(|w| w == column.column)
    };
    let Some(column) = COLUMNS.iter().find(head) else { return before };
    let end = line.find(&format!(" {}", column.column))? + 1 + column.column.len();
    Some((line[..end].chars().count(), column.rule))
}

/// Bytes of the figure whose last character is the one before this place.
fn word_that_ends_at(line: &str, end: usize) -> Option<Range<usize>> {
    let end = line.char_indices().map(|(at, _)| at).chain([line.len()]).nth(end)?;
    let start = line[..end].rfind(char::is_whitespace).map_or(0, |at| at + 1);
    let ends = line[end..].chars().next().is_none_or(char::is_whitespace);
    let is_figure = line[start..end].chars().any(|c| c.is_ascii_digit());
    (ends && is_figure).then_some(start..end)
}

/// Compares two texts.
pub fn compare(old: &str, new: &str, findings: &mut Findings) {
    let (old, new) = (lines(old), lines(new));
    let words = |lines: &[Line<'_>]| lines.iter().map(|line| line.masked.words.clone()).collect::<Vec<_>>();
    let steps = steps(&words(&old), &words(&new));
    let count: usize = old.iter().map(|line| line.masked.words.len()).sum();
    let mut differing = 0;
    let said = |line: &Line<'_>| Some(line.said.trim().to_owned());
    for step in steps {
        match step {
            Step::Pair(a, b) => {
                differing += old[a].masked.words.len();
                findings.differs(format!("line {}", old[a].number), said(&old[a]), said(&new[b]));
            }
            Step::OnlyOld(a) => {
                differing += old[a].masked.words.len();
                findings.differs(format!("line {}", old[a].number), said(&old[a]), None);
            }
            Step::OnlyNew(b) => findings.differs(format!("line {}", new[b].number), None, said(&new[b])),
        }
    }
    findings.same((count - differing) as u64);
    leave_out(
        old.iter().flat_map(|line| &line.masked.hidden),
        new.iter().flat_map(|line| &line.masked.hidden),
        findings,
    );
}

/// Counts what masking has left out on both sides.
pub(crate) fn leave_out<'a>(
    old: impl Iterator<Item = &'a (&'static str, String)>,
    new: impl Iterator<Item = &'a (&'static str, String)>,
    findings: &mut Findings,
) {
    let mut new = new;
    for hidden in old {
        findings.leave_out(hidden.0, new.next() != Some(hidden));
    }
    new.for_each(|hidden| findings.leave_out(hidden.0, true));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_of_the_host_s_time_is_left_out_until_its_table_ends() {
        let table = |error: &str, cost: &str, behind: &str| {
            format!(
                "scheme      deflections          gap  link offset      cost  sub-steps\n\
                 reference             -            -            -    {cost}    its own\n\
                 rk4             {error}      7.11e-3      7.91e-3    {cost}          2\n\n\
                 behind it                                           {behind}\n"
            )
        };
        let differing = |new: &str| {
            let mut findings = Findings::default();
            compare(&table("2.03e-2", "  3.45", "3.45"), new, &mut findings);
            findings.differences.len()
        };
        assert_eq!(differing(&table("2.03e-2", "276.26", "3.45")), 0);
        assert_eq!(differing(&table("2.04e-2", "  3.45", "3.45")), 1);
        assert_eq!(differing(&table("2.03e-2", "  3.45", "3.46")), 1);
    }
}
