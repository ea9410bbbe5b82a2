//! Origin of a record's figures: date, sources, host.

use std::process::Command;

use crate::workspace::{has_sources, workspace};

/// Version of this command.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Current time in UTC, to the second, in ISO 8601.
pub fn date() -> String {
    let now = time::OffsetDateTime::now_utc();
    now.replace_nanosecond(0).unwrap_or(now).format(&time::format_description::well_known::Rfc3339).unwrap_or_default()
}

/// Commit of the sources, if they are under git; with ` (changed)` if they differ from it.
pub fn git_commit() -> Option<String> {
    // An installed program may lie in a repository of its user, whose commit says nothing about these sources.
    if !has_sources() {
        return None;
    }
    let git = |arguments: &[&str]| {
        let output = Command::new("git").arg("-C").arg(workspace()).args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let commit = git(&["rev-parse", "--short=12", "HEAD"])?;
    let changed = git(&["status", "--porcelain"]).is_some_and(|changes| !changes.is_empty());
    Some(if changed { format!("{commit} (changed)") } else { commit })
}

/// Operating system and processor of the host.
pub fn host() -> String {
    format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)
}
