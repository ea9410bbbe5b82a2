//! Takes out of a text what no two runs share, as [`ignored`](crate::ignored) names it: dates, times of day, paths from the
//! root of the disk, and the words that follow or precede a known phrase. What is left is compared word by word, so that
//! neither the width of columns nor broken lines count.

use crate::ignored::{CHANGED, CLOCK, DATE, PATH, PHRASES};

/// What stands for a word that is left out.
pub(crate) const HIDDEN: &str = "<left out>";

/// A text without what was left out, and which rules have left something out.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub struct Masked {
    /// Its words.
    pub words: Vec<String>,
    /// The rules with the words that they have left out.
    pub hidden: Vec<(&'static str, String)>,
}

/// Masks a line or another short text.
pub fn masked(text: &str) -> Masked {
    let mut hidden = Vec::new();
    let text = text.replace(CHANGED, "");
    let mut words: Vec<String> = text.split_whitespace().map(|word| without_own(word, &mut hidden)).collect();
    for phrase in PHRASES {
        let pattern: Vec<&str> = phrase.words.split(' ').collect();
        for start in 0..words.len().saturating_sub(pattern.len() - 1) {
            let place = &words[start..start + pattern.len()];
            if !place.iter().zip(&pattern).all(|(word, wanted)| fits(word, wanted)) {
                continue;
            }
            for (word, wanted) in words[start..].iter_mut().zip(&pattern) {
                if let Some((before, after)) = wanted.split_once(SIGNS) {
                    let whole = std::mem::replace(word, format!("{before}{HIDDEN}{after}"));
                    hidden.push((phrase.rule, whole));
                }
            }
        }
    }
    Masked { words, hidden }
}

/// What stands for a number and for a digest in a phrase.
const SIGNS: [char; 2] = ['#', '@'];

/// Whether a word is the phrase's.
pub(crate) fn fits(word: &str, wanted: &str) -> bool {
    let Some((before, after)) = wanted.split_once(SIGNS) else { return word == wanted };
    let Some(inside) = word.strip_prefix(before).and_then(|rest| rest.strip_suffix(after)) else { return false };
    match wanted.contains('#') {
        true => inside.parse::<f64>().is_ok(),
        false => inside.len() >= 7 && inside.chars().all(|c| c.is_ascii_hexdigit()),
    }
}

/// A word without what tells by itself that it is a date, a time of day or a path.
fn without_own(word: &str, hidden: &mut Vec<(&'static str, String)>) -> String {
    let opening = word.len() - word.trim_start_matches(OPENING).len();
    let (before, rest) = word.split_at(opening);
    let closing = rest.trim_end_matches(CLOSING).len();
    let (core, after) = rest.split_at(closing);
    if let Some(rule) = is_date(core).or_else(|| is_clock(core)) {
        hidden.push((rule, core.to_owned()));
        return format!("{before}{HIDDEN}{after}");
    }
    // What stands before a path in the same word, as in `--out=/tmp/x`, stays.
    let start = match core.find("=/") {
        Some(sign) => sign + 1,
        None => 0,
    };
    let (name, path) = core.split_at(start);
    match path.strip_prefix('/').and_then(|rest| rest.rsplit_once('/')) {
        Some((folder, file)) => {
            hidden.push((PATH, format!("/{folder}/")));
            // The name of the file itself says what it is.
            format!("{before}{name}{HIDDEN}/{file}{after}")
        }
        None => word.to_owned(),
    }
}

const OPENING: [char; 6] = ['(', '[', '"', '\'', '`', '<'];
const CLOSING: [char; 9] = [')', ']', '"', '\'', '`', '>', ',', '.', ';'];

/// `2026-11-22`, or with a time behind it.
fn is_date(word: &str) -> Option<&'static str> {
    let (date, time) = word.split_once('T').map_or((word, None), |(date, time)| (date, Some(time)));
    let is_time = time.is_none_or(|time| is_clock(time.trim_end_matches('Z')).is_some());
    (shape(date) == "0000-00-00" && is_time).then_some(DATE)
}

/// `09:57:43`.
fn is_clock(word: &str) -> Option<&'static str> {
    (shape(word) == "00:00:00").then_some(CLOCK)
}

/// Every digit as a zero.
fn shape(word: &str) -> String {
    word.chars().map(|c| if c.is_ascii_digit() { '0' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> String {
        masked(text).words.join(" ")
    }

    #[test]
    fn dates_times_and_folders_are_left_out_and_nothing_else_is() {
        assert_eq!(text("on 2026-11-22T09:57:43Z, 3 planets"), "on <left out>, 3 planets");
        assert_eq!(text("(2026-11-22) 09:57:43"), "(<left out>) <left out>");
        assert_eq!(text("report: /home/one/target/report.html"), "report: <left out>/report.html");
        assert_eq!(text("--out=/tmp/x/y [/tmp/joint.toml:3:1]"), "--out=<left out>/y [<left out>/joint.toml:3:1]");
        for kept in ["3 N m/rad", "1/6 / 2", "2026-11", "9:57", "joints/q1.toml", "/ half", "-1.5e-7", "12:30:75:1"] {
            assert_eq!(text(kept), kept);
        }
    }

    #[test]
    fn what_was_left_out_is_told_with_its_rule() {
        let hidden = masked("at 2026-11-22 in /home/base/x").hidden;
        assert_eq!(hidden, [(DATE, "2026-11-22".to_owned()), (PATH, "/home/base/".to_owned())]);
    }

    #[test]
    fn phrases_hide_only_the_figure_or_digest_in_them() {
        for phrase in PHRASES {
            let say = |number: &str, digest: &str| phrase.words.replace('#', number).replace('@', digest);
            let found = masked(&format!("before {} after", say("12.5", "b1f3478181d7")));
            assert_eq!(found.words.join(" "), format!("before {} after", say(HIDDEN, HIDDEN)));
            assert_eq!(found.hidden.len(), 1);
            let other = format!("before {} after", say("q1", "q1"));
            assert_eq!(text(&other), other);
        }
        assert_eq!(text("Commit b1f3478181d7 (changed), now"), text("Commit 0000000000aa, now"));
    }
}
