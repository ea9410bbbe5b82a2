//! What several pages are put together from: a tile with a key figure, the table of checks.

use maud::{Markup, html};

use crate::checks::{Bound, Check, Source, Verdict};
use crate::plot::unit::figure as number;

/// A key figure with its name; `mark` stands behind the name.
pub fn tile(name: &str, mark: Markup, value: Markup) -> Markup {
    html! { div.tile { div.value { (value) } div.name { (name) (mark) } } }
}

/// The table alone; `board` marks what a board measured.
pub fn check_table(checks: &[Check], board: &Markup) -> Markup {
    let mut checks: Vec<&Check> = checks.iter().collect();
    checks.sort_by_key(|check| match check.verdict {
        Verdict::Failed => 0,
        Verdict::NotRun => 1,
        Verdict::Passed => 2,
        Verdict::Reported => 3,
    });
    html! {
        @if checks.is_empty() { p.none { "No check was made." } } @else {
            table.checks {
                thead { tr { th { "Verdict" } th { "Check" } th.number { "Figure" } th.number { "Bound" } th { "Note" } } }
                tbody { @for check in checks { (check_row(check, board)) } }
            }
        }
    }
}

fn check_row(check: &Check, board: &Markup) -> Markup {
    let (class, word) = match check.verdict {
        Verdict::Passed => ("passed", "held"),
        Verdict::Failed => ("failed", "FAILED"),
        Verdict::NotRun => ("open", "not made"),
        Verdict::Reported => ("reported", "reported"),
    };
    let with_unit = |value: f64| match check.unit.as_str() {
        "" => number(value),
        // As typed in a terminal, and as printed.
        "us" => format!("{} µs", number(value)),
        unit => format!("{} {unit}", number(value)),
    };
    let bound = match check.bound {
        Bound::AtMost(bound) => format!("≤ {}", with_unit(bound)),
        Bound::AtLeast(bound) => format!("≥ {}", with_unit(bound)),
        Bound::Exactly(bound) => format!("= {}", with_unit(bound)),
        Bound::None => "–".into(),
    };
    html! {
        tr class=(class) {
            td.verdict { span class={ "mark " (class) } { (word) } }
            td.name { (check.name) @if check.source == Source::Board { (board) } }
            td.number { (check.figure.map_or("–".into(), with_unit)) }
            td.number { (bound) }
            td.note { (check.note) }
        }
    }
}
