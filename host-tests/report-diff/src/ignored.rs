//! All ignored values in one place: values that differ between two runs of the same sources. Each rule has a reason, and a name by which
//! the report counts ignored values. Nothing else is ignored anywhere.

use std::fmt;

/// Date of the run.
pub const DATE: &str = "date";
/// Time of day of the run.
pub const CLOCK: &str = "time of day";
/// Folder of sources and results on this machine; the last part of a path is compared.
pub const PATH: &str = "folder";
/// Time spent by the host, by clock or processor time.
pub const HOST_TIME: &str = "host time";
/// Commit of the sources.
pub const COMMIT: &str = "commit";
/// Digest of an ELF file, which includes names and paths in its debugging information that no board sees. Its sizes and its behaviour on a
/// board are compared.
pub const ELF_DIGEST: &str = "digest of an ELF file";
/// Arrival times of bytes between host and emulator, which depend on the host: number of ticks that waited for them, and the tick or call
/// depth at which an interrupt of the line occurred. The step does not depend on them. Mean, least and greatest time of a tick are
/// compared, as are the RAM of statics and the deepest stack that `joint hil --check` finds in the image.
pub const LINE_TIMING: &str = "timing of the line";

/// Lists of files with digests and dates; the files themselves are compared.
pub const FILES: [&str; 1] = [".written-by-joint"];

/// Place of an ignored value. In phrases, `#` is an ignored number and `@` an ignored digest of hexadecimal digits.
#[derive(Debug, Clone, Copy)]
pub enum Place {
    /// Value below a key of JSON, or of the metadata of an MCAP log, whose path ends so.
    Key(&'static str),
    /// Value below a key in a JSON object with this `name`.
    Named(&'static str, &'static str),
    /// Value of an XML attribute.
    Attribute(&'static str),
    /// Number or digest in a phrase of any text, with single spaces between words.
    Phrase(&'static str),
    /// Column of a table of text or HTML whose first column has this head, in either case.
    Column(&'static str, &'static str),
    /// Cell of an HTML table to the right of this cell, which may end with [`MARK`].
    Beside(&'static str),
    /// Line of this form before or after the line with this figure's name, on a page.
    Tile(&'static str, &'static str),
}

/// Suffix of the name of a figure measured by an emulator.
pub const MARK: &str = " EMULATED";

/// Suffix of a commit whose sources were modified.
pub const CHANGED: &str = " (changed)";

/// Places and the rules that apply to them. The rules for dates, times of day and folders apply everywhere.
pub const RULES: &[(Place, &str)] = &[
    (Place::Key("date"), DATE),
    (Place::Key("git_commit"), COMMIT),
    (Place::Key("commit"), COMMIT),
    (Place::Key("elf_sha256"), ELF_DIGEST),
    // A test or a whole run of tests.
    (Place::Key("seconds"), HOST_TIME),
    // Schemes of `joint sim --scheme all`.
    (Place::Key("cost_ratio"), HOST_TIME),
    (Place::Key("cost_s_per_s"), HOST_TIME),
    // Libraries of `joint bench`.
    (Place::Key("host.times.cost"), HOST_TIME),
    (Place::Key("host_at_equal_error"), HOST_TIME),
    // Runs on the emulated board.
    (Place::Key("timing.counters.waited"), LINE_TIMING),
    (Place::Key("timing.idle_percent"), LINE_TIMING),
    (Place::Key("timing.stack_used_bytes"), LINE_TIMING),
    (Place::Key("samples.computation_s"), LINE_TIMING),
    (Place::Named("idle time", "figure"), LINE_TIMING),
    (Place::Named("ticks that waited for the schedule or the line", "figure"), LINE_TIMING),
    (Place::Named("RAM used", "figure"), LINE_TIMING),
    (Place::Named("RAM used", "note"), LINE_TIMING),
    (Place::Attribute("time"), HOST_TIME),
    (Place::Attribute("timestamp"), DATE),
    (Place::Phrase("runs, # s)"), HOST_TIME),
    (Place::Phrase("commit @"), COMMIT),
    (Place::Phrase("Commit @,"), COMMIT),
    (Place::Phrase("image @"), ELF_DIGEST),
    (Place::Phrase("idle time # %"), LINE_TIMING),
    (Place::Phrase("waited for the schedule or the line #"), LINE_TIMING),
    (Place::Phrase("RAM used # B"), LINE_TIMING),
    (Place::Phrase("and # B of stack at its deepest"), LINE_TIMING),
    (Place::Column("scheme", "cost"), HOST_TIME),
    (Place::Beside("Source commit"), COMMIT),
    (Place::Beside("Sources"), COMMIT),
    (Place::Beside("Date"), DATE),
    (Place::Beside("idle time"), LINE_TIMING),
    (Place::Beside("Idle share"), LINE_TIMING),
    (Place::Beside("ticks that waited for the schedule or the line"), LINE_TIMING),
    (Place::Beside("Waits"), LINE_TIMING),
    (Place::Beside("RAM used"), LINE_TIMING),
    (Place::Beside("Deepest stack"), LINE_TIMING),
    (Place::Tile("On the clock", "# s"), HOST_TIME),
    (Place::Tile("Idle", "# %"), LINE_TIMING),
];

/// Rule for the first place that satisfies `is_there`.
pub fn rule(is_there: impl Fn(&Place) -> bool) -> Option<&'static str> {
    RULES.iter().find(|(place, _)| is_there(place)).map(|(_, rule)| *rule)
}

/// Rule that ignores the value below a key, given all keys on the path, joined by dots.
pub fn ignored_key(path: &str) -> Option<&'static str> {
    let ends = |end: &str| path.strip_suffix(end).is_some_and(|before| before.is_empty() || before.ends_with('.'));
    rule(|place| matches!(place, Place::Key(end) if ends(end)))
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Key(end) => write!(f, "key {end}"),
            Self::Named(name, key) => write!(f, "{key} of `{name}`"),
            Self::Attribute(name) => write!(f, "attribute {name}"),
            Self::Phrase(words) => write!(f, "`#` or `@` in `{words}`"),
            Self::Column(first, column) => write!(f, "column {column} of a table that begins with {first}"),
            Self::Beside(name) => write!(f, "cell beside {name}"),
            Self::Tile(name, form) => write!(f, "`#` in `{form}` beside `{name}`"),
        }
    }
}

/// List of all rules, for the user.
pub fn list() -> String {
    let places: String = RULES.iter().map(|(place, rule)| format!("  {place}: {rule}\n")).collect();
    format!(
        "Ignored everywhere:\n  {DATE}\n  {CLOCK}\n  {PATH}\n  `{}`: {COMMIT}\n\
         Ignored at these places:\n{places}",
        CHANGED.trim()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A key matches by the end of its path.
    #[test]
    fn key_matches_by_end_of_path() {
        assert_eq!(ignored_key("identity.date"), Some(DATE));
        assert_eq!(ignored_key("host.times.cost"), Some(HOST_TIME));
        for kept in ["methods.cost", "duration_s", "date.figure", "update"] {
            assert_eq!(ignored_key(kept), None, "{kept}");
        }
    }
}
