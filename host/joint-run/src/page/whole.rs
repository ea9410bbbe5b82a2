//! Report of a run as a document: head, verdict, notices and the order of the sections. A terminal shows the checks
//! only. `sections` and `origin` fill the sections.

use super::{origin, sections};
use crate::record::{Completeness, RunRecord};
use report::checks::Verdict;
use report::document::{
    Block, Checks, Document, PAGES, Tone, alert, bad_notice, code, notice, section_bare, strong, text, verdict_of,
};
use report::number::PAGE;

/// Whole report of a run.
pub fn document(record: &RunRecord) -> Document {
    let identity = &record.identity;
    let checks = Checks { checks: record.checks.clone(), emulated: identity.emulated, keys: false };
    let mut blocks = vec![
        Block::Only(PAGES, notices(record)),
        sections::tiles(record),
        section_bare("Checks", vec![Block::Checks(checks)]),
        sections::motion(record),
        sections::timing(record),
        origin::identity(record),
    ];
    blocks.extend(origin::log(record));
    let verdict = verdict(record);
    Document {
        title: format!("Joint {}: {}", identity.joint, verdict.1),
        heading: text("Joint ") + &identity.joint,
        verdict: Some(verdict),
        emulated: identity.emulated,
        subtitle: format!(
            "Hardware in the loop: {} on {} · profile {} · {} · {} kHz · {}",
            identity.role,
            identity.board,
            record.settings.profile,
            record.settings.mode,
            PAGE.write(f64::from(record.settings.tick_rate_hz) / 1e3),
            identity.date
        )
        .into(),
        line: format!("{} on {} ({})", identity.joint, identity.board, identity.transport).into(),
        blocks,
        footer: format!(
            "joint {} · schema version {} · every value of this page is in the JSON file of the same run",
            identity.host_version, record.schema_version
        )
        .into(),
    }
}

fn verdict(record: &RunRecord) -> (Tone, String) {
    match record.completeness {
        Completeness::Interrupted { .. } => (Tone::Failed, "INCOMPLETE".into()),
        Completeness::Complete => {
            verdict_of(record.checks.iter().filter(|check| check.verdict == Verdict::Failed).count())
        }
    }
}

fn notices(record: &RunRecord) -> Vec<Block> {
    let identity = &record.identity;
    let mut notices = Vec::new();
    if let Completeness::Interrupted { reason, tick } = &record.completeness {
        notices.push(alert(
            strong("INCOMPLETE. ")
                + format!(
                    "The run broke off at tick {tick} of {}: {reason}. The recording up to that tick is shown below; \
                         checks that need the rest were not run.",
                    record.settings.ticks
                ),
        ));
    }
    for fault in &record.faults {
        let tick = fault.tick.map(|tick| format!(" at tick {tick}"));
        notices.push(bad_notice(strong(format!("FAULT {}", fault.name)) + tick + ": " + &fault.text));
    }
    if let Some(panic) = &identity.last_panic {
        notices.push(bad_notice(strong("PANIC before the last reset: ") + code(panic)));
    }
    if identity.watchdog_reset {
        notices.push(bad_notice(strong("WATCHDOG. ") + "The last reset before this run came from the watchdog."));
    }
    if identity.emulated {
        notices.push(notice(
            strong("EMULATED. ")
                + format!(
                    "The board was {}. Motion is computed by the very machine code that a real board is flashed with; \
                     times are the emulator’s counts and say nothing about a real chip.",
                    identity.transport
                ),
        ));
    }
    notices
}
