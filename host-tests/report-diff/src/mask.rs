//! Masks words of a text that differ between any two runs, as listed in [`ignored`](crate::ignored): dates, times of day, absolute paths,
//! and the figures in known phrases. The rest is compared word by word, so that neither column widths nor line breaks count.

use std::sync::LazyLock;

use regex::{Captures, Regex};

use crate::ignored::{CHANGED, CLOCK, DATE, PATH, Place, RULES};

/// Replacement of ignored words.
pub(crate) const MASKED: &str = "<ignored>";

/// A rule and the text that it ignores.
pub type Hidden = (&'static str, String);

/// Patterns of ignored words in a text in which each word has a space before and after it; the second group is ignored.
static PATTERNS: LazyLock<Vec<(Regex, &str)>> = LazyLock::new(|| {
    let [before, after] = [r#"( [(\["'`<]*)"#, r#"([)\]"'`>,.;]* )"#];
    let fixed = [
        (DATE, format!(r"{before}(\d{{4}}-\d\d-\d\d(?:T\d\d:\d\d:\d\dZ*)?){after}")),
        (CLOCK, format!(r"{before}(\d\d:\d\d:\d\d){after}")),
        // Text before a path in the same word stays, as in `--out=/tmp/x`; so does the name of the file.
        (PATH, r#"( [(\["'`<]*(?:[^ ]*?=)?)(/[^ ]*)(/[^ /]* )"#.to_owned()),
    ];
    let phrases = RULES.iter().filter_map(|(place, rule)| match place {
        Place::Phrase(words) => Some((*rule, format!(" {} ", pattern(words).replace(' ', "  ")))),
        _ => None,
    });
    let all = fixed.into_iter().chain(phrases);
    all.map(|(rule, pattern)| (Regex::new(&pattern).expect("a pattern"), rule)).collect()
});

/// Pattern of a phrase with `#` for a number or `@` for a digest, in three groups: before it, the number or digest, behind it.
pub(crate) fn pattern(words: &str) -> String {
    let sign = if words.contains('#') { r"[-+.\dEe]+" } else { "[0-9A-Fa-f]{7,}" };
    let (before, after) = words.split_once(['#', '@']).expect("a sign for the ignored value");
    format!("({})({sign})({})", regex::escape(before), regex::escape(after))
}

/// Text without ignored words, and the ignored words.
pub fn masked(text: &str) -> (String, Vec<Hidden>) {
    let mut hidden = Vec::new();
    let mut text: String = text.replace(CHANGED, "").split_whitespace().map(|word| format!(" {word} ")).collect();
    for (pattern, rule) in &*PATTERNS {
        let mask = |found: &Captures<'_>| {
            hidden.push((*rule, found[2].to_owned()));
            format!("{}{MASKED}{}", &found[1], &found[3])
        };
        text = pattern.replace_all(&text, mask).into_owned();
    }
    (text.split_whitespace().collect::<Vec<_>>().join(" "), hidden)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> String {
        masked(text).0
    }

    /// Dates, times of day and folders are masked; similar words stay.
    #[test]
    fn dates_times_and_folders_are_masked() {
        assert_eq!(text("on 2026-11-22T09:57:43Z, 3 planets"), "on <ignored>, 3 planets");
        assert_eq!(text("(2026-11-22) 09:57:43"), "(<ignored>) <ignored>");
        assert_eq!(text("report: /home/one/target/report.html"), "report: <ignored>/report.html");
        assert_eq!(text("--out=/tmp/x/y [/tmp/joint.toml:3:1]"), "--out=<ignored>/y [<ignored>/joint.toml:3:1]");
        for kept in ["3 N m/rad", "1/6 / 2", "2026-11", "9:57", "joints/q1.toml", "/ half", "-1.5e-7", "12:30:75:1"] {
            assert_eq!(text(kept), kept);
        }
    }

    /// Masked words are returned with their rules.
    #[test]
    fn masked_words_come_with_their_rule() {
        let hidden = masked("at 2026-11-22 in /home/base/x").1;
        assert_eq!(hidden, [(DATE, "2026-11-22".to_owned()), (PATH, "/home/base".to_owned())]);
    }

    /// In each known phrase, only the figure or digest is masked.
    #[test]
    fn phrases_mask_only_their_figure() {
        for (place, _) in RULES {
            let Place::Phrase(words) = place else { continue };
            let say = |number: &str, digest: &str| words.replace('#', number).replace('@', digest);
            let (found, hidden) = masked(&format!("before {} after", say("12.5", "b1f3478181d7")));
            assert_eq!(found, format!("before {} after", say(MASKED, MASKED)));
            assert_eq!(hidden.len(), 1);
            let other = format!("before {} after", say("q1", "q1"));
            assert_eq!(text(&other), other);
        }
        assert_eq!(text("Commit b1f3478181d7 (changed), now"), text("Commit 0000000000aa, now"));
    }
}
