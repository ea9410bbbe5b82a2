//! Takes out of a text what no two runs share, as [`ignored`](crate::ignored) names it: dates, times of day, paths from the
//! root of the disk, and the words that follow or precede a known phrase. What is left is compared word by word, so that
//! neither the width of columns nor broken lines count.

use std::sync::LazyLock;

use regex::{Captures, Regex};

use crate::ignored::{CHANGED, CLOCK, DATE, PATH, Place, RULES};

/// What stands for words that are left out.
pub(crate) const HIDDEN: &str = "<left out>";

/// A rule, and what it has left out.
pub type Hidden = (&'static str, String);

/// What is left out of a text in which each word has a space before it and one behind it: the second group of each.
static PATTERNS: LazyLock<Vec<(Regex, &str)>> = LazyLock::new(|| {
    let [before, after] = [r#"( [(\["'`<]*)"#, r#"([)\]"'`>,.;]* )"#];
    let own = [
        (DATE, format!(r"{before}(\d{{4}}-\d\d-\d\d(?:T\d\d:\d\d:\d\dZ*)?){after}")),
        (CLOCK, format!(r"{before}(\d\d:\d\d:\d\d){after}")),
        // What stands before a path in the same word, as in `--out=/tmp/x`, stays; so does the name of the file, which
        // says what it is.
        (PATH, r#"( [(\["'`<]*(?:[^ ]*?=)?)(/[^ ]*)(/[^ /]* )"#.to_owned()),
    ];
    let phrases = RULES.iter().filter_map(|(place, rule)| match place {
        Place::Phrase(words) => Some((*rule, format!(" {} ", form(words).replace(' ', "  ")))),
        _ => None,
    });
    let all = own.into_iter().chain(phrases);
    all.map(|(rule, pattern)| (Regex::new(&pattern).expect("a pattern"), rule)).collect()
});

/// Words with `#` for a number or `@` for a digest as a pattern with three groups: what is before it, itself, what is behind.
pub(crate) fn form(words: &str) -> String {
    let sign = if words.contains('#') { r"[-+.\dEe]+" } else { "[0-9A-Fa-f]{7,}" };
    let (before, after) = words.split_once(['#', '@']).expect("a sign for what is left out");
    format!("({})({sign})({})", regex::escape(before), regex::escape(after))
}

/// A text without what is left out, and that.
pub fn masked(text: &str) -> (String, Vec<Hidden>) {
    let mut hidden = Vec::new();
    let mut text: String = text.replace(CHANGED, "").split_whitespace().map(|word| format!(" {word} ")).collect();
    for (pattern, rule) in &*PATTERNS {
        let hide = |found: &Captures<'_>| {
            hidden.push((*rule, found[2].to_owned()));
            format!("{}{HIDDEN}{}", &found[1], &found[3])
        };
        text = pattern.replace_all(&text, hide).into_owned();
    }
    (text.split_whitespace().collect::<Vec<_>>().join(" "), hidden)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> String {
        masked(text).0
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
        let hidden = masked("at 2026-11-22 in /home/base/x").1;
        assert_eq!(hidden, [(DATE, "2026-11-22".to_owned()), (PATH, "/home/base".to_owned())]);
    }

    #[test]
    fn phrases_hide_only_the_figure_or_digest_in_them() {
        for (place, _) in RULES {
            let Place::Phrase(words) = place else { continue };
            let say = |number: &str, digest: &str| words.replace('#', number).replace('@', digest);
            let (found, hidden) = masked(&format!("before {} after", say("12.5", "b1f3478181d7")));
            assert_eq!(found, format!("before {} after", say(HIDDEN, HIDDEN)));
            assert_eq!(hidden.len(), 1);
            let other = format!("before {} after", say("q1", "q1"));
            assert_eq!(text(&other), other);
        }
        assert_eq!(text("Commit b1f3478181d7 (changed), now"), text("Commit 0000000000aa, now"));
    }
}
