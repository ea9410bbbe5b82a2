//! The page: head, verdict, notices and the order of the sections. What stands in a section is in
//! `sections` and `origin`.

use maud::{Markup, html};

use super::{origin, sections};
use crate::record::{Completeness, RunRecord};
use report::checks::Verdict;
use report::plot::unit::figure as number;
use report::shell::page;

/// The whole page.
pub fn render(record: &RunRecord) -> String {
    let identity = &record.identity;
    let body = html! {
        (header(record))
        (notices(record))
        (sections::tiles(record))
        (sections::checks(record))
        (sections::motion(record))
        (sections::timing(record))
        (origin::identity(record))
        (origin::log(record))
        footer {
            "joint " (identity.host_version) " · schema version " (record.schema_version)
            " · every value of this page is in the JSON file of the same run"
        }
    };
    page(&format!("Joint {}: {}", identity.joint, verdict(record).1), "", &body)
}

/// The mark on everything that an emulator measured.
pub fn emulated(record: &RunRecord) -> Markup {
    html! { @if record.identity.emulated { " " span.emulated { "EMULATED" } } }
}

/// Style class and word for the outcome.
fn verdict(record: &RunRecord) -> (&'static str, String) {
    let failed = record.checks.iter().filter(|check| check.verdict == Verdict::Failed).count();
    match (&record.completeness, failed) {
        (Completeness::Interrupted { .. }, _) => ("failed", "INCOMPLETE".into()),
        (Completeness::Complete, 0) => ("passed", "PASSED".into()),
        (Completeness::Complete, 1) => ("failed", "1 CHECK FAILED".into()),
        (Completeness::Complete, n) => ("failed", format!("{n} CHECKS FAILED")),
    }
}

fn header(record: &RunRecord) -> Markup {
    let identity = &record.identity;
    let (class, word) = verdict(record);
    html! {
        header {
            div.title {
                h1 { "Joint " (identity.joint) }
                span class={ "pill " (class) } { (word) }
                (emulated(record))
            }
            p.subtitle {
                "Hardware in the loop: " (identity.role) " on " (identity.board)
                " · profile " (record.settings.profile) " · " (record.settings.mode)
                " · " (number(f64::from(record.settings.tick_rate_hz) / 1e3)) " kHz · " (identity.date)
            }
        }
    }
}

fn notices(record: &RunRecord) -> Markup {
    let identity = &record.identity;
    html! {
        @if let Completeness::Interrupted { reason, tick } = &record.completeness {
            div.notice.bad role="alert" {
                strong { "INCOMPLETE. " }
                "The run broke off at tick " (tick) " of " (record.settings.ticks) ": " (reason)
                ". What was recorded until then is shown below; checks that need the rest were not made."
            }
        }
        @for fault in &record.faults {
            div.notice.bad {
                strong { "FAULT " (fault.name) } @if let Some(tick) = fault.tick { " at tick " (tick) } ": " (fault.text)
            }
        }
        @if let Some(panic) = &identity.last_panic {
            div.notice.bad { strong { "PANIC before the last reset: " } code { (panic) } }
        }
        @if identity.watchdog_reset {
            div.notice.bad { strong { "WATCHDOG. " } "The last reset before this run came from the watchdog." }
        }
        @if identity.emulated {
            div.notice {
                strong { "EMULATED. " }
                "The board was " (identity.transport) ". Motion is computed by the very machine code that a real "
                "board is flashed with; times are the emulator’s counts and say nothing about a real chip."
            }
        }
    }
}
