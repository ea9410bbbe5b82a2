//! The findings as one HTML page that needs neither network nor scripts, in the style of the other reports. Figures are
//! made elsewhere; this puts them in order.

use maud::{Markup, PreEscaped, html};

use super::findings::Finding;
use super::table::number;
use report::plot::Figure;
use report::shell::page;

/// What the page shows.
pub struct Content<'a> {
    /// Name of the joint.
    pub joint: &'a str,
    /// Name of the log.
    pub log: &'a str,
    /// How long it is [s].
    pub duration: f64,
    /// Changes of the carrying flank in it.
    pub crossings: usize,
    /// What was found.
    pub findings: &'a [Finding],
    /// What the joint file says for a finding.
    pub stated: &'a dyn Fn(&Finding) -> Option<String>,
    /// The pictures, first the most telling.
    pub figures: &'a [Figure],
    /// What the numbers rest on.
    pub assumptions: &'a [String],
}

/// The whole page.
pub fn render(content: &Content<'_>) -> String {
    let body = html! {
        header {
            div.title { h1 { "Joint " (content.joint) " identified" } }
            p.subtitle {
                (content.log) " · " (format!("{:.2} s", content.duration)) " · " (content.crossings)
                " crossings of the gap"
            }
        }
        section { h2 { "What was found" } (table(content)) }
        section {
            h2 { "How it fits" }
            @for figure in content.figures { figure { (PreEscaped(figure.to_svg())) } }
        }
        section {
            h2 { "What it rests on" }
            ul { @for assumption in content.assumptions { li { (typeset(assumption)) } } }
        }
        footer { "joint " (env!("CARGO_PKG_VERSION")) }
    };
    page(&format!("Joint {} identified", content.joint), "", &body)
}

fn table(content: &Content<'_>) -> Markup {
    html! {
        table {
            thead { tr {
                th { "Parameter" } th.number { "found" } th.number { "95 % interval" } th { "unit" }
                th.number { "joint file" } th { "note" }
            } }
            tbody { @for finding in content.findings { tr {
                td { (finding.name) }
                td.number { (finding.value.map_or_else(|| "–".into(), number)) }
                td.number {
                    (finding.interval.map_or_else(|| "–".into(), |[low, high]| format!("{} … {}", number(low), number(high))))
                }
                td { (unit(&finding.unit)) }
                @let stated = (content.stated)(finding);
                td.number { @match &stated {
                    Some(stated) if differs(finding, stated) => strong { (stated) },
                    Some(stated) => (stated),
                    None => "–",
                } }
                td { (typeset(&finding.note)) }
            } } }
        }
        @if content.findings.iter().any(|finding| (content.stated)(finding).is_some_and(|stated| differs(finding, &stated))) {
            p.note { "Bold: what the joint file says is outside of the interval." }
        }
    }
}

/// Whether a stated value is outside of the interval.
fn differs(finding: &Finding, stated: &str) -> bool {
    let stated: Option<f64> = stated.replace('_', "").parse().ok();
    stated.zip(finding.interval).is_some_and(|(stated, [low, high])| !(low..=high).contains(&stated))
}

/// Signs that a terminal may not have.
fn typeset(text: &str) -> String {
    text.replace("+- ", "± ").replace(" us", " µs")
}

/// As it is written where there are Greek letters.
fn unit(unit: &str) -> String {
    let micro = unit.strip_prefix('u').map_or(unit.to_owned(), |rest| format!("µ{rest}"));
    micro.replace(' ', "·")
}
