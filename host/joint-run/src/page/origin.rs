//! Provenance of a run: joint, board and image, the command that repeats it, and the board's log. This module judges no
//! figure.

use super::sections::mark;
use crate::record::RunRecord;
use report::document::{Block, Row, Table, Tone, facts, row, section, text, words};
use report::number::PAGE;

/// Log lines shown at most; the JSON has all.
const LOG_LINES_MAX: usize = 200;

/// Identity of the run, and the command that repeats it.
pub fn identity(record: &RunRecord) -> Block {
    let (identity, settings) = (&record.identity, &record.settings);
    let image = identity.image.as_ref();
    let unknown = || "not known to this host".to_owned();
    let rows = [
        ("Joint", format!("{} ({})", identity.joint, identity.joint_file)),
        ("Joint digest", identity.joint_digest.clone()),
        ("Board", format!("{}, {}", identity.board, identity.transport)),
        ("Role, firmware", format!("{} {}", identity.role, identity.firmware_version)),
        ("Core clock", identity.clock.clone()),
        ("Sub-steps at contact changes", format!("{} {}", settings.substeps, settings.method)),
        ("Time for the worst tick", if identity.forced { "none: built by --force" } else { "yes" }.to_owned()),
        ("Image", image.map_or_else(unknown, |image| image.file.clone())),
        ("ELF SHA-256", image.map_or_else(unknown, |image| image.elf_sha256.clone())),
        (
            "Flash, RAM",
            image.map_or_else(unknown, |image| {
                format!("{} bytes, {} bytes", PAGE.write(image.flash_bytes as f64), PAGE.write(image.ram_bytes as f64))
            }),
        ),
        ("Compiler", image.map_or_else(unknown, |image| image.compiler.clone())),
        ("Flags", image.map_or_else(unknown, |image| image.flags.clone())),
        ("Source commit", identity.git_commit.clone().unwrap_or_else(|| "not under git".into())),
        ("Host", format!("{}, joint {}", identity.host, identity.host_version)),
        ("Date", identity.date.clone()),
        ("Profile, seed", format!("{}, {}", settings.profile, settings.seed)),
    ];
    section(text("What ran") + mark(record), vec![facts(rows), Block::Again(settings.replay.clone())])
}

/// Identity of the run in one line, for below a picture.
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
        // Only the profile and its settings; the report has the rest.
        parts.push(until(&image.flags, ", --"));
    }
    parts.join(" · ")
}

/// Log of the board.
pub fn log(record: &RunRecord) -> Option<Block> {
    let rows = record.log.iter().take(LOG_LINES_MAX).map(|line| Row {
        tone: match line.level.as_str() {
            "error" => Tone::Failed,
            "warn" => Tone::Open,
            _ => Tone::Plain,
        },
        ..row([&line.timestamp, &line.level, &line.text])
    });
    let table = Table { columns: ["", "", ""].map(words).into(), rows: rows.collect(), log: true };
    let mut blocks = vec![Block::Table(table)];
    let more = record.log.len().saturating_sub(LOG_LINES_MAX);
    if more > 0 {
        blocks.push(Block::Paragraph(format!("{more} more lines are in the JSON file.").into()));
    }
    (!record.log.is_empty()).then(|| section("Log of the board", blocks))
}
