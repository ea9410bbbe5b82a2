//! One test in the report: what was asserted, every controller beside the others, pictures. What stands around it is the
//! page's.

use maud::{Markup, PreEscaped, html};

use super::{anchor, pill};
use crate::campaign::Tested;
use crate::controller::ControllerName;
use crate::pictures;
use crate::record::TestRecord;
use report::checks::Check;
use report::parts::check_table;
use report::plot::Figure;
use report::plot::unit::figure as number;

/// What is shown of every controller: name, heading, unit.
const COMPARED: [(&str, &str, &str); 9] = [
    ("rms_mrad", "error RMS", "mrad"),
    ("peak_mrad", "error peak", "mrad"),
    ("reversal_error_mrad", "reversal error", "mrad"),
    ("deviation_rms_mrad", "deviation RMS", "mrad"),
    ("lost_motion_ms", "lost motion", "ms"),
    ("crossings", "crossings", ""),
    ("effort_N_m", "torque effort", "N m"),
    ("peak_mesh_force_N", "peak mesh force", "N"),
    ("peak_mesh_force_ratio", "over rated", ""),
];

/// Everything about a test.
pub(super) fn section(tested: &Tested) -> Markup {
    let test = &tested.record;
    let checks: Vec<Check> = test.assertions.iter().map(|assertion| assertion.check()).collect();
    html! {
        section.names id=(anchor(test)) {
            div.title { h2 { (test.file) } (pill(test)) }
            p.subtitle {
                @if !test.title.is_empty() { strong { (test.title) } " · " }
                "joint " (test.joint) " · profile " (test.profile) " · controller " (test.controller)
                " · " (number(test.duration_s)) " s, figures from " (number(test.settle_s)) " s on"
                @for fault in &test.faults { " · fault " (fault) }
            }
            @if let Some(why) = &test.broken { div.notice.bad role="alert" { strong { "BROKEN OFF. " } (why) } }
            @if checks.is_empty() { p.none { "Nothing is asserted." } } @else { (check_table(&checks, &html! {})) }
            (compared(test))
            @if test.passed {
                details { summary { "Pictures, seed " (test.shown_seed) } (all_pictures(tested)) }
            } @else { (all_pictures(tested)) }
            h3 { "Again" }
            pre { (test.replay) }
        }
    }
}

/// Figures of every controller, worst of all seeds.
fn compared(test: &TestRecord) -> Markup {
    let controllers = test.controllers();
    let shown: Vec<_> = COMPARED
        .into_iter()
        .filter(|(name, _, _)| controllers.iter().any(|controller| test.largest(controller, name).is_some()))
        .collect();
    html! {
        h3 { "With compensation and without" }
        table.wide {
            thead { tr {
                th { "Controller" }
                @for (_, heading, unit) in &shown { th.number { (heading) @if !unit.is_empty() { " " span.whole { "[" (unit) "]" } } } }
            } }
            tbody { @for controller in &controllers {
                tr {
                    td.whole { (ControllerName::of_word(controller, false).label()) }
                    @for (name, _, _) in &shown { td.number { (test.largest(controller, name).map_or("–".into(), number)) } }
                }
            } }
        }
        @if test.seeds.len() > 1 { p.note { "Largest of " (test.seeds.len()) " seeds." } }
    }
}

fn all_pictures(tested: &Tested) -> Markup {
    html! {
        @if let Some(whole) = pictures::whole(tested) {
            (picture(&whole, html! { "Seed " (tested.record.shown_seed) ", least and greatest error of each stretch; lost motion is the time that each crossing took. Figures are taken from "
                (number(tested.record.settle_s)) " s on." }))
        }
        @if let Some(close) = pictures::close(tested) {
            (picture(&close, html! { strong { "Closely: " } "the longest crossing of the gap after " (number(tested.record.settle_s)) " s, a point each millisecond." }))
        }
    }
}

fn picture(figure: &Figure, caption: Markup) -> Markup {
    html! { figure { (PreEscaped(figure.to_svg())) figcaption { (caption) } } }
}
