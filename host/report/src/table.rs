//! The table of checks on a terminal: verdict, figure, bound. The report shows the same with more room.

use std::fmt::Write;

use crate::checks::{Bound, Check, Source, Verdict};

/// The table; figures of an emulated board are marked.
pub fn table(checks: &[Check], emulated: bool) -> String {
    let width = checks.iter().map(|check| check.name.chars().count()).max().unwrap_or(0);
    let mut text = String::new();
    for check in checks {
        let figure = check.figure.map_or_else(|| "-".to_owned(), number);
        let mark = if emulated && check.source == Source::Board && is_time(check) { "  EMULATED" } else { "" };
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "{:8} {:width$}  {figure:>10} {:2} {:18}{mark}",
            verdict(check.verdict),
            check.name,
            check.unit,
            bound(check.bound)
        );
        let trimmed = text.trim_end().len();
        text.truncate(trimmed);
        if !check.note.is_empty() && check.verdict != Verdict::Passed {
            let _ = write!(text, "\n{:8} {:4}{}", "", "", check.note);
        }
        text.push('\n');
    }
    text
}

fn is_time(check: &Check) -> bool {
    matches!(check.unit.as_str(), "us" | "%") || check.name == "overruns"
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Passed => "ok",
        Verdict::Failed => "FAILED",
        Verdict::NotRun => "not made",
        Verdict::Reported => "-",
    }
}

fn bound(bound: Bound) -> String {
    match bound {
        Bound::AtMost(limit) => format!("<= {}", number(limit)),
        Bound::AtLeast(limit) => format!(">= {}", number(limit)),
        Bound::Exactly(wanted) => format!("=  {}", number(wanted)),
        Bound::None => String::new(),
    }
}

/// Whole numbers whole, others to four digits.
fn number(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 {
        return format!("{value}");
    }
    if !value.is_finite() {
        return value.to_string();
    }
    match value.abs() {
        size if size >= 1000.0 => format!("{value:.0}"),
        size if size >= 0.01 => {
            let digits = (3 - size.log10().floor() as i32).max(0) as usize;
            format!("{value:.digits$}")
        }
        _ => format!("{value:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_shows_verdict_figure_bound_and_why_it_failed() {
        let good = Check::judge("overruns", 0.0, "", Bound::Exactly(0.0), Source::Board).note("fine");
        let bad = Check::judge("lateness", 61.25, "us", Bound::AtMost(50.0), Source::Board).note("too late");
        let text = table(&[good, bad], true);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3, "{text}");
        assert!(lines[0].starts_with("ok ") && lines[0].ends_with("EMULATED"), "{text}");
        assert!(lines[1].starts_with("FAILED") && lines[1].contains("61.25 us <= 50"), "{text}");
        assert_eq!(lines[2].trim(), "too late");
        assert!(!table(&[Check::judge("x", 1.0, "us", Bound::None, Source::Board)], false).contains("EMULATED"));
    }

    #[test]
    fn figures_keep_four_digits_at_most() {
        assert_eq!(
            [0.0, 100_000.0, 12.345_67, 0.001_234_5, 4321.9].map(number),
            ["0", "100000", "12.35", "1.23e-3", "4322"]
        );
        assert_eq!(number(f64::NAN), "NaN");
    }
}
