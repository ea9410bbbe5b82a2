//! The comparison as one HTML page that needs neither network nor scripts, in the style of the run reports. Figures are
//! made elsewhere; this puts them in order.

use maud::{Markup, PreEscaped, html};

use super::Figures;
use super::lineup::CaseFigures;
use super::verdicts::{AtError, LEVELS};
use super::{pictures, table};
use report::plot::Figure;
use report::shell::page;

/// The whole page.
pub fn render(figures: &Figures) -> String {
    let body = html! {
        header {
            div.title { h1 { "Error against cost" } }
            p.subtitle {
                "This step beside the methods that people use · instructions counted on the "
                strong { "EMULATED" } " Cortex-M4F · error is the worst over phases of the excitation"
            }
        }
        @if let Some(reason) = figures.host.as_ref().and_then(|host| host.without_cvode.as_ref()) {
            div.notice { strong { "CVODE is not among the libraries: " } (reason) }
        }
        @for case in &figures.cases { (section(figures, case)) }
        (origin(figures))
        footer { "joint " (env!("CARGO_PKG_VERSION")) }
    };
    page("Error against cost", "", &body)
}

fn section(figures: &Figures, case: &CaseFigures) -> Markup {
    let times = figures.host.as_ref().map_or(&[][..], |host| &host.times);
    let reached = |list: &[AtError]| list.iter().filter(|at| at.case == case.key).cloned().collect::<Vec<_>>();
    html! {
        section {
            h2 { "Case " (case.key) ": " (case.title) }
            p.lead {
                "Error: " (case.measure) ", worst of " (case.phases) " phases. A start moved by a millionth of b"
                sub { "c" } " moves the reference itself by " (format!("{:.0e}", case.sensitivity)) "." (table::windows(case))
            }
            @if let Some(figure) = pictures::board(case, &figures.methods) { (picture(&figure)) }
            (equal("Instructions at equal error", &reached(&figures.at_equal_error), |cost| format!("{:.1} M/s", cost / 1e6)))
            @if let Some(figure) = pictures::host(case, times) { h3 { "On the host" } (picture(&figure)) }
            (equal("Processor time at equal error", &reached(&figures.host_at_equal_error), |cost| format!("{:.2} ms/s", 1e3 * cost)))
        }
    }
}

fn picture(figure: &Figure) -> Markup {
    html! { figure { (PreEscaped(figure.to_svg())) } }
}

fn equal(title: &str, found: &[AtError], cost: impl Fn(f64) -> String) -> Markup {
    let mut names: Vec<&str> = Vec::new();
    for at in found {
        if !names.contains(&at.name.as_str()) {
            names.push(&at.name);
        }
    }
    let cell = |name: &str, level: f64| found.iter().find(|at| at.name == name && at.error == level);
    html! {
        @if found.iter().any(|at| at.cost.is_some()) {
            h3 { (title) }
            table {
                thead { tr {
                    th { "Method" }
                    @for level in LEVELS { th.number { "at " (format!("{level:.0e}")) } th.number { "over this step" } }
                } }
                tbody { @for name in names { tr {
                    td { (name) }
                    @for level in LEVELS {
                        @let at = cell(name, level);
                        td.number { (at.and_then(|at| at.cost).map_or_else(|| "not reached".into(), &cost)) }
                        td.number { (at.and_then(|at| at.ratio).map_or_else(|| "–".into(), |ratio| format!("{ratio:.2}"))) }
                    }
                } } }
            }
        }
    }
}

fn origin(figures: &Figures) -> Markup {
    let origin = &figures.origin;
    let rows = [
        ("Board", &origin.emulator),
        ("Compiler", &origin.compiler),
        ("Flags", &origin.flags),
        ("Host", &origin.host),
        ("Source commit", &origin.commit),
        ("Date", &origin.date),
    ];
    html! {
        section {
            h2 { "What ran" }
            table.identity { tbody { @for (name, value) in rows { tr { th { (name) } td { (value) } } } } }
        }
    }
}
