//! Where a run comes from: who ran what, how to run it again, and what the board said meanwhile. All of it is text; no
//! figure is judged here.

use maud::{Markup, html};

use super::whole::emulated;
use crate::record::RunRecord;
use report::plot::unit::figure as number;

/// Log lines shown; the JSON has all.
const MOST_LOG_LINES: usize = 200;

/// Who ran what, and how to run it again.
pub fn identity(record: &RunRecord) -> Markup {
    let (identity, settings) = (&record.identity, &record.settings);
    let image = identity.image.as_ref();
    let unknown = || "not known to this host".to_owned();
    let rows = [
        ("Joint", format!("{} ({})", identity.joint, identity.joint_file)),
        ("Joint digest", identity.joint_digest.clone()),
        ("Board", format!("{}, {}", identity.board, identity.transport)),
        ("Role, firmware", format!("{} {}", identity.role, identity.firmware_version)),
        ("Core clock", identity.clock.clone()),
        ("Image", image.map_or_else(unknown, |image| image.file.clone())),
        ("ELF SHA-256", image.map_or_else(unknown, |image| image.elf_sha256.clone())),
        (
            "Flash, RAM",
            image.map_or_else(unknown, |image| {
                format!("{} bytes, {} bytes", number(image.flash_bytes as f64), number(image.ram_bytes as f64))
            }),
        ),
        ("Compiler", image.map_or_else(unknown, |image| image.compiler.clone())),
        ("Flags", image.map_or_else(unknown, |image| image.flags.clone())),
        ("Source commit", identity.git_commit.clone().unwrap_or_else(|| "not under git".into())),
        ("Host", format!("{}, joint {}", identity.host, identity.host_version)),
        ("Date", identity.date.clone()),
        ("Profile, seed", format!("{}, {}", settings.profile, settings.seed)),
    ];
    html! {
        section {
            h2 { "What ran" (emulated(record)) }
            table.identity { tbody { @for (name, value) in rows { tr { th { (name) } td { (value) } } } } }
            h3 { "To run exactly this again" }
            pre { (settings.replay) }
        }
    }
}

/// What ran, short enough to stand below a picture.
pub fn in_one_line(record: &RunRecord) -> String {
    let identity = &record.identity;
    let mut parts = vec![format!("Joint {} on {}", identity.joint, identity.board)];
    if identity.emulated {
        parts.push("EMULATED".into());
    }
    if let Some(image) = &identity.image {
        let until = |text: &str, end: &str| text.split(end).next().unwrap_or_default().to_owned();
        parts.push(format!("ELF {}", image.elf_sha256.chars().take(12).collect::<String>()));
        parts.push(until(&image.compiler, " ("));
        // The profile and what it sets; the rest is in the report.
        parts.push(until(&image.flags, ", --"));
    }
    parts.join(" · ")
}

/// What the board said.
pub fn log(record: &RunRecord) -> Markup {
    if record.log.is_empty() {
        return html! {};
    }
    html! {
        section {
            h2 { "Log of the board" }
            table.log { tbody {
                @for line in record.log.iter().take(MOST_LOG_LINES) {
                    tr class={ "level-" (line.level) } { td { (line.timestamp) } td { (line.level) } td { (line.text) } }
                }
            } }
            @if record.log.len() > MOST_LOG_LINES {
                p.none { (record.log.len() - MOST_LOG_LINES) " more lines are in the JSON file." }
            }
        }
    }
}
